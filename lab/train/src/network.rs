//! Actor and critic networks: a layout of named weight blocks over one flat parameter vector.
//!
//! The parameters are plain numbers; tensors are made of them where they are used, one set for
//! each minibatch. That keeps the optimiser, checkpoints and policy files free of the
//! tensor library, and lets shards run on different cores without sharing a graph.

pub mod initial;
pub mod mlp;
pub mod set;

use crate::environment::Shape;
use burn_tensor::{Device, Tensor, TensorData};
use serde::{Deserialize, Serialize};

/// Architecture of a network.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Architecture {
    /// Fully connected layers with ReLU between them; `sizes` from input to output.
    Mlp {
        /// Width of every layer, input and output included.
        sizes: Vec<usize>,
    },
    /// Shared encoders over hotspots and neighbours, for any number of either.
    SetActor {
        /// Widths of the hidden layers after pooling.
        hidden: Vec<usize>,
        /// Outputs of the head.
        outputs: usize,
        /// Fields that search maps and tags add to what a UAV knows of itself.
        added: usize,
        /// Whether it also reads the number of UAVs, after those.
        fleet_size: bool,
        /// Whether UAVs choose one after the other. They read the choices of their neighbours,
        /// those in their cell and the next, the chances of detection, and their ranks. The network
        /// also attends between hotspots.
        choices: bool,
    },
    /// Shared encoders over UAVs and hotspots of the global state, with one output: the value.
    SetCritic {
        /// Widths of the hidden layers after pooling.
        hidden: Vec<usize>,
        /// Whether it reads how well the fleet covers each hotspot.
        cover: bool,
    },
}

/// A family of networks, with hidden layers, outputs, and what a set network reads.
enum Family<'a> {
    Mlp(&'a [usize]),
    Actor(&'a [usize], usize, set::Actor),
    Critic(&'a [usize], set::Critic),
}

impl Architecture {
    fn family(&self) -> Family<'_> {
        match *self {
            Architecture::Mlp { ref sizes } => Family::Mlp(sizes),
            Architecture::SetActor {
                ref hidden,
                outputs,
                added,
                fleet_size,
                choices,
            } => {
                let reads = set::Actor {
                    added,
                    fleet_size,
                    choices,
                };
                Family::Actor(hidden, outputs, reads)
            }
            Architecture::SetCritic { ref hidden, cover } => {
                Family::Critic(hidden, set::Critic { cover })
            }
        }
    }
}

/// One weight matrix or bias row inside the flat parameter vector.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Param {
    /// Name in policy files, like `0.weight`.
    pub name: String,
    /// Rows (inputs of a layer; 1 for a bias).
    pub rows: usize,
    /// Columns (outputs of a layer).
    pub columns: usize,
    /// Index of its first entry in the parameter vector.
    pub offset: usize,
}

impl Param {
    /// Entries of the block.
    pub fn len(&self) -> usize {
        self.rows * self.columns
    }

    /// Whether the block has no entry.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// An architecture with its blocks laid out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Network {
    /// What it computes.
    pub architecture: Architecture,
    /// Its weights, in the order of the flat vector.
    pub blocks: Vec<Param>,
}

impl Network {
    /// Lays out the blocks of an architecture.
    pub fn new(architecture: Architecture) -> Network {
        let shapes = match architecture.family() {
            Family::Mlp(sizes) => mlp::blocks(sizes),
            Family::Actor(hidden, outputs, reads) => set::actor_blocks(hidden, outputs, reads),
            Family::Critic(hidden, reads) => set::critic_blocks(hidden, reads),
        };
        let mut offset = 0;
        let blocks = shapes
            .into_iter()
            .map(|(name, rows, columns)| {
                let block = Param {
                    name,
                    rows,
                    columns,
                    offset,
                };
                offset += block.len();
                block
            })
            .collect();
        Network {
            architecture,
            blocks,
        }
    }

    /// Length of the flat parameter vector.
    pub fn parameters(&self) -> usize {
        self.blocks.iter().map(Param::len).sum()
    }

    /// Fresh weights; `output_gain` scales the last layer.
    pub fn initial(&self, output_gain: f64, random: &mut rand_chacha::ChaCha8Rng) -> Vec<f32> {
        initial::orthogonal(&self.blocks, output_gain, random)
    }

    /// Tensors of all blocks, ready for [`Network::forward`]; tracked on an autodiff device.
    pub fn tensors(&self, parameters: &[f32], device: &Device) -> Vec<Tensor<2>> {
        self.blocks
            .iter()
            .map(|block| {
                let values = parameters[block.offset..block.offset + block.len()].to_vec();
                let data = TensorData::new(values, [block.rows, block.columns]);
                let tensor = Tensor::<2>::from_data(data, device);
                if device.is_autodiff() {
                    tensor.require_grad()
                } else {
                    tensor
                }
            })
            .collect()
    }

    /// Features (rows × [`Network::features_len`]) of inputs (rows × fields) of this shape. They
    /// have no gradient and do not depend on the weights, so a batch computes them once for all
    /// epochs.
    pub fn features(&self, inputs: &[f32], shape: &Shape) -> Vec<f32> {
        match self.architecture.family() {
            Family::Mlp(_) => inputs.to_vec(),
            Family::Actor(_, _, reads) => set::observed(inputs, shape, reads),
            Family::Critic(_, reads) => set::overseen(inputs, shape, reads),
        }
    }

    /// Whether UAVs choose one after the other and read the choices of their neighbours.
    pub fn reads_choices(&self) -> bool {
        matches!(
            self.architecture,
            Architecture::SetActor { choices: true, .. }
        )
    }

    /// Features of a row.
    pub fn features_len(&self, shape: &Shape) -> usize {
        match self.architecture.family() {
            Family::Mlp(sizes) => sizes[0],
            Family::Actor(_, _, reads) => reads.widths(shape).iter().sum(),
            Family::Critic(_, reads) => reads.widths(shape).iter().sum(),
        }
    }

    /// Outputs (rows × outputs) for features of this shape, on the device of the weights.
    pub fn forward(&self, weights: &[Tensor<2>], features: Vec<f32>, shape: &Shape) -> Tensor<2> {
        match self.architecture.family() {
            Family::Mlp(sizes) => {
                let inputs = matrix(features, sizes[0], &weights[0].device());
                mlp::forward(weights, inputs)
            }
            Family::Actor(_, _, reads) => set::actor(weights, &features, reads, shape),
            Family::Critic(_, reads) => set::critic(weights, &features, reads, shape),
        }
    }
}

/// Gradient of all blocks as one flat vector; a block that does not affect the loss gives zeros.
pub fn flat_gradient(
    network: &Network,
    weights: &[Tensor<2>],
    mut gradients: burn_tensor::Gradients,
) -> Vec<f32> {
    let mut flat = vec![0.0; network.parameters()];
    for (block, weight) in network.blocks.iter().zip(weights) {
        if let Some(gradient) = weight.grad_remove(&mut gradients) {
            flat[block.offset..block.offset + block.len()].copy_from_slice(&values(gradient));
        }
    }
    flat
}

/// The numbers of a tensor, row by row.
pub fn values(tensor: Tensor<2>) -> Vec<f32> {
    tensor
        .into_data()
        .try_into_vec::<f32>()
        .expect("the trainer's tensors are f32")
}

/// A tensor of these rows.
pub fn matrix(values: Vec<f32>, columns: usize, device: &Device) -> Tensor<2> {
    let rows = values.len() / columns;
    Tensor::<2>::from_data(TensorData::new(values, [rows, columns]), device)
}
