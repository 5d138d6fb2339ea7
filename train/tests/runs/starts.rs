//! The beginnings of stratified flight that a run chooses for its fleets.

use crate::{config, fleets, plan, settings};
use jcas_core::{Config, Model};
use jcas_evaluate::policy::network::{Flight, Network};
use jcas_evaluate::policy::strata::FleetStarts;
use jcas_train::policy::files;
use jcas_train::policy::{Actor, Mode};
use jcas_train::run::{Origin, Unwatched, evaluate};
use jcas_train::settings::{NetworkKind, Settings};
use jcas_train::starts::{self, START_SEED};
use std::sync::Arc;

/// Each fleet begins in its own way, which the file tells every host.
#[test]
fn a_beginning_is_chosen_for_each_fleet() {
    // Within reach of a walk that has hardly learnt, so that it matters how it begins.
    let within_reach = |config: &Config| Config {
        sensing_range_m: Some(250.0),
        quorum: 2,
        horizon_steps: 100,
        ..*config
    };
    let configs: Vec<Config> = fleets().iter().map(within_reach).collect();
    let chosen = |evaluation_starts| {
        let mut plan = plan(
            &format!("starts-{evaluation_starts}"),
            Settings {
                evaluation_starts,
                curriculum: None,
                ..settings(NetworkKind::Set)
            },
        );
        plan.configs.clone_from(&configs);
        plan.train(&Origin::Nothing, &mut Unwatched).unwrap();
        let stored = files::load(&plan.out).unwrap();
        let bytes = std::fs::read(plan.out.join(files::WEIGHTS)).unwrap();
        std::fs::remove_dir_all(&plan.out).unwrap();
        let note = Network::read(&bytes).unwrap().note();
        assert_eq!(note.starts, stored.actor.starts);
        let of_card = stored.card.starts.iter().map(|(&uavs, &of)| (uavs, of));
        assert_eq!(FleetStarts::new(of_card), Some(note.starts));
        stored
    };
    assert!(chosen(1).card.starts.is_empty());
    let stored = chosen(5);
    assert_eq!(stored.card.starts.keys().collect::<Vec<_>>(), [&4, &7]);
    for config in configs {
        let model = Model::new(config).map(Arc::new).unwrap();
        choices_are_the_best(&stored.actor, &model);
    }
}

fn choices_are_the_best(actor: &Actor, model: &Arc<Model<'static>>) {
    let uavs = model.config().uav_count;
    let score = |starts| {
        let policy = actor.fly("p", Mode::Stratified).with_flight(Flight {
            starts: FleetStarts::new([(uavs, starts)]).unwrap(),
            ..actor.flight(Mode::Stratified)
        });
        let flown = evaluate(model, &policy, Mode::Stratified, 2, START_SEED).unwrap();
        100.0 * flown.success_rate - flown.mission_steps_mean
    };
    let choose = |count, stop: &mut dyn FnMut(u64) -> bool| {
        starts::best(actor, std::slice::from_ref(model), count, 16, stop).unwrap()
    };

    // Of four, which one round tries on two missions: the best in the first phase, held, and then in the last.
    let best = choose(4, &mut |_| false).unwrap();
    let held: Vec<f64> = (0..4).map(|start| score([start; 5])).collect();
    assert!(held.iter().any(|score| *score != held[0]), "{held:?}");
    let first = (0..4).rev().max_by(|&a, &b| held[a].total_cmp(&held[b]));
    assert_eq!(Some(usize::from(best[0])), first);
    let in_the_last = |start| score([best[0], best[1], best[2], best[3], start]);
    assert!((0..4).all(|start| score(best) >= in_the_last(start)));

    let mut flown = 0;
    let mut count = |missions| {
        flown += missions;
        false
    };
    choose(17, &mut count).unwrap();
    assert_eq!(flown, starts::missions(17, 16));
    assert_eq!(choose(4, &mut |_| true), None);
}

// Of 17 starts 5 are left after two missions each, then 2 after eight, then 1 after 32.
#[test]
fn missions_that_choose() {
    assert_eq!(starts::missions(17, 16), 5 * (17 * 2 + 5 * 8 + 2 * 32));
    assert_eq!(starts::missions(1, 16), 0);
}

#[test]
fn starts_are_chosen_for_eight_fleets_at_most() {
    let sizes: Vec<Config> = (2..11)
        .map(|uav_count| Config {
            uav_count,
            ..config()
        })
        .collect();
    let mut plan = plan(
        "sizes",
        Settings {
            environments: 9,
            workers: 9,
            batch_steps: 9 * 8,
            evaluation_starts: 2,
            ..settings(NetworkKind::Set)
        },
    );
    plan.configs = sizes;
    let error = plan.trainer().err().unwrap().to_string();
    assert!(
        error.contains("evaluation_starts: 2 for 9 sizes of fleets"),
        "{error}"
    );
    plan.configs.pop();
    plan.trainer().unwrap();
}
