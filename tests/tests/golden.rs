//! Golden traces: episodes that all builds have to reproduce bit for bit.
//!
//! These tests catch any change of the model, its random draws, its rounding or its order of
//! summation. They also catch a change of the observations or of the state's layout. Each trace
//! covers a branch of the step, and its test shows that it reaches that branch. `golden/record.sh`
//! records them.

mod abi_support;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::ErrorKind;
use std::path::PathBuf;

use abi_support::skip;
use jcas_core::config::FieldValue;
use jcas_core::{Cell, Config, DetectionCurve, Model, PilotGain, TargetVisibility, motion};
use jcas_episode::trace::{self, Step, Trace};

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden")
}

fn read(name: &str) -> Trace {
    let path = folder().join(format!("{name}.jsonl"));
    let bytes = fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    trace::read(bytes.as_slice()).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Reads a trace and verifies that this build reproduces it.
fn reproduced(name: &str) -> Trace {
    let trace = read(name);
    match trace::verify(&trace) {
        Ok(None) => trace,
        Ok(Some(difference)) => panic!("{name}: {difference}"),
        Err(error) => panic!("{name}: {error}"),
    }
}

/// Pairs of consecutive steps.
fn pairs(trace: &Trace) -> impl Iterator<Item = (&Step, &Step)> {
    trace.steps.windows(2).map(|pair| (&pair[0], &pair[1]))
}

fn capacity_uj(config: &Config) -> u64 {
    (config.battery_capacity_kwh * 3.6e12).round() as u64
}

#[test]
fn completion() {
    let trace = reproduced("completion");
    assert!(trace.end.terminated && !trace.end.truncated);
    let last = trace.steps.last().unwrap();
    assert_eq!(last.informed.len(), trace.header.hotspots.len());
    assert!(last.reward.0[2] > 0.0, "the completion pays");
    // Confirmed exceeds informed at some time, since knowledge has to spread.
    assert!(
        trace
            .steps
            .iter()
            .any(|step| step.confirmed.len() > step.informed.len())
    );
    // A hotspot is paid once: a step without a newly informed hotspot pays nothing.
    assert!(
        pairs(&trace)
            .filter(|(a, b)| !a.informed.is_empty() && a.informed == b.informed)
            .all(|(_, step)| step.reward.0[1] == 0.0)
    );
}

#[test]
fn completion_on_horizon() {
    let trace = reproduced("completion_on_horizon");
    assert_eq!(trace.end.steps, trace.header.config.horizon_steps);
    assert!(trace.end.terminated && !trace.end.truncated);
    // The paper's penalty applies at t = T_max, whether the mission is complete or not.
    assert!(trace.steps.last().unwrap().reward.0[7] < 0.0);
    assert!(
        trace.steps.last().unwrap().reward.0[2] > 0.0,
        "the completion pays"
    );
}

#[test]
fn truncation() {
    let trace = reproduced("truncation");
    assert!(trace.end.truncated && !trace.end.terminated);
    assert_eq!(trace.end.steps, trace.header.config.horizon_steps);
    assert!(
        trace.steps.last().unwrap().reward.0[7] < 0.0,
        "truncation costs"
    );
    assert!(
        trace.end.metrics.confirmed > 0,
        "something was confirmed before"
    );
}

#[test]
fn paper_preset() {
    let trace = reproduced("paper_preset");
    let config = &trace.header.config;
    let paper = Config {
        uav_count: config.uav_count,
        hotspot_count: config.hotspot_count,
        // Stronger chargers than the paper's have a rating above what a battery accepts.
        charge_power_kw: config.charge_power_kw,
        ..Config::preset(jcas_core::Preset::Paper)
    };
    assert_eq!(*config, paper);
    // The letter pays informed hotspots again at every step.
    assert!(
        pairs(&trace).any(|(a, b)| !a.informed.is_empty()
            && a.informed == b.informed
            && b.reward.0[1] > 0.0)
    );
    // It bills chargers by their rating, also for full batteries.
    assert!(trace.end.metrics.grid_kwh > trace.end.metrics.accepted_kwh);
}

#[test]
fn return_to_base() {
    let trace = reproduced("return_to_base");
    let depot = trace.header.depots[0];
    let mut homeward = 0;
    let mut charging = 0;
    for (before, step) in pairs(&trace) {
        for &uav in &step.returning {
            let (from, to) = (before.positions[uav], step.positions[uav]);
            let home = motion::toward(from, depot);
            let grid = (
                trace.header.config.grid_width,
                trace.header.config.grid_height,
            );
            assert_eq!(to, motion::destination(from, home, grid.0, grid.1));
            homeward += usize::from(from != to);
            charging += usize::from(from == depot && step.battery_uj[uav] > before.battery_uj[uav]);
        }
    }
    assert!(homeward > 0, "a UAV flies home");
    assert!(charging > 0, "a UAV stays on the depot and charges");
    let left_again = pairs(&trace).any(|(before, step)| {
        before
            .returning
            .iter()
            .any(|uav| !step.returning.contains(uav) && before.positions[*uav] == depot)
    });
    assert!(left_again, "a UAV has charged above the threshold");
}

#[test]
fn charging_to_full() {
    let trace = reproduced("charging_to_full");
    let capacity = capacity_uj(&trace.header.config);
    let filled = pairs(&trace).any(|(before, step)| {
        (0..step.battery_uj.len())
            .any(|uav| before.battery_uj[uav] < capacity && step.battery_uj[uav] == capacity)
    });
    assert!(filled, "a battery fills up");
    assert!(trace.end.metrics.accepted_kwh > 0.0);
    assert!(trace.end.metrics.co2_kg > 0.0);
}

#[test]
fn grounded() {
    let trace = reproduced("grounded");
    let depot = trace.header.depots[0];
    let mut stranded = 0;
    for (before, step) in pairs(&trace) {
        for &uav in &step.grounded {
            assert_eq!(before.battery_uj[uav], 0);
            assert_eq!(
                before.positions[uav], step.positions[uav],
                "a grounded UAV stays"
            );
            assert!(
                step.links.iter().flatten().all(|&linked| linked != uav),
                "and is silent"
            );
            stranded += usize::from(step.positions[uav] != depot);
        }
    }
    assert!(stranded > 0, "a UAV is grounded away from the depot");
    assert!(
        trace.end.metrics.shortfall_kwh > 0.0,
        "a step asked for more than was left"
    );
}

#[test]
fn grounded_on_depot() {
    let trace = reproduced("grounded_on_depot");
    let first = &trace.steps[0];
    assert_eq!(first.grounded.len(), first.positions.len());
    assert!(
        first.battery_uj.iter().all(|&charge| charge > 0),
        "grounded UAVs charge"
    );
    assert!(trace.steps[1].grounded.is_empty(), "and recover");
    assert!(
        trace.end.metrics.moves == 0,
        "but return to base keeps them"
    );
}

#[test]
fn link_on_threshold() {
    let trace = reproduced("link_on_threshold");
    let model = Model::new(trace.header.config).unwrap();
    let throughput = |step: &Step, i: usize, k: usize| {
        let (a, b) = (step.positions[i], step.positions[k]);
        model.link_throughput(a.x.abs_diff(b.x), a.y.abs_diff(b.y), step.pilot_density[i])
    };
    let needed = trace.header.config.link_throughput_min;
    let (mut on_threshold, mut below) = (0, 0);
    for step in &trace.steps {
        for i in 0..step.positions.len() {
            for k in i + 1..step.positions.len() {
                let weaker = throughput(step, i, k).min(throughput(step, k, i));
                assert_eq!(step.links.contains(&[i, k]), weaker >= needed);
                on_threshold += usize::from(weaker == needed);
                below += usize::from(weaker < needed);
            }
        }
    }
    assert!(on_threshold > 0, "a pair is exactly on the threshold");
    assert!(below > 0, "a pair is below it");
}

#[test]
fn hidden_targets() {
    let trace = reproduced("hidden_targets");
    assert_eq!(
        trace.header.config.target_visibility,
        TargetVisibility::Hidden
    );
    assert!(
        trace.end.metrics.confirmed > 0,
        "the search finds something"
    );
    // With visible hotspots the same actions lead to the same episode with other observations.
    let mut shown = trace.clone();
    shown.header.config.target_visibility = TargetVisibility::Known;
    let model = Model::new(shown.header.config).unwrap();
    let mut sim = jcas_core::Sim::new(&model);
    sim.reset(trace.header.seed.0);
    let mut observations = vec![0.0; model.uav_count() * model.observation_len()];
    for step in &trace.steps {
        sim.step(step.actions.as_flattened()).unwrap();
        sim.observe(&mut observations).unwrap();
        let positions: Vec<Cell> = (0..model.uav_count())
            .map(|i| sim.state().cell(i))
            .collect();
        assert_eq!(positions, step.positions);
        let everything_known = step
            .knowledge
            .iter()
            .all(|known| known.len() == model.hotspot_count());
        assert_eq!(
            jcas_core::hash::reals(&observations) == step.observation_hash.0,
            everything_known,
            "step {}",
            step.t
        );
    }
}

#[test]
fn search() {
    let trace = reproduced("search");
    assert!(trace.end.terminated);
    let model = Model::new(trace.header.config).unwrap();
    let mut sim = jcas_core::Sim::new(&model);
    sim.reset(trace.header.seed.0);
    let (uavs, width) = (model.uav_count(), trace.header.config.grid_width);
    let cells = trace.header.config.cell_count();
    let mut maps = vec![vec![false; cells]; uavs];
    let mut differed = 0;
    for step in &trace.steps {
        // A trace has each UAV's cell and links, which determine its map.
        for (map, cell) in maps.iter_mut().zip(&step.positions) {
            for (index, looked) in map.iter_mut().enumerate() {
                let (x, y) = (index as u32 % width, index as u32 / width);
                let (dx, dy) = (x.abs_diff(cell.x), y.abs_diff(cell.y));
                // A radius of 100 m is two cells.
                *looked |= dx * dx + dy * dy <= 4;
            }
        }
        for _ in 0..uavs {
            for &[i, k] in &step.links {
                let both: Vec<bool> = maps[i].iter().zip(&maps[k]).map(|(a, b)| a | b).collect();
                (maps[i], maps[k]) = (both.clone(), both);
            }
        }
        sim.step(step.actions.as_flattened()).unwrap();
        for (i, map) in maps.iter().enumerate() {
            for (index, &looked) in map.iter().enumerate() {
                assert_eq!(sim.state().searched(i, index), looked);
            }
        }
        differed += usize::from(maps.iter().any(|map| *map != maps[0]));
    }
    assert!(differed > 3 && differed < trace.steps.len());
}

#[test]
fn one_uav() {
    let trace = reproduced("one_uav");
    assert_eq!(trace.header.config.uav_count, 1);
    assert!(trace.end.terminated, "alone it completes");
    assert!(
        trace
            .steps
            .iter()
            .all(|step| step.links.is_empty() && step.throughput == 0.0)
    );
}

#[test]
fn several_depots() {
    let trace = reproduced("several_depots");
    assert!(trace.header.depots.len() > 1);
    let charged_elsewhere = pairs(&trace).any(|(before, step)| {
        (0..step.positions.len()).any(|uav| {
            trace.header.depots[1..].contains(&step.positions[uav])
                && step.battery_uj[uav] > before.battery_uj[uav]
        })
    });
    assert!(
        charged_elsewhere,
        "a UAV charges on a depot other than the first"
    );
    assert!(
        trace
            .header
            .hotspots
            .iter()
            .all(|cell| !trace.header.depots.contains(cell))
    );
}

#[test]
fn narrow_grid() {
    let trace = reproduced("narrow_grid");
    let config = &trace.header.config;
    assert_ne!(config.grid_width, config.grid_height);
    assert!(
        config.neighbour_slots < config.uav_count - 1,
        "not all neighbours are observed"
    );
    let stopped_by_edge = pairs(&trace).any(|(before, step)| {
        (0..step.positions.len()).any(|uav| {
            let moves = jcas_core::action::motion(step.actions[uav][0]);
            moves != jcas_core::Motion::Stay && before.positions[uav] == step.positions[uav]
        })
    });
    assert!(stopped_by_edge, "a move off the grid is a stay");
}

#[test]
fn large_fleet() {
    let trace = reproduced("large_fleet");
    assert!(
        trace.header.config.uav_count > 64,
        "sets span several words"
    );
    assert!(trace.header.config.hotspot_count > 64);
    let pairs = |step: &Step| step.positions.len() * (step.positions.len() - 1) / 2;
    assert!(
        trace
            .steps
            .iter()
            .any(|step| step.links.len() < pairs(step)),
        "not all are linked"
    );
    assert!(trace.end.metrics.confirmed > 0);
}

/// Steps in which some pairs of UAVs are linked and others are not.
fn partly_linked(trace: &Trace) -> usize {
    let uavs = trace.header.config.uav_count as usize;
    let pairs = uavs * (uavs - 1) / 2;
    let partly = |step: &&Step| !step.links.is_empty() && step.links.len() < pairs;
    trace.steps.iter().filter(partly).count()
}

#[test]
fn ten_uavs() {
    let trace = reproduced("ten_uavs");
    let config = &trace.header.config;
    assert_eq!(config.uav_count, 10);
    // R_min bounds distances between cells from below, not the distance that sets the threshold.
    let least_m = config.range_min_m.unwrap_or(config.cell_size_m / 2.0);
    assert!(config.sensing_range_m.is_some_and(|range| range < least_m));
    assert!(trace.end.metrics.confirmed > trace.end.metrics.informed);
    assert!(partly_linked(&trace) > 20);
    let returning = trace.steps.iter().flat_map(|step| &step.returning);
    let (first, rest): (Vec<usize>, Vec<usize>) = returning.partition(|&&uav| uav < 8);
    assert!(
        !first.is_empty() && !rest.is_empty(),
        "UAVs return in both parts of the fleet"
    );
}

#[test]
fn fifteen_uavs() {
    let trace = reproduced("fifteen_uavs");
    let paper = Config {
        uav_count: 15,
        hotspot_count: 5,
        ..Config::preset(jcas_core::Preset::Paper)
    };
    assert_eq!(trace.header.config, paper);
    assert!(trace.end.terminated);
    assert!(partly_linked(&trace) > 10);
}

#[test]
fn twenty_uavs() {
    let trace = reproduced("twenty_uavs");
    let search = Config {
        uav_count: 20,
        hotspot_count: 5,
        horizon_steps: 20,
        ..Config::preset(jcas_core::Preset::Search)
    };
    assert_eq!(trace.header.config, search);
    assert!(trace.end.terminated);
    let travelling = |step: &&Step| step.confirmed.len() > step.informed.len();
    assert!(trace.steps.iter().filter(travelling).count() > 10);
}

/// Checks a trace with low charge, whose fleet size is next to the one where buckets begin.
fn short_of_charge(trace: &Trace, uavs: u32) {
    assert_eq!(trace.header.config.uav_count, uavs);
    assert!(trace.end.metrics.confirmed > 0);
    assert!(partly_linked(trace) > 5);
    let growing = pairs(trace).all(|(a, b)| b.grounded.len() >= a.grounded.len());
    assert!(growing, "UAVs run empty one after another");
    let mixed = |step: &Step, block: usize| {
        let uavs = 16 * block..16 * block + 16;
        let grounded = step.grounded.iter().filter(|uav| uavs.contains(uav));
        let grounded = grounded.count();
        0 < grounded && grounded < 16
    };
    let all_mixed = |step: &Step| (0..3).all(|block| mixed(step, block));
    assert!(
        trace.steps.iter().any(all_mixed),
        "some of each sixteen are grounded, some fly"
    );
}

#[test]
fn forty_eight_uavs() {
    short_of_charge(&reproduced("forty_eight_uavs"), 48);
}

#[test]
fn forty_nine_uavs() {
    short_of_charge(&reproduced("forty_nine_uavs"), 49);
}

#[test]
fn hundred_uavs() {
    let trace = reproduced("hundred_uavs");
    assert_eq!(trace.header.config.uav_count, 100);
    assert!(partly_linked(&trace) > 5);
    // Links join UAVs of both words of a set.
    let across = |&[i, k]: &[usize; 2]| i < 64 && k >= 64;
    assert!(trace.steps.iter().any(|step| step.links.iter().any(across)));
    assert!(trace.end.metrics.confirmed > 0 && trace.end.metrics.informed == 0);
}

/// UAVs that detected a hotspot while flying at the lowest and at the highest pilot density.
fn learners_by_density(trace: &Trace) -> [usize; 2] {
    let config = &trace.header.config;
    let mut learners = [0; 2];
    for (before, step) in pairs(trace) {
        for uav in 0..step.positions.len() {
            if step.knowledge[uav].len() > before.knowledge[uav].len() {
                let density = step.pilot_density[uav];
                learners[0] += usize::from(density == config.pilot_density_min);
                learners[1] += usize::from(density == config.pilot_density_max);
            }
        }
    }
    learners
}

#[test]
fn coherent_pilots() {
    let trace = reproduced("coherent_pilots");
    let config = &trace.header.config;
    assert_eq!(config.pilot_gain, PilotGain::Coherent);
    assert_eq!(config.detection_curve, DetectionCurve::Logistic);
    assert!(trace.end.metrics.confirmed > 0);
    assert!(learners_by_density(&trace).iter().all(|&count| count > 0));
}

#[test]
fn swerling1() {
    let trace = reproduced("swerling1");
    let config = &trace.header.config;
    assert_eq!(config.pilot_gain, PilotGain::Coherent);
    assert_eq!(config.detection_curve, DetectionCurve::Swerling1);
    assert!(trace.end.metrics.confirmed > 0);
    assert!(learners_by_density(&trace).iter().all(|&count| count > 0));
}

/// Fewer UAVs than a wide block, and no gain of the pilots.
#[test]
fn swerling1_alone() {
    let trace = reproduced("swerling1_alone");
    let config = &trace.header.config;
    assert_eq!(config.pilot_gain, PilotGain::None);
    assert_eq!(config.detection_curve, DetectionCurve::Swerling1);
    assert!(trace.end.metrics.confirmed > 0);
}

#[test]
fn detection_table() {
    let trace = reproduced("detection_table");
    let config = &trace.header.config;
    assert_eq!(config.detection_curve, DetectionCurve::Table);
    assert_eq!(config.detection_table.len(), 3);
    assert!(trace.end.metrics.confirmed > 0);
    assert!(learners_by_density(&trace).iter().all(|&count| count > 0));
}

/// Every trace has a test and a line in the script that records it, and every test has a trace.
#[test]
fn every_trace_has_its_test_and_its_line() {
    let files: BTreeSet<String> = fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter_map(|name| name.strip_suffix(".jsonl").map(str::to_owned))
        .collect();
    let script = fs::read_to_string(folder().join("record.sh")).unwrap();
    let recorded: BTreeSet<String> = script
        .lines()
        .filter_map(|line| line.strip_prefix("record "))
        .filter_map(|line| line.split_whitespace().next())
        .map(str::to_owned)
        .collect();
    let tests = include_str!("golden.rs");
    let tested: BTreeSet<String> = files
        .iter()
        .filter(|name| tests.contains(&format!("reproduced(\"{name}\")")))
        .cloned()
        .collect();
    assert_eq!(files, recorded);
    assert_eq!(files, tested);
}

/// A changed trace is detected wherever the change is.
#[test]
fn any_changed_field_is_caught() {
    let honest = read("completion");
    type Change = (&'static str, fn(&mut Trace));
    let changes: [Change; 8] = [
        ("config_hash", |trace| trace.header.config_hash.0 ^= 1),
        ("initial.state_hash", |trace| {
            trace.header.initial.state_hash.0 ^= 1
        }),
        ("positions[0][0]", |trace| {
            trace.steps[4].positions[0].x ^= 1
        }),
        ("battery_uj[9]", |trace| trace.steps[4].battery_uj[9] += 1),
        ("throughput", |trace| {
            let bits = trace.steps[4].throughput.to_bits();
            trace.steps[4].throughput = f64::from_bits(bits ^ 1);
        }),
        ("reward.spread", |trace| trace.steps[4].reward.0[9] += 1e-9),
        ("observation_hash", |trace| {
            trace.steps[4].observation_hash.0 ^= 1
        }),
        ("metrics.moves", |trace| trace.end.metrics.moves += 1),
    ];
    for (field, change) in changes {
        let mut changed = honest.clone();
        change(&mut changed);
        let found = trace::verify(&changed).unwrap().expect(field);
        assert_eq!(found.field, field);
        assert_eq!(trace::diff(&honest, &changed).unwrap().field, field);
    }
}

/// The row-major index of a cell in a set of cells that a trace counts by quorum.
fn seen_by(step: &Step, cell: Cell) -> usize {
    let alarms = step
        .false_alarms
        .as_ref()
        .expect("a trace with false alarms");
    alarms.iter().filter(|cells| cells.contains(&cell)).count()
}

/// A cell is falsely confirmed once its alarms reach the quorum, and for good.
fn cells_are_confirmed_by_quorum(trace: &Trace) {
    let config = &trace.header.config;
    let mut confirmed: BTreeSet<(u32, u32)> = BTreeSet::new();
    for step in &trace.steps {
        let before = confirmed.len();
        for cell in step.false_alarms.iter().flatten().flatten() {
            assert!(
                !trace.header.hotspots.contains(cell),
                "a hotspot is no false alarm"
            );
            if seen_by(step, *cell) >= config.quorum as usize {
                confirmed.insert((cell.y, cell.x));
            }
        }
        let recorded = step.falsely_confirmed.iter().flatten();
        assert!(
            recorded
                .map(|cell| (cell.y, cell.x))
                .eq(confirmed.iter().copied())
        );
        if confirmed.len() > before && config.reward_detect == 0.0 {
            assert!(step.reward.0[0] < 0.0);
        }
    }
    let counted = trace.end.metrics.false_confirmations;
    assert_eq!(counted as usize, confirmed.len());
    assert!(counted > 0);
}

#[test]
fn false_alarms() {
    let trace = reproduced("false_alarms");
    cells_are_confirmed_by_quorum(&trace);
    let config = &trace.header.config;
    let pays = config.reward_false_confirmation;
    for (before, step) in pairs(&trace) {
        let count = |step: &Step| step.falsely_confirmed.as_ref().map_or(0, Vec::len);
        let fresh = count(step) - count(before);
        let found = step.confirmed.len() - before.confirmed.len();
        let expected = config.reward_detect * found as f64 + pays * fresh as f64;
        assert_eq!(step.reward.0[0], expected, "step {}", step.t);
    }
    // A footprint of 150 m reaches three cells.
    for step in &trace.steps {
        for (uav, alarms) in step.false_alarms.iter().flatten().enumerate() {
            let here = step.positions[uav];
            let near = |cell: &Cell| {
                let (dx, dy) = (cell.x.abs_diff(here.x), cell.y.abs_diff(here.y));
                dx * dx + dy * dy <= 9
            };
            assert!(alarms.iter().all(near));
        }
    }
}

#[test]
fn false_alarms_alone() {
    let trace = reproduced("false_alarms_alone");
    cells_are_confirmed_by_quorum(&trace);
    let alarms = trace
        .steps
        .iter()
        .flat_map(|step| step.false_alarms.iter().flatten());
    let most = alarms.map(Vec::len).max();
    assert_eq!(most, Some(8), "more alarms than eight count as eight");
}

/// The reports that a UAV knows after a step, as sets of (y, x) level by level.
fn reports_of(step: &Step, uav: usize) -> Vec<BTreeSet<(u32, u32)>> {
    let reports = step.reports.as_ref().expect("a trace with reports");
    let sets = reports[uav].iter();
    sets.map(|cells| cells.iter().map(|cell| (cell.y, cell.x)).collect())
        .collect()
}

/// A UAV reports its false alarms, once a level, and neighbours know the same.
#[test]
fn reports() {
    let trace = reproduced("reports");
    let uavs = trace.header.config.uav_count as usize;
    let mut alarms_of: Vec<BTreeMap<(u32, u32), u32>> = vec![BTreeMap::new(); uavs];
    let mut heard = 0;
    for step in &trace.steps {
        for (uav, cells) in step.false_alarms.iter().flatten().enumerate() {
            for cell in cells {
                *alarms_of[uav].entry((cell.y, cell.x)).or_insert(0) += 1;
            }
        }
        for (uav, own) in alarms_of.iter().enumerate() {
            let known = reports_of(step, uav);
            assert!(known[1].is_subset(&known[0]));
            for (cell, &times) in own {
                assert!(known[0].contains(cell) && (times < 2 || known[1].contains(cell)));
            }
            heard += known[0]
                .iter()
                .filter(|&cell| !own.contains_key(cell))
                .count();
        }
        for &[a, b] in &step.links {
            assert_eq!(reports_of(step, a), reports_of(step, b), "step {}", step.t);
        }
    }
    assert!(heard > 0, "word of others' sightings");
    for (before, step) in pairs(&trace) {
        for uav in 0..uavs {
            let known = reports_of(step, uav);
            let nested = reports_of(before, uav).into_iter().zip(&known);
            assert!(
                nested
                    .into_iter()
                    .all(|(before, after)| before.is_subset(after))
            );
        }
    }
    let last = trace.steps.last().expect("a step");
    assert!((0..uavs).any(|uav| !reports_of(last, uav)[1].is_empty()));
}

/// The configuration in a trace is complete. The later fields alone may be left out: at their
/// default they are off.
#[test]
fn headers_hold_every_field() {
    let path = folder().join("completion.jsonl");
    let text = fs::read_to_string(path).unwrap();
    let header = text.lines().next().unwrap();
    let config = Config::default();
    let fields = Config::FIELDS.iter().zip(config.values());
    for (info, value) in fields.take(Config::LATER_FIELDS) {
        let derived = value == FieldValue::Optional(None);
        assert_eq!(
            header.contains(&format!("\"{}\":", info.name)),
            !derived,
            "{}",
            info.name
        );
    }
}

/// A script that follows only `docs/model.md` rebuilds every trace.
#[test]
fn the_page_is_enough_to_rebuild_every_trace() {
    let script = folder().join("../rebuild/rebuild.py");
    let traces = fs::read_dir(folder())
        .expect("the golden traces are there")
        .map(|entry| entry.expect("a readable folder").path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "jsonl"));
    let rebuilding = std::process::Command::new("python3")
        .arg(&script)
        .args(traces)
        .output();
    let output = match rebuilding {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return skip("python3 is not installed");
        }
        rebuilding => rebuilding.expect("python3 runs"),
    };
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    // The script refuses a trace with another seed.
    let other = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("other_seed.jsonl");
    let text = fs::read_to_string(folder().join("one_uav.jsonl")).expect("a golden trace");
    let at = text.find("\"seed\":\"0x").expect("a seed") + 10;
    let digit = if &text[at..=at] == "0" { "1" } else { "0" };
    let changed = format!("{}{digit}{}", &text[..at], &text[at + 1..]);
    fs::write(&other, changed).expect("the target folder can be written");
    let output = std::process::Command::new("python3")
        .arg(&script)
        .arg(&other)
        .output()
        .expect("python3 runs");
    assert!(!output.status.success());
}
