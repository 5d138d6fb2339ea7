//! Runs on the real kernel: interrupted and continued, written and read back, exported.

use burn_tensor::Device;
use jcas_core::{Config, Model};
use jcas_evaluate::policy::Policy;
use jcas_evaluate::policy::network::{Flight, Network};
use jcas_evaluate::policy::strata::FleetStarts;
use jcas_train::head::Head;
use jcas_train::metrics::Row;
use jcas_train::network::{Architecture, values};
use jcas_train::policy::files::{self, Precision};
use jcas_train::policy::{Actor, Mode, shape_of};
use jcas_train::run::{Ending, Observer, Origin, Plan, Unwatched, evaluate};
use jcas_train::settings::{Curriculum, NetworkKind, PilotCredit, Preset, Settings, SmallFleets};
use jcas_train::starts::{self, START_SEED};
use std::path::Path;
use std::sync::Arc;

fn settings(network: NetworkKind) -> Settings {
    Settings {
        network,
        head: Head::Hybrid,
        actor_hidden: vec![24, 16],
        critic_hidden: vec![24, 16],
        environments: 8,
        workers: 4,
        batch_steps: 256,
        total_steps: 7 * 256,
        epochs: 2,
        minibatch_rows: 128,
        critic_minibatch_rows: 64,
        shard_rows: 64,
        normalise_inputs: network == NetworkKind::Mlp,
        normalise_values: true,
        evaluate_every: 3,
        evaluation_episodes: 2,
        checkpoint_every: 2,
        finding_reward: 1.0,
        critic_survey: true,
        informing_reward: 1.0,
        meeting_reward: 1.0,
        pilot_credit: PilotCredit::Step,
        // The radar changes before the third and before the fourth batch.
        curriculum: Some(Curriculum {
            threshold_db: -10.0,
            batches: 3,
            stages: 2,
        }),
        ..Settings::preset(Preset::Paper)
    }
}

fn config() -> Config {
    Config {
        uav_count: 4,
        hotspot_count: 3,
        horizon_steps: 20,
        ..Config::default()
    }
}

fn plan(name: &str, settings: Settings) -> Plan {
    let out = std::env::temp_dir().join(format!("jcas-train-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&out);
    Plan {
        settings,
        configs: vec![config()],
        out,
        name: name.into(),
        precision: Precision::Single,
    }
}

/// Asks to stop after some iterations.
struct StopAfter(u64);

impl Observer for StopAfter {
    fn iteration(&mut self, _row: &Row, _total: u64, _left_s: f64) {
        self.0 -= 1;
    }

    fn stop(&mut self) -> bool {
        self.0 == 0
    }
}

/// Reads of the first iterations what would be said of a success in them.
struct Successes(Vec<String>);

impl Observer for Successes {
    fn iteration(&mut self, row: &Row, _total: u64, _left_s: f64) {
        let succeeded = Row {
            success_rate: Some(1.0),
            ..row.clone()
        };
        self.0.push(succeeded.success());
    }

    fn stop(&mut self) -> bool {
        self.0.len() == 2
    }
}

/// In missions of 40 steps nobody fails within the first batch of 32: who has ended there has succeeded.
#[test]
fn the_success_of_the_first_to_end_is_called_so() {
    let mut plan = plan("first", settings(NetworkKind::Set));
    plan.configs[0].horizon_steps = 40;
    let mut successes = Successes(Vec::new());
    plan.train(&Origin::Nothing, &mut successes).unwrap();
    assert_eq!(successes.0, ["1.00 of the first to end", "1.00"]);
    std::fs::remove_dir_all(plan.out).unwrap();
}

/// A fleet that is small learns as one whose settings are those of small fleets, and no other does.
#[test]
fn small_fleets_are_trained_by_what_they_are_paid() {
    let trained = |name: &str, settings: Settings| {
        let plan = plan(name, settings);
        plan.train(&Origin::Nothing, &mut StopAfter(3)).unwrap();
        let text = std::fs::read_to_string(plan.out.join("metrics.csv")).unwrap();
        std::fs::remove_dir_all(&plan.out).unwrap();
        // Up to the wall time.
        let of_line = |line: &str| line.split(',').take(18).collect::<Vec<_>>().join(",");
        text.lines().map(of_line).collect::<Vec<_>>()
    };
    let small = |uavs_max| Settings {
        small_fleets: Some(SmallFleets {
            uavs_max,
            step_cost: 2.0,
            finding_reward: 7.0,
            discount: 0.9,
        }),
        ..settings(NetworkKind::Set)
    };
    let all = trained("none-small", small(3));
    let few = trained("small", small(4));
    let as_few = Settings {
        step_cost: 2.0,
        finding_reward: 7.0,
        discount: 0.9,
        ..settings(NetworkKind::Set)
    };
    assert_eq!(few, trained("as-small", as_few));
    assert_eq!(all, trained("as-large", settings(NetworkKind::Set)));
    assert_ne!(few, all);
}

fn weights(plan: &Plan) -> Vec<u8> {
    std::fs::read(plan.out.join(files::WEIGHTS)).unwrap()
}

/// Stopped twice, or killed between checkpoints, a run ends with the same
/// policy file, card and metrics (times apart) as one that was never stopped.
#[test]
fn a_resumed_run_ends_as_if_never_stopped() {
    for network in [NetworkKind::Mlp, NetworkKind::Set] {
        let whole = plan(&format!("whole-{network:?}"), settings(network));
        whole.train(&Origin::Nothing, &mut Unwatched).unwrap();

        let parts = plan(&format!("parts-{network:?}"), settings(network));
        for stop in [1, 4] {
            let ending = parts.train(&Origin::Resume, &mut StopAfter(stop)).unwrap();
            assert!(matches!(ending, Ending::Stopped));
        }
        parts.train(&Origin::Resume, &mut Unwatched).unwrap();
        assert_eq!(weights(&whole), weights(&parts));
        let lines = |plan: &Plan| -> Vec<String> {
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
        killed.train(&Origin::Nothing, &mut StopAfter(4)).unwrap();
        // What a kill after the checkpoint of iteration 4 may leave: half a file beside it.
        std::fs::write(killed.out.join("checkpoint.safetensors.part"), b"half").unwrap();
        killed.train(&Origin::Resume, &mut Unwatched).unwrap();
        assert_eq!(weights(&whole), weights(&killed));
        for plan in [whole, parts, killed] {
            std::fs::remove_dir_all(plan.out).unwrap();
        }
    }
}

#[test]
fn a_run_is_not_overwritten_nor_continued_with_other_settings() {
    let first = plan("held", settings(NetworkKind::Mlp));
    first.train(&Origin::Nothing, &mut StopAfter(1)).unwrap();
    let again = first
        .train(&Origin::Nothing, &mut Unwatched)
        .err()
        .unwrap()
        .to_string();
    assert!(again.contains("--resume"), "{again}");
    let mut other = first.clone();
    other.settings.discount = 0.9;
    let refused = other
        .train(&Origin::Resume, &mut Unwatched)
        .err()
        .unwrap()
        .to_string();
    assert!(refused.contains("other settings"), "{refused}");
    std::fs::remove_dir_all(first.out).unwrap();
}

/// Begun with what another run has learnt, a run of no steps ends with its weights, whatever it would have trained with.
#[test]
fn a_run_begins_with_what_another_has_learnt() {
    let first = plan("taught", settings(NetworkKind::Set));
    let Ending::Finished(taught) = first.train(&Origin::Nothing, &mut Unwatched).unwrap() else {
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
    let origin = Origin::Run(first.out.clone());
    let Ending::Finished(card) = second.train(&origin, &mut Unwatched).unwrap() else {
        panic!("nobody stopped it");
    };
    assert_eq!(weights(&first), weights(&second));
    // Killed before its first batch, it still goes on from there.
    second.train(&Origin::Resume, &mut Unwatched).unwrap();
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
    let Ending::Finished(card) = third.train(&origin, &mut Unwatched).unwrap() else {
        panic!("nobody stopped it");
    };
    assert_ne!(weights(&first), weights(&third));
    assert_eq!(card.environment_steps, Some(7 * 256 + 512));

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
            Origin::Run(larger.out.join("nothing")),
            "checkpoint.safetensors",
        ),
    ] {
        let refused = larger.train(&origin, &mut Unwatched).err().unwrap();
        assert!(refused.to_string().contains(named), "{refused}");
        assert!(!larger.out.exists());
    }
    for plan in [first, second, third] {
        std::fs::remove_dir_all(plan.out).unwrap();
    }
}

fn observations(model: &Model<'static>) -> Vec<f32> {
    let mut sim = jcas_core::Sim::new(model);
    sim.reset(3);
    let mut observations = vec![0.0; model.uav_count() * model.observation_len()];
    for step in 0..6 {
        let actions: Vec<f32> = (0..model.action_len())
            .map(|k| ((k * 7 + step * 3) % 11) as f32 / 5.5 - 1.0)
            .collect();
        sim.step(&actions).unwrap();
    }
    sim.observe(&mut observations).unwrap();
    observations
}

/// A policy read back acts as the trained one; in half precision nearly so.
#[test]
fn policies_read_back_as_written() {
    let plan = plan("store", settings(NetworkKind::Mlp));
    plan.train(&Origin::Nothing, &mut Unwatched).unwrap();
    let model = Model::new(config()).unwrap();
    let stored = files::load(&plan.out).unwrap();
    stored.check(&model).unwrap();
    let mut trainer = plan.trainer().unwrap();
    while !trainer.finished() {
        trainer.iterate();
    }
    let trained = Arc::new(plan.actor(&trainer));
    assert_eq!(*stored.actor, *trained);

    let shape = shape_of(&model);
    files::save(&plan.out, &trained, &stored.card, &shape, Precision::Half).unwrap();
    let half = files::load(&plan.out).unwrap();
    let outputs = |actor: Arc<Actor>| {
        actor
            .fly("p", Mode::Deterministic)
            .outputs(&model, &observations(&model))
            .unwrap()
    };
    for (a, b) in outputs(trained).iter().zip(outputs(half.actor)) {
        assert!((a - b).abs() < 0.02, "{a} {b}");
    }
    std::fs::remove_dir_all(&plan.out).unwrap();
}

/// Flights use the inference that every host uses, learning uses tensors: the same function.
fn same_outputs(actor: &Arc<Actor>, model: &Model<'static>) {
    let weights = actor.network.tensors(&actor.parameters, &Device::flex());
    let mut inputs = observations(model);
    let mut policy = actor.fly("p", Mode::Deterministic);
    let flown = policy.outputs(model, &inputs).unwrap();
    actor.inputs.apply(&mut inputs);
    let learnt = values(actor.network.forward(&weights, inputs, &shape_of(model)));
    assert_eq!(flown.len(), learnt.len());
    for (flown, learnt) in flown.iter().zip(learnt) {
        let error = (flown - learnt).abs() / learnt.abs().max(1.0);
        assert!(error < 1e-5, "{flown} {learnt}");
    }
}

#[test]
fn what_flies_is_what_was_trained() {
    let model = Model::new(config()).unwrap();
    for network in [NetworkKind::Mlp, NetworkKind::Set] {
        let plan = plan(&format!("flies-{network:?}"), settings(network));
        plan.train(&Origin::Nothing, &mut Unwatched).unwrap();
        same_outputs(&files::load(&plan.out).unwrap().actor, &model);
        std::fs::remove_dir_all(&plan.out).unwrap();
    }
}

/// A mission of another size is refused with both sizes named.
#[test]
fn a_policy_that_does_not_fit_is_refused() {
    let plan = plan("fit", settings(NetworkKind::Mlp));
    plan.train(&Origin::Nothing, &mut Unwatched).unwrap();
    let stored = files::load(&plan.out).unwrap();
    let other = Model::new(Config {
        uav_count: 6,
        ..config()
    })
    .unwrap();
    let refusal = stored.check(&other).unwrap_err().to_string();
    for part in ["32", "38", "uav_count = 4", "uav_count = 6"] {
        assert!(refusal.contains(part), "{part} is missing in: {refusal}");
    }
    std::fs::remove_dir_all(&plan.out).unwrap();
}

/// A set network that reads tags flies alike whether the mission shows them or not; it reads no other maps
/// than those that it was trained with.
#[test]
fn the_set_network_numbers_the_uavs_where_the_mission_does_not() {
    let tagged = Config {
        uav_tag: jcas_core::UavTag::Index,
        ..config()
    };
    let mut plan = plan("tags", settings(NetworkKind::Set));
    plan.configs = vec![tagged];
    plan.train(&Origin::Nothing, &mut Unwatched).unwrap();
    let stored = files::load(&plan.out).unwrap();
    // At the start all UAVs see the same but for their tags.
    let outputs = |config: Config| {
        let model = Model::new(config).unwrap();
        stored.check(&model).unwrap();
        let mut sim = jcas_core::Sim::new(&model);
        sim.reset(5);
        let mut observations = vec![0.0; model.uav_count() * model.observation_len()];
        sim.observe(&mut observations).unwrap();
        let mut policy = stored.policy(None);
        policy.outputs(&model, &observations).unwrap()
    };
    let shown = outputs(tagged);
    assert_eq!(shown, outputs(config()));
    let rows: Vec<_> = shown.chunks_exact(shown.len() / 4).collect();
    assert!(rows.windows(2).all(|pair| pair[0] != pair[1]));

    let mapped = Config {
        map_directions: jcas_core::MapDirections::Shown,
        search_maps: jcas_core::SearchMaps::Shared,
        ..tagged
    };
    let refusal = stored.check(&Model::new(mapped).unwrap()).unwrap_err();
    assert!(refusal.to_string().contains("map_directions"), "{refusal}");
    std::fs::remove_dir_all(&plan.out).unwrap();
}

/// The set network learns over search maps, and what flies is what it learned.
#[test]
fn the_set_network_reads_search_maps() {
    let searched = Config {
        uav_count: 4,
        hotspot_count: 3,
        horizon_steps: 20,
        ..Config::preset(jcas_core::Preset::Search)
    };
    let mut plan = plan("maps", settings(NetworkKind::Set));
    plan.configs = vec![searched];
    plan.train(&Origin::Nothing, &mut Unwatched).unwrap();
    let stored = files::load(&plan.out).unwrap();
    let model = Model::new(searched).unwrap();
    stored.check(&model).unwrap();
    same_outputs(&stored.actor, &model);
    std::fs::remove_dir_all(&plan.out).unwrap();
}

fn fleets() -> Vec<Config> {
    let larger = Config {
        uav_count: 7,
        ..config()
    };
    vec![config(), larger]
}

/// Trained for several fleets, the set network reads how many UAVs there are, in flight as in learning.
#[test]
fn the_set_network_reads_the_size_of_the_fleet() {
    let mut plan = plan("fleets", settings(NetworkKind::Set));
    plan.configs = fleets();
    // Trained on twice as often, listed and evaluated once.
    plan.configs.push(plan.configs[1]);
    plan.train(&Origin::Nothing, &mut Unwatched).unwrap();
    let stored = files::load(&plan.out).unwrap();
    assert_eq!(stored.card.trained_on, [(4, 3), (7, 3)]);
    assert_eq!(stored.card.evaluations.len(), 2 * 3);
    let reads = |actor: &Actor| match actor.network.architecture {
        Architecture::SetActor { fleet_size, .. } => fleet_size,
        _ => false,
    };
    assert!(reads(&stored.actor));
    for config in plan.configs {
        let model = Model::new(config).unwrap();
        stored.check(&model).unwrap();
        same_outputs(&stored.actor, &model);
    }
    std::fs::remove_dir_all(&plan.out).unwrap();
}

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

/// Sampled actions follow from the mission's seed alone.
#[test]
fn sampled_flights_repeat() {
    let plan = plan("sampled", settings(NetworkKind::Set));
    plan.train(&Origin::Nothing, &mut Unwatched).unwrap();
    let stored = files::load(&plan.out).unwrap();
    let model = Model::new(Config {
        uav_count: 7,
        hotspot_count: 2,
        ..config()
    })
    .unwrap();
    stored.check(&model).unwrap();
    let fly = |seed: u64| {
        let mut policy = stored.policy(Some(Mode::Sampled));
        let mut sim = jcas_core::Sim::new(&model);
        jcas_evaluate::mission::fly_episode(&model, &mut sim, &mut policy, seed).unwrap();
        assert_eq!(policy.name(), "sampled");
        sim.state_hash()
    };
    assert_eq!(fly(5), fly(5));
    assert_ne!(fly(5), fly(6));
    std::fs::remove_dir_all(&plan.out).unwrap();
}

/// onnxruntime gives the same outputs and actions to 1e-5, for both networks and both heads.
/// Needs a Python with `onnxruntime`: where `JCAS_ONNX_PYTHON` names one, as `.ci/python.sh` does, it must
/// have it; without that, `python3` serves if it happens to.
#[test]
fn onnxruntime_gives_the_same_actions() {
    let named = std::env::var("JCAS_ONNX_PYTHON").ok();
    let python = named.clone().unwrap_or_else(|| "python3".into());
    let has = std::process::Command::new(&python)
        .args(["-c", "import onnxruntime"])
        .output();
    if !has.is_ok_and(|output| output.status.success()) {
        assert!(named.is_none(), "{python} has no onnxruntime");
        eprintln!("{python} has no onnxruntime: not compared");
        return;
    }
    for (network, head, configs) in [
        (NetworkKind::Mlp, Head::Gaussian, vec![config()]),
        (NetworkKind::Mlp, Head::Hybrid, vec![config()]),
        (NetworkKind::Set, Head::Hybrid, vec![config()]),
        (NetworkKind::Set, Head::Gaussian, fleets()),
    ] {
        let mut plan = plan(
            &format!("onnx-{network:?}-{head:?}"),
            Settings {
                head,
                ..settings(network)
            },
        );
        plan.configs = configs;
        plan.train(&Origin::Nothing, &mut Unwatched).unwrap();
        let model = Model::new(config()).unwrap();
        let stored = files::load(&plan.out).unwrap();
        let observations = observations(&model);
        let mut policy = stored.actor.fly("p", Mode::Deterministic);
        let outputs = policy.outputs(&model, &observations).unwrap();
        let actions: Vec<f32> = outputs
            .chunks_exact(head.output_len())
            .flat_map(|row| head.action(head.deterministic(row)))
            .collect();
        compare(
            &python,
            &plan.out,
            &observations,
            [&outputs, &actions],
            model.uav_count(),
        );
        std::fs::remove_dir_all(&plan.out).unwrap();
    }
}

fn compare(python: &str, folder: &Path, input: &[f32], expected: [&[f32]; 2], rows: usize) {
    let script = "
import json, sys, numpy, onnxruntime
given = json.load(sys.stdin)
x = numpy.array(given['input'], dtype=numpy.float32).reshape(given['rows'], -1)
session = onnxruntime.InferenceSession(sys.argv[1])
for name, want in zip(('distribution', 'actions'), given['expected']):
    got = session.run([name], {'observations': x})[0].ravel()
    gap = float(numpy.abs(got - numpy.array(want, dtype=numpy.float32)).max())
    assert gap < 1e-5, (name, gap)
";
    use std::io::Write;
    let mut child = std::process::Command::new(python)
        .args(["-c", script])
        .arg(folder.join(files::ONNX))
        .stdin(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let given = serde_json::json!({ "input": input, "rows": rows, "expected": expected });
    child
        .stdin
        .take()
        .unwrap()
        .write_all(given.to_string().as_bytes())
        .unwrap();
    assert!(child.wait().unwrap().success());
}
