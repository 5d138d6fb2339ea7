//! `jcas replay`: writes a page that plays an episode.

use std::path::{Path, PathBuf};

use clap::Args;
use jcas_core::Model;
use jcas_episode::files::{TRACE_BYTES_MAX, read_text};
use jcas_episode::{replay, trace};

use super::trace::read_from;
use crate::error::{CliError, Outcome};
use crate::files;
use crate::idle::Idle;
use crate::learned::PolicyFactory;
use crate::options::{EpisodeOptions, ModelOptions, PolicyOptions, policy_factory};

const EXAMPLES: &str = "\
Examples:
  jcas replay -o page.html
  jcas replay flight.jsonl -o page.html
  jcas replay --uavs 20 --hotspots 11 --policy teams --seed 7 --episode 3 -o page.html";

/// Write one self-contained HTML page that plays an episode
///
/// Plays the given trace. Without a trace, the command runs an episode with the options below.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Replay {
    /// Trace to play
    #[arg(value_name = "TRACE")]
    trace: Option<PathBuf>,
    /// Page to write
    #[arg(short, long, value_name = "FILE", default_value = "replay.html")]
    out: PathBuf,
    #[command(flatten)]
    model: ModelOptions,
    #[command(flatten)]
    policy: PolicyOptions,
    #[command(flatten)]
    episode: EpisodeOptions,
}

impl Replay {
    /// A trace holds its own configuration, actions and seed.
    pub fn idle(&self) -> Vec<Idle> {
        const APPLIES: &str = "without TRACE, which is played as it was recorded";
        match self.trace {
            Some(_) => vec![
                Idle::group::<ModelOptions>(APPLIES),
                Idle::group::<PolicyOptions>(APPLIES),
                Idle::group::<EpisodeOptions>(APPLIES),
            ],
            None => self.policy.idle(),
        }
    }

    /// Writes the page.
    pub fn run(self) -> Result<Outcome, CliError> {
        match &self.trace {
            Some(path) => {
                // The strict reader runs first, since its messages name what is wrong with the
                // file.
                read_from(path)?;
                let text = read_text(path, TRACE_BYTES_MAX).map_err(CliError::io(path))?;
                write_page(&self.out, &text)?;
            }
            None => {
                let (policy, config) = self.policy.choose(&self.model)?;
                let model = Model::new(config)?;
                let factory = policy_factory(&policy, &self.policy.pilot, &model)?;
                fly_page(&self.out, &model, &factory, self.episode.seed())?;
            }
        }
        files::print(&format!("{}\n", self.out.display()))?;
        Ok(Outcome::Done)
    }
}

/// Runs an episode and writes its page.
pub fn fly_page(
    path: &Path,
    model: &Model<'_>,
    factory: &PolicyFactory,
    seed: u64,
) -> Result<(), CliError> {
    let mut text = Vec::new();
    trace::record(model, factory().as_mut(), seed, &mut text)
        .map_err(|error| CliError::trace(path, error))?;
    write_page(path, &String::from_utf8_lossy(&text))
}

fn write_page(path: &Path, trace: &str) -> Result<(), CliError> {
    let page = replay::page(trace).map_err(CliError::input)?;
    files::write_bytes(path, page.as_bytes())
}
