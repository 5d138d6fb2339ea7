//! A run that goes on: from where it was stopped or killed, or from what another has learnt.

use crate::{StopAfter, fleets, plan, settings};
use jcas_train::checkpoint;
use jcas_train::run::{CHECKPOINT, NoObserver, RunOutcome, RunSpec, Start};
use jcas_train::settings::{NetworkKind, Settings};

fn weights(plan: &RunSpec) -> Vec<u8> {
    std::fs::read(plan.out.join(jcas_episode::card::WEIGHTS)).unwrap()
}

/// Stopped twice, or killed between checkpoints, a run ends with the same
/// policy file, card and metrics (times apart) as one that was never stopped.
#[test]
fn a_resumed_run_ends_as_if_never_stopped() {
    for network in [NetworkKind::Mlp, NetworkKind::Set] {
        let whole = plan(&format!("whole-{network:?}"), settings(network));
        whole.train(&Start::Fresh, &mut NoObserver).unwrap();

        let parts = plan(&format!("parts-{network:?}"), settings(network));
        for stop in [1, 4] {
            let ending = parts.train(&Start::Resume, &mut StopAfter(stop)).unwrap();
            assert!(matches!(ending, RunOutcome::Stopped));
        }
        parts.train(&Start::Resume, &mut NoObserver).unwrap();
        assert_eq!(weights(&whole), weights(&parts));
        let lines = |plan: &RunSpec| -> Vec<String> {
            let text = std::fs::read_to_string(plan.out.join("metrics.csv")).unwrap();
            // The columns up to the wall time are the same in every run; the rest are times.
            let before = |head: &str| head.split(',').position(|name| name == "wall_s");
            let columns = before(text.lines().next().unwrap()).unwrap();
            text.lines()
                .map(|line| line.split(',').take(columns).collect::<Vec<_>>().join(","))
                .collect()
        };
        assert_eq!(lines(&whole), lines(&parts));
        assert_eq!(lines(&whole).len(), 8);

        let killed = plan(&format!("killed-{network:?}"), settings(network));
        killed.train(&Start::Fresh, &mut StopAfter(4)).unwrap();
        // What a kill after the checkpoint of iteration 4 may leave: half a file beside it.
        std::fs::write(killed.out.join("checkpoint.safetensors.part"), b"half").unwrap();
        killed.train(&Start::Resume, &mut NoObserver).unwrap();
        assert_eq!(weights(&whole), weights(&killed));
        for plan in [whole, parts, killed] {
            std::fs::remove_dir_all(plan.out).unwrap();
        }
    }
}

#[test]
fn a_run_is_not_overwritten_nor_continued_with_other_settings() {
    let first = plan("held", settings(NetworkKind::Mlp));
    first.train(&Start::Fresh, &mut StopAfter(1)).unwrap();
    let again = first
        .train(&Start::Fresh, &mut NoObserver)
        .err()
        .unwrap()
        .to_string();
    assert!(again.contains("--resume"), "{again}");
    let mut other = first.clone();
    other.settings.discount = 0.9;
    let refused = other
        .train(&Start::Resume, &mut NoObserver)
        .err()
        .unwrap()
        .to_string();
    assert!(refused.contains("other settings"), "{refused}");
    std::fs::remove_dir_all(first.out).unwrap();
}

/// A run of no steps that starts from another run ends with that run's weights, under any settings.
#[test]
fn a_run_begins_with_what_another_has_learnt() {
    let first = plan("taught", settings(NetworkKind::Set));
    let RunOutcome::Finished(taught) = first.train(&Start::Fresh, &mut NoObserver).unwrap() else {
        panic!("nobody stopped it");
    };
    let other = Settings {
        seed: 5,
        total_steps: 0,
        batch_steps: 512,
        workers: 2,
        discount: 0.9,
        ..settings(NetworkKind::Set)
    };
    let second = plan("begun", other.clone());
    let origin = Start::Run(first.out.clone());
    let RunOutcome::Finished(card) = second.train(&origin, &mut NoObserver).unwrap() else {
        panic!("nobody stopped it");
    };
    assert_eq!(weights(&first), weights(&second));
    // Killed before its first batch, it still goes on from there.
    second.train(&Start::Resume, &mut NoObserver).unwrap();
    assert_eq!(weights(&first), weights(&second));
    assert_eq!(card.environment_steps, taught.environment_steps);
    assert_eq!(card.environment_steps, Some(7 * 256));
    // It is as new as any other: it trains all of its own steps.
    let third = plan(
        "trained-on",
        Settings {
            total_steps: 512,
            ..other.clone()
        },
    );
    let RunOutcome::Finished(card) = third.train(&origin, &mut NoObserver).unwrap() else {
        panic!("nobody stopped it");
    };
    assert_ne!(weights(&first), weights(&third));
    assert_eq!(card.environment_steps, Some(7 * 256 + 512));
    // With networks over sets, also on fleets of another size.
    let mut fourth = plan("another-fleet", other.clone());
    fourth.configs = vec![fleets()[1]];
    fourth.train(&origin, &mut NoObserver).unwrap();
    assert_eq!(weights(&first), weights(&fourth));

    let larger = plan(
        "larger",
        Settings {
            actor_hidden: vec![32, 16],
            ..other
        },
    );
    for (origin, named) in [
        (origin, "actor.parameters"),
        (
            Start::Run(larger.out.join("nothing")),
            "checkpoint.safetensors",
        ),
    ] {
        let refused = larger.train(&origin, &mut NoObserver).err().unwrap();
        assert!(refused.to_string().contains(named), "{refused}");
        assert!(!larger.out.exists());
    }
    for plan in [first, second, third, fourth] {
        std::fs::remove_dir_all(plan.out).unwrap();
    }
}

/// A shipped policy has no critic. Its weights stay while a new critic learns, also across a stop.
#[test]
fn a_run_begins_with_a_policy_and_a_new_critic() {
    let policy = plan("policy-alone", settings(NetworkKind::Set));
    policy.train(&Start::Fresh, &mut NoObserver).unwrap();
    std::fs::remove_file(policy.out.join(CHECKPOINT)).unwrap();
    let origin = Start::Run(policy.out.clone());
    let after = |name: &str, batches: u64| {
        let settings = Settings {
            seed: 5,
            total_steps: batches * 256,
            ..settings(NetworkKind::Set)
        };
        plan(name, settings)
    };
    let held = after("critic-only", 10);
    let RunOutcome::Finished(card) = held.train(&origin, &mut NoObserver).unwrap() else {
        panic!("nobody stopped it");
    };
    assert_eq!(weights(&policy), weights(&held));
    assert_eq!(card.environment_steps, Some(17 * 256));
    let mut trainer = held.trainer().unwrap();
    let untrained = trainer.critic.parameters.clone();
    checkpoint::load_learnt(&mut trainer, &held.out.join(CHECKPOINT)).unwrap();
    assert_ne!(untrained, trainer.critic.parameters);

    let whole = after("followed", 12);
    whole.train(&origin, &mut NoObserver).unwrap();
    assert_ne!(weights(&policy), weights(&whole));
    let parts = after("followed-in-parts", 12);
    parts.train(&origin, &mut StopAfter(4)).unwrap();
    // Another run takes over what the critic still has to learn alone.
    let early = Start::Run(parts.out.clone());
    let (taken, longer) = (after("taken-over", 6), after("taken-over-longer", 7));
    taken.train(&early, &mut NoObserver).unwrap();
    longer.train(&early, &mut NoObserver).unwrap();
    assert_eq!(weights(&policy), weights(&taken));
    assert_ne!(weights(&policy), weights(&longer));
    parts.train(&Start::Resume, &mut NoObserver).unwrap();
    assert_eq!(weights(&whole), weights(&parts));

    let mut other = after("another-network", 12);
    other.settings.actor_hidden = vec![32, 16];
    let refused = other.train(&origin, &mut NoObserver).err().unwrap();
    assert!(refused.to_string().contains("its network is"), "{refused}");
    assert!(!other.out.exists());
    for plan in [policy, held, whole, parts, taken, longer] {
        std::fs::remove_dir_all(plan.out).unwrap();
    }
}
