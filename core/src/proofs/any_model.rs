//! The model that the proofs of whole steps run on.
//!
//! Kani gets one configuration, the smallest that still has pairs of UAVs. Its tables hold any
//! values within the range that `proofs::tables` shows. The stand-in gets real models of random
//! small configurations.

use super::Model;
#[cfg(not(kani))]
use crate::config::SearchMaps;
use crate::config::{Config, LearnedDetections, QuorumWindow, StartCells};
#[cfg(not(kani))]
use crate::proofs::inputs::between;
use crate::proofs::inputs::real_between;
#[cfg(not(kani))]
use crate::proofs::standin as kani;

/// Words of the tables of the smallest model.
pub(crate) const SMALLEST_TABLE_WORDS: usize = 18;
/// Room for the tables of every model that [`any_model`] makes.
#[cfg(kani)]
pub(crate) const TABLE_WORDS: usize = SMALLEST_TABLE_WORDS;
/// Room for the tables of every model that [`any_model`] makes.
#[cfg(not(kani))]
pub(crate) const TABLE_WORDS: usize = 3 * 16 + 7 + 7 + 16 + 8 * 17;

/// Most hotspots of a model that [`any_model`] makes.
pub(crate) const HOTSPOTS_MAX: usize = 4;

/// Two UAVs, one hotspot, two by two cells, a battery for two moves.
pub(crate) fn smallest() -> Config {
    Config {
        grid_width: 2,
        grid_height: 2,
        uav_count: 2,
        hotspot_count: 1,
        horizon_steps: 3,
        quorum: 2,
        battery_capacity_kwh: 2e-3,
        rtb_threshold_kwh: 5e-4,
        ..Config::default()
    }
}

/// The configuration whose quorum counts the episode, and whose UAVs learn all that they detect.
pub(crate) fn remembering(config: Config) -> Config {
    Config {
        quorum_window: QuorumWindow::Episode,
        learned_detections: LearnedDetections::All,
        ..config
    }
}

/// A model whose radar and link tables hold anything in range; for the stand-in a real one.
pub(crate) fn any_model(words: &mut [u64; TABLE_WORDS]) -> Model<'_> {
    any_model_of(any_config(), words)
}

/// The same with two hotspots for its three free cells.
#[cfg(kani)]
pub(crate) fn any_spread_model(words: &mut [u64; TABLE_WORDS]) -> Model<'_> {
    let config = Config {
        hotspot_count: 2,
        ..smallest()
    };
    any_model_of(config, words)
}

/// The same with three UAVs and a bucket for each cell, each next to all others.
#[cfg(kani)]
pub(crate) fn any_bucketed_model(words: &mut [u64; TABLE_WORDS]) -> Model<'_> {
    let config = Config {
        uav_count: 3,
        ..smallest()
    };
    Model {
        bucket_side: 1,
        bucket_columns: 2,
        bucket_rows: 2,
        ..any_model_of(config, words)
    }
}

/// The same with any range of charges at the start.
pub(crate) fn any_charged_model(words: &mut [u64; TABLE_WORDS]) -> Model<'_> {
    let low = real_between(0.0, 1.0);
    let config = Config {
        initial_soc_min: low,
        initial_soc_max: real_between(low, 1.0),
        ..any_config()
    };
    any_model_of(config, words)
}

/// The same whose quorum counts the episode, and whose UAVs learn all hotspots that they detect.
pub(crate) fn any_remembering_model(words: &mut [u64; TABLE_WORDS]) -> Model<'_> {
    any_model_of(remembering(any_config()), words)
}

/// The same whose UAVs start anywhere.
pub(crate) fn any_scattered_model(words: &mut [u64; TABLE_WORDS]) -> Model<'_> {
    let config = Config {
        start_cells: StartCells::Random,
        ..any_config()
    };
    any_model_of(config, words)
}

/// The one configuration that Kani gets.
#[cfg(kani)]
fn any_config() -> Config {
    smallest()
}

/// A model of two by two cells.
#[cfg(kani)]
fn any_model_of(config: Config, words: &mut [u64; TABLE_WORDS]) -> Model<'_> {
    use super::{Tables, Words};
    use crate::config::{Cell, MAX_DEPOTS};

    let depots = config.effective_depots();
    let tables = Tables::of(2, 2);
    for y in 0..2 {
        for x in 0..2 {
            let index = (2 * y + x) as usize;
            words[index] = real_between(1e-131, 1e131).to_bits();
            words[tables.link + index] = real_between(0.0, 1e6).to_bits();
            let distance = Cell { x, y }.manhattan(depots.as_slice()[0]);
            words[tables.depot + index] = u64::from(distance) << 32;
        }
    }
    let mut sorted_depots = [u32::MAX; MAX_DEPOTS];
    sorted_depots[0] = 3;
    Model {
        hash: 1,
        depots,
        sorted_depots,
        energy: super::EnergyConstants::new(&config),
        carbon: super::CarbonConstants::new(&config),
        reward: super::RewardConstants::new(&config),
        layout: super::Layout::of(&config),
        uavs: config.uav_count as usize,
        hotspots: config.hotspot_count as usize,
        width: 2,
        height: 2,
        curve: crate::radio::radar::curve::AnyCurve::of(&config),
        threshold_db: 13.1,
        reach_cells: 1,
        bucket_side: 2,
        bucket_columns: 1,
        bucket_rows: 1,
        disc: super::Disc::from_radius(config.search_map_radius_m, config.cell_size_m),
        footprint: crate::radio::footprint::of(&config),
        added: 0,
        tables: Words::Borrowed(words),
        config,
    }
}

/// Most UAVs of a model that the stand-in makes: more than a word of a set holds, and more than are
/// linked pair by pair.
#[cfg(not(kani))]
pub(crate) const UAVS_MAX: usize = 70;

/// Mostly few UAVs, of which a case is soon flown; now and then any number.
#[cfg(not(kani))]
fn any_uav_count() -> u32 {
    let most = if between(0, 11) == 6 { UAVS_MAX } else { 5 };
    between(1, most as u64) as u32
}

/// The same, as its grid has buckets.
#[cfg(not(kani))]
pub(crate) fn any_bucketed_model(words: &mut [u64; TABLE_WORDS]) -> Model<'_> {
    any_model(words)
}

/// The same; many of these models have several hotspots.
#[cfg(not(kani))]
pub(crate) fn any_spread_model(words: &mut [u64; TABLE_WORDS]) -> Model<'_> {
    any_model(words)
}

/// The smallest configuration, or one of up to 70 UAVs, four hotspots and 16 cells.
#[cfg(not(kani))]
fn any_config() -> Config {
    let mut config = smallest();
    if kani::any() {
        config.grid_width = between(1, 4) as u32;
        config.grid_height = between(2, 4) as u32;
        config.uav_count = any_uav_count();
        let room = u64::from(config.grid_width * config.grid_height) - 1;
        config.hotspot_count = between(1, room.min(HOTSPOTS_MAX as u64)) as u32;
        config.horizon_steps = between(1, 12) as u32;
        config.quorum = between(1, 2) as u32;
        config.processing_gain_db = 8.0 + between(0, 30) as f64;
        config.link_throughput_min = between(0, 12) as f64 / 8.0;
        config.initial_soc_min = between(0, 1) as f64;
        if kani::any() {
            config.search_maps = SearchMaps::Shared;
            config.search_map_radius_m = between(0, 200) as f64;
        }
        if kani::any() {
            config.false_alarm_per_cell = real_between(0.0001, 0.5);
            config.report_levels = between(0, 3) as u32;
        }
        if between(0, 3) == 0 {
            config.quorum_window = QuorumWindow::Episode;
        }
        if between(0, 3) == 0 {
            config.learned_detections = LearnedDetections::All;
        }
        if between(0, 3) == 0 {
            config.start_cells = StartCells::Random;
        }
    }
    config
}

/// The widths at which the kernel runs, and that of Kani.
#[cfg(not(kani))]
const WIDTHS: [usize; 3] = [1, 2, crate::lanes::WIDE];

/// A model whose steps run at any of the widths, for any size of its fleet.
#[cfg(not(kani))]
fn any_model_of(config: Config, words: &mut [u64; TABLE_WORDS]) -> Model<'_> {
    crate::lanes::forced::set(WIDTHS[between(0, 2) as usize]);
    let len = Model::table_words(&config).unwrap_or(0);
    match Model::new_in(config, &mut words[..len]) {
        Ok(model) => model,
        Err(error) => panic!("{error}"),
    }
}
