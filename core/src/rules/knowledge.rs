//! OR-consensus over the radio graph. All UAVs of a connected component receive the union of the
//! hotspots that its members know, and the unions of their search maps and reports.

use crate::config::LearnedDetections;
use crate::model::Model;
use crate::state::StateMut;
use crate::state::scratch::{Scratch, StepTotals};
use crate::words::bits;

/// Spreads knowledge, search maps and reports over the graph. Records the hotspots that all UAVs
/// now know.
#[inline(always)]
pub(crate) fn communicate(model: &Model<'_>, state: &mut StateMut<'_>, scratch: &mut Scratch<'_>) {
    let (uavs, hotspots) = (model.uav_count(), model.hotspot_words());
    if model.uav_words() == 1 && hotspots == 1 {
        consensus_of_words(state.links, state.knowledge);
    } else {
        let (order, unreached, union) = scratch.consensus(uavs, model.uav_words(), hotspots);
        consensus(uavs, state.links, state.knowledge, order, unreached, union);
    }
    if model.layout().shared > 0 {
        spread_cells(model, state, scratch);
    }

    let t = u64::from(state.header.t());
    for word in 0..hotspots {
        let mut common = u64::MAX;
        for i in 0..uavs {
            common &= state.knowledge[i * hotspots + word];
        }
        let mut fresh = common & !state.informed[word];
        state.informed[word] |= fresh;
        while fresh != 0 {
            state.informed_at[word * 64 + fresh.trailing_zeros() as usize] = t;
            fresh &= fresh - 1;
        }
    }
}

/// Spreads search maps and reports.
#[inline(always)]
fn spread_cells(model: &Model<'_>, state: &mut StateMut<'_>, scratch: &mut Scratch<'_>) {
    let (uavs, uav_words) = (model.uav_count(), model.uav_words());
    let (maps, reports) = (&mut *state.searched, &mut *state.reports);
    for (row, sets) in [(model.map_words(), maps), (model.layout().reports, reports)] {
        if row > 0 {
            let (order, unreached, union) = scratch.consensus(uavs, uav_words, row);
            consensus(uavs, state.links, sets, order, unreached, union);
        }
    }
}

/// Counts confirmations, informed hotspots and the spread of knowledge.
#[inline(always)]
pub(crate) fn count(model: &Model<'_>, state: &StateMut<'_>, totals: &mut StepTotals) {
    let t = u64::from(state.header.t());
    for j in 0..model.hotspot_count() {
        totals.newly_confirmed += u64::from(state.confirmed_at[j] == t);
        totals.newly_informed += u64::from(state.informed_at[j] == t);
    }
    totals.informed = bits::count(state.informed) as u64;
    // The known bits of confirmed hotspots, divided by N times these hotspots, are the mean
    // fraction of UAVs that know a confirmed hotspot.
    let confirmed = bits::count(state.confirmed);
    totals.confirmed = confirmed as u64;
    if confirmed > 0 {
        let known = match model.config().learned_detections {
            LearnedDetections::Confirmed => bits::count(state.knowledge),
            LearnedDetections::All => count_common(state.knowledge, state.confirmed),
        };
        totals.knowledge_spread = known as f64 / (confirmed * model.uav_count()) as f64;
    }
}

/// Counts the bits that the rows of a matrix have in common with one row, over all rows.
fn count_common(rows: &[u64], row: &[u64]) -> usize {
    let mut count = 0;
    for set in rows.chunks_exact(row.len()) {
        for (word, mask) in set.iter().zip(row) {
            count += (word & mask).count_ones() as usize;
        }
    }
    count
}

/// Gives every UAV the union of the rows of its connected component.
///
/// The union is the fixed point that the paper's N iterations of k_i ← k_i ∨ k_neighbours reach.
///
/// `links` and `rows` hold a row of bits per UAV; `links` is symmetric. `order` (a word per UAV),
/// `unreached` (a set of UAVs) and `union` (one row) are working memory. Each UAV enters `order`
/// once, which bounds every loop.
// Proof: proofs/knowledge.rs, consensus_equals_the_papers_iterations
#[inline(always)]
pub fn consensus(
    uavs: usize,
    links: &[u64],
    rows: &mut [u64],
    order: &mut [u64],
    unreached: &mut [u64],
    union: &mut [u64],
) {
    let (uav_words, row_words) = (unreached.len(), union.len());
    for word in 0..uav_words {
        unreached[word] = bits::valid_mask(word, uavs);
    }
    let mut reached = 0;
    for start in 0..uavs {
        if !bits::get(unreached, start) {
            continue;
        }
        bits::assign(unreached, start, false);
        let begin = reached;
        order[begin] = start as u64;
        reached = reach(links, rows, order, begin, unreached, union);
        for member in begin..reached {
            let i = order[member] as usize;
            for word in 0..row_words {
                receive(&mut rows[i * row_words + word], union[word]);
            }
        }
    }
}

/// Adds to a row what its component holds. Rows change by this alone, so that nothing is forgotten.
// Proof: proofs/knowledge.rs, what_is_received_is_added
#[inline(always)]
pub(crate) fn receive(row: &mut u64, union: u64) {
    *row |= union;
}

/// Finds the component of `order[begin]`, breadth first, and the union of its rows. Returns the end
/// of the component in `order`.
#[inline(always)]
fn reach(
    links: &[u64],
    rows: &[u64],
    order: &mut [u64],
    begin: usize,
    unreached: &mut [u64],
    union: &mut [u64],
) -> usize {
    let (uav_words, row_words) = (unreached.len(), union.len());
    union.fill(0);
    let (mut next, mut reached) = (begin, begin + 1);
    while next < reached {
        let i = order[next] as usize;
        next += 1;
        for word in 0..row_words {
            union[word] |= rows[i * row_words + word];
        }
        for word in 0..uav_words {
            let mut fresh = links[i * uav_words + word] & unreached[word];
            unreached[word] &= !fresh;
            while fresh != 0 {
                order[reached] = (word * 64) as u64 + u64::from(fresh.trailing_zeros());
                reached += 1;
                fresh &= fresh - 1;
            }
        }
    }
    reached
}

/// [`consensus`] for at most 64 UAVs and 64 hotspots: one word holds the component found so far.
// Proof: proofs/knowledge.rs, fast_consensus_equals_the_papers_iterations
#[inline(always)]
pub(crate) fn consensus_of_words(links: &[u64], rows: &mut [u64]) {
    let mut unreached = bits::valid_mask(0, rows.len());
    while unreached != 0 {
        let (mut component, mut next) = (0, unreached & unreached.wrapping_neg());
        let mut union = 0;
        while next != 0 {
            let i = next.trailing_zeros() as usize;
            component |= 1 << i;
            union |= rows[i];
            next = (next | links[i]) & !component;
        }
        unreached &= !component;
        while component != 0 {
            receive(&mut rows[component.trailing_zeros() as usize], union);
            component &= component - 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spread(uavs: usize, edges: &[(usize, usize)], mut knowledge: [u64; 5]) -> [u64; 5] {
        let before = knowledge;
        let mut links = [0u64; 5];
        for &(a, b) in edges {
            links[a] |= 1 << b;
            links[b] |= 1 << a;
        }
        let (mut order, mut unreached, mut union) = ([0; 5], [0; 1], [0; 1]);
        consensus(
            uavs,
            &links,
            &mut knowledge,
            &mut order,
            &mut unreached,
            &mut union,
        );
        let mut of_words = before;
        consensus_of_words(&links[..uavs], &mut of_words[..uavs]);
        assert_eq!(of_words, knowledge);
        knowledge
    }

    #[test]
    fn both_ways_agree_on_any_graph() {
        for seed in 0..20_000u64 {
            let draw = |index| crate::words::rng::derive_seed(seed, index);
            let uavs = 1 + (draw(0) % 64) as usize;
            let (mut links, mut rows) = ([0u64; 64], [0u64; 64]);
            for edge in 0..draw(1) % (2 * uavs as u64 + 1) {
                let (a, b) = (draw(2 + 2 * edge), draw(3 + 2 * edge));
                let (a, b) = (a as usize % uavs, b as usize % uavs);
                if a != b {
                    links[a] |= 1 << b;
                    links[b] |= 1 << a;
                }
            }
            for i in 0..uavs {
                rows[i] = draw(1000 + i as u64) & draw(2000 + i as u64);
            }
            let mut of_words = rows;
            consensus_of_words(&links[..uavs], &mut of_words[..uavs]);
            let (mut order, mut unreached, mut union) = ([0; 64], [0; 1], [0; 1]);
            let (order, links) = (&mut order[..uavs], &links[..uavs]);
            consensus(
                uavs,
                links,
                &mut rows[..uavs],
                order,
                &mut unreached,
                &mut union,
            );
            assert_eq!(of_words, rows);
        }
    }

    #[test]
    fn components_hold_their_unions() {
        let before = [0b001, 0, 0b100, 0, 0b010];
        assert_eq!(spread(5, &[], before), before);
        assert_eq!(
            spread(5, &[(0, 1), (1, 3), (2, 4)], before),
            [0b001, 0b001, 0b110, 0b001, 0b110]
        );
        assert_eq!(
            spread(5, &[(0, 4), (4, 1), (1, 3), (3, 2)], before),
            [0b111; 5]
        );
    }
}
