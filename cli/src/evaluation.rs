//! A part of an evaluation for another machine, and the merging of all parts.

use std::path::Path;

use jcas_core::{Config, Metrics, Model};
use jcas_episode::campaign::Campaign;
use jcas_episode::shard::Shard;
use jcas_episode::statistics::Summary;
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use crate::commands::simulate::{Report, fly_part};
use crate::error::CliError;
use crate::files;
use crate::learned::PolicyFactory;
use crate::options::ThreadOptions;
use crate::shard::{Build, Head, Manifest, ManifestError, hash_of_policy, require_equal};

/// What an evaluation flies. Its results follow from it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Evaluation {
    /// Folder of a trained policy, or a baseline's name.
    policy: String,
    /// The pilot rule that the report names.
    pilot: String,
    /// How a trained policy turns its outputs into actions.
    mode: String,
    /// Hash of the policy's files.
    policy_files: String,
    episodes: u64,
    seed: u64,
    config: Config,
}

impl Evaluation {
    /// The evaluation of a policy with a pilot rule, in a mode.
    ///
    /// # Errors
    /// A file of the policy cannot be read.
    pub fn new(
        (policy, pilot): (&str, &str),
        mode: &str,
        config: Config,
        campaign: Campaign,
    ) -> Result<Self, CliError> {
        Ok(Self {
            policy: policy.to_owned(),
            pilot: pilot.to_owned(),
            mode: mode.to_owned(),
            policy_files: hash_of_policy(policy)?,
            episodes: campaign.episodes,
            seed: campaign.seed,
            config,
        })
    }

    fn campaign(&self) -> Campaign {
        Campaign {
            episodes: self.episodes,
            seed: self.seed,
        }
    }

    /// The report on all episodes.
    fn report(&self, episodes: &[Metrics]) -> Report<'_> {
        let summary = Summary::of(episodes, self.config.horizon_steps);
        let who = (self.policy.as_str(), self.pilot.as_str());
        Report::new(who, &self.config, self.seed, summary)
    }

    /// Everything that must be the same in all parts, as texts by name.
    fn fields(&self) -> [(&'static str, String); 7] {
        [
            ("policy", self.policy.clone()),
            ("pilot", self.pilot.clone()),
            ("mode", self.mode.clone()),
            ("policy_files", self.policy_files.clone()),
            ("episodes", self.episodes.to_string()),
            ("seed", self.seed.to_string()),
            ("config_hash", format!("0x{:016x}", self.config.hash())),
        ]
    }
}

/// A part on file: what is evaluated, by which build, and the metrics of its episodes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EvaluationPart {
    format: u32,
    build: Build,
    evaluation: Evaluation,
    shard: Shard,
    #[serde(rename = "missions")]
    episodes: Vec<Metrics>,
}

impl EvaluationPart {
    fn episodes_in_all(&self) -> usize {
        self.evaluation.episodes as usize
    }
}

impl Manifest for EvaluationPart {
    const DESCRIBES: &'static str = "an evaluation's shard";
    const FORMAT: u32 = 1;

    fn head(&self) -> Head<'_> {
        Head {
            format: self.format,
            build: &self.build,
            shard: self.shard,
        }
    }

    fn check(&self) -> Result<(), ManifestError> {
        let (shard, count, all) = (self.shard, self.episodes.len(), self.episodes_in_all());
        let needed = shard.cell_count(all);
        if count == needed {
            return Ok(());
        }
        Err(ManifestError::Episodes {
            count,
            needed,
            shard,
            all,
        })
    }

    fn require_same_work(&self, path: &Path, origin: &str, other: &Self) -> Result<(), CliError> {
        let others = other.evaluation.fields();
        for ((name, own), (_, other)) in self.evaluation.fields().iter().zip(&others) {
            let field = format!("other evaluation: {name}");
            require_equal(path, origin, &field, (own, other))?;
        }
        Ok(())
    }
}

/// Flies the episodes of a part and writes them into a folder, unless they are on file.
///
/// # Errors
/// The file is of another evaluation or build and must be kept, the kernel refuses a step, or the
/// file cannot be written.
pub fn fly_shard(
    evaluation: Evaluation,
    shard: Shard,
    factory: &PolicyFactory,
    threads: &ThreadOptions,
    (folder, overwrite): (&Path, bool),
) -> Result<(), CliError> {
    files::prepare_folder(folder)?;
    let path = shard.manifest_path(folder);
    let mut part = EvaluationPart {
        format: EvaluationPart::FORMAT,
        build: Build::current()?,
        evaluation,
        shard,
        episodes: Vec::new(),
    };
    let all = part.episodes_in_all();
    let own = shard.cell_count(all);
    if path.exists() && !overwrite {
        let origin = "this command; give another --out, or --overwrite to replace it";
        EvaluationPart::read(&path)?.require_same(&path, origin, &part)?;
    } else {
        let model = Model::new(part.evaluation.config)?;
        let campaign = part.evaluation.campaign();
        part.episodes = threads.run_episodes(own as u64, || {
            fly_part(&model, campaign, shard, factory, "episodes")
        })??;
        part.write(&path)?;
    }
    files::print(&format!("{}: {own} of {all} episodes\n", path.display()))
}

/// Whether a file says that it is a part of an evaluation. `read` checks the rest.
pub fn is_part(path: &Path) -> bool {
    #[derive(Deserialize)]
    struct Named {
        evaluation: Option<IgnoredAny>,
    }
    let bytes = files::read_bytes(path).unwrap_or_default();
    serde_json::from_slice(&bytes).is_ok_and(|Named { evaluation }| evaluation.is_some())
}

/// The report of all parts, with the bytes of `jcas evaluate --json`, and the number of episodes.
///
/// # Errors
/// The report has no form as JSON.
pub fn merged<P>(parts: Vec<(P, EvaluationPart)>) -> Result<(Vec<u8>, usize), CliError> {
    let evaluation = parts[0].1.evaluation.clone();
    let all = parts[0].1.episodes_in_all();
    let mut episodes = vec![Metrics::default(); all];
    for (_, part) in parts {
        for (episode, metrics) in part.shard.cells(all).zip(part.episodes) {
            episodes[episode] = metrics;
        }
    }
    let text = files::json(&evaluation.report(&episodes))?;
    Ok((text.into_bytes(), all))
}
