//! Products of a matrix with rows of numbers, with the same bits everywhere.
//!
//! Each output is its own sum, taken over the inputs in their order: start + x₀w₀ + x₁w₁ + …, every product
//! and every sum rounded. Only different outputs and different rows are worked out side by side, so that no
//! width of a register changes a result.

/// Outputs side by side. Rows of outputs are padded to a multiple of it, with zeros.
pub(crate) const LANES: usize = 16;

/// Rows side by side: the sums of two rows fit the registers of the smallest x86-64.
const ROWS: usize = 2;

/// Length of a padded row.
pub(crate) const fn padded(outputs: usize) -> usize {
    outputs.div_ceil(LANES) * LANES
}

/// One layer's place in the weights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Layer {
    pub(crate) inputs: usize,
    pub(crate) outputs: usize,
    /// Where its matrix begins: block after block of [`LANES`] outputs, in each one input after the other.
    pub(crate) weight: usize,
    /// Where its bias begins, padded; none where something else is added.
    pub(crate) bias: Option<usize>,
}

impl Layer {
    /// Length of a row of outputs.
    pub(crate) const fn width(&self) -> usize {
        padded(self.outputs)
    }

    /// Where the weight of an input for an output is.
    pub(crate) const fn at(&self, input: usize, output: usize) -> usize {
        let block = output / LANES;
        self.weight + (block * self.inputs + input) * LANES + output % LANES
    }

    /// `outputs` = `inputs` · W + b for rows of `stride` numbers, of which the layer reads the first.
    pub(crate) fn apply(
        &self,
        weights: &[f32],
        inputs: &[f32],
        stride: usize,
        outputs: &mut [f32],
    ) {
        let start = match self.bias {
            Some(bias) => &weights[bias..bias + self.width()],
            None => &[],
        };
        self.apply_from(weights, start, inputs, stride, outputs);
    }

    /// As [`Layer::apply`] with something else in place of b: one padded row, or nothing for zeros.
    pub(crate) fn apply_from(
        &self,
        weights: &[f32],
        start: &[f32],
        inputs: &[f32],
        stride: usize,
        outputs: &mut [f32],
    ) {
        let width = self.width();
        let matrix = &weights[self.weight..self.weight + self.inputs * width];
        for (block, matrix) in matrix.chunks_exact(self.inputs * LANES).enumerate() {
            let first = block * LANES;
            let mut begin = [0.0; LANES];
            if let Some(start) = start.get(first..first + LANES) {
                begin.copy_from_slice(start);
            }
            let mut pairs = inputs.chunks_exact(ROWS * stride);
            let mut out = outputs.chunks_exact_mut(ROWS * width);
            for (rows, out) in pairs.by_ref().zip(out.by_ref()) {
                let (one, other) = rows.split_at(stride);
                let sums = tile(matrix, &begin, [&one[..self.inputs], &other[..self.inputs]]);
                for (sums, out) in sums.iter().zip(out.chunks_exact_mut(width)) {
                    out[first..first + LANES].copy_from_slice(sums);
                }
            }
            let out = out.into_remainder();
            for (row, out) in pairs
                .remainder()
                .chunks_exact(stride)
                .zip(out.chunks_exact_mut(width))
            {
                let [sums] = tile(matrix, &begin, [&row[..self.inputs]]);
                out[first..first + LANES].copy_from_slice(&sums);
            }
        }
    }
}

/// Sums of one block of outputs for `N` rows.
#[inline(always)]
fn tile<const N: usize>(
    matrix: &[f32],
    start: &[f32; LANES],
    rows: [&[f32]; N],
) -> [[f32; LANES]; N] {
    let mut sums = [*start; N];
    for (index, weights) in matrix.chunks_exact(LANES).enumerate() {
        for (sums, row) in sums.iter_mut().zip(rows) {
            let input = row[index];
            for (sum, weight) in sums.iter_mut().zip(weights) {
                *sum += input * weight;
            }
        }
    }
    sums
}

/// max(x, 0) of each; what is no number becomes 0.
pub(crate) fn relu(values: &mut [f32]) {
    for value in values {
        *value = if *value > 0.0 { *value } else { 0.0 };
    }
}
