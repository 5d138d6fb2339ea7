//! Models that plans do not cover are refused by the name of the field.

use jcas_core::config::Cell;
use jcas_core::{Config, LearnedDetections, Model, QuorumWindow, Sim, StartCells};
use jcas_plan::PlannedKind;
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
