//! Runs a whole episode in the kernel and in the specification and compares after every step.

use crate::comparison::{self, Outcome};
use crate::sampling::{self, Dice, Pilot};
use crate::specification::{Specification, World};
use jcas_core::{Config, Model, Sim};

/// Runs an episode to its end and passes the world after each step to `note`.
///
/// Every state is compared. Observations are compared at the times that `observed_every` divides.
///
/// # Errors
/// Returns the first difference, with its step, the step's actions and the configuration.
pub fn fly(
    config: &Config,
    pilot: Pilot,
    dice: &mut Dice,
    observed_every: u32,
    mut note: impl FnMut(&Specification, &World),
) -> Outcome {
    let model = Model::new(*config).map_err(|error| format!("refused: {error}"))?;
    let spec = Specification::new(config);
    let seed = dice.bits();
    let mut world = spec.reset(seed);
    let mut sim = Sim::new(&model);
    sim.reset(seed);
    compare(&spec, &world, &sim)
        .and_then(|()| compare_observations(&spec, &world, &mut sim))
        .map_err(|why| format!("at reset: {why}\n{config:?}"))?;
    while !world.terminated && !world.truncated {
        let actions = sampling::actions(dice, pilot, &spec, &world);
        let flat: Vec<f32> = actions
            .iter()
            .flat_map(|&(dir, pilot)| [dir, pilot])
            .collect();
        spec.step(&mut world, &actions);
        let outcome = sim.step(&flat).map_err(|error| error.to_string())?;
        comparison::real("reward", world.rewards.sum(), outcome.reward)
            .and_then(|()| compare(&spec, &world, &sim))
            .and_then(|()| {
                if world.t.is_multiple_of(observed_every) {
                    compare_observations(&spec, &world, &mut sim)
                } else {
                    Ok(())
                }
            })
            .map_err(|why| format!("t = {}: {why}\n{actions:?}\n{config:?}", world.t))?;
        note(&spec, &world);
    }
    Ok(())
}

/// Compares the state, and checks its validity.
fn compare(spec: &Specification, world: &World, sim: &Sim<'_>) -> Outcome {
    comparison::states(spec, world, &sim.state())?;
    comparison::equal("is_valid", true, sim.state().is_valid(sim.model()))
}

/// Compares the observations and the global state.
fn compare_observations(spec: &Specification, world: &World, sim: &mut Sim<'_>) -> Outcome {
    let model = sim.model();
    let mut observations = vec![0.0; model.uav_count() * model.observation_len()];
    sim.observe(&mut observations)
        .map_err(|error| error.to_string())?;
    for (i, theirs) in observations.chunks(model.observation_len()).enumerate() {
        let what = format_args!("observation {i}");
        comparison::observations(what, &spec.observe(world, i), theirs)?;
    }
    let mut global = vec![0.0; model.global_len()];
    sim.observe_global(&mut global)
        .map_err(|error| error.to_string())?;
    comparison::observations("global state", &spec.observe_global(world), &global)
}
