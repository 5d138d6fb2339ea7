//! Campaigns over a grid of settings: cells, results on file, and figures.

pub mod charts;
pub mod plan;
pub mod shard;
pub mod store;

use jcas_core::Model;
use jcas_episode::campaign::{self, Campaign};
use jcas_episode::statistics::Summary;

use crate::error::CliError;
use crate::options::{ThreadOptions, policy_factory};
use crate::{interrupt, progress};
use plan::SweepCell;
use store::Store;

/// Runs the cells that are not in the store, one after the other, with the episodes of a cell on
/// all cores. After Ctrl-C, the finished cells are on file.
pub fn fly(
    cells: &[SweepCell],
    store: &mut Store,
    campaign: Campaign,
    threads: &ThreadOptions,
) -> Result<(), CliError> {
    let bar = progress::bar(cells.len() as u64 * campaign.episodes, "episodes");
    bar.inc(store.len() as u64 * campaign.episodes);
    bar.reset_eta();
    let ran = threads.run_episodes(campaign.episodes, || {
        for (index, cell) in cells.iter().enumerate() {
            if store.has(index) {
                continue;
            }
            let summary = fly_cell(cell, campaign, &bar)?;
            store.add(index, &summary)?;
        }
        Ok(())
    })?;
    bar.finish_and_clear();
    store.write()?;
    match ran {
        Err(CliError::Interrupted(_)) => Err(CliError::Interrupted(format!(
            "interrupted: {} of {} cells are in {}; the same command goes on from there",
            store.len(),
            cells.len(),
            store.path().display()
        ))),
        other => other,
    }
}

fn fly_cell(
    cell: &SweepCell,
    campaign: Campaign,
    bar: &indicatif::ProgressBar,
) -> Result<Summary, CliError> {
    let model = Model::new(cell.config)?;
    let factory = policy_factory(&cell.policy, &cell.pilot, &model)?;
    let episodes = campaign::fly(&model, campaign, &factory, &|| {
        bar.inc(1);
        interrupt::check()
    })?;
    Ok(Summary::of(&episodes, cell.config.horizon_steps))
}
