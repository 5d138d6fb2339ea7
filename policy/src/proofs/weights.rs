//! P11: every weight has a place of its own within its layer's memory.

use super::inputs::between;
#[cfg(not(kani))]
use super::standin as kani;
use crate::network::Layer;

/// The widest layer of the proof: a whole panel of outputs, and a partial one.
const WIDEST: u64 = 90;

/// Two weights lie within the memory of the layer, and apart.
fn weights_lie_apart(layer: &Layer, [input, output]: [usize; 2], other: [usize; 2]) {
    let at = layer.at(input, output);
    assert!(at >= layer.weight && at < layer.weight + layer.inputs * layer.width());
    // Numbers are compared one by one: arrays are compared byte by byte, in a loop that needs a
    // bound.
    let same = input == other[0] && output == other[1];
    assert!(at != layer.at(other[0], other[1]) || same);
}

#[cfg_attr(kani, kani::proof)]
pub fn weights_lie_apart_within_their_layer() {
    let layer = Layer {
        inputs: between(1, WIDEST) as usize,
        outputs: between(1, WIDEST) as usize,
        weight: between(0, 1 << 20) as usize,
        bias: None,
    };
    let weight = || {
        [
            between(0, layer.inputs as u64 - 1) as usize,
            between(0, layer.outputs as u64 - 1) as usize,
        ]
    };
    let (one, other) = (weight(), weight());
    kani::cover!(one[1] >= 64, "a weight of the second panel");
    kani::cover!(one[0] != other[0], "two weights");
    weights_lie_apart(&layer, one, other);
}

#[cfg(not(kani))]
super::standin::twins! {
    weights_lie_apart_within_their_layer: 4000 cases, 2 covers;
}
