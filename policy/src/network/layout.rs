//! The layout of the network in a file, and of its weights in memory.

use super::dense::{Layer, padded};
use super::error::{ArrayName, LoadError};
use super::features::{hotspot_features, neighbour_features};
use super::file::{Array, File};
use super::row::OWN_FIRST;
use crate::head::Head;

/// The maximum number of layers of an MLP, or of the trunk of a set network.
pub const DEPTH_MAX: usize = 8;

/// The maximum width of a layer.
const WIDTH_MAX: usize = 1 << 16;

/// The maximum number of attention heads.
pub(crate) const HEADS_MAX: usize = 16;

/// A sequence of layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Stack {
    layers: [Layer; DEPTH_MAX],
    depth: usize,
}

impl Stack {
    pub(crate) fn layers(&self) -> &[Layer] {
        &self.layers[..self.depth]
    }

    pub(crate) fn inputs(&self) -> usize {
        self.layers[0].inputs
    }

    pub(crate) fn outputs(&self) -> usize {
        self.layers[self.depth - 1].outputs
    }

    /// Returns the length of the longest padded row between layers.
    pub(crate) fn width_max(&self) -> usize {
        self.layers().iter().map(Layer::width).fold(0, usize::max)
    }
}

/// The layout of the weights of an MLP.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Mlp {
    pub(crate) stack: Stack,
    /// The index of the offsets of the inputs, which the scales follow, if inputs are normalised.
    pub(crate) normalisation: Option<usize>,
}

/// The layout of the weights of a set network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Set {
    pub(crate) neighbour: [Layer; 2],
    pub(crate) hotspot: [Layer; 3],
    pub(crate) own: Layer,
    /// The bilinear form of the attention between hotspots, if UAVs choose sequentially.
    pub(crate) relation: Option<Layer>,
    pub(crate) others: Layer,
    pub(crate) score: Layer,
    pub(crate) trunk: Stack,
}

impl Set {
    /// Returns the number of fields that belong to neither a hotspot nor a neighbour.
    pub(crate) fn own_fields(&self) -> usize {
        self.own.inputs - self.neighbour[1].outputs
    }
}

/// A network of one of the known families.
// Without allocation, neither can lie elsewhere.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Mlp(Mlp),
    Set(Set),
}

/// A reader of arrays in a fixed order, which stores the weights or only lays them out.
struct Reader<'f, 'w> {
    file: File<'f>,
    weights: Option<&'w mut [f32]>,
    /// Elements of the weights laid out so far.
    len: usize,
    /// Arrays read so far.
    count: usize,
    /// Whether UAVs choose sequentially.
    choices: bool,
}

const fn name(stem: &'static str, layer: Option<usize>, part: &'static str) -> ArrayName {
    ArrayName { stem, layer, part }
}

impl<'f> Reader<'f, '_> {
    fn array(&mut self, name: ArrayName) -> Result<Array<'f>, LoadError> {
        self.count += 1;
        self.file.find(name)?.ok_or(LoadError::Missing(name))
    }

    /// Reads a matrix, which must have the expected rows and columns; 0 stands for any number.
    fn matrix(&mut self, name: ArrayName, expected: [usize; 2]) -> Result<Layer, LoadError> {
        let array = self.array(name)?;
        let got = array.shape;
        let fits = |got: usize, expected: usize| {
            got > 0 && got <= WIDTH_MAX && (expected == 0 || got == expected)
        };
        if !(fits(got[0], expected[0]) && fits(got[1], expected[1])) {
            return Err(LoadError::Shape {
                array: name,
                expected,
                got,
            });
        }
        let [inputs, outputs] = got;
        let layer = Layer {
            inputs,
            outputs,
            weight: self.len,
            bias: None,
        };
        self.len = inputs
            .checked_mul(padded(outputs))
            .and_then(|len| len.checked_add(self.len))
            .ok_or(LoadError::Truncated)?;
        let place = |index| layer.at(index / outputs, index % outputs);
        self.values(name, array, place)?;
        Ok(layer)
    }

    /// Reads a row of `length` numbers, and returns its index in the weights.
    fn row(&mut self, name: ArrayName, length: usize) -> Result<usize, LoadError> {
        let array = self.array(name)?;
        if array.shape != [1, length] {
            return Err(LoadError::Shape {
                array: name,
                expected: [1, length],
                got: array.shape,
            });
        }
        let first = self.len;
        self.len += padded(length);
        self.values(name, array, |index| first + index)?;
        Ok(first)
    }

    /// Checks the values of an array, and stores each in the weights if there are any.
    fn values(
        &mut self,
        name: ArrayName,
        array: Array<'_>,
        place: impl Fn(usize) -> usize,
    ) -> Result<(), LoadError> {
        for (index, value) in array.values().enumerate() {
            finite(name, index, value)?;
            if let Some(weights) = self.weights.as_deref_mut() {
                weights[place(index)] = value;
            }
        }
        Ok(())
    }

    /// Reads a matrix and its bias.
    fn layer(
        &mut self,
        stem: &'static str,
        layer: Option<usize>,
        expected: [usize; 2],
    ) -> Result<Layer, LoadError> {
        let mut read = self.matrix(name(stem, layer, "weight"), expected)?;
        read.bias = Some(self.row(name(stem, layer, "bias"), read.outputs)?);
        Ok(read)
    }

    fn stack(&mut self, stem: &'static str, inputs: usize) -> Result<Stack, LoadError> {
        let mut stack = Stack {
            layers: [Layer::default(); DEPTH_MAX],
            depth: 0,
        };
        let mut from = inputs;
        while stack.depth == 0
            || self
                .file
                .find(name(stem, Some(stack.depth), "weight"))?
                .is_some()
        {
            let Some(place) = stack.layers.get_mut(stack.depth) else {
                return Err(LoadError::Depth);
            };
            *place = self.layer(stem, Some(stack.depth), [from, 0])?;
            from = place.outputs;
            stack.depth += 1;
        }
        Ok(stack)
    }

    fn mlp(&mut self) -> Result<Mlp, LoadError> {
        let stack = self.stack("", 0)?;
        let inputs = stack.inputs();
        let (offset, scale) = (
            name("inputs", None, "offset"),
            name("inputs", None, "scale"),
        );
        let mut normalisation = None;
        if self.file.find(offset)?.is_some() {
            normalisation = Some(self.row(offset, inputs)?);
            self.row(scale, inputs)?;
            let scales = self.file.find(scale)?.ok_or(LoadError::Missing(scale))?;
            if let Some(index) = scales.values().position(|scale| scale <= 0.0) {
                return Err(LoadError::Value {
                    array: scale,
                    index,
                });
            }
        }
        Ok(Mlp {
            stack,
            normalisation,
        })
    }

    fn set(&mut self) -> Result<Set, LoadError> {
        let features = neighbour_features(self.choices);
        let encode = self.layer("neighbour", Some(0), [features, 0])?;
        let neighbour = [
            encode,
            self.layer("neighbour", Some(1), [encode.outputs, 0])?,
        ];
        let pooled = neighbour[1].outputs;
        let features = hotspot_features(self.choices);
        let first = self.layer("hotspot", Some(0), [features, 0])?;
        let own_name = name("hotspot", None, "own");
        let own = self.matrix(own_name, [0, first.outputs])?;
        if own.inputs <= pooled + OWN_FIRST {
            return Err(LoadError::Shape {
                array: own_name,
                expected: [pooled + OWN_FIRST + 1, first.outputs],
                got: [own.inputs, own.outputs],
            });
        }
        let second = self.layer("hotspot", Some(1), [first.outputs, 0])?;
        let mut relation = None;
        let mut related = second.outputs;
        if self.choices {
            let square = [second.outputs, second.outputs];
            relation = Some(self.matrix(name("hotspot", None, "relation"), square)?);
            related += second.outputs;
        }
        let third = self.layer("hotspot", Some(2), [related, 0])?;
        let embedded = third.outputs;
        let others = self.matrix(name("hotspot", None, "others"), [second.outputs, embedded])?;
        let score = self.layer("score", None, [embedded, 0])?;
        if score.outputs > HEADS_MAX {
            return Err(LoadError::Shape {
                array: name("score", None, "weight"),
                expected: [embedded, HEADS_MAX],
                got: [embedded, score.outputs],
            });
        }
        // The context's order is (own, neighbours), the trunk's (attended, neighbours, own).
        let trunk = self.stack("trunk", score.outputs * embedded + own.inputs)?;
        Ok(Set {
            neighbour,
            hotspot: [first, second, third],
            own,
            relation,
            others,
            score,
            trunk,
        })
    }

    fn kind(&mut self) -> Result<(Kind, Head), LoadError> {
        let is_there = |name| self.file.find(name).map(|array| array.is_some());
        let kind = if is_there(name("", Some(0), "weight"))? {
            Kind::Mlp(self.mlp()?)
        } else if is_there(name("hotspot", None, "own"))? {
            Kind::Set(self.set()?)
        } else {
            return Err(LoadError::UnknownNetwork);
        };
        if self.count != self.file.count {
            return Err(LoadError::Surplus {
                count: self.file.count,
                expected: self.count,
            });
        }
        let outputs = match &kind {
            Kind::Mlp(mlp) => mlp.stack.outputs(),
            Kind::Set(set) => set.trunk.outputs(),
        };
        let head = Head::of_outputs(outputs).ok_or(LoadError::Outputs(outputs))?;
        Ok((kind, head))
    }
}

fn finite(array: ArrayName, index: usize, value: f32) -> Result<(), LoadError> {
    if value.is_finite() {
        Ok(())
    } else {
        Err(LoadError::Value { array, index })
    }
}

/// Lays out the network of a file, and stores its weights if `weights` is given, which must have
/// the exact length. Returns the network, its head and that length. `choices` says whether UAVs
/// choose sequentially.
pub(crate) fn read(
    file: File<'_>,
    choices: bool,
    weights: Option<&mut [f32]>,
) -> Result<(Kind, Head, usize), LoadError> {
    let reader = |weights| Reader {
        file,
        weights,
        len: 0,
        count: 0,
        choices,
    };
    let mut first = reader(None);
    let (kind, head) = first.kind()?;
    let expected = first.len;
    if let Some(weights) = weights {
        if weights.len() != expected {
            return Err(LoadError::Memory {
                expected,
                got: weights.len(),
            });
        }
        weights.fill(0.0);
        reader(Some(weights)).kind()?;
    }
    Ok((kind, head, expected))
}
