//! Products of rows of numbers with a matrix, with the same bits everywhere.
//!
//! Each output is its own sum, taken over the inputs in their order: start + x₀w₀ + x₁w₁ + …, every product
//! and every sum rounded. Only different outputs are worked out side by side, so that no width of a register
//! changes a result. An input of zero adds nothing to a sum and is left out: after a ReLU that is half of
//! them or more.

use super::product::Product;

/// Outputs in one vector. Rows of outputs are padded to a multiple of it, with zeros.
pub(crate) const LANES: usize = 16;

/// Outputs whose weights for one input lie together.
pub(crate) const PANEL: usize = 64;

/// Length of a padded row.
pub(crate) const fn padded(outputs: usize) -> usize {
    outputs.div_ceil(LANES) * LANES
}

/// One layer's place in the weights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Layer {
    pub(crate) inputs: usize,
    pub(crate) outputs: usize,
    /// Where its matrix begins: panel after panel of [`PANEL`] outputs, the last of what is left, in each one
    /// input after the other.
    pub(crate) weight: usize,
    /// Where its bias begins, padded; none where something else is added.
    pub(crate) bias: Option<usize>,
}

/// Rows that a layer reads.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows<'a> {
    pub(crate) values: &'a [f32],
    /// From one row to the next.
    pub(crate) stride: usize,
    /// Each number counts as max(x, 0), and what is no number as 0.
    pub(crate) rectified: bool,
}

impl<'a> Rows<'a> {
    /// Rows as they are.
    pub(crate) const fn plain(values: &'a [f32], stride: usize) -> Self {
        Self {
            values,
            stride,
            rectified: false,
        }
    }

    /// Rows behind a ReLU.
    pub(crate) const fn rectified(values: &'a [f32], stride: usize) -> Self {
        Self {
            values,
            stride,
            rectified: true,
        }
    }
}

impl Layer {
    /// Length of a row of outputs.
    pub(crate) const fn width(&self) -> usize {
        padded(self.outputs)
    }

    /// Where the weight of an input for an output is.
    pub(crate) const fn at(&self, input: usize, output: usize) -> usize {
        let first = output / PANEL * PANEL;
        let left = self.width() - first;
        let panel = if left < PANEL { left } else { PANEL };
        self.weight + first * self.inputs + input * panel + output % PANEL
    }

    /// Its bias, padded; nothing where it has none.
    pub(crate) fn bias<'w>(&self, weights: &'w [f32]) -> &'w [f32] {
        match self.bias {
            Some(bias) => &weights[bias..bias + self.width()],
            None => &[],
        }
    }

    /// `outputs` = rows · W + b, of which the layer reads the first numbers of each row.
    pub(crate) fn apply(
        &self,
        product: Product,
        weights: &[f32],
        rows: Rows<'_>,
        outputs: &mut [f32],
    ) {
        self.apply_from(product, weights, self.bias(weights), rows, outputs);
    }

    /// As [`Layer::apply`] with something else in place of b: one padded row, or nothing for zeros.
    pub(crate) fn apply_from(
        &self,
        product: Product,
        weights: &[f32],
        start: &[f32],
        rows: Rows<'_>,
        outputs: &mut [f32],
    ) {
        let width = self.width();
        for out in outputs.chunks_exact_mut(width) {
            if start.is_empty() {
                out.fill(0.0);
            } else {
                out.copy_from_slice(start);
            }
        }
        let matrix = &weights[self.weight..self.weight + self.inputs * width];
        product.add(matrix, self.inputs, rows, outputs);
    }
}

/// max(x, 0) of each; what is no number becomes 0.
pub(crate) fn relu(values: &mut [f32]) {
    for value in values {
        *value = if *value > 0.0 { *value } else { 0.0 };
    }
}
