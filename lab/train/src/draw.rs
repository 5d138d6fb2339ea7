//! Configurations drawn at random around one, for a policy that shall serve them all.

use crate::random::{Purpose, stream_for};
use jcas_core::config::{Cell, Depots};
use jcas_core::{Config, Error, Model, QuorumWindow};
use jcas_policy::baselines::quorum_probability;
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
/// Draws of one configuration.
const TRIES: usize = 100;

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

/// Whether the whole fleet, over one hotspot after the other, expects to confirm all of them within
/// the horizon. The ways between them are not counted. A quorum over the episode always passes, as
/// its detections add up over the steps.
fn can_finish(config: Config) -> Result<bool, Error> {
    let model = Model::new(config)?;
    let config = model.config();
    if config.quorum_window == QuorumWindow::Episode {
        return Ok(true);
    }
    let chance = quorum_probability(
        config.uav_count as usize,
        config.quorum as usize,
        model.detection_probability(0, 0, config.pilot_density_max),
    );
    Ok(f64::from(config.hotspot_count) <= chance * f64::from(config.horizon_steps))
}

/// Draws until a fleet can finish, at most [`TRIES`] times.
fn finishable(base: &Config, random: &mut impl Rng) -> Result<Config, Error> {
    for _ in 1..TRIES {
        let config = one(base, random);
        if can_finish(config)? {
            return Ok(config);
        }
    }
    let last = one(base, random);
    last.validate()?;
    Ok(last)
}

/// Draws `count` configurations from `seed`.
///
/// They have fleets of up to 24 UAVs, 1 to 11 hotspots, grids of 8 to 16 cells a side, and any
/// depot. The sensing range is 0.75 to 1.25 of that of `base`, and all other fields are those of
/// `base`. If they do not allow what was drawn, it returns the field's error.
///
/// A configuration in which the fleet cannot expect to finish is drawn again: it has nothing to
/// teach. If that happens a hundred times in a row, the last one stays.
pub fn draw(base: &Config, count: usize, seed: u64) -> Result<Vec<Config>, Error> {
    let mut random = stream_for(seed, Purpose::Configurations, 0, 0);
    (0..count).map(|_| finishable(base, &mut random)).collect()
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

    // In `mission` a UAV detects a hotspot in its own cell with a chance of 0.16. To confirm one,
    // three UAVs take 250 steps, five 31 and six 18. So five confirm three in 100 steps.
    #[test]
    fn a_fleet_is_drawn_only_with_hotspots_that_it_can_confirm() {
        let base = Config::preset(Preset::Mission);
        let drawn = draw(&base, 1000, 1).unwrap();
        let most = |uavs| {
            let hotspots = drawn.iter().filter(|c| c.uav_count == uavs);
            hotspots.map(|c| c.hotspot_count).max()
        };
        assert_eq!([3, 5, 6].map(most), [None, Some(3), Some(5)]);
        assert_eq!(most(12), Some(11));
        let adding_up = Config {
            quorum_window: QuorumWindow::Episode,
            ..base
        };
        let drawn = draw(&adding_up, 100, 1).unwrap();
        assert!(drawn.iter().any(|config| config.uav_count == 3));
        let blind = Config {
            detection_threshold_db: Some(200.0),
            ..base
        };
        assert_eq!(draw(&blind, 3, 1).unwrap().len(), 3);
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
