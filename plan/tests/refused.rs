//! Models that plans do not cover are refused by the name of the field.

use std::ops::ControlFlow;

use jcas_core::config::Cell;
use jcas_core::{Config, LearnedDetections, Model, Preset, QuorumWindow, Sim, StartCells};
use jcas_plan::{PlannedKind, Settings, search};
use jcas_policy::Policy as _;

fn refusal(kind: PlannedKind, config: Config) -> String {
    let model = Model::new(config).unwrap();
    kind.build(&model).map(|_| ()).unwrap_err().to_string()
}

#[test]
fn a_quorum_over_the_episode_and_own_detections_are_refused() {
    for kind in PlannedKind::ALL {
        let config = Config {
            quorum_window: QuorumWindow::Episode,
            ..Config::default()
        };
        let message = refusal(kind, config);
        assert_eq!(message, "quorum_window = episode: a plan needs step");
        let config = Config {
            learned_detections: LearnedDetections::All,
            ..Config::default()
        };
        let message = refusal(kind, config);
        assert_eq!(message, "learned_detections = all: a plan needs confirmed");
    }
}

#[test]
fn only_a_plan_that_begins_in_a_state_covers_random_starts() {
    let config = Config {
        uav_count: 6,
        sensing_range_m: Some(150.0),
        start_cells: StartCells::Random,
        ..Config::default()
    };
    let message = refusal(PlannedKind::Plan, config);
    assert!(message.starts_with("start_cells = random: a plan needs depot"));
    let model = Model::new(config).unwrap();
    let mut replan = PlannedKind::Replan.build(&model).unwrap();
    let mut sim = Sim::new(&model);
    let starts: Vec<Cell> = (0..6).map(|uav| sim.state().cell(uav)).collect();
    assert!(starts.iter().any(|&cell| cell != starts[0]));
    let mut actions = vec![0.0; model.action_len()];
    let mut over = false;
    while !over {
        replan.act(&model, &sim.state(), &mut actions);
        let outcome = sim.step(&actions).unwrap();
        over = outcome.terminated || outcome.truncated;
    }
    assert!(sim.state().terminated());
}

#[test]
fn what_takes_unreasonably_long_is_refused_by_name() {
    let many = Config {
        hotspot_count: 600,
        grid_width: 40,
        grid_height: 40,
        ..Config::default()
    };
    let message = refusal(PlannedKind::Plan, many);
    assert_eq!(
        message,
        "hotspot_count = 600: a plan holds at most 512 hotspots"
    );
    let long = Config {
        horizon_steps: 1_000_000,
        grid_width: 100,
        grid_height: 100,
        ..Config::preset(Preset::Search)
    };
    let message = refusal(PlannedKind::Plan, long);
    assert!(message.starts_with("horizon_steps = 1000000: a plan over these cells"));
}

/// The caller is asked while the initial trajectories are evaluated, too.
#[test]
fn a_planning_ends_before_its_first_move() {
    let model = Model::new(Config {
        uav_count: 20,
        grid_width: 40,
        grid_height: 40,
        horizon_steps: 200,
        ..Config::preset(Preset::Search)
    })
    .unwrap();
    let mut asked = 0;
    let plan = search(&model, &Settings::default(), &mut |now| {
        asked += 1;
        assert_eq!(now.iterations, 0);
        ControlFlow::Break(())
    })
    .unwrap();
    assert_eq!((asked, plan.iterations, plan.stopped), (1, 0, true));
    assert!(plan.expected.steps <= plan.start_steps && plan.start_steps <= 200.0);
    assert!(plan.bound_steps <= plan.expected.steps);
}
