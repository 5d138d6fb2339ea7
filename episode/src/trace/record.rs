//! Records an episode, and verifies that this build reproduces a recorded one.

use std::io::Write;

use jcas_core::host::Call;
use jcas_core::{Error, Model, Scratch, Sim, StateRef};
use jcas_trace::{
    Arguments, CallLine, EndLine, Escaped, Hashes, HeaderLine, Problem, Replay, Sink, StepLine,
    VerifyError, Workspace, WorkspaceSizes, Writer,
};

use super::compare::{Difference, diff};
use super::error::TraceError;
use super::format::{End, Hex, Trace};
use super::read::read;
use jcas_policy::Policy;

/// Runs one episode and writes its trace. Returns the last line.
///
/// # Errors
/// Writing fails, or the kernel refuses an action of the policy.
pub fn record(
    model: &Model<'_>,
    policy: &mut dyn Policy,
    seed: u64,
    out: impl Write,
) -> Result<End, TraceError> {
    let pilot = policy.pilot().to_string();
    let mut episode = EpisodeRecorder::begin(model, seed, (policy.name(), &pilot), out)?;
    policy.reset(model, seed);
    let mut actions = vec![0.0; model.action_len()];
    while !episode.over() {
        episode.ask(policy, &mut actions);
        episode.step(&actions, &[])?;
    }
    episode.end()
}

/// Replays a trace from its configuration, seed, actions and host calls. Returns the first
/// difference between the file and this build; `None` where all bits are the same.
///
/// # Errors
/// The kernel refuses the configuration, an action or a call.
pub fn verify(trace: &Trace) -> Result<Option<Difference>, TraceError> {
    let text = rerecord(trace)?;
    Ok(diff(trace, &read(text.as_slice())?))
}

/// Replays a trace and writes what this build makes of its configuration, seed, actions and host
/// calls.
///
/// # Errors
/// The kernel refuses the configuration, an action or a call.
pub fn rerecord(trace: &Trace) -> Result<Vec<u8>, TraceError> {
    let model = Model::new(trace.header.config)?;
    let mut words = vec![0; model.state_words()];
    let mut scratch = vec![0; Scratch::words_for(&model)];
    let sizes = WorkspaceSizes::of(&model);
    let workspace = Workspace {
        observations: &mut vec![0.0; sizes.observations],
        actions: &mut vec![0.0; sizes.actions],
        arguments: Arguments {
            cells: &mut vec![jcas_core::Cell::default(); sizes.cells],
            charges_uj: &mut vec![0; sizes.uavs],
            throughput: &mut vec![0.0; sizes.uavs],
            matrix: &mut vec![0; sizes.matrix],
        },
    };
    let mut text = Vec::new();
    let mut writer = Writer::new(Output(&mut text));
    match Replay::new(&model, &mut words, &mut scratch, workspace).fly(&trace.text, &mut writer) {
        Ok(()) => {}
        // The file continues after the end of the episode.
        Err(VerifyError {
            problem: Problem::Kernel(Error::EpisodeOver),
            ..
        }) => {
            let metrics = model.state(&words)?.metrics();
            writer.line(&EndLine { metrics });
        }
        Err(VerifyError {
            problem: Problem::Kernel(error),
            ..
        }) => return Err(error.into()),
        Err(error) => {
            return Err(TraceError::Malformed {
                line: error.line,
                problem: error.problem.to_string(),
            });
        }
    }
    writer.finish()?;
    Ok(text)
}

/// Writes the lines of an episode while it runs.
pub struct EpisodeRecorder<'m, W: Write> {
    model: &'m Model<'m>,
    sim: Sim<'m>,
    observations: Vec<f32>,
    scratch: Vec<u64>,
    writer: Writer<Output<W>>,
}

impl<'m, W: Write> EpisodeRecorder<'m, W> {
    /// Begins the episode of `seed` and writes the header with the names of the policy and of its
    /// pilot mode.
    ///
    /// # Errors
    /// Writing fails.
    pub fn begin(
        model: &'m Model<'m>,
        seed: u64,
        (policy, pilot): (&str, &str),
        out: W,
    ) -> Result<Self, TraceError> {
        let mut sim = Sim::new(model);
        sim.reset(seed);
        let mut episode = Self {
            model,
            sim,
            observations: vec![0.0; model.uav_count() * model.observation_len()],
            scratch: vec![0; Scratch::words_for(model)],
            writer: Writer::new(Output(out)),
        };
        let hashes = episode.observe()?;
        episode.writer.line(&HeaderLine {
            core_version: &jcas_core::VERSION,
            policy: &Escaped(policy),
            pilot: &Escaped(pilot),
            model,
            state: &episode.sim.state(),
            hashes,
        });
        episode.writer.check()?;
        Ok(episode)
    }

    /// The current state.
    #[must_use]
    pub fn state(&self) -> StateRef<'_> {
        self.sim.state()
    }

    /// Whether the episode has ended.
    #[must_use]
    pub fn over(&self) -> bool {
        let state = self.sim.state();
        state.terminated() || state.truncated()
    }

    /// Makes a host's call between two steps.
    ///
    /// # Errors
    /// The kernel refuses the call.
    pub fn call(&mut self, call: &Call<'_>) -> Result<(), TraceError> {
        self.apply(call)?;
        self.sim.observe(&mut self.observations)?;
        Ok(())
    }

    /// Lets a policy choose the next actions.
    pub fn ask(&mut self, policy: &mut dyn Policy, actions: &mut [f32]) {
        if policy.reads_observations() {
            policy.see(&self.observations);
        }
        policy.act(self.model, &self.sim.state(), actions);
    }

    /// Runs a step with the calls that a host makes within it, in their order.
    ///
    /// # Errors
    /// The kernel refuses the actions or a call, or writing fails.
    pub fn step(&mut self, actions: &[f32], calls: &[Call<'_>]) -> Result<(), TraceError> {
        if calls.is_empty() {
            self.sim.step(actions)?;
        } else {
            self.step_by_parts(actions, calls)?;
        }
        let line = StepLine {
            hashes: self.observe()?,
            model: self.model,
            state: &self.sim.state(),
            actions,
        };
        self.writer.line(&line);
        self.writer.check()?;
        Ok(())
    }

    fn step_by_parts(&mut self, actions: &[f32], calls: &[Call<'_>]) -> Result<(), TraceError> {
        self.sim.step_begin(actions)?;
        let mut calls = calls.iter().peekable();
        let senses = |call: &&Call<'_>| matches!(call, Call::StepSenseWith { .. });
        let communicates = |call: &&Call<'_>| matches!(call, Call::StepCommunicateWith { .. });
        while let Some(call) = calls.next_if(|call| !senses(call) && !communicates(call)) {
            self.apply(call)?;
        }
        match calls.next_if(senses) {
            Some(call) => self.apply(call)?,
            None => self.sim.step_sense()?,
        }
        match calls.next_if(communicates) {
            Some(call) => self.apply(call)?,
            None => self.sim.step_communicate()?,
        }
        // The kernel refuses a call that comes too late.
        calls.try_for_each(|call| self.apply(call))?;
        self.sim.step_end()?;
        Ok(())
    }

    /// Writes the last line and returns it.
    ///
    /// # Errors
    /// Writing fails.
    pub fn end(mut self) -> Result<End, TraceError> {
        let metrics = self.sim.state().metrics();
        self.writer.line(&EndLine { metrics });
        Ok(End::of(metrics, Hex(self.writer.finish()?)))
    }

    fn apply(&mut self, call: &Call<'_>) -> Result<(), TraceError> {
        self.sim.apply(call)?;
        let uavs = self.model.uav_count();
        self.writer.line(&CallLine { call, uavs });
        Ok(())
    }

    fn observe(&mut self) -> Result<Hashes, Error> {
        let words = self.sim.words();
        Hashes::of(self.model, words, &mut self.scratch, &mut self.observations)
    }
}

/// Passes the bytes of a trace to a writer of the standard library.
struct Output<W>(W);

impl<W: Write> Sink for Output<W> {
    type Error = std::io::Error;

    fn take(&mut self, bytes: &[u8]) -> Result<(), Self::Error> {
        self.0.write_all(bytes)
    }
}
