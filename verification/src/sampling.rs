//! Random configurations and actions that reach the corners of the model.

use crate::specification::philox::{block, first_u64};
use crate::specification::{Specification, World, motion};
use jcas_core::config::{Depots, DetectionPoint, DetectionTable};
use jcas_core::{
    Cell, Config, DetectionCurve, LearnedDetections, MapDirections, MotionMap, PilotGain, Preset,
    QuorumWindow, SearchMaps, StartCells, TargetVisibility, UavTag,
};

/// A stream of random numbers, independent of the model's draws.
#[derive(Clone, Debug)]
pub struct Dice {
    seed: u64,
    rolls: u32,
}

impl Dice {
    /// Returns the stream of a seed.
    pub fn new(seed: u64) -> Self {
        Dice { seed, rolls: 0 }
    }

    /// Returns 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.rolls += 1;
        first_u64(block(self.seed, [self.rolls, 0, 0, 0xD1CE]))
    }

    /// Returns an integer in `low..=high`.
    pub fn integer(&mut self, low: u32, high: u32) -> u32 {
        low + (self.bits() % (u64::from(high - low) + 1)) as u32
    }

    /// Returns a real in `low..high`.
    pub fn real(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / 9_007_199_254_740_992.0)
    }

    /// Returns true one time in `n`.
    pub fn one_in(&mut self, n: u32) -> bool {
        self.integer(1, n) == 1
    }
}

/// Fleet sizes at which the kernel's path changes, and the sizes next to them.
///
/// Blocks of UAVs and words of sets end at these sizes. The neighbour search in buckets starts at
/// one of them.
pub const SEAMS: [u32; 18] = [
    1, 2, 7, 8, 9, 15, 16, 17, 31, 32, 33, 47, 48, 49, 63, 64, 65, 100,
];

/// The largest fleet that is drawn.
pub const UAVS_MAX: u32 = 100;

/// Draws a number of UAVs, two times in three one of `SEAMS`.
pub fn fleet_size(dice: &mut Dice) -> u32 {
    if dice.one_in(3) {
        dice.integer(1, UAVS_MAX)
    } else {
        SEAMS[dice.integer(0, SEAMS.len() as u32 - 1) as usize]
    }
}

/// Draws a legal configuration of any fleet size, far from the defaults in many fields.
pub fn configuration(dice: &mut Dice) -> Config {
    let uavs = fleet_size(dice);
    configuration_of(dice, uavs)
}

/// Draws a legal configuration for a number of UAVs.
pub fn configuration_of(dice: &mut Dice, uavs: u32) -> Config {
    let preset = if dice.one_in(2) {
        Preset::Mission
    } else {
        Preset::Paper
    };
    let mut c = Config::preset(preset);
    c.sensing_range_m = None;
    c.uav_count = uavs;
    mission(dice, &mut c);
    radio(dice, &mut c);
    energy(dice, &mut c);
    if dice.one_in(3) {
        weights(dice, &mut c);
    }
    search(dice, &mut c);
    false_alarms(dice, &mut c);
    detections(dice, &mut c);
    c.motion_map = MotionMap::ALL[dice.integer(0, 1) as usize];
    c
}

/// Draws what detections count for, and where UAVs start.
fn detections(dice: &mut Dice, c: &mut Config) {
    if dice.one_in(3) {
        c.quorum_window = QuorumWindow::Episode;
    }
    if dice.one_in(3) {
        c.learned_detections = LearnedDetections::All;
    }
    if dice.one_in(3) {
        c.start_cells = StartCells::Random;
    }
}

/// Draws false alarms, often more than are counted, and their footprint.
fn false_alarms(dice: &mut Dice, c: &mut Config) {
    if dice.one_in(2) {
        return;
    }
    c.false_alarm_per_cell = match dice.integer(0, 2) {
        0 => 0.5,
        1 => dice.real(1e-6, 0.01),
        _ => dice.real(0.01, 0.3),
    };
    c.sensing_footprint_m = match dice.integer(0, 3) {
        0 => Some(0.0),
        1 => Some(c.cell_size_m * dice.real(0.0, 4.0)),
        2 => Some(c.cell_size_m * 20.0),
        _ => None,
    };
    c.reward_false_confirmation = dice.real(-10.0, 1.0);
    c.report_levels = dice.integer(0, 3);
    if c.report_levels > 0 {
        c.report_slots = dice.integer(0, 5);
        c.map_window_radius = dice.integer(0, 3);
    }
}

/// Draws the settings of search maps and their observation.
fn search(dice: &mut Dice, c: &mut Config) {
    let tags = [UavTag::Off, UavTag::Index];
    c.uav_tag = tags[dice.integer(0, 1) as usize];
    if dice.one_in(2) {
        c.search_maps = SearchMaps::Shared;
        c.search_map_radius_m = match dice.integer(0, 3) {
            0 => 0.0,
            1 => c.cell_size_m * f64::from(dice.integer(1, 3)),
            2 => c.cell_size_m * 20.0,
            _ => c.cell_size_m * dice.real(0.0, 5.0),
        };
        c.map_window_radius = dice.integer(0, 4);
        if dice.one_in(2) {
            c.map_directions = MapDirections::Shown;
        }
    }
}

fn mission(dice: &mut Dice, c: &mut Config) {
    loop {
        c.grid_width = dice.integer(1, 14);
        c.grid_height = dice.integer(1, 14);
        if c.grid_width * c.grid_height > 1 {
            break;
        }
    }
    let cells = c.grid_width * c.grid_height;
    c.hotspot_count = dice.integer(1, 9.min(cells - 1));
    // A step of a large fleet takes as long as many steps of a small one.
    c.horizon_steps = dice.integer(1, 40.min(8 + 600 / c.uav_count));
    c.quorum = dice.integer(1, 4);
    c.cell_size_m = dice.real(1.0, 120.0);
    c.depots = depots(dice, c);
    if dice.one_in(2) {
        c.target_visibility = TargetVisibility::Hidden;
    }
    if dice.one_in(3) {
        c.neighbour_slots = dice.integer(0, c.uav_count + 1);
    }
}

/// Draws a legal configuration of a large fleet on a wide grid.
///
/// The kernel sorts its UAVs into several buckets, and a set of UAVs or hotspots takes two words.
pub fn large_configuration(dice: &mut Dice) -> Config {
    let uavs = dice.integer(49, UAVS_MAX);
    let mut c = configuration_of(dice, uavs);
    c.grid_width = dice.integer(20, 30);
    c.grid_height = dice.integer(20, 30);
    c.depots = Depots::CENTRE;
    c.hotspot_count = dice.integer(60, 75);
    c.horizon_steps = 10;
    c.neighbour_slots = dice.integer(0, 4095);
    c.cell_size_m = dice.real(30.0, 60.0);
    c.range_min_m = None;
    c.path_loss_exponent = 2.0;
    c.link_throughput_min = dice.real(0.8, 1.3);
    c.pilot_density_min = 0.01;
    c.pilot_density_max = 0.30;
    c
}

/// Draws up to four distinct depots that leave room for the hotspots, and often none, the default.
fn depots(dice: &mut Dice, c: &Config) -> Depots {
    let room = c.grid_width * c.grid_height - c.hotspot_count;
    let wanted = dice.integer(0, 4.min(room));
    let mut cells: Vec<Cell> = Vec::new();
    for _ in 0..wanted {
        let x = dice.integer(0, c.grid_width - 1);
        let y = dice.integer(0, c.grid_height - 1);
        if !cells.contains(&Cell { x, y }) {
            cells.push(Cell { x, y });
        }
    }
    Depots::from_slice(&cells).unwrap_or(Depots::CENTRE)
}

fn radio(dice: &mut Dice, c: &mut Config) {
    c.processing_gain_db = dice.real(0.0, 45.0);
    c.comm_load_penalty_db = dice.real(0.0, 3.0);
    c.detection_probability = dice.real(0.3, 0.9);
    c.false_alarm_probability = dice.real(1e-6, 1e-3);
    c.logistic_slope_per_db = dice.real(0.0, 1.0);
    c.path_loss_exponent = dice.real(1.5, 3.5);
    c.link_throughput_min = dice.real(0.0, 2.0);
    c.pilot_density_min = dice.real(0.0, 0.5);
    c.pilot_density_max = if dice.one_in(5) {
        c.pilot_density_min.max(0.01)
    } else {
        dice.real(0.5, 1.0)
    };
    c.pilot_density_min = c.pilot_density_min.min(c.pilot_density_max);
    if dice.one_in(3) {
        c.detection_threshold_db = Some(dice.real(-10.0, 20.0));
    }
    if dice.one_in(3) {
        c.sensing_range_m = Some(dice.real(0.01, 300.0));
    }
    if dice.one_in(3) {
        c.range_min_m = Some(dice.real(0.1, 200.0));
    }
    if dice.one_in(3) {
        c.range_resolution_m = Some(if dice.one_in(2) {
            0.0
        } else {
            dice.real(0.0, 10.0)
        });
    }
    detection(dice, c);
}

/// Draws the gain of the pilots and the detection curve.
fn detection(dice: &mut Dice, c: &mut Config) {
    if dice.one_in(2) {
        c.pilot_gain = PilotGain::Coherent;
    }
    match dice.integer(0, 3) {
        0 => return,
        1 => {
            c.detection_curve = DetectionCurve::Table;
            c.detection_table = detection_table(dice);
        }
        _ => {
            c.detection_curve = DetectionCurve::Swerling1;
            c.false_alarm_probability = libm::pow(10.0, -dice.real(1.0, 12.0));
            c.logistic_slope_per_db = Config::default().logistic_slope_per_db;
        }
    }
    c.detection_threshold_db = None;
    c.sensing_range_m = None;
}

/// Draws a table of one to 64 points, whose P_d falls or stays from one to the next, and ends at
/// 0.1 or below.
fn detection_table(dice: &mut Dice) -> DetectionTable {
    let (mut range_m, mut probability) = (dice.real(0.0, 50.0), dice.real(0.3, 1.0));
    let mut points: Vec<_> = (0..dice.integer(1, 64))
        .map(|_| {
            let point = DetectionPoint {
                range_m,
                probability,
            };
            range_m += dice.real(0.1, 50.0);
            probability *= if dice.one_in(4) {
                1.0
            } else {
                dice.real(0.5, 1.0)
            };
            point
        })
        .collect();
    if let Some(last) = points.last_mut() {
        last.probability = last.probability.min(0.1);
    }
    DetectionTable::from_slice(&points).expect("at most 64 points")
}

/// Draws batteries that last from a few steps to more than an episode.
fn energy(dice: &mut Dice, c: &mut Config) {
    c.step_duration_s = dice.real(1.0, 60.0);
    c.battery_capacity_kwh = dice.real(0.0005, 0.02);
    c.rtb_threshold_kwh = if dice.one_in(3) {
        0.0
    } else {
        dice.real(0.0, c.battery_capacity_kwh)
    };
    c.charge_power_kw = dice.real(0.0, 2.0);
    c.move_energy_kwh = dice.real(0.0, 2e-3);
    c.hover_energy_kwh = if dice.one_in(2) {
        0.0
    } else {
        dice.real(0.0, 1e-3)
    };
    c.sense_energy_kwh = dice.real(0.0, 1e-3);
    c.comm_energy_kwh = dice.real(0.0, 1e-3);
    c.renewable_share = dice.real(0.0, 1.0);
    c.initial_soc_min = if dice.one_in(3) {
        0.0
    } else {
        dice.real(0.0, 1.0)
    };
    c.initial_soc_max = dice.real(c.initial_soc_min, 1.0);
    if dice.one_in(4) {
        (c.initial_soc_min, c.initial_soc_max) = (1.0, 1.0);
    }
    if dice.one_in(4) {
        c.carbon_intensity_max_kg_per_kwh = c.carbon_intensity_min_kg_per_kwh;
    } else {
        c.carbon_intensity_min_kg_per_kwh = dice.real(0.0, 0.3);
    }
}

fn weights(dice: &mut Dice, c: &mut Config) {
    c.reward_detect = dice.real(-10.0, 10.0);
    c.reward_inform = dice.real(-10.0, 10.0);
    c.reward_complete = dice.real(-10.0, 10.0);
    c.reward_coverage = dice.real(-10.0, 10.0);
    c.penalty_energy_per_kwh = dice.real(-10.0, 10.0);
    c.penalty_carbon_per_kg = dice.real(-10.0, 10.0);
    c.penalty_revisit = dice.real(-1.0, 1.0);
    c.penalty_truncation = dice.real(-1.0, 1.0);
    c.reward_throughput = dice.real(-1.0, 1.0);
    c.reward_spread = dice.real(-1.0, 1.0);
    c.shaping_discount = dice.real(0.0, 1.0);
    c.shaping_goal_weight = dice.real(0.0, 5.0);
    c.shaping_charge_weight = dice.real(0.0, 5.0);
    c.shaping_unconfirmed_weight = dice.real(0.0, 3.0);
}

/// A rule that chooses the actions of a fleet in an episode.
#[derive(Clone, Copy, Debug)]
pub enum Pilot {
    /// Random values within and outside of [-1, 1], infinities included.
    Anything,
    /// Each UAV to its nearest unconfirmed hotspot.
    Greedy,
    /// All UAVs to the first unconfirmed hotspot.
    Swarm,
    /// UAV i to hotspot i mod n, known or not, so that the fleet spreads.
    Spread,
}

/// Draws one of the rules.
pub fn pilot(dice: &mut Dice) -> Pilot {
    match dice.integer(0, 2) {
        0 => Pilot::Anything,
        1 => Pilot::Greedy,
        _ => Pilot::Swarm,
    }
}

/// Returns the fleet's actions for the coming step.
pub fn actions(
    dice: &mut Dice,
    pilot: Pilot,
    spec: &Specification,
    world: &World,
) -> Vec<(f32, f32)> {
    let mut actions = Vec::new();
    for i in 0..spec.config.uav_count as usize {
        let u_dir = match (pilot, target(pilot, world, i)) {
            (Pilot::Anything, _) | (_, None) => component(dice),
            (_, Some(j)) => toward(spec, world, i, j),
        };
        actions.push((u_dir, component(dice)));
    }
    actions
}

/// Returns the hotspot that UAV i flies to.
fn target(pilot: Pilot, world: &World, i: usize) -> Option<usize> {
    if matches!(pilot, Pilot::Spread) {
        return Some(i % world.hotspot.len());
    }
    let here = world.position[i];
    let open = (0..world.hotspot.len()).filter(|&j| world.confirmed_at[j].is_none());
    let mut choice: Option<(i64, usize)> = None;
    for j in open {
        let there = world.hotspot[j];
        let distance = match pilot {
            Pilot::Greedy => (here.x - there.x).abs() + (here.y - there.y).abs(),
            _ => 0,
        };
        if choice.is_none_or(|(best, _)| distance < best) {
            choice = Some((distance, j));
        }
    }
    choice.map(|(_, j)| j)
}

/// Returns the middle of the bin of a motion that brings UAV i nearer to hotspot j.
fn toward(spec: &Specification, world: &World, i: usize, j: usize) -> f32 {
    let (here, there) = (world.position[i], world.hotspot[j]);
    let wanted = if there.y != here.y {
        (0, (there.y - here.y).signum())
    } else {
        ((there.x - here.x).signum(), 0)
    };
    let centres = [-0.8, -0.4, 0.0, 0.4, 0.8];
    let map = spec.config.motion_map;
    let leads = |&u_dir: &f32| motion(u_dir, map) == wanted;
    centres.into_iter().find(leads).expect("five motions")
}

/// Draws one component of an action, mostly within [-1, 1] and often on an edge.
fn component(dice: &mut Dice) -> f32 {
    const EDGES: [f32; 12] = [
        -1.0,
        1.0,
        0.0,
        -0.0,
        -0.6,
        -0.2,
        0.2,
        0.6,
        1.5,
        -7.0,
        f32::INFINITY,
        f32::NEG_INFINITY,
    ];
    if dice.one_in(4) {
        EDGES[dice.integer(0, 11) as usize]
    } else {
        dice.real(-1.0, 1.0) as f32
    }
}
