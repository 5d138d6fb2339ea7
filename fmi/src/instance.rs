//! The life cycle of an instance: parameters, initialization, steps, and the values of its
//! variables.

#[cfg(test)]
mod tests;

use std::path::PathBuf;

use jcas_core::Config;
use jcas_core::config::FieldValue;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::episode::{Episode, Inputs};
use crate::error::Error;
use crate::setup::Setup;
use crate::values::{Values, field_values, output};
use crate::variables::{Causality, Extent, Variable, VariableType, all, reference};

/// The state of an instance in the state machine of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// The instance was just instantiated.
    Instantiated,
    /// Sizes may be set.
    Configuration,
    /// Parameters may be set.
    Initialization,
    /// Steps may be done.
    Step,
    /// Values may be read.
    Terminated,
}

/// Tolerance for the rounding of an importer's clock, as a fraction of a step.
const STEP_TOLERANCE: f64 = 1e-6;

/// The state of an instance that can be saved.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Saved {
    mode: Mode,
    setup: Setup,
    time_s: f64,
    reward: f64,
    actions: Vec<f32>,
    positions: Vec<u32>,
    links: Vec<bool>,
    /// The kernel's snapshot, or none before the episode begins.
    snapshot: Option<Vec<u8>>,
    /// What the policy remembers.
    memory: Vec<u64>,
}

/// An instance of the unit.
pub struct Instance {
    variables: Vec<Variable>,
    mode: Mode,
    setup: Setup,
    inputs: Inputs,
    episode: Option<Episode>,
    time_s: f64,
}

impl Instance {
    /// Builds an instance with the default parameters.
    ///
    /// # Errors
    /// Never: the default configuration is legal.
    pub fn new(resources: Option<PathBuf>) -> Result<Self, Error> {
        let setup = Setup {
            resources,
            ..Setup::default()
        };
        let inputs = setup.initial_inputs()?;
        Ok(Self {
            variables: all(),
            mode: Mode::Instantiated,
            setup,
            inputs,
            episode: None,
            time_s: 0.0,
        })
    }

    /// Returns the present mode.
    #[must_use]
    pub const fn mode(&self) -> Mode {
        self.mode
    }

    /// Goes from one mode to another.
    ///
    /// # Errors
    /// The call fails if the standard does not allow the change from the present mode.
    pub fn go(&mut self, allowed: &[Mode], to: Mode, called: &str) -> Result<(), Error> {
        if !allowed.contains(&self.mode) {
            let (call, mode) = (called.to_owned(), self.mode);
            return Err(Error::CallInMode { call, mode });
        }
        self.mode = to;
        Ok(())
    }

    /// Sets the time at which the episode begins, in seconds.
    pub const fn start_at(&mut self, time_s: f64) {
        self.time_s = time_s;
    }

    /// Builds the episode from the parameters, unless it exists.
    ///
    /// # Errors
    /// The text names the parameter, the value and what is allowed.
    pub fn prepare(&mut self) -> Result<&Episode, Error> {
        if self.episode.is_none() {
            self.episode = Some(Episode::new(&self.setup)?);
        }
        self.episode.as_ref().ok_or(Error::NoEpisode)
    }

    /// Resets the instance to its state after instantiation.
    ///
    /// # Errors
    /// The errors are those of [`Instance::new`].
    pub fn reset(&mut self) -> Result<(), Error> {
        *self = Self::new(self.setup.resources.take())?;
        Ok(())
    }

    /// Simulates from `from_s` for `length_s`, which must be whole steps of Δt. After the end of
    /// the episode the state no longer changes.
    ///
    /// # Errors
    /// The call fails if the times do not fit or the kernel refuses an input. The time is then that
    /// of the last complete step.
    pub fn do_step(&mut self, from_s: f64, length_s: f64) -> Result<f64, Error> {
        if self.mode != Mode::Step {
            let (call, mode) = ("fmi3DoStep".to_owned(), self.mode);
            return Err(Error::CallInMode { call, mode });
        }
        let episode = self.episode.as_mut().ok_or(Error::NoEpisode)?;
        let step_s = episode.model().config().step_duration_s;
        let steps = (length_s / step_s).round();
        if !(steps >= 1.0 && (steps * step_s - length_s).abs() <= STEP_TOLERANCE * step_s) {
            return Err(Error::Argument {
                argument: "communicationStepSize",
                value: length_s.to_string(),
                allowed: format!("must be a multiple of step_duration_s = {step_s}"),
            });
        }
        if (from_s - self.time_s).abs() > STEP_TOLERANCE * step_s {
            return Err(Error::Argument {
                argument: "currentCommunicationPoint",
                value: from_s.to_string(),
                allowed: format!("the instance is at {}", self.time_s),
            });
        }
        episode.reward = 0.0;
        for _ in 0..steps as u64 {
            if !episode.over()? {
                episode.step(&self.inputs)?;
            }
            self.time_s += step_s;
        }
        Ok(self.time_s)
    }

    fn variable(&self, vr: u32) -> Result<&Variable, Error> {
        self.variables
            .iter()
            .find(|variable| variable.reference == vr)
            .ok_or(Error::NoVariable(vr))
    }

    /// Returns the type of a variable and its number of elements.
    ///
    /// # Errors
    /// The call fails if there is no such variable.
    pub fn shape(&self, vr: u32) -> Result<(VariableType, usize), Error> {
        let variable = self.variable(vr)?;
        let mut count = 1;
        for extent in variable.extents {
            count *= match extent {
                Extent::Uavs => self.setup.size("uav_count")? as usize,
                Extent::Hotspots => self.setup.size("hotspot_count")? as usize,
                Extent::Two => 2,
            };
        }
        Ok((variable.kind, count))
    }

    /// Returns the value of a variable.
    ///
    /// # Errors
    /// The call fails if there is no such variable, or if the parameters are not legal.
    pub fn get(&mut self, vr: u32) -> Result<Values, Error> {
        use reference::*;
        if let Some(name) = field_name(vr) {
            return field_values(self.shape(vr)?.0, &self.setup.field(name)?);
        }
        Ok(match vr {
            TIME => Values::Float64(vec![self.time_s]),
            UAV_COUNT => Values::UInt64(vec![self.setup.size("uav_count")?]),
            HOTSPOT_COUNT => Values::UInt64(vec![self.setup.size("hotspot_count")?]),
            PRESET => Values::String(vec![self.setup.preset.clone()]),
            SEED => Values::UInt64(vec![self.setup.seed]),
            POLICY => Values::String(vec![self.setup.policy.clone()]),
            PILOT => Values::String(vec![self.setup.pilot.clone()]),
            OWN_POSITIONS => Values::Boolean(vec![self.setup.own_positions]),
            OWN_LINKS => Values::Boolean(vec![self.setup.own_links]),
            ACTIONS => Values::Float32(self.inputs.actions.clone()),
            POSITIONS => Values::UInt32(self.inputs.positions.clone()),
            LINKS => Values::Boolean(self.inputs.links.clone()),
            _ => {
                let name = self.variable(vr)?.name;
                output(name, self.prepare()?)?
            }
        })
    }

    /// Sets a variable. `values` has the type and the number of elements of [`Instance::shape`].
    ///
    /// # Errors
    /// The call fails if the variable may not be set, not in this mode or not to this value.
    pub fn set(&mut self, vr: u32, values: Values) -> Result<(), Error> {
        use reference::*;
        let (name, causality) = {
            let variable = self.variable(vr)?;
            (variable.name, variable.causality)
        };
        let modes: &[Mode] = match causality {
            Causality::Structural => &[Mode::Instantiated, Mode::Configuration],
            Causality::Parameter => &[Mode::Instantiated, Mode::Initialization],
            Causality::Input => &[Mode::Instantiated, Mode::Initialization, Mode::Step],
            Causality::Independent | Causality::Output => {
                return Err(Error::ReadOnly(name));
            }
        };
        if !modes.contains(&self.mode) {
            let mode = self.mode;
            return Err(Error::SetInMode { name, mode });
        }
        if causality != Causality::Input {
            self.episode = None;
        }
        match (vr, values) {
            (UAV_COUNT | HOTSPOT_COUNT, Values::UInt64(values)) => self.resize(name, values[0])?,
            (PRESET, Values::String(mut values)) => self.setup.preset = values.remove(0),
            (SEED, Values::UInt64(values)) => self.setup.seed = values[0],
            (POLICY, Values::String(mut values)) => self.setup.policy = values.remove(0),
            (PILOT, Values::String(mut values)) => self.setup.pilot = values.remove(0),
            (OWN_POSITIONS, Values::Boolean(values)) => self.setup.own_positions = values[0],
            (OWN_LINKS, Values::Boolean(values)) => self.setup.own_links = values[0],
            (ACTIONS, Values::Float32(values)) => self.inputs.actions = values,
            (POSITIONS, Values::UInt32(values)) => self.inputs.positions = values,
            (LINKS, Values::Boolean(values)) => self.inputs.links = values,
            (_, values) => self.set_field(name, values)?,
        }
        Ok(())
    }

    fn resize(&mut self, name: &str, count: u64) -> Result<(), Error> {
        if !(1..=4096).contains(&count) {
            return Err(Error::Value {
                name: name.to_owned(),
                value: count.to_string(),
                allowed: "from 1 to 4096",
            });
        }
        self.setup.fields.insert(name.to_owned(), count.into());
        self.inputs = self.setup.initial_inputs()?;
        Ok(())
    }

    fn set_field(&mut self, name: &str, values: Values) -> Result<(), Error> {
        let value = match values {
            Values::Float64(values) if values[0].is_nan() => {
                if !may_be_derived(name) {
                    return Err(Error::Value {
                        name: name.to_owned(),
                        value: "NaN".to_owned(),
                        allowed: "a number",
                    });
                }
                Value::Null
            }
            Values::Float64(values) => values[0].into(),
            Values::UInt32(values) => values[0].into(),
            Values::String(mut values) if matches!(name, "depots" | "detection_table") => {
                serde_json::from_str(&values.remove(0)).map_err(|source| json(name, source))?
            }
            Values::String(mut values) => values.remove(0).into(),
            _ => return Err(Error::FieldType(name.to_owned())),
        };
        let at_rest = self.inputs == self.setup.initial_inputs()?;
        // An absent field is derived, as in every text of a configuration.
        if value.is_null() {
            self.setup.fields.remove(name);
        } else {
            self.setup.fields.insert(name.to_owned(), value);
        }
        if at_rest {
            self.inputs = self.setup.initial_inputs()?;
        }
        Ok(())
    }

    /// Saves the whole instance as bytes.
    ///
    /// # Errors
    /// The errors are those of [`Episode::save`].
    pub fn save(&self) -> Result<Vec<u8>, Error> {
        let saved = Saved {
            mode: self.mode,
            setup: self.setup.clone(),
            time_s: self.time_s,
            reward: self.episode.as_ref().map_or(0.0, |episode| episode.reward),
            actions: self.inputs.actions.clone(),
            positions: self.inputs.positions.clone(),
            links: self.inputs.links.clone(),
            snapshot: self.episode.as_ref().map(Episode::save).transpose()?,
            memory: self
                .episode
                .as_ref()
                .map(Episode::memory)
                .unwrap_or_default(),
        };
        serde_json::to_vec(&saved).map_err(Error::Save)
    }

    /// Restores a saved instance.
    ///
    /// # Errors
    /// The call fails if [`Instance::save`] did not write the bytes.
    pub fn load(&self, bytes: &[u8]) -> Result<Self, Error> {
        let mut saved: Saved =
            serde_json::from_slice(bytes).map_err(|source| json("saved state", source))?;
        saved.setup.resources.clone_from(&self.setup.resources);
        let mut episode = saved
            .snapshot
            .map(|snapshot| Episode::restore(&saved.setup, &snapshot, &saved.memory))
            .transpose()?;
        if let Some(episode) = &mut episode {
            episode.reward = saved.reward;
        }
        let uavs = saved.setup.size("uav_count")? as usize;
        if saved.actions.len() != 2 * uavs
            || saved.positions.len() != 2 * uavs
            || saved.links.len() != uavs * uavs
        {
            return Err(Error::ForeignInputs);
        }
        Ok(Self {
            variables: all(),
            mode: saved.mode,
            setup: saved.setup,
            inputs: Inputs {
                actions: saved.actions,
                positions: saved.positions,
                links: saved.links,
            },
            episode,
            time_s: saved.time_s,
        })
    }
}

fn json(name: &str, source: serde_json::Error) -> Error {
    let name = name.to_owned();
    Error::Json { name, source }
}

fn field_name(vr: u32) -> Option<&'static str> {
    let index = vr.checked_sub(reference::FIELDS)? as usize;
    jcas_core::Config::FIELDS.get(index).map(|info| info.name)
}

/// Whether a field of the configuration can be derived from others.
fn may_be_derived(name: &str) -> bool {
    let config = Config::default();
    let mut fields = Config::FIELDS.iter().zip(config.values());
    fields.any(|(info, value)| info.name == name && matches!(value, FieldValue::Optional(_)))
}
