//! The carbon constants of a configuration, and the conversion from energy to carbon.

use crate::config::{ChargeBilling, Config};
use crate::words::rng::{self, Purpose};
use crate::words::units::{milligrams, round_half_up};

/// Parts in a billion.
const BILLION: u64 = 1_000_000_000;
/// nanograms = microjoules · (mg/kWh) / this: 3.6e12 uJ in a kWh, 1e6 ng in a mg.
const UJ_MG_PER_KWH_NG: u64 = 3_600_000;

/// The carbon constants of a configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarbonConstants {
    /// Lowest carbon intensity of the grid, in mg/kWh.
    pub intensity_min_mg_per_kwh: u64,
    /// Highest carbon intensity of the grid, in mg/kWh.
    pub intensity_max_mg_per_kwh: u64,
    /// Share of grid energy, 1 - ρ_RE, in parts of a billion.
    pub grid_share_ppb: u64,
    /// The energy that charging bills.
    pub billing: ChargeBilling,
}

impl CarbonConstants {
    /// Rounds each constant once.
    #[must_use]
    pub fn new(config: &Config) -> Self {
        Self {
            intensity_min_mg_per_kwh: milligrams(config.carbon_intensity_min_kg_per_kwh),
            intensity_max_mg_per_kwh: milligrams(config.carbon_intensity_max_kg_per_kwh),
            grid_share_ppb: round_half_up((1.0 - config.renewable_share) * 1e9),
            billing: config.charge_billing,
        }
    }

    /// The intensity that the step after time `t` is billed with: uniform over the whole
    /// milligrams.
    #[must_use]
    pub fn intensity_mg_per_kwh(&self, seed: u64, t: u32) -> u64 {
        let span = self.intensity_max_mg_per_kwh - self.intensity_min_mg_per_kwh + 1;
        let draw = rng::bits64(seed, t, 0, 0, Purpose::Carbon);
        self.intensity_min_mg_per_kwh + rng::below(draw, span)
    }

    /// Intensity as a fraction of its range, in [0, 1]; 0 if the range is one value.
    #[must_use]
    pub fn normalised(&self, intensity_mg_per_kwh: u64) -> f64 {
        let span = self.intensity_max_mg_per_kwh - self.intensity_min_mg_per_kwh;
        if span == 0 {
            return 0.0;
        }
        (intensity_mg_per_kwh - self.intensity_min_mg_per_kwh) as f64 / span as f64
    }

    /// The billed energy that comes from the grid: e_grid = (1 - ρ_RE) · billed, in microjoules.
    #[inline]
    #[must_use]
    pub fn grid_uj(&self, billed_uj: u64) -> u64 {
        scale(billed_uj, self.grid_share_ppb, BILLION)
    }
}

/// Carbon of grid energy, e_grid · c_t, in nanograms.
#[inline]
#[must_use]
pub fn emitted_ng(grid_uj: u64, intensity_mg_per_kwh: u64) -> u64 {
    scale(grid_uj, intensity_mg_per_kwh, UJ_MG_PER_KWH_NG)
}

/// value · factor / divisor, computed exactly in 128 bits and rounded half up.
#[inline]
#[must_use]
pub fn scale(value: u64, factor: u64, divisor: u64) -> u64 {
    if value == 0 {
        return 0;
    }
    let product = value as u128 * factor as u128;
    ((product + (divisor / 2) as u128) / divisor as u128) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::words::units::kilograms;

    #[test]
    fn one_grid_kilowatt_hour_emits_its_intensity() {
        // 1 kWh at 0.25 kg/kWh is 0.25 kg = 2.5e11 ng.
        assert_eq!(emitted_ng(3_600_000_000_000, 250_000), 250_000_000_000);
        assert_eq!(kilograms(250_000_000_000), 0.25);
    }

    #[test]
    fn a_tenth_is_renewable_by_default() {
        let plan = CarbonConstants::new(&Config::default());
        assert_eq!(plan.grid_uj(3_000_000_000), 2_700_000_000);
        assert_eq!(plan.normalised(250_000), 0.0);
        assert_eq!(plan.normalised(400_000), 1.0);
    }

    #[test]
    fn intensity_stays_in_its_range() {
        let plan = CarbonConstants::new(&Config::default());
        for t in 0..1000 {
            let intensity = plan.intensity_mg_per_kwh(7, t);
            assert!((250_000..=400_000).contains(&intensity));
        }
    }
}
