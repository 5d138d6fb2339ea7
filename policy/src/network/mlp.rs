//! Fully connected layers with ReLU between them.

use super::dense::Rows;
use super::layout::{Mlp, Stack};
use super::matmul::MatmulKernel;

/// The bound at which normalised inputs are clipped, in standard deviations.
const CLIP: f32 = 10.0;

/// The number of rows that are multiplied together.
pub(crate) const ROWS: usize = 16;

impl Stack {
    /// The length of the working memory for `rows` rows, in numbers.
    pub(crate) fn scratch_len(&self, rows: usize) -> usize {
        2 * rows * self.width_max()
    }

    /// Applies the layers to rows of [`Stack::inputs`] numbers. Returns the padded outputs of each
    /// row.
    pub(crate) fn apply<'s>(
        &self,
        matmul: MatmulKernel,
        weights: &[f32],
        inputs: &[f32],
        scratch: &'s mut [f32],
    ) -> &'s [f32] {
        let rows = inputs.len() / self.inputs();
        let (mut from, mut to) = scratch.split_at_mut(rows * self.width_max());
        let mut width = 0;
        for (index, layer) in self.layers().iter().enumerate() {
            let next = layer.width();
            let inputs = if index == 0 {
                Rows::plain(inputs, self.inputs())
            } else {
                Rows::rectified(&from[..rows * width], width)
            };
            layer.apply(matmul, weights, inputs, &mut to[..rows * next]);
            width = next;
            core::mem::swap(&mut from, &mut to);
        }
        &from[..rows * width]
    }
}

impl Mlp {
    /// The length of the working memory, in numbers.
    pub(crate) fn scratch_len(&self) -> usize {
        ROWS * self.stack.inputs() + self.stack.scratch_len(ROWS)
    }

    /// Computes the padded outputs for at most [`ROWS`] observations.
    pub(crate) fn outputs<'s>(
        &self,
        matmul: MatmulKernel,
        weights: &[f32],
        observations: &[f32],
        scratch: &'s mut [f32],
    ) -> &'s [f32] {
        let fields = self.stack.inputs();
        let (inputs, scratch) = scratch.split_at_mut(observations.len());
        inputs.copy_from_slice(observations);
        if let Some(first) = self.normalisation {
            let offsets = &weights[first..first + fields];
            let first = first + super::dense::padded(fields);
            let scales = &weights[first..first + fields];
            for row in inputs.chunks_exact_mut(fields) {
                for ((x, offset), scale) in row.iter_mut().zip(offsets).zip(scales) {
                    let scaled = (*x - offset) / scale;
                    *x = if scaled > CLIP {
                        CLIP
                    } else if scaled < -CLIP {
                        -CLIP
                    } else {
                        scaled
                    };
                }
            }
        }
        self.stack.apply(matmul, weights, inputs, scratch)
    }
}
