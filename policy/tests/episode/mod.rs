//! Episodes of shipped policies, and the hash of all actions of each, which is the same on every
//! platform. The tests of this crate run them, and so do those of jcas-simd with each instruction
//! set. `tests/portable` runs them on other processors.

use jcas_core::hash::Fnv1a;
use jcas_core::{Config, Model, Preset, Sim};
use jcas_policy::head::Mode;
use jcas_policy::network::{ActOptions, MatmulKernel, Network};

const MISSION: &[u8] = include_bytes!("../../../policies/mission/policy.safetensors");
const PAPER: &[u8] = include_bytes!("../../../policies/paper/policy.safetensors");

/// An episode and its expected end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Episode {
    pub preset: Preset,
    pub uav_count: u32,
    pub hotspot_count: u32,
    pub seed: u64,
    pub mode: Mode,
    pub steps: u32,
    pub hash: u64,
}

const fn episode(sizes: (u32, u32), seed: u64, mode: Mode, steps: u32, hash: u64) -> Episode {
    Episode {
        preset: Preset::Mission,
        uav_count: sizes.0,
        hotspot_count: sizes.1,
        seed,
        mode,
        steps,
        hash,
    }
}

/// All episodes.
pub const EPISODES: [Episode; 4] = [
    episode((15, 7), 1, Mode::Deterministic, 55, 150_359_270_845_837_785),
    episode((15, 7), 1, Mode::Sampled, 53, 14_214_026_197_780_337_069),
    episode(
        (10, 3),
        2,
        Mode::Deterministic,
        21,
        13_099_932_164_702_744_476,
    ),
    Episode {
        preset: Preset::Paper,
        ..episode((10, 11), 1, Mode::Sampled, 9, 7_391_731_238_831_725_945)
    },
];

/// Runs the episode with this matrix product, and returns it with the end that it reached.
pub fn fly(episode: Episode, matmul: MatmulKernel) -> Episode {
    let model = Model::new(Config {
        uav_count: episode.uav_count,
        hotspot_count: episode.hotspot_count,
        ..Config::preset(episode.preset)
    })
    .expect("legal sizes");
    let file = match episode.preset {
        Preset::Paper => PAPER,
        _ => MISSION,
    };
    let layout = Network::read(file).expect("the shipped policy is whole");
    let mut weights = vec![0.0; layout.weights_len()];
    let network = Network::load(file, &mut weights).expect("the shipped policy is whole");
    let network = network.with_matmul(matmul);
    let options = ActOptions {
        mode: episode.mode,
        ..network.act_options(model.config())
    };
    let mut sim = Sim::new(&model);
    sim.reset(episode.seed);
    let mut observations = vec![0.0; model.uav_count() * model.observation_len()];
    let mut scratch = vec![0.0; network.scratch_len(&model)];
    let mut actions = vec![0.0; model.action_len()];
    let mut hash = Fnv1a::new();
    loop {
        sim.observe(&mut observations).expect("of the right length");
        let state = sim.state();
        network
            .act(
                &weights,
                options,
                &model,
                &state,
                &observations,
                &mut scratch,
                &mut actions,
            )
            .expect("the policy fits");
        for action in &actions {
            hash.write(&action.to_bits().to_le_bytes());
        }
        let outcome = sim.step(&actions).expect("finite actions");
        if outcome.terminated || outcome.truncated {
            return Episode {
                steps: sim.state().t(),
                hash: hash.finish(),
                ..episode
            };
        }
    }
}
