//! Networks over sets: shared encoders for hotspots and neighbours, pooled by attention and by sum.
//!
//! The same weights work for any number of hotspots and neighbours. Some
//! [features](super::features) are computed rather than learnt.

use jcas_core::observation::index_tag;

use super::dense::{LANES, Layer, Rows, relu};
use super::features::{CROWD, describe_hotspots, describe_neighbour};
use super::layout::Set;
use super::matmul::MatmulKernel;
use super::mlp::ROWS;
use super::row::{HOTSPOT_FIELDS, OWN_FIRST, RowLayout, SLOT_FIELDS};

/// The number of neighbours that are encoded together.
const SLOTS: usize = 16;

/// The sizes of the observations of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sizes {
    pub(crate) row: RowLayout,
    /// Number of UAVs of an episode; their rows are consecutive.
    pub(crate) uavs: usize,
    /// Whether the network reads the number of UAVs.
    pub(crate) fleet_size: bool,
    /// The reach of the radar in cells, if the network reads chances of detection and ranks.
    pub(crate) reach: Option<f32>,
}

/// Splits the first `length` elements off `rest`.
fn take<'s>(rest: &mut &'s mut [f32], length: usize) -> &'s mut [f32] {
    let (taken, left) = core::mem::take(rest).split_at_mut(length);
    *rest = left;
    taken
}

/// Adds up padded rows of `width` numbers each.
fn add_up(rows: &[f32], width: usize, sums: &mut [f32]) {
    for row in rows.chunks_exact(width) {
        for (sum, x) in sums.iter_mut().zip(row) {
            *sum += x;
        }
    }
}

/// Writes the own fields: the two ends of an observation, then the tag and the size of the fleet
/// if the network reads them.
fn describe_own(head: &[f32], tail: &[f32], tag: f32, sizes: Sizes, own: &mut [f32]) {
    own[..OWN_FIRST].copy_from_slice(head);
    let (shown, unseen) = own[OWN_FIRST..].split_at_mut(tail.len());
    shown.copy_from_slice(tail);
    let (numbered, counted) = unseen.split_at_mut(unseen.len() - usize::from(sizes.fleet_size));
    numbered.fill(tag);
    counted.fill(sizes.uavs as f32 / CROWD);
}

fn divide(values: &mut [f32], by: f32) {
    for value in values {
        *value /= by;
    }
}

impl Set {
    fn embedding_width(&self) -> usize {
        self.hotspot.iter().map(Layer::width).fold(0, usize::max)
    }

    /// The length of the working memory, in numbers.
    pub(crate) fn scratch_len(&self, hotspots: usize) -> usize {
        let [first, second] = &self.neighbour;
        let slots = SLOTS * (first.inputs + first.width() + second.width());
        let context =
            self.own.inputs + self.own.width() + self.others.width() + self.hotspot[1].width();
        // The form of each hotspot, its score, and the row that the third layer reads.
        let related = self
            .relation
            .map_or(0, |form| form.width() + 1 + self.hotspot[2].inputs);
        let first = self.hotspot[0].inputs;
        let each = first + 2 * self.embedding_width() + related + self.score.width();
        slots
            + context
            + hotspots * each
            + ROWS * self.trunk.inputs()
            + self.trunk.scratch_len(ROWS)
    }

    /// Computes the padded outputs for at most [`ROWS`] observations. The first of them is row
    /// `first` of all observations.
    pub(crate) fn outputs<'s>(
        &self,
        matmul: MatmulKernel,
        weights: &[f32],
        observations: &[f32],
        first: usize,
        sizes: Sizes,
        scratch: &'s mut [f32],
    ) -> &'s [f32] {
        let rows = observations.len() / sizes.row.observation_len;
        let (inputs, scratch) = scratch.split_at_mut(rows * self.trunk.inputs());
        let observations = observations.chunks_exact(sizes.row.observation_len);
        let outs = inputs.chunks_exact_mut(self.trunk.inputs());
        for (index, (row, out)) in observations.zip(outs).enumerate() {
            let tag = index_tag((first + index) % sizes.uavs, sizes.uavs);
            self.pool(matmul, weights, row, tag, sizes, out, scratch);
        }
        self.trunk.apply(matmul, weights, inputs, scratch)
    }

    /// Computes the inputs of the trunk for one observation: attended hotspots, pooled neighbours,
    /// own fields.
    #[allow(clippy::too_many_arguments)]
    fn pool(
        &self,
        matmul: MatmulKernel,
        weights: &[f32],
        row: &[f32],
        tag: f32,
        sizes: Sizes,
        out: &mut [f32],
        mut scratch: &mut [f32],
    ) {
        let (n, embedded) = (sizes.row.hotspots, self.hotspot[2].outputs);
        let (head, rest) = row.split_at(OWN_FIRST);
        let (hotspots, rest) = rest.split_at(HOTSPOT_FIELDS * n);
        let (slots, tail) = rest.split_at(SLOT_FIELDS * sizes.row.slots);
        let (attended, out) = out.split_at_mut(self.score.outputs * embedded);
        let (neighbours, own) = out.split_at_mut(self.neighbour[1].outputs);
        describe_own(head, tail, tag, sizes, own);
        let cells = sizes.row.cells.map(|cells| cells as f32);
        self.pool_neighbours(matmul, weights, slots, cells, neighbours, &mut *scratch);

        let context = take(&mut scratch, self.own.inputs);
        context[..own.len()].copy_from_slice(own);
        context[own.len()..].copy_from_slice(neighbours);
        let start = take(&mut scratch, self.own.width());
        let rows = Rows::plain(context, self.own.inputs);
        let bias = self.hotspot[0].bias(weights);
        self.own.apply_from(matmul, weights, bias, rows, start);

        let features = take(&mut scratch, n * self.hotspot[0].inputs);
        describe_hotspots(hotspots, slots, cells, sizes.reach, features);
        let width = self.embedding_width();
        let (one, other) = (take(&mut scratch, n * width), take(&mut scratch, n * width));
        let [first, second, third] = &self.hotspot;
        let embeddings = &mut one[..n * first.width()];
        let rows = Rows::plain(features, first.inputs);
        first.apply_from(matmul, weights, start, rows, embeddings);
        let next = &mut other[..n * second.width()];
        let rows = Rows::rectified(embeddings, first.width());
        second.apply(matmul, weights, rows, next);
        relu(next);
        let embeddings = &mut one[..n * third.width()];
        self.second_round(matmul, weights, next, embeddings, &mut *scratch);
        let scores = take(&mut scratch, n * self.score.width());
        // The scores' bias is the same for every hotspot, so the softmax over hotspots cancels it.
        let rows = Rows::plain(embeddings, third.width());
        self.score.apply_from(matmul, weights, &[], rows, scores);
        for (head, attended) in attended.chunks_exact_mut(embedded).enumerate() {
            attend(
                scores,
                self.score.width(),
                head,
                embeddings,
                third.width(),
                attended,
            );
        }
    }

    /// Computes the embeddings of a second round, in which each hotspot reads the sum over all
    /// hotspots, and those it relates to. The order of a tour depends on them.
    fn second_round(
        &self,
        matmul: MatmulKernel,
        weights: &[f32],
        first: &[f32],
        embeddings: &mut [f32],
        mut scratch: &mut [f32],
    ) {
        let [_, second, third] = &self.hotspot;
        let sums = take(&mut scratch, second.width());
        sums.fill(0.0);
        add_up(first, second.width(), sums);
        divide(sums, CROWD);
        let start = take(&mut scratch, self.others.width());
        let rows = Rows::plain(sums, second.width());
        self.others
            .apply_from(matmul, weights, third.bias(weights), rows, start);
        let rows = match &self.relation {
            None => Rows::plain(first, second.width()),
            Some(form) => {
                let hotspots = first.len() / second.width();
                let related = take(&mut scratch, hotspots * third.inputs);
                relate(form, matmul, weights, first, related, scratch);
                Rows::plain(related, third.inputs)
            }
        };
        third.apply_from(matmul, weights, start, rows, embeddings);
        relu(embeddings);
    }

    /// Sums the encodings of the neighbours in occupied slots.
    fn pool_neighbours(
        &self,
        matmul: MatmulKernel,
        weights: &[f32],
        slots: &[f32],
        cells: [f32; 2],
        pooled: &mut [f32],
        mut scratch: &mut [f32],
    ) {
        let [first, second] = &self.neighbour;
        let inputs = take(&mut scratch, SLOTS * first.inputs);
        let hidden = take(&mut scratch, SLOTS * first.width());
        let encoded = take(&mut scratch, SLOTS * second.width());
        pooled.fill(0.0);
        for slots in slots.chunks(SLOTS * SLOT_FIELDS) {
            let mut count = 0;
            let present = slots
                .chunks_exact(SLOT_FIELDS)
                .filter(|slot| slot[0] != 0.0);
            for (slot, input) in present.zip(inputs.chunks_exact_mut(first.inputs)) {
                describe_neighbour(slot, cells, input);
                count += 1;
            }
            let hidden = &mut hidden[..count * first.width()];
            let rows = Rows::plain(&inputs[..count * first.inputs], first.inputs);
            first.apply(matmul, weights, rows, hidden);
            let encoded = &mut encoded[..count * second.width()];
            let rows = Rows::rectified(hidden, first.width());
            second.apply(matmul, weights, rows, encoded);
            relu(encoded);
            add_up(encoded, second.width(), pooled);
        }
        divide(pooled, CROWD);
    }
}

/// Writes the embedding of each hotspot, and after it the sum of all embeddings, weighted by the
/// softmax of the hotspot's bilinear form with each. So hotspots of one tour know of each other.
fn relate(
    form: &Layer,
    matmul: MatmulKernel,
    weights: &[f32],
    embeddings: &[f32],
    related: &mut [f32],
    mut scratch: &mut [f32],
) {
    let width = form.width();
    let forms = take(&mut scratch, embeddings.len());
    let scores = take(&mut scratch, embeddings.len() / width);
    form.apply(matmul, weights, Rows::plain(embeddings, width), forms);
    let scale = libm::sqrtf(form.outputs as f32);
    let rows = related.chunks_exact_mut(2 * form.outputs);
    let hotspots = embeddings
        .chunks_exact(width)
        .zip(forms.chunks_exact(width));
    for ((embedding, form), row) in hotspots.zip(rows) {
        for (score, other) in scores.iter_mut().zip(embeddings.chunks_exact(width)) {
            let products = form.iter().zip(other).map(|(a, b)| a * b);
            *score = products.sum::<f32>() / scale;
        }
        let (own, others) = row.split_at_mut(row.len() / 2);
        own.copy_from_slice(&embedding[..own.len()]);
        attend(scores, 1, 0, embeddings, width, others);
    }
}

/// Computes the sum of the hotspots' embeddings for one head. The weights are the softmax of the
/// scores.
fn attend(
    scores: &[f32],
    score_width: usize,
    head: usize,
    embeddings: &[f32],
    width: usize,
    out: &mut [f32],
) {
    debug_assert!(head < LANES);
    let scores = || scores.chunks_exact(score_width).map(|scores| scores[head]);
    let max = scores().fold(f32::MIN, |max, score| if score > max { score } else { max });
    let mut total = 0.0;
    for score in scores() {
        total += libm::expf(score - max);
    }
    out.fill(0.0);
    for (score, embedding) in scores().zip(embeddings.chunks_exact(width)) {
        let share = libm::expf(score - max) / total;
        for (sum, x) in out.iter_mut().zip(embedding) {
            *sum += share * x;
        }
    }
}
