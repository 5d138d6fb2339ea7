//! An episode of the unit: the kernel and the source of its actions.

use std::fmt::Display;

use jcas_core::{Cell, Model, Motion, MotionMap, Scratch, StateRef, hash, observation};
use jcas_plan::{PlanFile, Planned, PlannedKind};
use jcas_policy::{BaselineKind, MemoryReader, PilotMode, Policy, PolicyError, Trained};
use jcas_simd::InstructionSet;

use crate::error::Error;
use crate::setup::Setup;

/// The inputs of a step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inputs {
    /// The actions (u_dir, u_pilot) of each UAV, each from −1 to 1.
    pub actions: Vec<f32>,
    /// The cell (x, y) of each UAV.
    pub positions: Vec<u32>,
    /// The radio graph, \[N\]\[N\], row by row.
    pub links: Vec<bool>,
}

impl Inputs {
    /// Every UAV stays in cell (0, 0) at the lowest pilot density, without a link.
    #[must_use]
    pub fn of(uavs: usize, map: MotionMap) -> Self {
        Self {
            actions: [Motion::Stay.to_action(map), -1.0].repeat(uavs),
            positions: vec![0; 2 * uavs],
            links: vec![false; uavs * uavs],
        }
    }
}

/// An episode of a setup.
pub struct Episode {
    setup: Setup,
    model: Model<'static>,
    words: Vec<u64>,
    scratch: Vec<u64>,
    policy: Option<Box<dyn Policy>>,
    observations: Vec<f32>,
    actions: Vec<f32>,
    /// The sum of rewards since the last communication point.
    pub reward: f64,
}

impl Episode {
    /// Builds the episode at t = 0.
    ///
    /// # Errors
    /// The text names the parameter, the value and what is allowed.
    pub fn new(setup: &Setup) -> Result<Self, Error> {
        let model = Model::new(setup.config()?)?;
        let policy = policy(setup, &model)?;
        let mut episode = Self {
            setup: setup.clone(),
            words: vec![0; model.state_words()],
            scratch: vec![0; Scratch::words_for(&model)],
            actions: vec![0.0; model.action_len()],
            observations: vec![0.0; model.uav_count() * model.observation_len()],
            policy,
            model,
            reward: 0.0,
        };
        episode.reset()?;
        Ok(episode)
    }

    fn reset(&mut self) -> Result<(), Error> {
        let mut scratch = Scratch::new(&self.model, &mut self.scratch)?;
        self.model
            .reset(&mut self.words, &mut scratch, self.setup.seed)?;
        if let Some(policy) = &mut self.policy {
            policy.reset(&self.model, self.setup.seed);
        }
        self.reward = 0.0;
        Ok(())
    }

    /// Returns the model.
    #[must_use]
    pub const fn model(&self) -> &Model<'static> {
        &self.model
    }

    /// Returns a view of the state.
    ///
    /// # Errors
    /// The call never fails for words that the model itself wrote.
    pub fn state(&self) -> Result<StateRef<'_>, Error> {
        Ok(self.model.state(&self.words)?)
    }

    /// Returns the fingerprint of the state.
    #[must_use]
    pub fn hash(&self) -> u64 {
        hash::words(&self.words)
    }

    /// Whether the episode has ended.
    ///
    /// # Errors
    /// The errors are those of [`Episode::state`].
    pub fn over(&self) -> Result<bool, Error> {
        let state = self.state()?;
        Ok(state.terminated() || state.truncated())
    }

    /// Performs one step of Δt.
    ///
    /// # Errors
    /// The call fails if the kernel refuses an input. The state then does not change.
    pub fn step(&mut self, inputs: &Inputs) -> Result<(), Error> {
        let Self {
            model,
            words,
            scratch,
            policy,
            observations,
            actions,
            ..
        } = self;
        match policy {
            Some(policy) => {
                let state = model.state(words)?;
                if policy.reads_observations() {
                    let mut scratch = Scratch::new(model, scratch)?;
                    observation::observe(model, &state, &mut scratch, observations)?;
                    policy.see(observations);
                }
                policy.act(model, &state, actions);
            }
            None => actions.copy_from_slice(&inputs.actions),
        }
        let before = self.words.clone();
        let stepped = self.step_by_parts(inputs);
        if stepped.is_err() {
            self.words = before;
        }
        Ok(stepped?)
    }

    fn step_by_parts(&mut self, inputs: &Inputs) -> Result<(), jcas_core::Error> {
        let Self {
            setup,
            model,
            words,
            scratch,
            actions,
            ..
        } = self;
        let mut state = model.state_mut(words)?;
        let mut scratch = Scratch::new(model, scratch)?;
        model.step_begin(&mut state, actions)?;
        if setup.own_positions {
            let cells: Vec<Cell> = inputs
                .positions
                .chunks_exact(2)
                .map(|pair| Cell {
                    x: pair[0],
                    y: pair[1],
                })
                .collect();
            model.set_positions(&mut state, &cells)?;
        }
        model.step_sense(&mut state, &mut scratch)?;
        if setup.own_links {
            let links: Vec<u8> = inputs.links.iter().map(|&link| u8::from(link)).collect();
            model.step_communicate_with(&mut state, &mut scratch, &links, None)?;
        } else {
            model.step_communicate(&mut state, &mut scratch)?;
        }
        self.reward += model.step_end(&mut state, &mut scratch)?.reward;
        Ok(())
    }

    /// Returns the kernel's snapshot of the state.
    ///
    /// # Errors
    /// The call never fails for words that the model itself wrote.
    pub fn save(&self) -> Result<Vec<u8>, Error> {
        let mut bytes = vec![0; self.model.save_len()];
        self.model.save(&self.words, &mut bytes)?;
        Ok(bytes)
    }

    /// Returns what the policy remembers.
    #[must_use]
    pub fn memory(&self) -> Vec<u64> {
        let mut words = Vec::new();
        if let Some(policy) = &self.policy {
            policy.save_memory(&mut |word| words.push(word));
        }
        words
    }

    /// Restores the episode of a setup at a saved state, with what its policy remembered there.
    ///
    /// # Errors
    /// The call fails if the snapshot or the memory is not of this setup.
    pub fn restore(setup: &Setup, snapshot: &[u8], memory: &[u64]) -> Result<Self, Error> {
        let mut episode = Self::new(setup)?;
        let mut spare = vec![0; episode.words.len()];
        episode
            .model
            .load(snapshot, &mut episode.words, &mut spare)?;
        if let Some(policy) = &mut episode.policy {
            policy
                .load_memory(&episode.model, &mut MemoryReader::new(memory))
                .map_err(Error::Memory)?;
        }
        Ok(episode)
    }
}

/// The most bytes of a resource.
const RESOURCE_BYTES_MAX: u64 = 1 << 30;

/// Reads a regular file among the unit's resources.
fn resource(path: &std::path::Path) -> std::io::Result<Vec<u8>> {
    let bytes = std::fs::metadata(path)?.len();
    if bytes > RESOURCE_BYTES_MAX {
        let message = format!("has {bytes} bytes: must have at most {RESOURCE_BYTES_MAX}");
        return Err(std::io::Error::new(
            std::io::ErrorKind::FileTooLarge,
            message,
        ));
    }
    std::fs::read(path)
}

/// The source of actions: the importer, a trained policy or a plan among the unit's resources, or a
/// baseline.
fn policy(setup: &Setup, model: &Model<'_>) -> Result<Option<Box<dyn Policy>>, Error> {
    if setup.policy.is_empty() {
        return Ok(None);
    }
    let refused = |reason: &dyn Display| Error::Policy {
        policy: setup.policy.clone(),
        reason: reason.to_string(),
    };
    if let Some(path) = setup.resource("safetensors") {
        let bytes = resource(&path).map_err(|error| refused(&error))?;
        let trained = Trained::read(&setup.policy, &bytes).map_err(|error| refused(&error))?;
        trained.check(model).map_err(|error| refused(&error))?;
        let trained = trained.with_matmul(InstructionSet::best().matmul());
        return Ok(Some(Box::new(trained)));
    }
    if let Some(path) = setup.resource("json") {
        let text = resource(&path).map_err(|error| refused(&error))?;
        let plan =
            PlanFile::parse(&String::from_utf8_lossy(&text)).and_then(|file| file.plan(model));
        let plan = plan.map_err(|error| refused(&error))?;
        return Ok(Some(Box::new(Planned::following(plan))));
    }
    if let Some(kind) = PlannedKind::named(&setup.policy) {
        let planned = kind.build(model).map_err(|error| refused(&error))?;
        return Ok(Some(Box::new(planned)));
    }
    let baseline = |error: PolicyError<'_>| Error::Baseline(error.to_string());
    let kind = BaselineKind::named(&setup.policy).map_err(baseline)?;
    let mode = PilotMode::named(&setup.pilot).map_err(|error| Error::Pilot(error.to_string()))?;
    let built = kind.build(model, mode).map_err(baseline)?;
    Ok(Some(Box::new(built)))
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use jcas_plan::{Settings, search};

    use super::*;

    fn setup(policy: &str, visibility: &str) -> Setup {
        let fields = [("uav_count", 5), ("hotspot_count", 2), ("grid_width", 8)];
        let mut setup = Setup {
            policy: policy.to_owned(),
            seed: 3,
            ..Setup::default()
        };
        for (name, value) in fields {
            setup.fields.insert(name.to_owned(), value.into());
        }
        (setup.fields).insert("target_visibility".to_owned(), visibility.into());
        setup
    }

    fn fly(episode: &mut Episode) -> u64 {
        while !episode.over().unwrap() {
            episode.step(&Inputs::default()).unwrap();
        }
        episode.hash()
    }

    /// A state that is saved and restored with its memory goes on alike.
    fn goes_on_alike(setup: &Setup) -> u64 {
        let mut episode = Episode::new(setup).unwrap();
        for _ in 0..4 {
            episode.step(&Inputs::default()).unwrap();
        }
        let mut restored =
            Episode::restore(setup, &episode.save().unwrap(), &episode.memory()).unwrap();
        let hash = fly(&mut episode);
        assert_eq!(fly(&mut restored), hash);
        hash
    }

    #[test]
    fn policies_fly_and_are_restored() {
        let flown = ["plan", "replan"].map(|name| goes_on_alike(&setup(name, "known")));
        assert_ne!(flown[0], flown[1]);
        goes_on_alike(&setup("squads", "known"));
        goes_on_alike(&setup("line", "hidden"));
    }

    #[test]
    fn a_plan_among_the_resources_flies() {
        let folder = std::env::temp_dir().join(format!("jcas-fmi-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let mut setup = setup("route", "hidden");
        setup.resources = Some(folder.clone());
        let model = Model::new(setup.config().unwrap()).unwrap();
        let settings = Settings {
            iterations: 2_000,
            seed: 1,
        };
        let plan = search(&model, &settings, &mut |_| ControlFlow::Continue(())).unwrap();
        let text = PlanFile::new(&model, &plan, None).to_json().unwrap();
        std::fs::write(folder.join("route.json"), text).unwrap();
        goes_on_alike(&setup);
        let mut episode = Episode::new(&setup).unwrap();
        let (mut flown, mut stepped) = (Planned::following(plan), vec![0.0; model.action_len()]);
        flown.act(&model, &episode.state().unwrap(), &mut stepped);
        episode.step(&Inputs::default()).unwrap();
        assert_eq!(episode.actions, stepped);
        setup.fields.insert("uav_count".to_owned(), 6.into());
        let refused = Episode::new(&setup).map(|_| ()).unwrap_err().to_string();
        assert!(
            refused.contains("policy = route: made for the configuration"),
            "{refused}"
        );
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
