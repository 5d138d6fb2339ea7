//! Draws from a Beta distribution with both parameters at least 1.

use super::{Draw, normals};
use jcas_core::rng;

/// The maximum number of tries for one gamma variate. Each try is accepted with a probability above
/// 0.95.
const TRIES: u32 = 32;

/// Draws X/(X + Y) from two gamma variates, in [0, 1].
pub(super) fn sample(alpha: f64, beta: f64, draw: Draw) -> f64 {
    let x = gamma(alpha, 1, draw);
    let y = gamma(beta, 1 + 2 * TRIES, draw);
    x / (x + y)
}

/// Draws a gamma variate of shape at least 1 (G. Marsaglia and W. W. Tsang, 2000). Each try takes
/// two blocks. If all tries are rejected, which has a probability of 10⁻⁴⁰, the result is near the
/// mode.
fn gamma(shape: f64, first: u32, draw: Draw) -> f64 {
    let d = shape - 1.0 / 3.0;
    let c = 1.0 / libm::sqrt(9.0 * d);
    for attempt in 0..TRIES {
        let index = first + 2 * attempt;
        let [x, _] = normals(draw.block(index));
        let v = 1.0 + c * x;
        if v <= 0.0 {
            continue;
        }
        let v = v * v * v;
        let words = draw.block(index + 1);
        let u = 1.0 - rng::unit(u64::from(words[0]) | u64::from(words[1]) << 32);
        if libm::log(u) < 0.5 * x * x + d * (1.0 - v + libm::log(v)) {
            return d * v;
        }
    }
    d
}
