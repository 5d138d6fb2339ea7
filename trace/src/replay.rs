//! The replay of a trace: it reads the actions and calls of each line and writes the line again.

use core::fmt::{self, Display, Write};

use jcas_core::hash::Fnv1a;
use jcas_core::header::Phase;
use jcas_core::host::Call;
use jcas_core::{Error, Model, Scratch, StateMut, StateRef};

use crate::call;
use crate::error::{Problem, VerifyError};
use crate::line::{CHECKSUM, EndLine, Hashes, HeaderLine, StepLine};
use crate::reader::{Header, Reader, STEP, expect, hexadecimal};
use crate::workspace::{Arguments, Workspace};
use crate::writer::{Sink, Writer};

/// A receiver of the lines of a replay.
pub trait Lines<'t> {
    /// Takes a line that the kernel produces. `recorded` is the line in the file, without a
    /// checksum.
    ///
    /// # Errors
    /// The call fails if the line must equal the recorded one and does not.
    fn flown(&mut self, recorded: &'t str, line: &dyn Display) -> Result<(), Problem<'t>>;

    /// Takes a line that the file supplies: a call of the host.
    fn supplied(&mut self, recorded: &'t str);
}

/// A simulation that repeats traces.
#[derive(Debug)]
pub struct Replay<'r> {
    simulation: Simulation<'r>,
    arguments: Arguments<'r>,
}

#[derive(Debug)]
struct Simulation<'r> {
    model: &'r Model<'r>,
    words: &'r mut [u64],
    scratch: &'r mut [u64],
    observations: &'r mut [f32],
    actions: &'r mut [f32],
}

impl<'r> Replay<'r> {
    /// Builds a replay over the words of a state and of working memory. The state is left where a
    /// trace ends or where it is refused.
    pub fn new(
        model: &'r Model<'r>,
        words: &'r mut [u64],
        scratch: &'r mut [u64],
        workspace: Workspace<'r>,
    ) -> Self {
        let Workspace {
            observations,
            actions,
            arguments,
        } = workspace;
        Self {
            simulation: Simulation {
                model,
                words,
                scratch,
                observations,
                actions,
            },
            arguments,
        }
    }

    /// Repeats a trace and compares every line with the file, byte by byte.
    ///
    /// # Errors
    /// The error names the first line that is refused or differs.
    pub fn verify<'t>(&mut self, trace: &'t str) -> Result<(), VerifyError<'t>> {
        self.fly(trace, &mut LineComparison)
    }

    /// Repeats a trace and passes every line to `lines`.
    ///
    /// # Errors
    /// The error names the first line that the kernel or `lines` refuses.
    pub fn fly<'t>(
        &mut self,
        trace: &'t str,
        lines: &mut impl Lines<'t>,
    ) -> Result<(), VerifyError<'t>> {
        let mut offset = self.advance(trace, 0, lines)?;
        while offset < trace.len() {
            offset = self.advance(trace, offset, lines)?;
        }
        Ok(())
    }

    /// Verifies the next lines of a trace, to the end of a step; see [`Replay::advance`].
    ///
    /// # Errors
    /// The error names the first line that is refused or differs.
    pub fn verify_step<'t>(
        &mut self,
        trace: &'t str,
        offset: usize,
    ) -> Result<usize, VerifyError<'t>> {
        self.advance(trace, offset, &mut LineComparison)
    }

    /// Repeats the next lines of a trace from a byte offset and returns the offset after them. At 0
    /// this is the header. Later calls take all lines to the end of a step, and the last call takes
    /// the lines after the last step. The state must be that of the preceding lines.
    ///
    /// # Errors
    /// The error names the first line that the kernel or `lines` refuses.
    pub fn advance<'t>(
        &mut self,
        trace: &'t str,
        offset: usize,
        lines: &mut impl Lines<'t>,
    ) -> Result<usize, VerifyError<'t>> {
        if offset == 0 {
            check_whole(trace)?;
        }
        let mut reader = Reader::at(trace, offset)?;
        let flown = if offset == 0 {
            let header = reader.header()?;
            self.begin(&header, lines)
        } else {
            loop {
                match self.line(&mut reader, lines) {
                    Ok(true) => reader.next_line(),
                    other => break other.map(|_| ()),
                }
            }
        };
        flown.map_err(|problem| reader.error(problem))?;
        Ok(trace.len() - reader.later.len())
    }

    fn begin<'t>(
        &mut self,
        header: &Header<'t>,
        lines: &mut impl Lines<'t>,
    ) -> Result<(), Problem<'t>> {
        let simulation = &mut self.simulation;
        if header.config.hash() != simulation.model.config_hash() {
            return Err(Problem::OtherModel);
        }
        let mut scratch =
            Scratch::new(simulation.model, simulation.scratch).or(Err(Problem::Memory))?;
        let reset = simulation
            .model
            .reset(simulation.words, &mut scratch, header.seed);
        reset.map_err(Problem::Kernel)?;
        let hashes = simulation.hashes()?;
        let line = HeaderLine {
            core_version: &header.core_version,
            policy: &header.policy,
            pilot: &header.pilot,
            model: simulation.model,
            state: &simulation.state()?,
            hashes,
        };
        lines.flown(header.line, &line)
    }

    /// Repeats a line. Returns whether it is a call, which a step or the end must follow.
    fn line<'t>(
        &mut self,
        reader: &mut Reader<'t>,
        lines: &mut impl Lines<'t>,
    ) -> Result<bool, Problem<'t>> {
        if reader.line.starts_with(STEP) {
            self.simulation.step(reader, lines)?;
            return Ok(false);
        }
        reader.skip("{\"kind\":\"")?;
        let kind = reader.text()?;
        reader.skip("\",")?;
        if kind == "end" {
            self.simulation.end(reader, lines)?;
            return Ok(false);
        }
        let call = call::read(kind, reader, self.simulation.model, &mut self.arguments)?;
        if call.within_step() {
            self.simulation.begin_step(reader)?;
        }
        if matches!(call, Call::StepCommunicateWith { .. }) {
            self.simulation.sense()?;
        }
        self.simulation
            .act(|model, state, scratch, _| call.apply(model, state, scratch))?;
        lines.supplied(reader.line);
        Ok(true)
    }
}

impl Simulation<'_> {
    fn act<'t, F>(&mut self, act: F) -> Result<(), Problem<'t>>
    where
        F: FnOnce(&Model<'_>, &mut StateMut<'_>, &mut Scratch<'_>, &[f32]) -> Result<(), Error>,
    {
        let mut scratch = Scratch::new(self.model, self.scratch).or(Err(Problem::Memory))?;
        let mut state = self.model.state_mut(self.words).map_err(Problem::Kernel)?;
        act(self.model, &mut state, &mut scratch, self.actions).map_err(Problem::Kernel)
    }

    fn state<'t>(&self) -> Result<StateRef<'_>, Problem<'t>> {
        self.model.state(self.words).map_err(Problem::Kernel)
    }

    fn hashes<'t>(&mut self) -> Result<Hashes, Problem<'t>> {
        Hashes::of(self.model, self.words, self.scratch, self.observations)
            .map_err(|_| Problem::Memory)
    }

    fn phase(&self) -> Option<Phase> {
        self.model.state(self.words).ok()?.header.phase()
    }

    fn within_step(&self) -> bool {
        let within = [Phase::Moved, Phase::Sensed, Phase::Communicated];
        self.phase().is_some_and(|phase| within.contains(&phase))
    }

    /// Begins the step whose line comes next, unless it has begun.
    fn begin_step<'t>(&mut self, reader: &Reader<'t>) -> Result<(), Problem<'t>> {
        if self.within_step() {
            return Ok(());
        }
        reader.actions(self.actions)?;
        self.act(|model, state, _, actions| model.step_begin(state, actions))
    }

    /// Continues the step to the point where the radio graph is needed.
    fn sense<'t>(&mut self) -> Result<(), Problem<'t>> {
        if self.phase() == Some(Phase::Moved) {
            self.act(|model, state, scratch, _| model.step_sense(state, scratch))?;
        }
        Ok(())
    }

    fn step<'t>(
        &mut self,
        reader: &Reader<'t>,
        lines: &mut impl Lines<'t>,
    ) -> Result<(), Problem<'t>> {
        self.begin_step(reader)?;
        self.sense()?;
        if self.phase() == Some(Phase::Sensed) {
            self.act(|model, state, scratch, _| model.step_communicate(state, scratch))?;
        }
        self.act(|model, state, scratch, _| model.step_end(state, scratch).map(|_| ()))?;
        let line = StepLine {
            hashes: self.hashes()?,
            model: self.model,
            state: &self.state()?,
            actions: self.actions,
        };
        lines.flown(reader.line, &line)
    }

    fn end<'t>(
        &mut self,
        reader: &Reader<'t>,
        lines: &mut impl Lines<'t>,
    ) -> Result<(), Problem<'t>> {
        expect(reader.later.is_empty() && !self.within_step())?;
        let at = reader.line.rfind(CHECKSUM).ok_or(Problem::Form)?;
        let metrics = self.state()?.metrics();
        lines.flown(&reader.line[..at], &EndLine { metrics })
    }
}

/// Checks that the checksum is last and correct.
fn check_whole(trace: &str) -> Result<(), VerifyError<'_>> {
    let whole = || {
        let at = trace.rfind(CHECKSUM)?;
        let (digits, rest) = trace[at + CHECKSUM.len()..].split_at_checked(16)?;
        let mut hash = Fnv1a::new();
        hash.write(&trace.as_bytes()[..at]);
        (rest == "\"}\n" && hexadecimal(digits)? == hash.finish()).then_some(())
    };
    whole().ok_or(VerifyError {
        line: 0,
        problem: Problem::Incomplete,
    })
}

impl<S: Sink> Lines<'_> for Writer<S> {
    fn flown(&mut self, _recorded: &str, line: &dyn Display) -> Result<(), Problem<'static>> {
        self.line(line);
        Ok(())
    }

    fn supplied(&mut self, recorded: &str) {
        self.line(&recorded);
    }
}

/// A receiver that compares each line with the recorded one.
struct LineComparison;

impl<'t> Lines<'t> for LineComparison {
    fn flown(&mut self, recorded: &'t str, line: &dyn Display) -> Result<(), Problem<'t>> {
        let mut beside = Beside {
            line: recorded,
            alike: 0,
        };
        match write!(beside, "{line}") {
            Ok(()) if beside.alike == recorded.len() => Ok(()),
            _ => Err(Problem::Differs(field_at(recorded, beside.alike))),
        }
    }

    fn supplied(&mut self, _recorded: &'t str) {}
}

struct Beside<'t> {
    line: &'t str,
    alike: usize,
}

impl Write for Beside<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let rest = &self.line.as_bytes()[self.alike..];
        let same = rest.iter().zip(text.as_bytes()).take_while(|(a, b)| a == b);
        let same = same.count();
        self.alike += same;
        if same == text.len() {
            Ok(())
        } else {
            Err(fmt::Error)
        }
    }
}

/// Returns the name of the field that a byte of a line belongs to.
fn field_at(line: &str, at: usize) -> &str {
    let mut end = at.min(line.len());
    while !line.is_char_boundary(end) {
        end -= 1;
    }
    let name = || {
        let before = &line[..line[..end].rfind("\":")?];
        Some(&before[before.rfind('"')? + 1..])
    };
    name().unwrap_or("kind")
}
