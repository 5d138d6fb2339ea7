//! Products of rows with a matrix, with the same bits on every platform.
//!
//! Each output is a sum of its own, taken over the inputs in their order: start + x₀w₀ + x₁w₁ + ….
//! Every product and every sum is rounded. Only different outputs are computed side by side, so the
//! width of a register changes no result. An input of zero adds nothing to a sum and is left out:
//! after a ReLU that is half of the inputs or more.

use super::matmul::MatmulKernel;

/// The number of outputs in one vector. Zeros pad rows of outputs to a multiple of this number.
pub(crate) const LANES: usize = 16;

/// The number of outputs with adjacent weights for one input.
pub(crate) const PANEL: usize = 64;

/// Returns the length of a padded row.
pub(crate) const fn padded(outputs: usize) -> usize {
    outputs.div_ceil(LANES) * LANES
}

/// The layout of one layer in the weights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Layer {
    pub(crate) inputs: usize,
    pub(crate) outputs: usize,
    /// The index of the matrix. It is stored in panels of [`PANEL`] outputs, of which the last may
    /// be narrower. A panel holds the weights of one input after the other.
    pub(crate) weight: usize,
    /// The index of the padded bias. `None` if something else is added instead.
    pub(crate) bias: Option<usize>,
}

/// The rows that a layer reads.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows<'a> {
    pub(crate) values: &'a [f32],
    /// Distance from one row to the next, in numbers.
    pub(crate) stride: usize,
    /// Whether each number counts as max(x, 0), and a NaN as 0.
    pub(crate) rectified: bool,
}

impl<'a> Rows<'a> {
    /// Makes rows that are read unchanged.
    pub(crate) const fn plain(values: &'a [f32], stride: usize) -> Self {
        Self {
            values,
            stride,
            rectified: false,
        }
    }

    /// Makes rows that are read through a ReLU.
    pub(crate) const fn rectified(values: &'a [f32], stride: usize) -> Self {
        Self {
            values,
            stride,
            rectified: true,
        }
    }
}

impl Layer {
    /// Returns the length of a padded row of outputs.
    pub(crate) const fn width(&self) -> usize {
        padded(self.outputs)
    }

    /// Returns the index of the weight of an input for an output.
    pub(crate) const fn at(&self, input: usize, output: usize) -> usize {
        let first = output / PANEL * PANEL;
        let left = self.width() - first;
        let panel = if left < PANEL { left } else { PANEL };
        self.weight + first * self.inputs + input * panel + output % PANEL
    }

    /// Returns the padded bias; it is empty if there is none.
    pub(crate) fn bias<'w>(&self, weights: &'w [f32]) -> &'w [f32] {
        match self.bias {
            Some(bias) => &weights[bias..bias + self.width()],
            None => &[],
        }
    }

    /// Computes `outputs` = rows · W + b. The layer reads the first numbers of each row.
    pub(crate) fn apply(
        &self,
        matmul: MatmulKernel,
        weights: &[f32],
        rows: Rows<'_>,
        outputs: &mut [f32],
    ) {
        self.apply_from(matmul, weights, self.bias(weights), rows, outputs);
    }

    /// Computes `outputs` = rows · W + `start`. `start` is one padded row, or empty for zeros.
    pub(crate) fn apply_from(
        &self,
        matmul: MatmulKernel,
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
        matmul.add(matrix, self.inputs, rows, outputs);
    }
}

/// Replaces each number by max(x, 0), and a NaN by 0.
pub(crate) fn relu(values: &mut [f32]) {
    for value in values {
        *value = if *value > 0.0 { *value } else { 0.0 };
    }
}
