//! What a scope trains, and in which order.

use super::*;

#[test]
fn the_trainings_that_tell_most_come_first() {
    let trainings = Scope::full(2).trainings();
    assert_eq!(trainings.len(), 2 * 20 * 2);
    let first: Vec<_> = trainings
        .iter()
        .map(|training| (training.cell, training.constant.is_some()))
        .take(9)
        .collect();
    let expected = [
        ((10, 5), false),
        ((15, 5), false),
        ((5, 5), false),
        ((20, 5), false),
        ((10, 5), true),
        ((15, 5), true),
        ((5, 5), true),
        ((20, 5), true),
        ((10, 3), false),
    ];
    assert_eq!(first, expected);
    assert_eq!((trainings[0].seed, trainings[79].seed), (0, 1));
}

#[test]
fn a_range_is_the_mission_of_the_paper_with_another_range() {
    let scope = Scope::full(1);
    assert_eq!(
        scope.ranged(3.0, (10, 5)),
        scope.mission(Preset::Paper, (10, 5))
    );
    assert_eq!(scope.ranged(2.0, (10, 5)).sensing_range_m, Some(100.0));
}

#[test]
fn the_two_readings_differ_in_credit_alone() {
    let [team, own] = Scope::full(1).learners().try_into().unwrap();
    let mut expected = team.settings.clone();
    uav_credit(&mut expected);
    assert_eq!(own.settings, expected);
    assert_ne!(own.settings, team.settings);
}

#[test]
fn with_one_credit_that_is_trained_and_both_are_shown() {
    for (only, names) in [
        (None, vec!["ppo", "ppo-uav"]),
        (Some(Credit::Team), vec!["ppo"]),
        (Some(Credit::Uav), vec!["ppo-uav"]),
    ] {
        let scope = Scope {
            paper_credit: only,
            ..Scope::full(1)
        };
        let trained: Vec<_> = scope.trained().iter().map(|who| who.name).collect();
        assert_eq!(trained, names);
        assert_eq!(scope.learners().len(), 2);
    }
}

#[test]
fn a_training_that_is_cut_short_says_so() {
    let named = |scope: Scope| scope.learners()[0].as_trained();
    assert_eq!(named(Scope::full(1)), "the paper's PPO, credit of the team");
    assert_eq!(
        named(Scope::quick(1)),
        "the paper's PPO, credit of the team (7 of 62 iterations)"
    );
}
