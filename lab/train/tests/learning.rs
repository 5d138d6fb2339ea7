//! PPO learns from random weights. The tasks are a toy with a known best return, and episodes of
//! the kernel in which a random walk fails.

mod support;

use burn_tensor::Device;
use jcas_core::{Config, MotionMap};
use jcas_policy::head::Head;
use jcas_train::environment::VectorEnvironment;
use jcas_train::environment::fleet::{Fleet, RewardShaping};
use jcas_train::environment::task::TrainingTask;
use jcas_train::network::values;
use jcas_train::settings::{Credit, Preset, Settings};
use jcas_train::trainer::Trainer;
use support::Beacon;

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
        learning_rate: 2e-3,
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
fn learns(settings: Settings) {
    let mut trainer = Trainer::new(settings.clone(), workers(&settings), "cpu").unwrap();
    let before = mean_return(&mut trainer, 1);
    mean_return(&mut trainer, 36);
    let after = mean_return(&mut trainer, 3);
    println!("{before} -> {after}");
    assert!(before < 4.0, "{before}");
    assert!(after > 11.0, "{after}");
}

#[test]
fn the_hybrid_head_learns() {
    learns(settings(Head::Hybrid));
}

#[test]
fn the_gaussian_head_learns() {
    learns(settings(Head::Gaussian));
}

/// What is drawn for a held density changes nothing, so there is nothing to learn from it.
#[test]
fn a_held_pilot_density_is_not_judged() {
    for (head, motion, pilot) in [
        (Head::Hybrid, vec![0, 1, 2, 3, 4], vec![5, 6]),
        (Head::Gaussian, vec![0, 2], vec![1, 3]),
    ] {
        let settings = Settings {
            constant_pilot: Some(0.1),
            ..settings(head)
        };
        let mut trainer = Trainer::new(settings.clone(), workers(&settings), "cpu").unwrap();
        let outputs = head.outputs();
        let last_layer = |trainer: &Trainer, columns: &[usize]| -> Vec<f32> {
            let parameters = &trainer.actor.parameters;
            let first = parameters.len() - (32 + 1) * outputs;
            let rows = parameters[first..].chunks_exact(outputs);
            rows.flat_map(|row| columns.iter().map(|&column| row[column]))
                .collect()
        };
        let of = |trainer: &Trainer| [&motion, &pilot].map(|columns| last_layer(trainer, columns));
        let before = of(&trainer);
        trainer.iterate();
        let after = of(&trainer);
        assert_ne!(before[0], after[0], "{head:?}");
        assert_eq!(before[1], after[1], "{head:?}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes without optimisation")]
fn each_head_learns_from_the_uavs_own_rewards() {
    for head in [Head::Hybrid, Head::Gaussian] {
        learns(Settings {
            credit: Credit::Uav,
            ..settings(head)
        });
    }
}

/// With eight UAVs, seven eighths of the team's reward are about the others. So after equal steps,
/// the fleet with each UAV's own reward earns clearly more.
#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes without optimisation")]
fn credit_for_each_uav_learns_faster_than_the_team_s() {
    let earned = |credit: Credit| {
        let settings = Settings {
            credit,
            ..settings(Head::Hybrid)
        };
        let workers = (0..settings.workers)
            .map(|_| Box::new(Beacon::new(8, 8)) as Box<dyn VectorEnvironment>)
            .collect();
        let mut trainer = Trainer::new(settings, workers, "cpu").unwrap();
        mean_return(&mut trainer, 8);
        mean_return(&mut trainer, 2)
    };
    let (team, uav) = (earned(Credit::Team), earned(Credit::Uav));
    assert!(uav > team + 1.5, "{uav} {team}");
}

/// Missions of the kernel, with the networks that the presets use: from random weights fleets come
/// to succeed where a random walk mostly fails. The MLP has to learn for each hotspot and neighbour
/// what the set network learns once for all.
#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes without optimisation")]
fn fleets_learn_missions_from_nothing() {
    use jcas_core::Config;
    use jcas_train::policy::files::Precision;
    use jcas_train::run::RunSpec;
    use jcas_train::settings::NetworkKind;

    let tuned = Settings::preset(Preset::Tuned);
    let mlp = Settings {
        network: NetworkKind::Mlp,
        ..tuned.clone()
    };
    for (settings, batches, reached) in [(tuned, 20, 0.9), (mlp, 200, 0.8)] {
        let network = settings.network;
        let plan = RunSpec {
            settings: Settings {
                environments: 40,
                batch_steps: 1280,
                ..settings
            },
            configs: vec![Config {
                uav_count: 6,
                hotspot_count: 4,
                horizon_steps: 40,
                detection_threshold_db: Some(-23.8),
                ..Config::preset(jcas_core::Preset::Paper)
            }],
            drawn_around: None,
            out: std::env::temp_dir(),
            name: "from nothing".into(),
            precision: Precision::Single,
            device: "cpu".into(),
        };
        let mut trainer = plan.trainer().unwrap();
        let mut success = |batches: usize| {
            let missions: Vec<_> = (0..batches)
                .flat_map(|_| trainer.iterate().finished)
                .collect();
            let succeeded = missions.iter().filter(|mission| mission.success);
            succeeded.count() as f64 / missions.len() as f64
        };
        // The first missions to end are those that succeed early, so the first batches count as
        // one.
        let before = success(3);
        success(batches);
        let after = success(3);
        println!("{network:?}: {before} -> {after}");
        assert!(before < 0.6, "{network:?}: {before}");
        assert!(after > reached, "{network:?}: {after}");
    }
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
            let mut trainer = Trainer::new(settings.clone(), workers(&settings), "cpu").unwrap();
            (0..3).for_each(|_| drop(trainer.iterate()));
            trainer.actor.parameters
        })
    };
    assert_eq!(train(1), train(2));
}

/// Three UAVs look for one hotspot, eight episodes a worker.
fn three_uavs(settings: &Settings) -> Fleet {
    let config = Config {
        uav_count: 3,
        hotspot_count: 1,
        ..Config::default()
    };
    let task = TrainingTask::new(&config, settings).unwrap();
    Fleet::new(task, 8, RewardShaping::new(settings, None).unwrap())
}

fn trainer_of_three_uavs(settings: &Settings) -> Trainer {
    let worker = |_| Box::new(three_uavs(settings)) as Box<dyn VectorEnvironment>;
    let workers = (0..settings.workers).map(worker).collect();
    Trainer::new(settings.clone(), workers, "cpu").unwrap()
}

/// Five motions at random cost ln 5 = 1.6 a row. The loss is that of a batch's last epoch.
#[test]
fn a_teacher_is_imitated() {
    let mut trainer = trainer_of_three_uavs(&Settings {
        credit: Credit::Teacher,
        constant_pilot: Some(0.3),
        total_steps: 10 * 1024,
        learning_rate: 5e-3,
        ..settings(Head::Hybrid)
    });
    let mut loss = || {
        let actor = trainer.iterate().actor;
        actor.loss / actor.rows
    };
    let first = loss();
    let last = (0..9).map(|_| loss()).last().unwrap();
    assert!(last < 0.2 && last < first / 2.0, "{first} {last}");
}

/// At the depot no hotspot is near, and the rule `adaptive` takes the least density. Fresh weights
/// take the middle of the range.
#[test]
fn a_teacher_s_densities_are_imitated() {
    let settings = Settings {
        credit: Credit::Teacher,
        total_steps: 2 * 1024,
        learning_rate: 5e-3,
        ..settings(Head::Hybrid)
    };
    let mut trainer = trainer_of_three_uavs(&settings);
    let mut fleet = three_uavs(&settings);
    fleet.reset(9);
    let shape = fleet.shape();
    let mut observations = vec![0.0; shape.rows() * shape.observation_len];
    let mut global = vec![0.0; shape.environments * shape.global_len];
    fleet.observe(&mut observations, &mut global);
    let place = |trainer: &Trainer| {
        let network = &trainer.actor.network;
        let weights = network.tensors(&trainer.actor.parameters, &Device::flex());
        let features = network.features(&observations, &shape);
        let outputs = values(network.forward(&weights, features, &shape));
        let rows = outputs.chunks_exact(Head::Hybrid.outputs());
        let pilots =
            rows.map(|row| (Head::Hybrid.deterministic(row, MotionMap::Udlrs)[1] + 1.0) / 2.0);
        pilots.sum::<f32>() / shape.rows() as f32
    };
    let before = place(&trainer);
    // Later on, a fleet that is taught hovers over its hotspot and is seldom at the depot.
    (0..2).for_each(|_| drop(trainer.iterate()));
    let after = place(&trainer);
    assert!(
        (before - 0.5).abs() < 0.1 && after < 0.2,
        "{before} {after}"
    );
}
