//! Each baseline acts as documented and reads only what it may read.

use std::ops::ControlFlow;

use jcas_core::{Cell, Config, Model, Motion, MotionMap, Sim, TargetVisibility, action};
use jcas_episode::campaign::{self, Campaign};
use jcas_episode::statistics::Summary;
use jcas_policy::head::Mode;
use jcas_policy::network::ActOptions;
use jcas_policy::{
    BaselineKind, PilotMode, Policy, PolicyError, Trained, gather, quorum_probability,
    stays_to_charge,
};

const MISSION: &[u8] = include_bytes!("../../policies/mission/policy.safetensors");

fn model(config: Config) -> Model<'static> {
    Model::new(config).unwrap()
}

fn fly(config: Config, kind: BaselineKind, pilot: PilotMode, episodes: u64) -> Summary {
    let model = model(config);
    let campaign = Campaign { episodes, seed: 1 };
    let make = || -> Box<dyn Policy> { Box::new(kind.build_privileged(pilot)) };
    let episodes = campaign::fly(&model, campaign, &make, &|| ControlFlow::Continue(())).unwrap();
    Summary::of(&episodes, config.horizon_steps)
}

/// `greedy` at the highest pilot density confirms all hotspots as often as in a prototype of the
/// model, over 300 episodes. The prototype left out the range resolution's penalty.
#[test]
fn greedy_succeeds_as_often_as_the_prototype_did() {
    for (uav_count, hotspot_count, expected) in [
        (5, 3, 0.57),
        (5, 5, 0.15),
        (5, 9, 0.0),
        (10, 3, 1.0),
        (10, 9, 0.98),
        (10, 11, 0.91),
        (15, 11, 1.0),
    ] {
        let config = Config {
            uav_count,
            hotspot_count,
            range_resolution_m: Some(0.0),
            ..Config::default()
        };
        let got = fly(config, BaselineKind::Greedy, PilotMode::Max, 300).success_rate;
        // Both fractions come from 300 episodes: three standard errors of their difference.
        let error = 3.0 * (2.0 * expected * (1.0 - expected) / 300.0f64).sqrt() + 0.01;
        assert!(
            (got.value - expected).abs() <= error,
            "N = {uav_count}, n = {hotspot_count}: {} against {expected}",
            got.value
        );
    }
}

#[test]
fn planning_whole_ways_beats_going_to_the_nearest() {
    for (uav_count, hotspot_count) in [(10, 7), (20, 9)] {
        let config = Config {
            uav_count,
            hotspot_count,
            ..Config::default()
        };
        let greedy = fly(config, BaselineKind::Greedy, PilotMode::Adaptive, 200);
        let teams = fly(config, BaselineKind::Teams, PilotMode::Adaptive, 200);
        assert!(teams.mission_steps.value < greedy.mission_steps.value);
        assert!(teams.energy_kwh.value < greedy.energy_kwh.value);
        assert!(teams.success_rate.value >= greedy.success_rate.value - 0.01);
    }
}

#[test]
fn adaptive_pilots_raise_throughput_and_cost_no_success() {
    let config = Config {
        hotspot_count: 9,
        ..Config::default()
    };
    let constant = fly(config, BaselineKind::Greedy, PilotMode::Max, 200);
    let adaptive = fly(config, BaselineKind::Greedy, PilotMode::Adaptive, 200);
    assert!(adaptive.throughput.low > constant.throughput.high);
    assert!(adaptive.success_rate.value >= constant.success_rate.low);
    assert!(adaptive.pilot_density.value < 0.3 && adaptive.pilot_density.value > 0.01);
}

#[test]
fn pilot_modes_ask_for_their_density() {
    let model = model(Config::default());
    let sim = Sim::new(&model);
    for (mode, density) in [
        (PilotMode::Min, 0.01),
        (PilotMode::Mid, 0.155),
        (PilotMode::Max, 0.30),
        (PilotMode::named("0.2").unwrap(), 0.2),
    ] {
        let u = mode.action(&model, &sim.state(), 0);
        let got = action::pilot_density(u, 0.01, 0.30);
        // Actions are single precision.
        assert!((got - density).abs() < 1e-7, "{mode}");
        assert!(
            (mode.sensing_density(&model) - density).abs() < 1e-12,
            "{mode}"
        );
    }
}

/// Returns the actions of the first step of many episodes, (u_dir, u_pilot) each.
fn first_actions(kind: BaselineKind, pilot: PilotMode) -> Vec<[f32; 2]> {
    let model = model(Config::default());
    let mut sim = Sim::new(&model);
    let mut policy = kind.build(&model, pilot).unwrap();
    let mut actions = vec![0.0; model.action_len()];
    let mut all = Vec::new();
    for seed in 0..1000 {
        sim.reset(seed);
        policy.reset(&model, seed);
        policy.act(&model, &sim.state(), &mut actions);
        all.extend(actions.chunks_exact(2).map(|action| [action[0], action[1]]));
    }
    all
}

/// Counts how often each motion was taken.
fn motions(actions: &[[f32; 2]]) -> [u32; 5] {
    let mut counts = [0; 5];
    for [direction, _] in actions {
        counts[action::motion(*direction, MotionMap::Udlrs) as usize] += 1;
    }
    counts
}

#[test]
fn a_random_walk_takes_every_motion_equally_often_and_repeats_with_its_seed() {
    let actions = first_actions(BaselineKind::Random, PilotMode::Max);
    assert_eq!(actions, first_actions(BaselineKind::Random, PilotMode::Max));
    // 10 000 draws: 2 000 each, five standard deviations of 40.
    let counts = motions(&actions);
    assert!(
        counts.iter().all(|count| count.abs_diff(2000) < 200),
        "{counts:?}"
    );
}

/// The normal distribution gives 0.2743 for the outer bins of u_dir and 0.1464, 0.1585, 0.1464 for
/// the others.
#[test]
fn an_untrained_policy_draws_clipped_normals() {
    let actions = first_actions(BaselineKind::Untrained, PilotMode::Adaptive);
    let counts = motions(&actions);
    for (count, expected) in counts.into_iter().zip([2743, 1464, 1585, 1464, 2743]) {
        assert!(count.abs_diff(expected) < 223, "{counts:?}");
    }
    // The density is clipped as often: 0.1587 at either end.
    for end in [-1.0, 1.0] {
        let clipped = actions.iter().filter(|[_, pilot]| *pilot == end).count();
        assert!(clipped.abs_diff(1587) < 185, "{clipped}");
    }
    let fixed = first_actions(BaselineKind::Untrained, PilotMode::Max);
    assert!(fixed.iter().all(|[_, pilot]| *pilot == 1.0));
}

/// Fleets that have confirmed all hotspots, and do not know it alike, walk as one that is blind and
/// low on charge does.
#[test]
fn a_random_walk_depends_on_no_state() {
    let walk = |seed: u64, config: Config| {
        let model = model(Config {
            quorum: 1,
            hotspot_count: 1,
            // No link reaches this throughput.
            link_throughput_min: 1000.0,
            ..config
        });
        let mut sim = Sim::new(&model);
        let mut policy = BaselineKind::Random.build(&model, PilotMode::Max).unwrap();
        let mut actions = vec![0.0; model.action_len()];
        let (mut all, mut all_confirmed) = (Vec::new(), 0);
        sim.reset(seed);
        policy.reset(&model, seed);
        while all.len() < 40 && !sim.state().terminated() {
            policy.act(&model, &sim.state(), &mut actions);
            all.push(actions.clone());
            all_confirmed += sim.state().confirmed_count();
            sim.step(&actions).unwrap();
        }
        (all, all_confirmed)
    };
    let mut steps = 0;
    for seed in 0..10 {
        let (seeing, all_confirmed) = walk(seed, Config::default());
        let (blind, none) = walk(
            seed,
            Config {
                radar_cross_section_dbsm: -100.0,
                initial_soc_min: 0.22,
                initial_soc_max: 0.22,
                ..Config::default()
            },
        );
        assert_eq!(none, 0);
        assert_eq!(seeing[..], blind[..seeing.len()]);
        steps += all_confirmed;
    }
    assert!(steps > 20, "{steps}");
}

#[test]
fn only_privileged_baselines_need_positions() {
    let model = model(Config {
        target_visibility: TargetVisibility::Hidden,
        ..Config::default()
    });
    for kind in BaselineKind::ALL {
        let built = kind.build(&model, PilotMode::Adaptive);
        match kind {
            BaselineKind::Random
            | BaselineKind::Untrained
            | BaselineKind::Line
            | BaselineKind::Answer => assert!(built.is_ok()),
            _ => assert_eq!(built.err(), Some(PolicyError::Hidden(kind))),
        }
    }
}

/// With hidden hotspots the unprivileged baselines act independently of the hotspots' cells until
/// the first confirmation.
#[test]
fn what_is_hidden_is_not_read() {
    let model = model(Config {
        target_visibility: TargetVisibility::Hidden,
        hotspot_count: 2,
        uav_count: 7,
        // Nothing is ever detected.
        radar_cross_section_dbsm: -100.0,
        ..Config::default()
    });
    let flight = |hotspots: [Cell; 2], kind: BaselineKind, pilot: PilotMode| {
        let mut sim = Sim::new(&model);
        sim.reset(3);
        sim.set_hotspots(&hotspots).unwrap();
        let mut policy = kind.build(&model, pilot).unwrap();
        policy.reset(&model, 3);
        let mut flown = Vec::new();
        for _ in 0..model.config().horizon_steps {
            let mut actions = vec![0.0; model.action_len()];
            policy.act(&model, &sim.state(), &mut actions);
            sim.step(&actions).unwrap();
            flown.push(actions);
        }
        assert_eq!(sim.state().confirmed_count(), 0);
        flown
    };
    let here = [Cell { x: 5, y: 6 }, Cell { x: 6, y: 5 }];
    let there = [Cell { x: 0, y: 11 }, Cell { x: 11, y: 0 }];
    for kind in [
        BaselineKind::Random,
        BaselineKind::Untrained,
        BaselineKind::Line,
        BaselineKind::Answer,
    ] {
        for pilot in PilotMode::ALL {
            assert_eq!(
                flight(here, kind, pilot),
                flight(there, kind, pilot),
                "{kind}, {pilot}"
            );
        }
    }
}

/// Places the UAVs, as a host simulator may.
fn place(sim: &mut Sim<'_>, cells: &[Cell]) {
    let stay = [Motion::Stay.to_action(MotionMap::Udlrs), 1.0].repeat(cells.len());
    sim.step_begin(&stay).unwrap();
    sim.set_positions(cells).unwrap();
    sim.step_sense().unwrap();
    sim.step_communicate().unwrap();
    sim.step_end().unwrap();
}

#[test]
fn gathering_brings_the_farthest_together_as_early_as_possible() {
    let model = model(Config {
        uav_count: 4,
        ..Config::default()
    });
    let corners = [(0, 0), (11, 0), (0, 11), (11, 11)].map(|(x, y)| Cell { x, y });
    let mut sim = Sim::new(&model);
    place(&mut sim, &corners);
    let diameter = |sim: &Sim<'_>| {
        let cells: Vec<Cell> = (0..4).map(|uav| sim.state().cell(uav)).collect();
        let pairs = cells
            .iter()
            .flat_map(|a| cells.iter().map(|b| a.manhattan(*b)));
        pairs.max().unwrap()
    };
    let mut motions = [Motion::Stay; 4];
    let mut steps = 0;
    while diameter(&sim) > 0 {
        gather(&model, &sim.state(), &mut motions);
        let actions: Vec<f32> = motions
            .iter()
            .flat_map(|m| [m.to_action(MotionMap::Udlrs), 1.0])
            .collect();
        sim.step(&actions).unwrap();
        steps += 1;
    }
    // Opposite corners are 22 moves apart; each UAV flies half of them, or one more where the
    // halves differ.
    assert!((11..=12).contains(&steps), "{steps}");
}

#[test]
fn a_uav_leaves_its_depot_only_with_charge_for_a_flight() {
    let model = model(Config {
        initial_soc_min: 0.22,
        initial_soc_max: 0.22,
        ..Config::default()
    });
    let mut sim = Sim::new(&model);
    sim.reset(5);
    let mut policy = BaselineKind::Greedy.build(&model, PilotMode::Max).unwrap();
    policy.reset(&model, 5);
    let mut actions = vec![0.0; model.action_len()];
    // Above the threshold of 20 %, but not by a crossing of the grid: 22 moves of 0.8 Wh.
    assert!(stays_to_charge(&model, &sim.state(), 0));
    let mut waited = 0;
    while stays_to_charge(&model, &sim.state(), 0) {
        policy.act(&model, &sim.state(), &mut actions);
        assert_eq!(action::motion(actions[0], MotionMap::Udlrs), Motion::Stay);
        sim.step(&actions).unwrap();
        waited += 1;
    }
    assert!(waited > 10, "{waited}");
    let enough_uj = ((0.04 + 22.0 * 8e-4) * 3.6e12) as u64;
    assert!(sim.state().battery_uj(0) >= enough_uj);
}

#[test]
fn detection_probability_of_a_team_matches_the_model() {
    let model = model(Config::default());
    let detection = model.detection_probability(0, 0, 0.30);
    assert!((0.15..0.17).contains(&detection), "{detection}");
    let ten = quorum_probability(10, 3, detection);
    assert!((0.18..0.22).contains(&ten), "{ten}");
}

/// Policies that choose a motion by its name take the centre of its bin. So the order of the bins
/// changes no cell of their episodes.
#[test]
fn the_order_of_motions_changes_nothing_for_a_policy_that_names_them() {
    let flown = |map: MotionMap, mode: Option<Mode>| {
        let model = model(Config {
            motion_map: map,
            ..Config::default()
        });
        let mut policy: Box<dyn Policy> = match mode {
            Some(mode) => {
                let options = ActOptions { mode, pilot: None };
                Box::new(
                    Trained::read("m", MISSION)
                        .unwrap()
                        .with_act_options(options),
                )
            }
            None => Box::new(BaselineKind::Teams.build(&model, PilotMode::Max).unwrap()),
        };
        let mut sim = Sim::new(&model);
        let mut actions = vec![0.0; model.action_len()];
        let mut rows = vec![0.0; model.uav_count() * model.observation_len()];
        let mut cells = Vec::new();
        sim.reset(11);
        policy.reset(&model, 11);
        for _ in 0..12 {
            sim.observe(&mut rows).unwrap();
            policy.see(&rows);
            policy.act(&model, &sim.state(), &mut actions);
            sim.step(&actions).unwrap();
            cells.extend((0..model.uav_count()).map(|uav| sim.state().cell(uav)));
        }
        cells
    };
    for mode in [None, Some(Mode::Deterministic), Some(Mode::Sampled)] {
        let udlrs = flown(MotionMap::Udlrs, mode);
        assert!(udlrs == flown(MotionMap::Symmetric, mode), "{mode:?}");
    }
}
