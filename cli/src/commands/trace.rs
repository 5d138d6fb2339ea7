//! `jcas trace`: records, verifies and compares episodes on file.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use jcas_core::Model;
use jcas_episode::files::{TRACE_BYTES_MAX, open};
use jcas_episode::trace::{self, Difference, End, Trace as Recorded};
use serde::Serialize;

use crate::error::{CliError, Outcome};
use crate::files;
use crate::idle::Idle;
use crate::learned::PolicyFactory;
use crate::options::{EpisodeOptions, ModelOptions, PolicyOptions, policy_factory};

const RECORD_EXAMPLES: &str = "\
Examples:
  jcas trace record -o flight.jsonl
  jcas trace record --uavs 15 --policy teams --pilot adaptive --seed 7 --episode 3 -o flight.jsonl";
const VERIFY_EXAMPLES: &str = "\
Examples:
  jcas trace verify flight.jsonl
  jcas trace verify tests/golden/*.jsonl --json";
const DIFF_EXAMPLES: &str = "\
Examples:
  jcas trace diff yesterday.jsonl today.jsonl";

/// Record an episode, verify that this build reproduces it bit for bit, compare two records
#[derive(Subcommand)]
pub enum Trace {
    Record(Record),
    Verify(Verify),
    Diff(Diff),
}

/// Run one episode and write its trace as JSON lines
#[derive(Args)]
#[command(after_help = RECORD_EXAMPLES)]
pub struct Record {
    #[command(flatten)]
    model: ModelOptions,
    #[command(flatten)]
    policy: PolicyOptions,
    #[command(flatten)]
    episode: EpisodeOptions,
    /// File to write
    #[arg(short, long, value_name = "FILE")]
    out: PathBuf,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Replay recorded episodes and compare every field; exit code 1 at the first difference
#[derive(Args)]
#[command(after_help = VERIFY_EXAMPLES)]
pub struct Verify {
    /// Traces to verify
    #[arg(required = true, value_name = "TRACE")]
    traces: Vec<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Name the first step and field at which two traces differ; exit code 1 if they do
#[derive(Args)]
#[command(after_help = DIFF_EXAMPLES)]
pub struct Diff {
    #[arg(value_name = "TRACE")]
    left: PathBuf,
    #[arg(value_name = "TRACE")]
    right: PathBuf,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Trace {
    /// The options that have no effect with the policy.
    pub fn idle(&self) -> Vec<Idle> {
        match self {
            Self::Record(command) => command.policy.idle(),
            Self::Verify(_) | Self::Diff(_) => Vec::new(),
        }
    }

    /// Runs the subcommand.
    pub fn run(self) -> Result<Outcome, CliError> {
        match self {
            Self::Record(command) => command.run(),
            Self::Verify(command) => command.run(),
            Self::Diff(command) => command.run(),
        }
    }
}

impl Record {
    fn run(self) -> Result<Outcome, CliError> {
        let (policy, config) = self.policy.choose(&self.model)?;
        let model = Model::new(config)?;
        let factory = policy_factory(&policy, &self.policy.pilot, &model)?;
        let end = record_to(&self.out, &model, &factory, self.episode.seed())?;
        if self.json {
            files::print_json(&end)?;
        } else {
            files::print(&format!("{}: {}\n", self.out.display(), describe(&end)))?;
        }
        Ok(Outcome::Done)
    }
}

/// Records one episode into a file.
pub fn record_to(
    path: &Path,
    model: &Model<'_>,
    factory: &PolicyFactory,
    seed: u64,
) -> Result<End, CliError> {
    files::write_atomically(path, |out| {
        trace::record(model, factory().as_mut(), seed, out)
            .map_err(|error| CliError::trace(path, error))
    })
}

/// Reads a trace from a file.
pub fn read_from(path: &Path) -> Result<Recorded, CliError> {
    let file = open(path, TRACE_BYTES_MAX).map_err(CliError::io(path))?;
    trace::read(file).map_err(|error| CliError::trace(path, error))
}

fn describe(end: &End) -> String {
    format!(
        "{} steps, {} confirmed, {} informed, {}",
        end.steps,
        end.metrics.confirmed,
        end.metrics.informed,
        if end.terminated {
            "terminated"
        } else {
            "truncated"
        }
    )
}

/// The outcome of verifying one trace.
#[derive(Serialize)]
struct Verdict {
    trace: PathBuf,
    reproduced: bool,
    steps: usize,
    recorded_by: String,
    verified_by: &'static str,
    difference: Option<Difference>,
}

impl Verify {
    fn run(self) -> Result<Outcome, CliError> {
        let mut verdicts = Vec::new();
        for path in &self.traces {
            let recorded = read_from(path)?;
            let difference =
                trace::verify(&recorded).map_err(|error| CliError::trace(path, error))?;
            let verdict = Verdict {
                trace: path.clone(),
                reproduced: difference.is_none(),
                steps: recorded.steps.len(),
                recorded_by: recorded.header.core_version,
                verified_by: jcas_core::VERSION,
                difference,
            };
            if !self.json {
                files::print(&verdict.to_text())?;
            }
            verdicts.push(verdict);
        }
        if self.json {
            files::print_json(&verdicts)?;
        }
        Ok(outcome(verdicts.iter().all(|verdict| verdict.reproduced)))
    }
}

impl Verdict {
    fn to_text(&self) -> String {
        let path = self.trace.display();
        match &self.difference {
            None => format!("{path}: reproduced, {} steps\n", self.steps),
            Some(difference) => format!(
                "{path}: differs at {difference} (recorded by {}, replayed by {})\n",
                self.recorded_by, self.verified_by
            ),
        }
    }
}

/// The output of `diff --json`.
#[derive(Serialize)]
struct Comparison {
    equal: bool,
    difference: Option<Difference>,
}

impl Diff {
    fn run(self) -> Result<Outcome, CliError> {
        let difference = trace::diff(&read_from(&self.left)?, &read_from(&self.right)?);
        let equal = difference.is_none();
        if self.json {
            files::print_json(&Comparison { equal, difference })?;
        } else {
            files::print(&match difference {
                None => "equal\n".to_owned(),
                Some(difference) => format!("first difference: {difference}\n"),
            })?;
        }
        Ok(outcome(equal))
    }
}

fn outcome(same: bool) -> Outcome {
    if same {
        Outcome::Done
    } else {
        Outcome::Different
    }
}
