//! The innermost loops of inference, which may be compiled for several instruction sets.

use core::fmt;

use super::dense::{LANES, PANEL, Rows};

/// The number of inputs in a block: the weights of a panel for them fit the first-level cache of
/// most processors.
const DEPTH: usize = 128;

/// The number of rows in a block.
const ROWS: usize = 16;

/// The number of inputs that are tested for zero together, as the bits of one word.
const WORD: usize = 64;

/// A matrix multiplication compiled for one instruction set. Every compilation takes the same sums
/// in the same order.
#[derive(Clone, Copy)]
pub struct MatmulKernel(fn(MatmulArgs<'_>));

/// The operands of a [`MatmulKernel`], and the sums that it adds to.
pub struct MatmulArgs<'a> {
    matrix: &'a [f32],
    inputs: usize,
    rows: Rows<'a>,
    sums: &'a mut [f32],
}

/// All kernels are equal, as all give the same results.
impl PartialEq for MatmulKernel {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl fmt::Debug for MatmulKernel {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("MatmulKernel")
    }
}

impl Default for MatmulKernel {
    /// The kernel compiled for the instruction set of the whole program.
    fn default() -> Self {
        Self(|operands| operands.multiply_inline::<32>())
    }
}

impl MatmulKernel {
    /// Makes a kernel from a function that inlines [`MatmulArgs::multiply_inline`].
    #[must_use]
    pub const fn new(multiply: fn(MatmulArgs<'_>)) -> Self {
        Self(multiply)
    }

    /// Adds rows · W to `sums`, row by row.
    pub(crate) fn add(self, matrix: &[f32], inputs: usize, rows: Rows<'_>, sums: &mut [f32]) {
        (self.0)(MatmulArgs {
            matrix,
            inputs,
            rows,
            sums,
        });
    }
}

/// The indices of the nonzero inputs of a row, in ascending order.
struct NonZeroInputs {
    indices: [u8; DEPTH],
    count: usize,
}

impl NonZeroInputs {
    const NONE: Self = Self {
        indices: [0; DEPTH],
        count: 0,
    };

    #[inline(always)]
    fn select(&mut self, inputs: &[f32], counts: impl Fn(f32) -> bool + Copy) {
        self.count = 0;
        let (words, rest) = inputs.as_chunks::<WORD>();
        for (index, word) in words.iter().enumerate() {
            let mut mask = 0;
            for (bit, &input) in word.iter().enumerate() {
                mask |= u64::from(counts(input)) << bit;
            }
            while mask != 0 {
                self.push(index * WORD + mask.trailing_zeros() as usize, true);
                mask &= mask - 1;
            }
        }
        for (index, &input) in rest.iter().enumerate() {
            self.push(words.len() * WORD + index, counts(input));
        }
    }

    #[inline(always)]
    fn push(&mut self, index: usize, counts: bool) {
        // The index is always written, without a branch: half of the inputs count, so a branch
        // would be mispredicted.
        self.indices[self.count] = index as u8;
        self.count += usize::from(counts);
    }

    #[inline(always)]
    fn indices(&self) -> &[u8] {
        &self.indices[..self.count]
    }
}

impl MatmulArgs<'_> {
    /// Computes the product, inlined into its caller and thus compiled for the instruction set of
    /// the caller. `WIDE` is the number of outputs with sums in registers, a divisor of 64.
    #[inline(always)]
    pub fn multiply_inline<const WIDE: usize>(self) {
        let Self {
            matrix,
            inputs,
            rows,
            sums,
        } = self;
        let width = matrix.len() / inputs;
        let each = rows.values.chunks(ROWS * rows.stride);
        for (values, sums) in each.zip(sums.chunks_mut(ROWS * width)) {
            let mut nonzero = [NonZeroInputs::NONE; ROWS];
            for first in (0..inputs).step_by(DEPTH) {
                let depth = DEPTH.min(inputs - first);
                for (nonzero, row) in nonzero.iter_mut().zip(values.chunks_exact(rows.stride)) {
                    let row = &row[first..first + depth];
                    if rows.rectified {
                        nonzero.select(row, |input| input > 0.0);
                    } else {
                        nonzero.select(row, |input| input != 0.0);
                    }
                }
                let mut from = 0;
                while from < width {
                    let panel = PANEL.min(width - from);
                    let weights = &matrix[from * inputs + first * panel..][..depth * panel];
                    let whole = panel == PANEL;
                    for part in (0..panel).step_by(if whole { WIDE } else { LANES }) {
                        let each = values.chunks_exact(rows.stride).zip(&nonzero);
                        for ((row, nonzero), sums) in each.zip(sums.chunks_exact_mut(width)) {
                            let (row, sums) =
                                (&row[first..first + depth], &mut sums[from + part..]);
                            if whole {
                                add::<WIDE>(row, nonzero, &weights[part..], panel, sums);
                            } else {
                                add::<LANES>(row, nonzero, &weights[part..], panel, sums);
                            }
                        }
                    }
                    from += panel;
                }
            }
        }
    }
}

/// Adds the products of the nonzero inputs to the first `N` sums. `stride` is the distance between
/// the weights of two consecutive inputs.
#[inline(always)]
fn add<const N: usize>(
    inputs: &[f32],
    nonzero: &NonZeroInputs,
    weights: &[f32],
    stride: usize,
    sums: &mut [f32],
) {
    let Some(out) = sums.first_chunk_mut::<N>() else {
        return;
    };
    let mut sums = *out;
    for &index in nonzero.indices() {
        let index = usize::from(index);
        let Some(weights) = weights[index * stride..].first_chunk::<N>() else {
            return;
        };
        let input = inputs[index];
        for lane in 0..N {
            sums[lane] += input * weights[lane];
        }
    }
    *out = sums;
}
