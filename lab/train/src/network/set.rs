//! Networks over sets: shared encoders for hotspots and UAVs, pooled by attention and by sum.
//!
//! The output does not depend on the order of hotspots and neighbours, and their number is free. So
//! one set of weights serves any fleet and any number of hotspots. Some features are computed,
//! because learning them would take one layer or several. These are the distance of a hotspot in
//! cells and the UAVs at and around it.

mod features;

pub(super) use features::{observed, overseen};

#[cfg(test)]
mod reference;

use super::matrix;
use crate::environment::Shape;
use burn_tensor::Tensor;
use burn_tensor::activation::{relu, softmax};
pub(crate) use jcas_policy::network::features::CROWD;
use jcas_policy::network::features::{hotspot_features, neighbour_features};
pub(crate) use jcas_policy::network::row::{HOTSPOT_FIELDS, OWN_FIRST, SLOT_FIELDS};

/// Width of hotspot embeddings.
pub const HOTSPOT_WIDTH: usize = 64;
/// Width of UAV embeddings.
pub const UAV_WIDTH: usize = 32;
/// Attention heads over hotspots.
pub const HEADS: usize = 4;
/// Fields of an observation about the UAV itself: self (5), connectivity, sustainability, progress.
pub(crate) const OWN: usize = 11;
const UAV_FIELDS: usize = 6;
const COMMON: usize = 4;
/// Position fields, confirmed, known share, and UAVs within one, four and twelve cells.
const TARGET_FEATURES: usize = HOTSPOT_FIELDS + 3;

/// What the actor reads about the UAV itself.
#[derive(Clone, Copy, Debug)]
pub(super) struct Actor {
    /// Fields that maps and tags add to the observation.
    pub added: usize,
    /// The number of UAVs too, which no observation shows.
    pub fleet_size: bool,
    /// Whether UAVs choose in turn. Then it also reads chances of detection, ranks, and which
    /// neighbours are in the own cell or the next.
    pub choices: bool,
}

impl Actor {
    /// Fields that are of no hotspot and of no other UAV.
    fn own(self) -> usize {
        OWN + self.added + usize::from(self.fleet_size)
    }

    /// Features of each neighbour.
    fn neighbour_features(self) -> usize {
        neighbour_features(self.choices)
    }

    /// Features of each hotspot.
    fn hotspot_features(self) -> usize {
        hotspot_features(self.choices)
    }

    /// Widths of the parts of a row of features: the UAV itself, neighbour slots with whether they
    /// are taken, the number of empty slots, hotspots.
    pub fn widths(self, shape: &Shape) -> [usize; 4] {
        [
            self.own(),
            (self.neighbour_features() + 1) * shape.neighbour_slots,
            1,
            self.hotspot_features() * shape.hotspots,
        ]
    }
}

/// What the critic reads.
#[derive(Clone, Copy, Debug)]
pub(super) struct Critic {
    /// Whether it reads how well the fleet covers each hotspot.
    pub cover: bool,
}

impl Critic {
    /// Fields of each hotspot.
    fn target_features(self) -> usize {
        TARGET_FEATURES + usize::from(self.cover)
    }

    /// Widths of the parts of a row of features: what is of no hotspot and of no UAV, UAVs each
    /// with a 1, hotspots.
    pub fn widths(self, shape: &Shape) -> [usize; 3] {
        [
            COMMON,
            (UAV_FIELDS + 1) * shape.agents,
            self.target_features() * shape.hotspots,
        ]
    }
}

/// The parts of rows of features, each by itself.
fn parts<const K: usize>(features: &[f32], widths: [usize; K]) -> [Vec<f32>; K] {
    let length = widths.iter().sum();
    let rows = features.len() / length;
    let mut parts = widths.map(|width| Vec::with_capacity(rows * width));
    for row in features.chunks_exact(length) {
        let mut rest = row;
        for (part, width) in parts.iter_mut().zip(widths) {
            let (own, others) = rest.split_at(width);
            part.extend_from_slice(own);
            rest = others;
        }
    }
    parts
}

/// Fields of an observation that the configuration adds: search map, directions, tag. They are the
/// UAV's own and come last.
pub fn added(shape: &Shape) -> usize {
    let always = OWN + HOTSPOT_FIELDS * shape.hotspots + SLOT_FIELDS * shape.neighbour_slots;
    shape.observation_len - always
}

type Shapes = Vec<(String, usize, usize)>;

fn layer(shapes: &mut Shapes, name: &str, inputs: usize, outputs: usize) {
    shapes.push((format!("{name}.weight"), inputs, outputs));
    shapes.push((format!("{name}.bias"), 1, outputs));
}

fn trunk(shapes: &mut Shapes, inputs: usize, hidden: &[usize], outputs: usize) {
    let mut from = inputs;
    for (index, &to) in hidden.iter().chain(std::iter::once(&outputs)).enumerate() {
        layer(shapes, &format!("trunk.{index}"), from, to);
        from = to;
    }
}

pub(super) fn actor_blocks(hidden: &[usize], outputs: usize, actor: Actor) -> Shapes {
    let own = actor.own();
    let mut shapes = Vec::new();
    layer(
        &mut shapes,
        "neighbour.0",
        actor.neighbour_features(),
        UAV_WIDTH,
    );
    layer(&mut shapes, "neighbour.1", UAV_WIDTH, UAV_WIDTH);
    layer(
        &mut shapes,
        "hotspot.0",
        actor.hotspot_features(),
        HOTSPOT_WIDTH,
    );
    shapes.push(("hotspot.own".into(), own + UAV_WIDTH, HOTSPOT_WIDTH));
    layer(&mut shapes, "hotspot.1", HOTSPOT_WIDTH, HOTSPOT_WIDTH);
    let mut related = HOTSPOT_WIDTH;
    if actor.choices {
        shapes.push(("hotspot.relation".into(), HOTSPOT_WIDTH, HOTSPOT_WIDTH));
        related += HOTSPOT_WIDTH;
    }
    layer(&mut shapes, "hotspot.2", related, HOTSPOT_WIDTH);
    shapes.push(("hotspot.others".into(), HOTSPOT_WIDTH, HOTSPOT_WIDTH));
    layer(&mut shapes, "score", HOTSPOT_WIDTH, HEADS);
    trunk(
        &mut shapes,
        HEADS * HOTSPOT_WIDTH + UAV_WIDTH + own,
        hidden,
        outputs,
    );
    shapes
}

pub(super) fn critic_blocks(hidden: &[usize], critic: Critic) -> Shapes {
    let (features, common) = (critic.target_features(), COMMON);
    let mut shapes = Vec::new();
    layer(&mut shapes, "uav.0", UAV_FIELDS, UAV_WIDTH);
    layer(&mut shapes, "uav.1", UAV_WIDTH, UAV_WIDTH);
    layer(&mut shapes, "hotspot.0", features, HOTSPOT_WIDTH);
    shapes.push(("hotspot.fleet".into(), common + UAV_WIDTH, HOTSPOT_WIDTH));
    layer(&mut shapes, "hotspot.1", HOTSPOT_WIDTH, HOTSPOT_WIDTH);
    trunk(&mut shapes, HOTSPOT_WIDTH + UAV_WIDTH + common, hidden, 1);
    shapes
}

/// Takes weights in the order of the blocks.
struct Weights<'a>(std::slice::Iter<'a, Tensor<2>>);

impl Weights<'_> {
    fn take(&mut self) -> Tensor<2> {
        self.0.next().expect("as many weights as blocks").clone()
    }

    /// x·W + b.
    fn linear(&mut self, input: Tensor<2>) -> Tensor<2> {
        input.matmul(self.take()) + self.take()
    }

    /// x·W + b for inputs whose last field is what b is multiplied by: one product, no addition.
    fn augmented(&mut self, input: Tensor<2>) -> Tensor<2> {
        input.matmul(Tensor::cat(vec![self.take(), self.take()], 0))
    }

    /// (x·W + b) + y·V for every x of a set, with one y for each set; b is added to y·V, of which
    /// there are fewer.
    fn with_context(&mut self, set: Tensor<2>, context: Tensor<2>) -> Tensor<2> {
        let (weight, bias) = (self.take(), self.take());
        let context = context.matmul(self.take()) + bias;
        let [rows, width] = context.dims();
        let elements = set.dims()[0] / rows;
        let set = set.matmul(weight).reshape([rows, elements, width]);
        (set + context.unsqueeze_dim::<3>(1)).reshape([rows * elements, width])
    }

    fn trunk(&mut self, input: Tensor<2>) -> Tensor<2> {
        let mut hidden = self.linear(input);
        while self.0.len() > 0 {
            hidden = self.linear(relu(hidden));
        }
        hidden
    }
}

/// Sum over the elements of each of `rows` sets.
fn sum(set: Tensor<2>, rows: usize) -> Tensor<2> {
    let [all, width] = set.dims();
    set.reshape([rows, all / rows, width])
        .sum_dim(1)
        .reshape([rows, width])
}

/// The embedding of each hotspot, and beside it the sum of all embeddings of its set, weighted by
/// the softmax of a bilinear form.
fn relate(embedded: Tensor<2>, form: Tensor<2>, rows: usize) -> Tensor<2> {
    let [all, width] = embedded.dims();
    let sets = [rows, all / rows, width];
    let hotspots = embedded.clone().reshape(sets);
    let forms = embedded.clone().matmul(form).reshape(sets);
    let scores = forms.matmul(hotspots.clone().swap_dims(1, 2));
    let attention = softmax(scores.div_scalar((width as f32).sqrt()), 2);
    let others = attention.matmul(hotspots).reshape([all, width]);
    Tensor::cat(vec![embedded, others], 1)
}

/// Actor outputs for rows of the features that [`observed`] gives.
pub(super) fn actor(
    weights: &[Tensor<2>],
    features: &[f32],
    actor: Actor,
    shape: &Shape,
) -> Tensor<2> {
    let device = weights[0].device();
    let mut weights = Weights(weights.iter());
    let [own, slots, empty, hotspots] = parts(features, actor.widths(shape));
    let rows = empty.len();
    let own = matrix(own, actor.own(), &device);

    let neighbours = if shape.neighbour_slots == 0 {
        weights.0.by_ref().take(4).for_each(drop);
        Tensor::zeros([rows, UAV_WIDTH], &device)
    } else {
        // An empty slot is all zeros, including the field for the bias. After the second layer it
        // holds relu(b), and subtracting that from the sum is cheaper than a mask.
        let embedded = matrix(slots, actor.neighbour_features() + 1, &device);
        let embedded = relu(weights.augmented(embedded));
        let (weight, bias) = (weights.take(), weights.take());
        let embedded = relu(embedded.matmul(weight) + bias.clone());
        let empty = matrix(empty, 1, &device).matmul(relu(bias));
        (sum(embedded, rows) - empty).div_scalar(CROWD)
    };

    let context = Tensor::cat(vec![own.clone(), neighbours.clone()], 1);
    let hotspots = matrix(hotspots, actor.hotspot_features(), &device);
    let embedded = relu(weights.with_context(hotspots, context));
    let embedded = relu(weights.linear(embedded));
    // A second round in which every hotspot knows of the others: the order of a tour.
    let others = sum(embedded.clone(), rows).div_scalar(CROWD);
    let embedded = if actor.choices {
        relate(embedded, weights.take(), rows)
    } else {
        embedded
    };
    let embedded = relu(weights.with_context(embedded, others));
    // The scores' bias is the same for every hotspot, so the softmax over hotspots cancels it.
    let scores = embedded.clone().matmul(weights.take());
    weights.take();
    let scores = scores.reshape([rows, shape.hotspots, HEADS]);
    let attention = softmax(scores.swap_dims(1, 2), 2);
    let attended = attention.matmul(embedded.reshape([rows, shape.hotspots, HOTSPOT_WIDTH]));
    let attended = attended.reshape([rows, HEADS * HOTSPOT_WIDTH]);
    weights.trunk(Tensor::cat(vec![attended, neighbours, own], 1))
}

/// Values of rows of the features that [`overseen`] gives.
pub(super) fn critic(
    weights: &[Tensor<2>],
    features: &[f32],
    critic: Critic,
    shape: &Shape,
) -> Tensor<2> {
    let device = weights[0].device();
    let mut weights = Weights(weights.iter());
    let [common, uavs, hotspots] = parts(features, critic.widths(shape));
    let common = matrix(common, COMMON, &device);
    let rows = common.dims()[0];

    let uavs = matrix(uavs, UAV_FIELDS + 1, &device);
    let fleet = relu(weights.augmented(uavs));
    let fleet = sum(relu(weights.linear(fleet)), rows).div_scalar(CROWD);
    let context = Tensor::cat(vec![common.clone(), fleet.clone()], 1);
    let hotspots = matrix(hotspots, critic.target_features(), &device);
    let embedded = relu(weights.with_context(hotspots, context));
    let embedded = sum(relu(weights.linear(embedded)), rows).div_scalar(CROWD);
    weights.trunk(Tensor::cat(vec![embedded, fleet, common], 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{Architecture, Network, values};
    use burn_tensor::Device;
    use rand::RngExt;
    use rand_chacha::ChaCha8Rng;

    fn shape(agents: usize, hotspots: usize) -> Shape {
        with_maps(agents, hotspots, 0)
    }

    fn with_maps(agents: usize, hotspots: usize, added: usize) -> Shape {
        Shape {
            motion_map: jcas_core::MotionMap::Udlrs,
            environments: 1,
            agents,
            hotspots,
            neighbour_slots: agents - 1,
            observation_len: 11 + 4 * hotspots + 3 * (agents - 1) + added,
            global_len: 6 * agents + 4 * hotspots + 4,
            grid: [12, 12],
            reach: 2.5,
        }
    }

    fn network(architecture: Architecture) -> (Network, Vec<f32>) {
        let network = Network::new(architecture);
        let parameters = network.initial(1.0, &mut crate::random::stream(2, 0));
        (network, parameters)
    }

    fn outputs(architecture: &Architecture, row: &[f32], shape: &Shape) -> Vec<f32> {
        let (network, parameters) = network(architecture.clone());
        let device = Device::flex();
        let weights = network.tensors(&parameters, &device);
        values(network.forward(&weights, network.features(row, shape), shape))
    }

    fn close(a: &[f32], b: &[f32]) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4)
    }

    fn row(length: usize, random: &mut ChaCha8Rng) -> Vec<f32> {
        (0..length)
            .map(|_| random.random_range(-1.0f32..1.0))
            .collect()
    }

    /// A row whose first neighbour slots are taken and whose others are all zeros, as the kernel
    /// writes them.
    fn observation(shape: &Shape, random: &mut ChaCha8Rng) -> Vec<f32> {
        let mut row = row(shape.observation_len, random);
        let taken = random.random_range(0..=shape.neighbour_slots);
        let first = OWN_FIRST + HOTSPOT_FIELDS * shape.hotspots;
        let slots = &mut row[first..first + SLOT_FIELDS * shape.neighbour_slots];
        for (index, slot) in slots.chunks_exact_mut(SLOT_FIELDS).enumerate() {
            if index < taken {
                slot[0] = if random.random_bool(0.5) { 1.0 } else { 2.0 };
            } else {
                slot.fill(0.0);
            }
        }
        for hotspot in row[OWN_FIRST..first].chunks_exact_mut(HOTSPOT_FIELDS) {
            hotspot[2] = f32::from(u8::from(random.random_bool(0.3)));
        }
        row
    }

    /// Weights with biases: fresh ones are zero.
    fn weights(network: &Network, random: &mut ChaCha8Rng) -> Vec<f32> {
        row(network.parameters(), random)
            .iter()
            .map(|x| 0.3 * x)
            .collect()
    }

    fn relative_error(a: &[f32], b: &[f32]) -> f32 {
        assert_eq!(a.len(), b.len());
        let size = b.iter().fold(1.0f32, |size, x| size.max(x.abs()));
        let error = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        error.fold(0.0, f32::max) / size
    }

    // Several rows at once, so that a mix-up of rows and elements shows.
    #[test]
    fn both_networks_are_what_they_are_row_by_row() {
        let mut random = crate::random::stream(4, 0);
        for (agents, hotspots, added) in [(1, 1, 0), (2, 5, 9), (10, 7, 0), (20, 11, 34)] {
            let shape = with_maps(agents, hotspots, added);
            let actor = Network::new(Architecture::SetActor {
                hidden: vec![24, 16],
                outputs: 7,
                added,
                fleet_size: agents > 1,
                choices: agents > 2,
            });
            let critic = Network::new(Architecture::SetCritic {
                hidden: vec![16],
                cover: agents > 2,
            });
            for (network, critic_length) in [(&actor, None), (&critic, Some(shape.global_len))] {
                let parameters = weights(network, &mut random);
                let rows: Vec<Vec<f32>> = (0..9)
                    .map(|_| match critic_length {
                        None => observation(&shape, &mut random),
                        Some(length) => row(length, &mut random),
                    })
                    .collect();
                let tensors = network.tensors(&parameters, &Device::flex());
                let fast = values(network.forward(
                    &tensors,
                    network.features(&rows.concat(), &shape),
                    &shape,
                ));
                let reference = if critic_length.is_none() {
                    reference::actor
                } else {
                    reference::critic
                };
                let plain: Vec<f32> = rows
                    .iter()
                    .flat_map(|row| reference(network, &parameters, row, &shape))
                    .collect();
                let error = relative_error(&fast, &plain);
                assert!(error < 1e-5, "{agents} UAVs, {hotspots} hotspots: {error}");
            }
        }
    }

    // Swapping two hotspots, or two neighbours, changes nothing; changing one does.
    #[test]
    fn the_actor_does_not_see_the_order_of_its_sets() {
        let architecture = Architecture::SetActor {
            hidden: vec![16],
            outputs: 7,
            added: 0,
            fleet_size: false,
            choices: false,
        };
        let shape = shape(4, 3);
        let row = observation(&shape, &mut crate::random::stream(9, 1));
        let mut swapped = row.clone();
        for field in 0..4 {
            swapped.swap(5 + field, 5 + 8 + field);
        }
        for field in 0..3 {
            swapped.swap(17 + field, 17 + 3 + field);
        }
        let first = outputs(&architecture, &row, &shape);
        assert!(close(&first, &outputs(&architecture, &swapped, &shape)));
        swapped[6] += 0.5;
        assert!(!close(&first, &outputs(&architecture, &swapped, &shape)));
    }

    #[test]
    fn the_critic_does_not_see_the_order_of_its_sets() {
        let architecture = Architecture::SetCritic {
            hidden: vec![16],
            cover: true,
        };
        let shape = shape(3, 2);
        let row = row(shape.global_len, &mut crate::random::stream(9, 1));
        let mut swapped = row.clone();
        for field in 0..6 {
            swapped.swap(field, 12 + field);
        }
        for field in 0..4 {
            swapped.swap(18 + field, 22 + field);
        }
        let first = outputs(&architecture, &row, &shape);
        assert!(close(&first, &outputs(&architecture, &swapped, &shape)));
        swapped[0] += 0.5;
        assert!(!close(&first, &outputs(&architecture, &swapped, &shape)));
    }

    // The same weights serve any size, a fleet of one included.
    #[test]
    fn one_set_of_weights_serves_every_size() {
        let actor = Architecture::SetActor {
            hidden: vec![16, 8],
            outputs: 7,
            added: 0,
            fleet_size: false,
            choices: false,
        };
        for (agents, hotspots) in [(1, 1), (5, 3), (20, 11)] {
            let shape = shape(agents, hotspots);
            let row = observation(&shape, &mut crate::random::stream(9, 1));
            let outputs = outputs(&actor, &row, &shape);
            assert_eq!(outputs.len(), 7);
            assert!(outputs.iter().all(|x| x.is_finite()));
        }
    }
}
