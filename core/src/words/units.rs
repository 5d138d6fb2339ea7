//! Units: whole microjoules, milligrams and nanograms, and the reals that become them.

/// Microjoules in a kilowatt-hour.
pub const MICROJOULES_PER_KWH: f64 = 3.6e12;

/// A non-negative real rounded half up to a whole number; the one rounding where a real enters a
/// ledger.
#[inline]
#[must_use]
pub fn round_half_up(value: f64) -> u64 {
    (value + 0.5) as u64
}

/// Kilowatt-hours as whole microjoules.
#[must_use]
pub fn microjoules(kwh: f64) -> u64 {
    round_half_up(kwh * MICROJOULES_PER_KWH)
}

/// Whole microjoules as kilowatt-hours, for reports, rewards and observations.
#[inline]
#[must_use]
pub fn kwh(microjoules: u64) -> f64 {
    microjoules as f64 / MICROJOULES_PER_KWH
}

/// Kilograms as whole milligrams.
#[must_use]
pub fn milligrams(kilograms: f64) -> u64 {
    round_half_up(kilograms * 1e6)
}

/// Whole nanograms as kilograms.
#[must_use]
pub fn kilograms(nanograms: u64) -> f64 {
    nanograms as f64 / 1e12
}
