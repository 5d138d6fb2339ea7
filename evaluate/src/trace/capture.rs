//! From the kernel to the lines of a trace: recording and verifying share this, so that a field that one
//! writes is a field that the other checks.

use std::io::Write;

use jcas_core::{Config, Error, Model, Sim, StateRef, action, hash};

use super::compare::{Difference, diff};
use super::error::TraceError;
use super::format::{End, FORMAT, FORMAT_VERSION, Header, Hex, Initial, Rewards, Step, Trace};
use super::host::Host;
use super::write::Writer;
use crate::policy::Policy;

/// Flies one episode and writes it down. Returns its last line.
///
/// # Errors
/// Where writing fails, or the kernel refuses an action of the policy.
pub fn record(
    model: &Model<'_>,
    policy: &mut dyn Policy,
    seed: u64,
    out: impl Write,
) -> Result<End, TraceError> {
    let mut episode = Flight::begin(model, seed)?;
    policy.reset(model, seed);
    let header = episode.header(policy.name(), &policy.pilot().to_string());
    let mut writer = Writer::new(out, &header)?;
    let mut actions = vec![0.0; 2 * model.uav_count()];
    while !episode.over() {
        episode.ask(policy, &mut actions);
        writer.step(&episode.step(&actions)?)?;
    }
    let mut end = episode.end();
    end.checksum = writer.end(end.clone())?;
    Ok(end)
}

/// Flies a trace again from its configuration, seed and actions. Returns the first difference between
/// what it says and what this build does; `None` where every bit is the same.
///
/// # Errors
/// Where the kernel refuses the configuration or an action.
pub fn verify(trace: &Trace) -> Result<Option<Difference>, TraceError> {
    let model = Model::new(trace.header.config)?;
    let mut episode = Flight::begin(&model, trace.header.seed.0)?;
    let header = episode.header(&trace.header.policy, &trace.header.pilot);
    let mut steps = Vec::with_capacity(trace.steps.len());
    for recorded in &trace.steps {
        if episode.over() {
            break;
        }
        for call in &recorded.host {
            episode.own(call.clone())?;
        }
        steps.push(episode.step(recorded.actions.as_flattened())?);
    }
    for call in &trace.end.host {
        episode.own(call.clone())?;
    }
    let flown = Trace {
        header,
        steps,
        end: episode.end(),
    };
    Ok(diff(trace, &flown))
}

/// An episode in flight, seen as lines of a trace.
pub struct Flight<'m> {
    model: &'m Model<'m>,
    config: Config,
    sim: Sim<'m>,
    observations: Vec<f32>,
    seed: u64,
    /// What the host has supplied since the last step.
    host: Vec<Host>,
}

impl<'m> Flight<'m> {
    /// Stands at the start of the episode of `seed`.
    ///
    /// # Errors
    /// Where the observations do not fit, which they do.
    pub fn begin(model: &'m Model<'m>, seed: u64) -> Result<Self, Error> {
        let mut sim = Sim::new(model);
        sim.reset(seed);
        let mut episode = Self {
            model,
            config: *model.config(),
            sim,
            observations: vec![0.0; model.uav_count() * model.observation_len()],
            seed,
            host: Vec::new(),
        };
        episode.sim.observe(&mut episode.observations)?;
        Ok(episode)
    }

    /// The state as it is now.
    #[must_use]
    pub fn state(&self) -> StateRef<'_> {
        self.sim.state()
    }

    /// Takes what a host owns in place of the model. A call between steps is made at once, one within a step
    /// when the next step comes to it.
    ///
    /// # Errors
    /// What the kernel refuses.
    pub fn own(&mut self, call: Host) -> Result<(), Error> {
        if !call.within_a_step() {
            if self.host.iter().any(Host::within_a_step) {
                return Err(Error::OutOfOrder {
                    called: "a call between steps",
                    after: "reset or step_end",
                });
            }
            call.make(&mut self.sim)?;
            self.sim.observe(&mut self.observations)?;
        }
        self.host.push(call);
        Ok(())
    }

    /// Lets a policy choose the next actions.
    pub fn ask(&mut self, policy: &mut dyn Policy, actions: &mut [f32]) {
        if policy.reads_observations() {
            policy.see(&self.observations);
        }
        policy.act(self.model, &self.sim.state(), actions);
    }

    /// Whether the episode has ended.
    #[must_use]
    pub fn over(&self) -> bool {
        let state = self.sim.state();
        state.terminated() || state.truncated()
    }

    /// The first line, before the first step and before the host owns anything.
    #[must_use]
    pub fn header(&self, policy: &str, pilot: &str) -> Header {
        let state = self.sim.state();
        let (uavs, hotspots) = (self.model.uav_count(), self.model.hotspot_count());
        Header {
            kind: "header".to_owned(),
            format: FORMAT.to_owned(),
            format_version: FORMAT_VERSION,
            core_version: jcas_core::VERSION.to_owned(),
            config: self.config,
            config_hash: Hex(self.config.hash()),
            seed: Hex(self.seed),
            policy: policy.to_owned(),
            pilot: pilot.to_owned(),
            hotspots: (0..hotspots).map(|j| state.hotspot_cell(j)).collect(),
            depots: self.model.depots().to_vec(),
            initial: Initial {
                positions: (0..uavs).map(|i| state.cell(i)).collect(),
                battery_uj: (0..uavs).map(|i| state.battery_uj(i)).collect(),
                carbon_intensity_mg_per_kwh: state.carbon_intensity_mg_per_kwh(),
                observation_hash: Hex(hash::reals(&self.observations)),
                state_hash: Hex(self.sim.state_hash()),
            },
        }
    }

    /// Flies a step and gives its line.
    ///
    /// # Errors
    /// Where the kernel refuses the actions.
    pub fn step(&mut self, actions: &[f32]) -> Result<Step, Error> {
        self.advance(actions)?;
        self.sim.observe(&mut self.observations)?;
        let state = self.sim.state();
        let (uavs, hotspots) = (self.model.uav_count(), self.model.hotspot_count());
        let uavs_where = |holds: &dyn Fn(usize) -> bool| (0..uavs).filter(|&i| holds(i)).collect();
        let hotspots_where =
            |holds: &dyn Fn(usize) -> bool| (0..hotspots).filter(|&j| holds(j)).collect();
        Ok(Step {
            kind: "step".to_owned(),
            t: state.t(),
            actions: actions
                .chunks_exact(2)
                .map(|pair| [written(pair[0]), written(pair[1])])
                .collect(),
            positions: (0..uavs).map(|i| state.cell(i)).collect(),
            pilot_density: (0..uavs).map(|i| state.pilot_density(i)).collect(),
            battery_uj: (0..uavs).map(|i| state.battery_uj(i)).collect(),
            grounded: uavs_where(&|i| state.grounded(i)),
            returning: uavs_where(&|i| state.returning(i)),
            links: (0..uavs)
                .flat_map(|i| state.neighbours(i).map(move |k| [i, k]))
                .filter(|[i, k]| i < k)
                .collect(),
            knowledge: (0..uavs)
                .map(|i| hotspots_where(&|j| state.knows(i, j)))
                .collect(),
            confirmed: hotspots_where(&|j| state.confirmed(j)),
            informed: hotspots_where(&|j| state.informed(j)),
            carbon_intensity_mg_per_kwh: state.billed_intensity_mg_per_kwh(),
            co2_ng: state.co2_ng(),
            throughput: state.mean_throughput(),
            reward: Rewards(state.rewards()),
            observation_hash: Hex(hash::reals(&self.observations)),
            state_hash: Hex(self.sim.state_hash()),
            host: std::mem::take(&mut self.host),
        })
    }

    /// A whole step; by parts where the host owns some of it.
    fn advance(&mut self, actions: &[f32]) -> Result<(), Error> {
        let Self { sim, host, .. } = self;
        let mut within = host.iter().filter(|call| call.within_a_step()).peekable();
        if within.peek().is_none() {
            return sim.step(actions).map(|_| ());
        }
        sim.step_begin(actions)?;
        let senses = |call: &&Host| matches!(call, Host::StepSenseOver { .. });
        let communicates = |call: &&Host| matches!(call, Host::StepCommunicateOver { .. });
        while let Some(call) = within.next_if(|call| !senses(call) && !communicates(call)) {
            call.make(sim)?;
        }
        match within.next_if(senses) {
            Some(call) => call.make(sim)?,
            None => sim.step_sense()?,
        }
        match within.next_if(communicates) {
            Some(call) => call.make(sim)?,
            None => sim.step_communicate()?,
        }
        // Whatever is left comes too late, which the kernel says.
        within.try_for_each(|call| call.make(sim))?;
        sim.step_end().map(|_| ())
    }

    /// The last line, but for its checksum.
    #[must_use]
    pub fn end(&self) -> End {
        let metrics = self.sim.state().metrics();
        End {
            kind: "end".to_owned(),
            steps: metrics.steps,
            terminated: metrics.terminated,
            truncated: metrics.truncated,
            metrics,
            checksum: Hex(0),
            host: self.host.clone(),
        }
    }
}

/// JSON has no infinity; clipped, as the kernel clips it, it means the same.
fn written(component: f32) -> f32 {
    if component.is_finite() {
        component
    } else {
        action::clip(component)
    }
}
