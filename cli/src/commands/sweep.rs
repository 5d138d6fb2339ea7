//! `jcas sweep`: runs episodes over a grid of settings.

use std::path::{Path, PathBuf};

use clap::Args;
use comfy_table::presets::UTF8_FULL_CONDENSED;
use comfy_table::{CellAlignment, Table};
use jcas_core::{Model, TargetVisibility};
use jcas_episode::campaign::Campaign;
use jcas_episode::shard::Shard;
use jcas_episode::statistics::{Estimate, FALSE_CONFIRMATIONS, Summary};
use jcas_policy::BaselineKind;
use serde::Serialize;

use super::replay::fly_page;
use crate::command_line::command_line;
use crate::config_source::ConfigSource;
use crate::error::{CliError, Outcome};
use crate::options::{ConfigOptions, DEFAULT_PILOT, ThreadOptions, policy_factory};
use crate::sweep::plan::{self, Axis, SweepCell};
use crate::sweep::store::{Frame, Store};
use crate::sweep::{self, charts, shard};
use crate::{files, learned, numbers};

const EXAMPLES: &str = "\
Examples:
  jcas sweep
  jcas sweep --policy greedy,teams,squads --pilot max,adaptive --hotspots 7 --out baselines
  jcas sweep --preset search --hotspots 3,7,11 --out searchers
  jcas sweep --uavs 10 --hotspots 5,11 --pilot 0.01,0.1,0.2,0.3 --out pilot
  jcas sweep --uavs 4,6,8 --vary battery_capacity_kwh=0.02,0.05,0.2 --episodes 500 --out battery
  jcas sweep --episodes 5000 --out parts --shard 2/8

Every option with a list flies every combination. Ctrl-C keeps the finished cells; the same \
command goes on with the others.";

/// Run every combination of the listed values; write a table, figures and a replay page
///
/// Without options, the sweep covers the paper's grid of fleets and hotspots with the best
/// baseline. It writes into the folder of --out. results.csv holds every quantity with its 95 %
/// interval. Figures show success, mission time, energy and throughput, as SVG and PNG. replay.html
/// plays one of the episodes. An interrupted sweep goes on where its table ends. The table of
/// another sweep, or of other policies under the same names, is refused.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Sweep {
    #[command(flatten)]
    config: ConfigOptions,
    /// Numbers of UAVs
    #[arg(
        long,
        value_name = "N,N",
        value_delimiter = ',',
        default_values_t = [5, 10, 15, 20],
        value_parser = numbers::uavs,
        allow_hyphen_values = true,
        help_heading = "Lists"
    )]
    uavs: Vec<u32>,
    /// Numbers of hotspots
    #[arg(
        long,
        value_name = "n,n",
        value_delimiter = ',',
        default_values_t = [3, 5, 7, 9, 11],
        value_parser = numbers::hotspots,
        allow_hyphen_values = true,
        help_heading = "Lists"
    )]
    hotspots: Vec<u32>,
    /// Policies (`jcas policies` lists them). The default is teams, or every searching baseline
    /// where hotspots are hidden
    #[arg(
        long,
        value_name = "POLICY,POLICY",
        value_delimiter = ',',
        help_heading = "Lists"
    )]
    policy: Vec<String>,
    /// Pilot densities: numbers such as 0.15, min, mid, max or adaptive; adaptive uses a trained
    /// policy's own density
    #[arg(
        long,
        value_name = "MODE,MODE",
        value_delimiter = ',',
        default_value = DEFAULT_PILOT,
        allow_hyphen_values = true,
        help_heading = "Lists"
    )]
    pilot: Vec<String>,
    /// Values of any field; may be repeated
    #[arg(long, value_name = "FIELD=VALUE,VALUE", help_heading = "Lists")]
    vary: Vec<String>,
    /// Episodes in each cell
    #[arg(long, value_name = "M", default_value_t = 300, value_parser = numbers::above_zero)]
    episodes: u64,
    /// Seed; every cell uses the same seeds of episodes
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = numbers::whole)]
    seed: u64,
    /// Folder for the results
    #[arg(short, long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Replace the results of another sweep in that folder
    #[arg(long)]
    overwrite: bool,
    /// Write only the table
    #[arg(long)]
    no_figures: bool,
    /// Run only the i-th of n parts and write only its table; `jcas merge` joins the parts
    #[arg(long, value_name = "i/n")]
    shard: Option<Shard>,
    #[command(flatten)]
    threads: ThreadOptions,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Sweep {
    /// Runs the cells that are not on file yet and writes all outputs.
    pub fn run(self) -> Result<Outcome, CliError> {
        let base = self.config.source()?;
        let axes = self.axes(&self.policies(&base)?)?;
        self.say_what_cards_do_not(&base, &axes)?;
        let cells = plan::cells(&base, &axes)?;
        files::prepare_folder(&self.out)?;
        let frame = Frame::new(&axes, &cells, self.seed, self.episodes)?;
        let (cells, mut store) = match self.shard {
            Some(part) => shard::open(part, &self.out, cells, frame, self.overwrite)?,
            None => {
                let table = self.out.join("results.csv");
                (cells, Store::open(&table, frame, self.overwrite)?)
            }
        };
        sweep::fly(&cells, &mut store, self.campaign(), &self.threads)?;

        let mut written = vec![store.path().to_owned()];
        if let Some(shard) = self.shard {
            written.push(shard.manifest_path(&self.out));
        } else if !self.no_figures {
            written.extend(charts::draw(
                &self.out,
                &axes,
                &cells,
                &store,
                self.episodes,
            )?);
            let page = self.out.join("replay.html");
            self.replay(&cells, &page)?;
            written.push(page);
        }
        if self.json {
            files::print_json(&report(&base, &axes, &cells, &store, &written))?;
        } else {
            let list: Vec<String> = written
                .iter()
                .map(|path| format!("  {}\n", path.display()))
                .collect();
            files::print(&format!(
                "{}\n{} episodes a cell; {INTERVALS}\nConfiguration {}: {}, with the lists \
                 above; each cell's hash is in the table.\nCommand: {}\n\nwritten:\n{}",
                text_table(&axes, &cells, &store),
                self.episodes,
                base.hash(),
                base.nearest_preset(),
                command_line(),
                list.concat()
            ))?;
        }
        Ok(Outcome::Done)
    }

    /// Every policy of a sweep runs the same episodes, even if it was trained on others.
    fn say_what_cards_do_not(&self, base: &ConfigSource, axes: &[Axis]) -> Result<(), CliError> {
        for policy in self.policy.iter().filter(|name| learned::is_policy(name)) {
            let trained_on = ConfigSource::of(&learned::card(Path::new(policy))?.config);
            let mut changes = base.changes_from(&trained_on);
            changes.retain(|(field, _)| !axes.iter().any(|axis| axis.name == *field));
            learned::say_changes(policy, &changes);
        }
        Ok(())
    }

    /// The requested policies, or by default those that suit the episode.
    fn policies(&self, base: &ConfigSource) -> Result<Vec<String>, CliError> {
        if !self.policy.is_empty() {
            return Ok(self.policy.clone());
        }
        let config = base.resolve()?;
        if config.target_visibility == TargetVisibility::Known {
            return Ok(vec![BaselineKind::default_for(&config).name().to_owned()]);
        }
        let searchers = BaselineKind::ALL
            .iter()
            .filter(|kind| !kind.reads_positions())
            .filter(|kind| config.report_levels > 0 || !kind.reads_reports());
        Ok(searchers.map(|kind| kind.name().to_owned()).collect())
    }

    fn axes(&self, policies: &[String]) -> Result<Vec<Axis>, CliError> {
        let mut axes = vec![
            Axis::new("policy", policies),
            Axis::new("pilot", &self.pilot),
            Axis::new("uav_count", &self.uavs),
            Axis::new("hotspot_count", &self.hotspots),
        ];
        for list in &self.vary {
            let axis = Axis::parse(list)?;
            let own = [("uav_count", "uavs"), ("hotspot_count", "hotspots")];
            if let Some((_, option)) = own.iter().find(|(field, _)| *field == axis.name) {
                let values = axis.values.join(",");
                return Err(CliError::input(format!(
                    "--vary {list}: must be given as --{option} {values}"
                )));
            }
            axes.push(axis);
        }
        Ok(axes)
    }

    /// Writes a page that plays the first episode of the last cell, in most sweeps the largest.
    fn replay(&self, cells: &[SweepCell], path: &std::path::Path) -> Result<(), CliError> {
        let Some(cell) = cells.last() else {
            return Ok(());
        };
        let model = Model::new(cell.config)?;
        let factory = policy_factory(&cell.policy, &cell.pilot, &model)?;
        fly_page(path, &model, &factory, self.campaign().episode_seed(0))
    }

    fn campaign(&self) -> Campaign {
        Campaign {
            episodes: self.episodes,
            seed: self.seed,
        }
    }
}

/// Columns of the printed table: name in the file, title, decimals.
pub(super) const SHOWN: [(&str, &str, usize); 5] = [
    ("success_rate", "success", 3),
    ("mission_steps_mean", "steps", 1),
    ("energy_kwh_mean", "energy kWh", 3),
    ("co2_kg_mean", "CO2 kg", 4),
    ("throughput_mean", "throughput", 2),
];

/// Lists with one value stand above the table; the other lists are its columns.
pub(super) fn text_table(axes: &[Axis], cells: &[SweepCell], store: &Store) -> String {
    let (columns, common): (Vec<usize>, Vec<usize>) =
        (0..axes.len()).partition(|&axis| axes[axis].values.len() > 1);
    let common: Vec<String> = common
        .into_iter()
        .map(|axis| format!("{} {}", title(&axes[axis].name), axes[axis].values[0]))
        .collect();
    let mut table = Table::new();
    table.load_preset(UTF8_FULL_CONDENSED);
    let names = columns.iter().map(|&axis| title(&axes[axis].name));
    let alarming = |index: usize| {
        let estimate = store.estimate(index, FALSE_CONFIRMATIONS);
        estimate.is_some_and(|estimate| estimate != Estimate::default())
    };
    let alarms = (0..cells.len()).any(alarming);
    let falsely = alarms.then_some((FALSE_CONFIRMATIONS, "false", 2));
    let quantities: Vec<_> = SHOWN.into_iter().chain(falsely).collect();
    table.set_header(names.chain(quantities.iter().map(|&(_, title, _)| title)));
    for (index, cell) in cells.iter().enumerate() {
        let values = columns.iter().map(|&axis| cell.values[axis].clone());
        let estimates = quantities.iter().map(|&(name, _, digits)| {
            let estimate = store.estimate(index, name);
            estimate.map_or_else(String::new, |estimate| shown(name, estimate, digits))
        });
        table.add_row(values.chain(estimates));
    }
    for column in table.column_iter_mut() {
        column.set_cell_alignment(CellAlignment::Right);
    }
    format!("{}\n{table}\n", common.join(", "))
}

/// Label of an axis.
pub(super) fn title(axis: &str) -> &str {
    match axis {
        "uav_count" => "UAVs",
        "hotspot_count" => "hotspots",
        field => field,
    }
}

/// What the intervals of a table are.
pub(super) const INTERVALS: &str = "95 % intervals, [low, high] or ± half the width; an episode \
                                    without success counts with its horizon";

/// Formats a value with its interval. A share has both bounds, because its interval is not
/// symmetric and ends at 1. A mean has half the width; the file has both ends.
pub(super) fn shown(quantity: &str, estimate: Estimate, digits: usize) -> String {
    let Estimate { value, low, high } = estimate;
    if quantity == "success_rate" {
        return format!("{value:.digits$} [{low:.digits$}, {high:.digits$}]");
    }
    let half = (high - low) / 2.0;
    format!("{value:.digits$} ± {half:.digits$}")
}

/// The output of `--json`.
#[derive(Serialize)]
struct Report {
    /// The preset next to the configuration before the lists, and what differs from it.
    preset: String,
    config_hash: String,
    cells: Vec<serde_json::Map<String, serde_json::Value>>,
    written: Vec<PathBuf>,
}

fn report(
    base: &ConfigSource,
    axes: &[Axis],
    cells: &[SweepCell],
    store: &Store,
    written: &[PathBuf],
) -> Report {
    let cells = cells
        .iter()
        .enumerate()
        .map(|(index, cell)| {
            let mut object = serde_json::Map::new();
            for (axis, value) in axes.iter().zip(&cell.values) {
                object.insert(axis.name.clone(), value.as_str().into());
            }
            for quantity in Summary::of(&[], 0).quantities() {
                if let Some(e) = store.estimate(index, quantity.name) {
                    object.insert(quantity.name.to_owned(), e.value.into());
                    object.insert(format!("{}_low", quantity.name), e.low.into());
                    object.insert(format!("{}_high", quantity.name), e.high.into());
                }
            }
            object
        })
        .collect();
    Report {
        preset: base.nearest_preset(),
        config_hash: base.hash(),
        cells,
        written: written.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // The Wilson interval of 200 successes in 200 episodes, and the mean steps of some.
    #[test]
    fn a_share_is_shown_with_both_bounds_and_a_mean_with_half_the_width() {
        let estimate = |[value, low, high]: [f64; 3]| Estimate { value, low, high };
        let share = estimate([1.0, 0.9812, 1.0]);
        assert_eq!(shown("success_rate", share, 3), "1.000 [0.981, 1.000]");
        let mean = estimate([16.0, 15.5, 16.5]);
        assert_eq!(shown("mission_steps_mean", mean, 1), "16.0 ± 0.5");
    }
}
