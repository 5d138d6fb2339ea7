//! `jcas-lab reproduce`: the paper's figures, made on this machine.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use jcas_cli::error::{CliError, Outcome};
use jcas_cli::options::ThreadOptions;
use jcas_cli::shard::Manifest;
use jcas_cli::{files, interrupt};
use jcas_episode::shard::Shard;
use jcas_reproduce::scope::{Part, Scope};
use jcas_reproduce::shard::{fly_shard, outline, tables};
use jcas_reproduce::{Progress, ProgressSink, publish, reproduce};
use jcas_train::metrics::Row;
use jcas_train::run::Observer;
use jcas_train::settings::Credit;

use super::failed;
use crate::manifest::ReproductionManifest;

const EXAMPLES: &str = "\
Examples:
  jcas-lab reproduce --quick                  minutes; a smaller version of every part
  jcas-lab reproduce --seeds 3 --out paper    the whole grid; hours, and a stopped run continues
  jcas-lab reproduce --paper-hotspots 5       the whole grid, the paper's own training at n = 5 only
  jcas-lab reproduce --only paper --credit team
                                          the paper's own training alone, judged as the paper does
  jcas-lab reproduce --only sensing-range     the sensing range that the paper's two success rates
                                              imply
  jcas-lab reproduce --only comparison,pilot,endurance --policy policies/endurance
                                          plans beside scripts, adaptive pilots, charging
  jcas-lab reproduce --seeds 3 --out paper --shard 2/8
                                          the second of eight machines, whose tables `jcas-lab
                                          merge` joins";

/// A part that can be done by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Only {
    /// Scripted policies over the grid
    Baselines,
    /// Success over the sensing range, and which range fits the paper's numbers
    SensingRange,
    /// The paper's training in each cell
    Paper,
    /// One policy for the whole grid, with our settings or given by --policy
    Tuned,
    /// The paper's training with one thing changed at a time
    Variations,
    /// Scripts, plans and our policies in every cell
    Comparison,
    /// What adapting the pilot density is worth, and where
    Pilot,
    /// Missions that outlast many batteries
    Endurance,
    /// Nothing new: the pages and figures again, from what is there
    Pages,
}

/// The advantage that judges an action.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum WhoseCredit {
    /// The team's
    Team,
    /// Each UAV's own
    Uav,
}

impl From<WhoseCredit> for Credit {
    fn from(whose: WhoseCredit) -> Credit {
        match whose {
            WhoseCredit::Team => Credit::Team,
            WhoseCredit::Uav => Credit::Uav,
        }
    }
}

impl Only {
    fn parts(self) -> &'static [Part] {
        match self {
            Only::Baselines => &[Part::Baselines],
            Only::SensingRange => &[Part::SensingRange, Part::TrainedRanges],
            Only::Paper => &[Part::Paper],
            Only::Tuned => &[Part::Tuned],
            Only::Variations => &[Part::Variations],
            Only::Comparison => &[Part::Comparison],
            Only::Pilot => &[Part::Pilot],
            Only::Endurance => &[Part::Endurance],
            Only::Pages => &[],
        }
    }
}

/// Train, fly and draw the paper's results: CSV, SVG, PNG, one HTML report, claims in Markdown
///
/// Results that are in the folder are not computed again.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Reproduce {
    /// A smaller version of every part, in minutes
    #[arg(long)]
    quick: bool,
    /// Do only these parts, with commas; the pages show all results in the folder
    #[arg(long, value_enum, value_name = "PART", value_delimiter = ',')]
    only: Vec<Only>,
    /// Training seeds
    #[arg(
        long,
        value_name = "K",
        default_value_t = 1,
        value_parser = clap::value_parser!(u64).range(1..=100)
    )]
    seeds: u64,
    /// Folder for results, policies and figures
    #[arg(long, short, value_name = "DIR", default_value = "out/reproduce")]
    out: PathBuf,
    /// Only these fleet sizes, with commas
    #[arg(
        long,
        value_name = "N",
        value_delimiter = ',',
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    uavs: Vec<u32>,
    /// Only these numbers of hotspots, with commas
    #[arg(
        long,
        value_name = "n",
        value_delimiter = ',',
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    hotspots: Vec<u32>,
    /// With the paper's settings, which take a training a cell, only these of them
    #[arg(
        long,
        value_name = "n",
        value_delimiter = ',',
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    paper_hotspots: Vec<u32>,
    /// With the paper's settings, only the training with this credit [default: both]
    #[arg(long, value_enum)]
    credit: Option<WhoseCredit>,
    /// Folder of a trained policy, flown as ours in the missions that it was trained on; may be
    /// repeated
    #[arg(long, value_name = "DIR")]
    policy: Vec<PathBuf>,
    /// Write the page of claims here as well, its pictures into a folder beside it
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
    /// Do only the i-th of n shards and write only its tables; `jcas-lab merge` joins the shards.
    /// A training and all that its policy flies belong to one shard
    #[arg(long, value_name = "i/n", conflicts_with = "page")]
    shard: Option<Shard>,
    #[command(flatten)]
    threads: ThreadOptions,
}

impl Reproduce {
    /// Computes the missing results.
    pub fn run(self) -> Result<Outcome, CliError> {
        let scope = if self.quick {
            Scope::quick(self.seeds)
        } else {
            Scope::full(self.seeds)
        };
        let scope = if self.only.is_empty() {
            scope
        } else {
            scope.parts(
                self.only
                    .iter()
                    .flat_map(|only| only.parts())
                    .copied()
                    .collect(),
            )
        };
        let scope = Scope {
            paper_credit: self.credit.map(Credit::from),
            ..scope.only(&self.uavs, &self.hotspots, &self.paper_hotspots)
        }
        .with(self.policy.clone());
        files::prepare_folder(&self.out)?;
        if let Some(shard) = self.shard {
            return self.run_shard(&scope, shard);
        }
        let progress = self
            .threads
            .run(|| reproduce(&scope, &self.out, &mut ConsoleProgress))?
            .map_err(failed)?;
        if let Some(page) = &self.page {
            publish(&scope, &self.out, page).map_err(failed)?;
        }
        let report = self.out.join("report.html");
        match progress {
            Progress::Finished => {
                files::print(&format!("report: {}\n", report.display()))?;
                Ok(Outcome::Done)
            }
            Progress::Stopped => Err(CliError::Interrupted(format!(
                "stopped; {} shows what there is, the same command goes on",
                report.display()
            ))),
        }
    }

    /// Computes what a shard lacks. Its manifest is on file before, so that rows of another build
    /// are not continued.
    fn run_shard(&self, scope: &Scope, shard: Shard) -> Result<Outcome, CliError> {
        let outline = outline(scope, &self.out).map_err(failed)?;
        let mut manifest = ReproductionManifest::new(shard, &outline)?;
        let path = shard.manifest_path(&self.out);
        if path.exists() {
            let origin = "this command; give another --out";
            ReproductionManifest::read(&path)?.require_same(&path, origin, &manifest)?;
        } else if let Some(table) = tables(shard, &self.out).iter().find(|at| at.exists()) {
            return Err(CliError::file(table, "has no manifest; give another --out"));
        }
        manifest.write(&path)?;
        let flown = self
            .threads
            .run(|| fly_shard(scope, &self.out, shard, &mut ConsoleProgress))?
            .map_err(failed)?;
        let Some(rows) = flown else {
            let path = path.display();
            let what = format!("stopped; {path} is not finished, the same command goes on");
            return Err(CliError::Interrupted(what));
        };
        manifest.rows = Some(rows);
        manifest.write(&path)?;
        files::print(&format!("shard {shard}: {}\n", path.display()))?;
        Ok(Outcome::Done)
    }
}

/// Tells the chapters, and about ten lines of each training.
struct ConsoleProgress;

impl Observer for ConsoleProgress {
    fn iteration(&mut self, row: &Row, total: u64, left_s: f64) {
        if row.iteration.is_multiple_of((total / 10).max(1)) {
            eprintln!(
                "  iteration {} of {total}: success {}, {:.0} steps/s, {left_s:.0} s left",
                row.iteration,
                row.success(),
                row.steps_per_s
            );
        }
    }

    fn stop(&mut self) -> bool {
        interrupt::requested()
    }
}

impl ProgressSink for ConsoleProgress {
    fn chapter(&mut self, title: &str) {
        eprintln!("{title}");
    }
}
