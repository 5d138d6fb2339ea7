//! The mission that both programs run, in memory on the stack.

use jcas_core::hash::{self, Fnv1a};
use jcas_core::{Config, Error, Model, Scratch, observation};

/// Size of the memory; the default mission needs less, and [`fly`] takes what the kernel asks for.
const ROOM_WORDS: usize = 4096;
const ROOM_REALS: usize = 4096;

/// Runs an episode of the default mission and returns the hash of every observation and state.
pub fn fly() -> Result<u64, Error> {
    let config = Config {
        // The batteries are small enough that UAVs return to base, charge and are grounded in the
        // mission.
        initial_soc_min: 0.2,
        initial_soc_max: 0.3,
        ..Config::default()
    };

    let mut tables = [0; ROOM_WORDS];
    let model = Model::new_in(config, &mut tables[..Model::table_words(&config)?])?;
    let mut words = [0; ROOM_WORDS];
    let words = &mut words[..model.state_words()];
    let mut room = [0; ROOM_WORDS];
    let mut scratch = Scratch::new(&model, &mut room).expect("ROOM_WORDS is enough");
    let mut observations = [0.0; ROOM_REALS];
    let observations = &mut observations[..model.uav_count() * model.observation_len()];
    let mut actions = [0.0; ROOM_REALS];
    let actions = &mut actions[..model.action_len()];

    let mut seen = Fnv1a::new();
    model.reset(words, &mut scratch, 7)?;
    for t in 0.. {
        observation::observe(&model, &model.state(words)?, &mut scratch, observations)?;
        seen.write_u64(hash::reals(observations));
        seen.write_u64(hash::words(words));
        choose(t, actions);
        let outcome = model.step(&mut model.state_mut(words)?, &mut scratch, actions)?;
        if outcome.terminated || outcome.truncated {
            break;
        }
    }
    seen.write_u64(hash::words(words));
    Ok(seen.finish())
}

/// Each UAV flies a square of its own size, at its own pilot density.
fn choose(t: usize, actions: &mut [f32]) {
    const SQUARE: [f32; 4] = [-0.8, 0.4, -0.4, 0.0];
    for (uav, action) in actions.chunks_exact_mut(2).enumerate() {
        action[0] = SQUARE[(uav + t / (1 + uav)) % SQUARE.len()];
        action[1] = 1.0 - 0.2 * (uav % 10) as f32;
    }
}
