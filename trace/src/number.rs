//! Real numbers of trace files, with the fewest digits that read back the same. The algorithm is
//! that of serde_json.

use core::fmt::{self, Display};

/// A finite real that is displayed in the form of trace files.
pub(crate) struct Real<T>(pub(crate) T);

impl<T: zmij::Float + Copy> Display for Real<T> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(zmij::Buffer::new().format(self.0))
    }
}

#[cfg(test)]
mod tests {
    use super::Real;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn reals_are_written_as_the_command_writes_them(bits: u64) {
            let (double, single) = (f64::from_bits(bits), f32::from_bits(bits as u32));
            if double.is_finite() {
                prop_assert_eq!(Real(double).to_string(), serde_json::to_string(&double).unwrap());
            }
            if single.is_finite() {
                prop_assert_eq!(Real(single).to_string(), serde_json::to_string(&single).unwrap());
            }
        }
    }
}
