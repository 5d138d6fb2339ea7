//! Configurations drawn at random around one, for a policy that shall serve them all.

use crate::random::{Purpose, stream_for};
use jcas_core::config::{Cell, Depots};
use jcas_core::{Config, ConfigError};
use rand::{Rng, RngExt};
use std::ops::RangeInclusive;

/// The largest fleet. The smallest has as many UAVs as the quorum, and three where it is less.
const UAVS_MAX: u32 = 24;
/// Hotspots.
const HOTSPOTS: RangeInclusive<u32> = 1..=11;
/// Cells along each side of the grid.
const SIDE: RangeInclusive<u32> = 8..=16;
/// Factors on the sensing range, if the configuration has one.
const RANGE_FACTORS: RangeInclusive<f64> = 0.75..=1.25;

/// Draws one configuration. The logarithm of the fleet's size is uniform, so that a batch has about
/// as many rows of small fleets as of large ones.
fn one(base: &Config, random: &mut impl Rng) -> Config {
    let least = f64::from(base.quorum.clamp(3, UAVS_MAX));
    let uavs = random.random_range(least.ln()..f64::from(UAVS_MAX + 1).ln());
    let (width, height) = (random.random_range(SIDE), random.random_range(SIDE));
    let (x, y) = (
        random.random_range(0..width),
        random.random_range(0..height),
    );
    let factor = random.random_range(RANGE_FACTORS);
    Config {
        uav_count: (uavs.exp() as u32).min(UAVS_MAX),
        hotspot_count: random.random_range(HOTSPOTS),
        grid_width: width,
        grid_height: height,
        depots: Depots::one(Cell { x, y }),
        sensing_range_m: base.sensing_range_m.map(|range| range * factor),
        ..*base
    }
}

/// Draws `count` configurations from `seed`.
///
/// They have fleets of up to 24 UAVs, 1 to 11 hotspots, grids of 8 to 16 cells a side, and any
/// depot. The sensing range is 0.75 to 1.25 of that of `base`, and all other fields are those of
/// `base`. If they do not allow what was drawn, it returns the field's error.
pub fn draw(base: &Config, count: usize, seed: u64) -> Result<Vec<Config>, ConfigError> {
    let mut random = stream_for(seed, Purpose::Configurations, 0, 0);
    let drawn: Vec<Config> = (0..count).map(|_| one(base, &mut random)).collect();
    drawn.iter().try_for_each(Config::validate)?;
    Ok(drawn)
}

#[cfg(test)]
mod tests {
    use super::*;
    use jcas_core::Preset;

    #[test]
    fn every_size_is_drawn_and_small_fleets_have_as_many_uavs_as_large_ones() {
        let base = Config::preset(Preset::Paper);
        let drawn = draw(&base, 4000, 1).unwrap();
        assert_eq!(drawn, draw(&base, 4000, 1).unwrap());
        assert_ne!(drawn, draw(&base, 4000, 2).unwrap());
        let range = |of: fn(&Config) -> u32| {
            let values = drawn.iter().map(of);
            (values.clone().min().unwrap(), values.max().unwrap())
        };
        assert_eq!(range(|c| c.uav_count), (3, 24));
        assert_eq!(range(|c| c.hotspot_count), (1, 11));
        assert_eq!(range(|c| c.grid_width), (8, 16));
        assert_eq!(range(|c| c.grid_height), (8, 16));
        // As many UAVs are in fleets of 3 to 12 as of 13 to 24, within the rounding of sizes.
        let uavs = |c: &Config| f64::from(c.uav_count);
        let small: f64 = drawn.iter().filter(|c| c.uav_count <= 12).map(uavs).sum();
        let all: f64 = drawn.iter().map(uavs).sum();
        assert!((0.4..0.6).contains(&(small / all)), "{}", small / all);
    }

    #[test]
    fn a_quorum_bounds_the_fleets_and_other_fields_stay() {
        let base = Config {
            quorum: 7,
            sensing_range_m: None,
            move_energy_kwh: 0.5,
            ..Config::preset(Preset::Mission)
        };
        for config in draw(&base, 200, 1).unwrap() {
            assert!(config.uav_count >= 7);
            assert_eq!(config.sensing_range_m, None);
            assert_eq!(config.move_energy_kwh, 0.5);
        }
    }
}
