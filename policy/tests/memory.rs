//! A memory that is saved and loaded with its state gives the same future, bit for bit.

use jcas_core::rng::{Purpose, below, bits64};
use jcas_core::{Config, Model, Preset, Sim};
use jcas_policy::memory::Step;
use jcas_policy::{Baseline, BaselineKind, MemoryError, MemoryReader, PilotMode, Policy};

/// Steps of each policy, over all its episodes.
const STEPS: usize = if cfg!(debug_assertions) { 600 } else { 20_000 };

fn saved(policy: &Baseline) -> Vec<u64> {
    let mut words = Vec::new();
    policy.save_memory(&mut |word| words.push(word));
    words
}

/// A source of draws.
struct Draws(u32);

impl Draws {
    fn below(&mut self, limit: usize) -> usize {
        self.0 += 1;
        below(bits64(1, self.0, 0, 0, Purpose::Policy), limit as u64) as usize
    }
}

fn model(preset: Preset) -> Model<'static> {
    Model::new(Config {
        uav_count: 10,
        hotspot_count: 5,
        // Batteries that run low make UAVs stop and start flying.
        battery_capacity_kwh: 0.04,
        rtb_threshold_kwh: 0.008,
        ..Config::preset(preset)
    })
    .unwrap()
}

/// The baselines that fly a model.
fn kinds(model: &Model<'_>) -> impl Iterator<Item = BaselineKind> {
    let all = BaselineKind::ALL.into_iter();
    all.filter(|kind| kind.build(model, PilotMode::Adaptive).is_ok())
}

/// Flies episodes without a pause, and the same ones with many saves, loads, forks and repeats.
fn flies_alike(model: &Model<'_>, kind: BaselineKind) {
    let build = || kind.build(model, PilotMode::Adaptive).unwrap();
    let (mut draws, mut steps, mut loads) = (Draws(0), 0, 0);
    // Two policies take turns, so that each loads over what it remembers of another state.
    let (mut steady, mut policy, mut other) = (build(), build(), build());
    let mut actions = vec![0.0; model.action_len()];
    for seed in 0.. {
        let (mut whole, mut sim) = (Sim::new(model), Sim::new(model));
        policy.reset(model, seed);
        whole.reset(seed);
        sim.reset(seed);
        let mut hashes = vec![whole.state_hash()];
        while !whole.state().terminated() && !whole.state().truncated() {
            steady.act(model, &whole.state(), &mut actions);
            whole.step(&actions).unwrap();
            hashes.push(whole.state_hash());
        }
        let mut pasts: Vec<(Sim<'_>, Vec<u64>)> = Vec::new();
        // Every load goes back, so that an episode takes several times its own steps.
        for _ in 0..3 * hashes.len() {
            steps += 1;
            match draws.below(6) {
                0 => pasts.push((sim.clone(), saved(&policy))),
                1 if !pasts.is_empty() => {
                    let (past, memory) = &pasts[draws.below(pasts.len())];
                    sim = past.clone();
                    if draws.below(2) == 0 {
                        std::mem::swap(&mut policy, &mut other);
                    }
                    let mut read = MemoryReader::new(memory);
                    policy.load_memory(model, &mut read).unwrap();
                    assert_eq!(saved(&policy), *memory);
                    loads += 1;
                }
                2 => policy.act(model, &sim.state(), &mut actions),
                _ => {}
            }
            assert_eq!(sim.state_hash(), hashes[sim.state().t() as usize], "{kind}");
            if sim.state().terminated() || sim.state().truncated() {
                continue;
            }
            policy.act(model, &sim.state(), &mut actions);
            sim.step(&actions).unwrap();
        }
        if steps > STEPS {
            break;
        }
    }
    assert!(loads > STEPS / 20, "{kind}: {loads}");
}

#[test]
fn every_baseline_has_the_same_future_after_a_load() {
    for preset in [Preset::Mission, Preset::Paper, Preset::Search, Preset::Isac] {
        let model = model(preset);
        kinds(&model).for_each(|kind| flies_alike(&model, kind));
    }
}

#[test]
fn another_state_is_refused_and_changes_nothing() {
    let model = model(Preset::Mission);
    for kind in kinds(&model).filter(|kind| *kind != BaselineKind::Greedy) {
        let mut policy = kind.build(&model, PilotMode::Adaptive).unwrap();
        let mut actions = vec![0.0; model.action_len()];
        let mut sim = Sim::new(&model);
        sim.reset(5);
        let mut states = Vec::new();
        for _ in 0..4 {
            policy.act(&model, &sim.state(), &mut actions);
            sim.step(&actions).unwrap();
            states.push(sim.clone());
        }
        let memory = saved(&policy);
        if !policy.remembers() {
            assert_eq!(memory, []);
            continue;
        }
        // The state at t = 2, where the policy last acted at t = 3.
        let acted = Step { seed: 5, t: 3 };
        let given = Step { seed: 5, t: 2 };
        let refused = policy.try_plan(&model, &states[1].state());
        assert_eq!(refused, Err(MemoryError::OtherState { acted, given }));
        assert_eq!(saved(&policy), memory, "{kind}");
        policy.try_plan(&model, &sim.state()).unwrap();
        policy.reset(&model, 5);
        policy.try_plan(&model, &states[1].state()).unwrap();
    }
}

/// Words that were changed are refused, or are another memory that a policy can act with.
#[test]
fn no_words_make_a_policy_panic() {
    let mut draws = Draws(7);
    for preset in [Preset::Mission, Preset::Isac] {
        let model = model(preset);
        for kind in kinds(&model) {
            let mut policy = kind.build(&model, PilotMode::Adaptive).unwrap();
            let mut actions = vec![0.0; model.action_len()];
            let mut sim = Sim::new(&model);
            sim.reset(5);
            for _ in 0..6 {
                policy.act(&model, &sim.state(), &mut actions);
                sim.step(&actions).unwrap();
            }
            let memory = saved(&policy);
            for _ in 0..if memory.is_empty() { 0 } else { 400 } {
                let mut changed = memory.clone();
                for _ in 0..=draws.below(3) {
                    let at = draws.below(changed.len());
                    changed[at] = [0, 1, 2, 7, 1 << 32, u64::MAX][draws.below(6)];
                }
                changed.truncate(changed.len() - draws.below(2) * draws.below(changed.len()));
                let before = saved(&policy);
                let mut read = MemoryReader::new(&changed);
                if policy.load_memory(&model, &mut read).is_err() {
                    assert_eq!(saved(&policy), before, "{kind}");
                } else if policy.try_plan(&model, &sim.state()).is_ok() {
                    policy.write(&model, &sim.state(), &mut actions);
                }
            }
        }
    }
}
