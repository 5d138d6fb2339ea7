//! The set networks written out row by row and element by element, to compare the products with.

use super::{COMMON, CROWD, HEADS, HOTSPOT_FIELDS, OWN_FIRST, SLOT_FIELDS, UAV_FIELDS, UAV_WIDTH};
use crate::environment::Shape;
use crate::network::{Architecture, Network, Param};

/// Blocks of a network in their order.
struct Blocks<'a> {
    parameters: &'a [f32],
    blocks: std::slice::Iter<'a, Param>,
}

impl<'a> Blocks<'a> {
    fn of(network: &'a Network, parameters: &'a [f32]) -> Blocks<'a> {
        Blocks {
            parameters,
            blocks: network.blocks.iter(),
        }
    }

    /// A map x → x·W of the next block.
    fn product(&mut self) -> impl Fn(&[f32]) -> Vec<f32> + use<'a> {
        let block = self.blocks.next().unwrap();
        let weight = &self.parameters[block.offset..block.offset + block.len()];
        move |x: &[f32]| {
            assert_eq!(x.len(), block.rows);
            (0..block.columns)
                .map(|j| {
                    (0..block.rows)
                        .map(|i| x[i] * weight[i * block.columns + j])
                        .sum()
                })
                .collect()
        }
    }

    /// A map x → x·W + b of the next two.
    fn linear(&mut self) -> impl Fn(&[f32]) -> Vec<f32> + use<'a> {
        let (weight, bias) = (self.product(), self.product());
        move |x: &[f32]| plus(&weight(x), &bias(&[1.0]))
    }

    fn trunk(&mut self, input: &[f32]) -> Vec<f32> {
        let mut hidden = self.linear()(input);
        while self.blocks.len() > 0 {
            hidden = self.linear()(&relu(&hidden));
        }
        hidden
    }
}

fn plus(a: &[f32], b: &[f32]) -> Vec<f32> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

fn relu(x: &[f32]) -> Vec<f32> {
    x.iter().map(|x| x.max(0.0)).collect()
}

fn pool(width: usize, set: &[Vec<f32>]) -> Vec<f32> {
    let sum = set.iter().fold(vec![0.0; width], |sum, x| plus(&sum, x));
    sum.iter().map(|sum| sum / CROWD).collect()
}

/// Distance in cells between two positions.
fn apart(a: [f32; 2], b: [f32; 2], shape: &Shape) -> f32 {
    let [x_cells, y_cells] = shape.position_cells();
    (a[0] - b[0]).abs() * x_cells + (a[1] - b[1]).abs() * y_cells
}

fn near(distance: f32, reach: f32) -> f32 {
    (1.0 - distance / reach).max(0.0)
}

/// 1/(1 + (d/R)⁴) for the distance d between two positions and the reach R.
fn detection(a: [f32; 2], b: [f32; 2], shape: &Shape) -> f32 {
    let [x_cells, y_cells] = shape.position_cells();
    let distance = ((a[0] - b[0]) * x_cells).hypot((a[1] - b[1]) * y_cells);
    1.0 / (1.0 + (distance / shape.reach).powi(4))
}

/// What UAVs that choose in turn read of a hotspot: chances of detection, rank, open hotspots
/// around, and the nearest neighbours.
fn read_in_turn(place: [f32; 2], slots: &[&[f32]], open: &[&[f32]], shape: &Shape) -> Vec<f32> {
    let to = |slot: &[f32]| apart(place, [slot[1], slot[2]], shape);
    let far = apart(place, [0.0; 2], shape);
    let chances = slots
        .iter()
        .map(|slot| detection(place, [slot[1], slot[2]], shape));
    let before = |slot: &&&[f32]| {
        let (chosen, cells) = (slot[0] == 2.0, to(slot));
        cells < far - 0.5 || chosen && cells < far + 0.5
    };
    let rank = slots.iter().filter(before).count() as f32;
    let around = open
        .iter()
        .map(|other| near(apart(place, [other[0], other[1]], shape), 4.0));
    let widest = 2.0 * shape.position_cells()[0];
    let nearest = slots.iter().map(|slot| to(slot)).chain([widest; 3]);
    let mut nearest: Vec<f32> = nearest.collect();
    nearest.sort_by(f32::total_cmp);
    let mut read = vec![detection(place, [0.0; 2], shape)];
    read.push(chances.sum::<f32>() / CROWD);
    read.push(rank / CROWD);
    read.push(around.sum::<f32>() / CROWD);
    read.extend(nearest[..3].iter().map(|distance| distance / widest));
    read
}

/// What UAVs that choose in turn read of a neighbour. These are its offset of at most one cell
/// along each axis, and whether it is in the same cell or the next.
fn read_beside(slot: &[f32], shape: &Shape) -> [f32; 4] {
    let [x_cells, y_cells] = shape.position_cells();
    let far = apart([0.0; 2], [slot[1], slot[2]], shape);
    [
        (slot[1] * x_cells).max(-1.0).min(1.0),
        (slot[2] * y_cells).max(-1.0).min(1.0),
        near(far, 1.0),
        near(far, 2.0),
    ]
}

/// The actor's outputs for one observation.
pub fn actor(network: &Network, parameters: &[f32], row: &[f32], shape: &Shape) -> Vec<f32> {
    let mut blocks = Blocks::of(network, parameters);
    let slots_first = OWN_FIRST + HOTSPOT_FIELDS * shape.hotspots;
    let tail_first = slots_first + SLOT_FIELDS * shape.neighbour_slots;
    let mut own = [&row[..OWN_FIRST], &row[tail_first..]].concat();
    let Architecture::SetActor {
        fleet_size,
        choices,
        ..
    } = network.architecture
    else {
        panic!("an actor over sets");
    };
    if fleet_size {
        own.push(shape.agents as f32 / CROWD);
    }
    let hotspots = || row[OWN_FIRST..slots_first].chunks_exact(HOTSPOT_FIELDS);
    let present = || {
        let slots = row[slots_first..tail_first].chunks_exact(SLOT_FIELDS);
        slots.filter(|slot| slot[0] > 0.0)
    };

    let (first, second) = (blocks.linear(), blocks.linear());
    let describe = |slot: &[f32]| {
        let mut described = slot.to_vec();
        if choices {
            described.extend(read_beside(slot, shape));
        }
        described
    };
    let neighbours: Vec<_> = present()
        .map(|slot| relu(&second(&relu(&first(&describe(slot))))))
        .collect();
    let neighbours = pool(UAV_WIDTH, &neighbours);

    let features = |hotspot: &[f32]| {
        let place = [hotspot[0], hotspot[1]];
        let count = |reach: f32| -> f32 {
            let each = present().map(|slot| near(apart(place, [slot[1], slot[2]], shape), reach));
            each.sum::<f32>() / CROWD
        };
        let far = apart(place, [0.0; 2], shape);
        let mut derived = vec![
            far / (2.0 * shape.position_cells()[0]),
            near(far, 1.0),
            near(far, 4.0),
            count(1.0),
            count(4.0),
        ];
        if choices {
            let slots: Vec<&[f32]> = present().collect();
            let open: Vec<&[f32]> = hotspots().filter(|other| other[2] == 0.0).collect();
            derived.extend(read_in_turn(place, &slots, &open, shape));
        }
        [hotspot, &derived].concat()
    };
    let (first, context) = (blocks.linear(), blocks.product());
    let context = context(&[&own[..], &neighbours].concat());
    let second = blocks.linear();
    let embedded: Vec<_> = hotspots()
        .map(|hotspot| relu(&plus(&first(&features(hotspot)), &context)))
        .map(|x| relu(&second(&x)))
        .collect();
    let embedded = second_round(&mut blocks, &embedded, choices);

    let score = blocks.linear();
    let scores: Vec<_> = embedded.iter().map(|x| score(x)).collect();
    let attended = attended(&scores, &embedded);
    blocks.trunk(&[&attended[..], &neighbours, &own].concat())
}

/// Embeddings of a second round, in which every hotspot reads the others.
fn second_round(blocks: &mut Blocks<'_>, embedded: &[Vec<f32>], relate: bool) -> Vec<Vec<f32>> {
    let relation = relate.then(|| blocks.product());
    let (third, others) = (blocks.linear(), blocks.product());
    let others = others(&pool(embedded[0].len(), embedded));
    let related = |x: &Vec<f32>| match &relation {
        None => x.clone(),
        Some(relation) => [x.clone(), attended_by(&relation(x), embedded)].concat(),
    };
    embedded
        .iter()
        .map(|x| relu(&plus(&third(&related(x)), &others)))
        .collect()
}

/// The mean of the embeddings for each attention head, weighted by the softmax of its scores.
fn attended(scores: &[Vec<f32>], embedded: &[Vec<f32>]) -> Vec<f32> {
    let mut attended = Vec::new();
    for head in 0..HEADS {
        let scores: Vec<f32> = scores.iter().map(|scores| scores[head]).collect();
        attended.extend(weighted(&scores, embedded));
    }
    attended
}

/// The mean of the embeddings, weighted by the softmax of their scaled products with a form.
fn attended_by(form: &[f32], embedded: &[Vec<f32>]) -> Vec<f32> {
    let dot = |y: &Vec<f32>| form.iter().zip(y).map(|(a, b)| a * b).sum::<f32>();
    let scale = (form.len() as f32).sqrt();
    let scores: Vec<_> = embedded.iter().map(|y| dot(y) / scale).collect();
    weighted(&scores, embedded)
}

/// The mean of the embeddings, weighted by the softmax of the scores.
fn weighted(scores: &[f32], embedded: &[Vec<f32>]) -> Vec<f32> {
    let weights: Vec<f32> = scores.iter().map(|score| score.exp()).collect();
    let total: f32 = weights.iter().sum();
    let mean = |j: usize| {
        let terms = weights.iter().zip(embedded).map(|(w, x)| w / total * x[j]);
        terms.sum::<f32>()
    };
    (0..embedded[0].len()).map(mean).collect()
}

/// The critic's output for one global state.
pub fn critic(network: &Network, parameters: &[f32], row: &[f32], shape: &Shape) -> Vec<f32> {
    let Architecture::SetCritic { cover, .. } = network.architecture else {
        panic!("a critic over sets");
    };
    let mut blocks = Blocks::of(network, parameters);
    let (uavs, rest) = row.split_at(UAV_FIELDS * shape.agents);
    let (hotspots, common) = rest.split_at(HOTSPOT_FIELDS * shape.hotspots);
    assert_eq!(common.len(), COMMON);
    let uavs = || uavs.chunks_exact(UAV_FIELDS);

    let (first, second) = (blocks.linear(), blocks.linear());
    let fleet: Vec<_> = uavs()
        .map(|uav| relu(&second(&relu(&first(uav)))))
        .collect();
    let fleet = pool(UAV_WIDTH, &fleet);

    let (first, context, second) = (blocks.linear(), blocks.product(), blocks.linear());
    let context = context(&[common, &fleet].concat());
    let embedded: Vec<_> = hotspots
        .chunks_exact(HOTSPOT_FIELDS)
        .map(|hotspot| {
            let place = [hotspot[0], hotspot[1]];
            let count = |reach: f32| -> f32 {
                let each = uavs().map(|uav| near(apart(place, [uav[0], uav[1]], shape), reach));
                each.sum::<f32>() / CROWD
            };
            let mut features = [hotspot, &[count(1.0), count(4.0), count(12.0)]].concat();
            if cover {
                let each = uavs().map(|uav| detection(place, [uav[0], uav[1]], shape));
                features.push(each.sum::<f32>() / CROWD);
            }
            relu(&second(&relu(&plus(&first(&features), &context))))
        })
        .collect();
    let embedded = pool(embedded[0].len(), &embedded);
    blocks.trunk(&[&embedded[..], &fleet, common].concat())
}
