//! Networks over sets: shared encoders for hotspots and UAVs, pooled by attention and by sum.
//!
//! Neither the order of hotspots and neighbours nor their number matters, so one set of weights
//! flies any fleet against any number of hotspots. Two features are worked out rather than learnt,
//! because a sum over pairs would cost a layer to learn: how near a hotspot is in cells, and how
//! many UAVs are at or around it.

use crate::environment::Shape;
use burn_tensor::Tensor;
use burn_tensor::activation::{relu, softmax};

/// Width of hotspot embeddings.
pub const HOTSPOT_WIDTH: usize = 64;
/// Width of UAV embeddings.
pub const UAV_WIDTH: usize = 32;
/// Attention heads over hotspots.
pub const HEADS: usize = 4;
/// Sums over a set are divided by this, which keeps them near 1 for the paper's sizes.
pub(crate) const CROWD: f32 = 8.0;

/// Fields of an observation about the UAV itself: self (5), connectivity, sustainability, progress.
pub(crate) const OWN: usize = 11;
pub(crate) const OWN_FIRST: usize = 5;
pub(crate) const HOTSPOT_FIELDS: usize = 4;
/// Those of the observation, distance, here, near, and UAVs at and around it.
const HOTSPOT_FEATURES: usize = HOTSPOT_FIELDS + 5;
pub(crate) const SLOT_FIELDS: usize = 3;
const UAV_FIELDS: usize = 6;
const COMMON: usize = 4;
/// Position fields, confirmed, known share, and UAVs within one, four and twelve cells.
const TARGET_FEATURES: usize = HOTSPOT_FIELDS + 3;

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

pub(super) fn actor_blocks(hidden: &[usize], outputs: usize) -> Shapes {
    let mut shapes = Vec::new();
    layer(&mut shapes, "neighbour.0", SLOT_FIELDS, UAV_WIDTH);
    layer(&mut shapes, "neighbour.1", UAV_WIDTH, UAV_WIDTH);
    layer(&mut shapes, "hotspot.0", HOTSPOT_FEATURES, HOTSPOT_WIDTH);
    shapes.push(("hotspot.own".into(), OWN + UAV_WIDTH, HOTSPOT_WIDTH));
    layer(&mut shapes, "hotspot.1", HOTSPOT_WIDTH, HOTSPOT_WIDTH);
    layer(&mut shapes, "hotspot.2", HOTSPOT_WIDTH, HOTSPOT_WIDTH);
    shapes.push(("hotspot.others".into(), HOTSPOT_WIDTH, HOTSPOT_WIDTH));
    layer(&mut shapes, "score", HOTSPOT_WIDTH, HEADS);
    trunk(
        &mut shapes,
        HEADS * HOTSPOT_WIDTH + UAV_WIDTH + OWN,
        hidden,
        outputs,
    );
    shapes
}

pub(super) fn critic_blocks(hidden: &[usize]) -> Shapes {
    let mut shapes = Vec::new();
    layer(&mut shapes, "uav.0", UAV_FIELDS, UAV_WIDTH);
    layer(&mut shapes, "uav.1", UAV_WIDTH, UAV_WIDTH);
    layer(&mut shapes, "hotspot.0", TARGET_FEATURES, HOTSPOT_WIDTH);
    shapes.push(("hotspot.fleet".into(), COMMON + UAV_WIDTH, HOTSPOT_WIDTH));
    layer(&mut shapes, "hotspot.1", HOTSPOT_WIDTH, HOTSPOT_WIDTH);
    trunk(&mut shapes, HOTSPOT_WIDTH + UAV_WIDTH + COMMON, hidden, 1);
    shapes
}

/// Multiply-adds of one observation's forward pass.
pub(super) fn actor_products(hidden: &[usize], outputs: usize, shape: &Shape) -> u64 {
    let neighbour = SLOT_FIELDS * UAV_WIDTH + UAV_WIDTH * UAV_WIDTH;
    let hotspot = HOTSPOT_WIDTH * (HOTSPOT_FEATURES + 2 * HOTSPOT_WIDTH + HEADS);
    let once = HOTSPOT_WIDTH * (OWN + UAV_WIDTH + HOTSPOT_WIDTH);
    let mut sizes = vec![HEADS * HOTSPOT_WIDTH + UAV_WIDTH + OWN];
    sizes.extend_from_slice(hidden);
    sizes.push(outputs);
    let trunk: usize = sizes.windows(2).map(|pair| pair[0] * pair[1]).sum();
    (neighbour * shape.neighbour_slots + hotspot * shape.hotspots + once + trunk) as u64
}

/// Multiply-adds of one global state's forward pass.
pub(super) fn critic_products(hidden: &[usize], shape: &Shape) -> u64 {
    let uav = UAV_FIELDS * UAV_WIDTH + UAV_WIDTH * UAV_WIDTH;
    let hotspot = HOTSPOT_WIDTH * (TARGET_FEATURES + HOTSPOT_WIDTH);
    let once = HOTSPOT_WIDTH * (COMMON + UAV_WIDTH);
    let mut sizes = vec![HOTSPOT_WIDTH + UAV_WIDTH + COMMON];
    sizes.extend_from_slice(hidden);
    sizes.push(1);
    let trunk: usize = sizes.windows(2).map(|pair| pair[0] * pair[1]).sum();
    (uav * shape.agents + hotspot * shape.hotspots + once + trunk) as u64
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

    /// The same linear map of every element of a set (rows × elements × fields).
    fn each(&mut self, set: Tensor<3>) -> Tensor<3> {
        let [rows, elements, fields] = set.dims();
        let output = self.linear(set.reshape([rows * elements, fields]));
        let width = output.dims()[1];
        output.reshape([rows, elements, width])
    }

    fn trunk(&mut self, input: Tensor<2>) -> Tensor<2> {
        let mut hidden = self.linear(input);
        while self.0.len() > 0 {
            hidden = self.linear(relu(hidden));
        }
        hidden
    }
}

/// Sum over the elements of a set, in units of [`CROWD`].
fn pool(set: Tensor<3>) -> Tensor<2> {
    set.sum_dim(1).div_scalar(CROWD).squeeze_dim::<2>(1)
}

/// Adds one row of fields to every element of its set.
fn added_to_each(set: Tensor<3>, row: Tensor<2>) -> Tensor<3> {
    set + row.unsqueeze_dim::<3>(1)
}

/// Columns `first..first + count·fields` as a set of `count` elements.
fn set_of(input: &Tensor<2>, first: usize, count: usize, fields: usize) -> Tensor<3> {
    let rows = input.dims()[0];
    input
        .clone()
        .narrow(1, first, count * fields)
        .reshape([rows, count, fields])
}

/// Manhattan distances in cells between elements (rows × a × 1) and (rows × 1 × b) of two sets.
fn distances(a: [Tensor<3>; 2], b: [Tensor<3>; 2], shape: &Shape) -> Tensor<3> {
    let [ax, ay] = a;
    let [bx, by] = b;
    let [x_cells, y_cells] = shape.position_cells();
    (ax - bx).abs().mul_scalar(x_cells) + (ay - by).abs().mul_scalar(y_cells)
}

/// 1 at distance 0, falling evenly to 0 at `reach` cells.
fn nearness(distance: Tensor<3>, reach: f32) -> Tensor<3> {
    relu(distance.div_scalar(-reach).add_scalar(1.0))
}

fn field(set: &Tensor<3>, index: usize) -> Tensor<3> {
    set.clone().narrow(2, index, 1)
}

/// Actor outputs for observations (rows × 11 + 4n + 3k).
pub(super) fn actor(weights: &[Tensor<2>], input: Tensor<2>, shape: &Shape) -> Tensor<2> {
    let mut weights = Weights(weights.iter());
    let (n, k) = (shape.hotspots, shape.neighbour_slots);
    let rows = input.dims()[0];
    let hotspots = set_of(&input, OWN_FIRST, n, HOTSPOT_FIELDS);
    let slots_first = OWN_FIRST + HOTSPOT_FIELDS * n;
    let tail_first = slots_first + SLOT_FIELDS * k;
    let own = Tensor::cat(
        vec![
            input.clone().narrow(1, 0, OWN_FIRST),
            input.clone().narrow(1, tail_first, OWN - OWN_FIRST),
        ],
        1,
    );

    let distance = distances(
        [field(&hotspots, 0), field(&hotspots, 1)],
        [
            field(&hotspots, 0).zeros_like(),
            field(&hotspots, 1).zeros_like(),
        ],
        shape,
    );
    let (neighbours, at, around) = if k == 0 {
        weights.0.by_ref().take(4).for_each(drop);
        let none = distance.zeros_like();
        (
            Tensor::zeros([rows, UAV_WIDTH], &input.device()),
            none.clone(),
            none,
        )
    } else {
        let slots = set_of(&input, slots_first, k, SLOT_FIELDS);
        let present = field(&slots, 0);
        let embedded = relu(weights.each(slots.clone()));
        let embedded = relu(weights.each(embedded)) * present.clone();
        let apart = distances(
            [field(&hotspots, 0), field(&hotspots, 1)],
            [
                field(&slots, 1).swap_dims(1, 2),
                field(&slots, 2).swap_dims(1, 2),
            ],
            shape,
        );
        let present = present.swap_dims(1, 2);
        let count = |reach: f32| {
            (nearness(apart.clone(), reach) * present.clone())
                .sum_dim(2)
                .div_scalar(CROWD)
        };
        (pool(embedded), count(1.0), count(4.0))
    };

    let [x_cells, _] = shape.position_cells();
    let features = Tensor::cat(
        vec![
            hotspots,
            distance.clone().div_scalar(2.0 * x_cells),
            nearness(distance.clone(), 1.0),
            nearness(distance, 4.0),
            at,
            around,
        ],
        2,
    );
    let context = Tensor::cat(vec![own.clone(), neighbours.clone()], 1);
    let embedded = weights.each(features);
    let embedded = relu(added_to_each(embedded, context.matmul(weights.take())));
    let embedded = relu(weights.each(embedded));
    // A second round in which every hotspot knows of the others: the order of a tour.
    let others = pool(embedded.clone());
    let embedded = weights.each(embedded);
    let embedded = relu(added_to_each(embedded, others.matmul(weights.take())));
    let attention = softmax(weights.each(embedded.clone()), 1);
    let attended = attention.swap_dims(1, 2).matmul(embedded);
    let attended = attended.reshape([rows, HEADS * HOTSPOT_WIDTH]);
    weights.trunk(Tensor::cat(vec![attended, neighbours, own], 1))
}

/// Values of global states (rows × 6N + 4n + 4).
pub(super) fn critic(weights: &[Tensor<2>], input: Tensor<2>, shape: &Shape) -> Tensor<2> {
    let mut weights = Weights(weights.iter());
    let (agents, n) = (shape.agents, shape.hotspots);
    let uavs = set_of(&input, 0, agents, UAV_FIELDS);
    let hotspots = set_of(&input, UAV_FIELDS * agents, n, HOTSPOT_FIELDS);
    let common = input.narrow(1, UAV_FIELDS * agents + HOTSPOT_FIELDS * n, COMMON);

    let apart = distances(
        [field(&hotspots, 0), field(&hotspots, 1)],
        [
            field(&uavs, 0).swap_dims(1, 2),
            field(&uavs, 1).swap_dims(1, 2),
        ],
        shape,
    );
    let count = |reach: f32| nearness(apart.clone(), reach).sum_dim(2).div_scalar(CROWD);
    let features = Tensor::cat(vec![hotspots, count(1.0), count(4.0), count(12.0)], 2);

    let fleet = relu(weights.each(uavs));
    let fleet = pool(relu(weights.each(fleet)));
    let context = Tensor::cat(vec![common.clone(), fleet.clone()], 1);
    let embedded = weights.each(features);
    let embedded = relu(added_to_each(embedded, context.matmul(weights.take())));
    let embedded = pool(relu(weights.each(embedded)));
    weights.trunk(Tensor::cat(vec![embedded, fleet, common], 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::{Architecture, Network, matrix, values};
    use burn_tensor::Device;
    use rand::RngExt;

    fn shape(agents: usize, hotspots: usize) -> Shape {
        Shape {
            environments: 1,
            agents,
            hotspots,
            neighbour_slots: agents - 1,
            observation_len: 11 + 4 * hotspots + 3 * (agents - 1),
            global_len: 6 * agents + 4 * hotspots + 4,
            grid: [12, 12],
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
        values(network.forward(&weights, matrix(row.to_vec(), row.len(), &device), shape))
    }

    fn close(a: &[f32], b: &[f32]) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4)
    }

    fn row(length: usize) -> Vec<f32> {
        let mut random = crate::random::stream(9, 1);
        (0..length)
            .map(|_| random.random_range(-1.0f32..1.0))
            .collect()
    }

    // Swapping two hotspots, or two neighbours, changes nothing; changing one does.
    #[test]
    fn the_actor_does_not_see_the_order_of_its_sets() {
        let architecture = Architecture::SetActor {
            hidden: vec![16],
            outputs: 7,
        };
        let shape = shape(4, 3);
        let row = row(shape.observation_len);
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
        let architecture = Architecture::SetCritic { hidden: vec![16] };
        let shape = shape(3, 2);
        let row = row(shape.global_len);
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
        };
        for (agents, hotspots) in [(1, 1), (5, 3), (20, 11)] {
            let shape = shape(agents, hotspots);
            let outputs = outputs(&actor, &row(shape.observation_len), &shape);
            assert_eq!(outputs.len(), 7);
            assert!(outputs.iter().all(|x| x.is_finite()));
        }
    }
}
