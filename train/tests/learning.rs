//! PPO learns the toy task: from no better than chance to most of what the best policy earns.

use jcas_train::environment::VectorEnvironment;
use jcas_train::environment::beacon::Beacon;
use jcas_train::head::Head;
use jcas_train::settings::{Imitation, Preset, Settings};
use jcas_train::trainer::{Stage, Trainer};

fn settings(head: Head) -> Settings {
    Settings {
        head,
        actor_hidden: vec![32, 32],
        critic_hidden: vec![32, 32],
        environments: 32,
        workers: 4,
        batch_steps: 1024,
        total_steps: 40 * 1024,
        epochs: 6,
        minibatch_rows: 512,
        critic_minibatch_rows: 256,
        shard_rows: 256,
        learning_rate: 2e-3,
        critic_learning_rate: 2e-3,
        normalise_inputs: true,
        normalise_values: true,
        ..Settings::preset(Preset::Paper)
    }
}

fn workers(settings: &Settings) -> Vec<Box<dyn VectorEnvironment>> {
    let missions = settings.environments / settings.workers;
    (0..settings.workers)
        .map(|_| Box::new(Beacon::new(missions, 2)) as Box<dyn VectorEnvironment>)
        .collect()
}

fn mean_return(trainer: &mut Trainer, iterations: usize) -> f64 {
    let mut returns = Vec::new();
    for _ in 0..iterations {
        returns.extend(trainer.iterate().finished.iter().map(|e| e.return_sum));
    }
    returns.iter().sum::<f64>() / returns.len() as f64
}

/// A random walk earns below 1.5 of 16; walking straight there earns about 13.8.
fn learns(head: Head) {
    let settings = settings(head);
    let mut trainer = Trainer::new(settings.clone(), workers(&settings)).unwrap();
    let before = mean_return(&mut trainer, 1);
    mean_return(&mut trainer, 36);
    let after = mean_return(&mut trainer, 3);
    println!("{head:?}: {before} -> {after}");
    assert!(before < 4.0, "{before}");
    assert!(after > 11.0, "{after}");
}

#[test]
fn the_hybrid_head_learns() {
    learns(Head::Hybrid);
}

#[test]
fn the_gaussian_head_learns() {
    learns(Head::Gaussian);
}

#[test]
fn imitation_alone_comes_close_to_the_teacher() {
    let settings = Settings {
        imitation: Some(Imitation {
            teacher: "straight".into(),
            iterations: 12,
            epochs: 6,
            learning_rate: 3e-3,
            teacher_share: 0.5,
            noise: 0.1,
            sharpening: 1.0,
        }),
        ..settings(Head::Hybrid)
    };
    let mut trainer = Trainer::new(settings.clone(), workers(&settings)).unwrap();
    while trainer.stage() == Stage::Imitation {
        trainer.iterate();
    }
    let after = mean_return(&mut trainer, 1);
    assert!(after > 12.0, "{after}");
}

/// The same seed gives the same weights, bit for bit, on one core and on two.
#[test]
fn threads_do_not_change_the_policy() {
    let train = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let settings = settings(Head::Hybrid);
            let mut trainer = Trainer::new(settings.clone(), workers(&settings)).unwrap();
            (0..3).for_each(|_| drop(trainer.iterate()));
            trainer.actor.parameters
        })
    };
    assert_eq!(train(1), train(2));
}
