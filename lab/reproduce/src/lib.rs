//! Reproduction of the paper: its trainings, campaigns, results and figures.
//!
//! One table, `results.csv`, holds every result. A row that exists is not computed again, so a
//! reproduction resumes where it was stopped. Figures and texts depend only on this table and two
//! small ones: the course of trainings, and the pilot density over the distance.

mod campaign;
mod cell_means;
mod chapter;
pub mod claims;
pub mod comparison;
mod comparison_page;
pub mod curves;
mod endurance;
mod evidence;
pub mod figures;
pub mod fit;
mod flights;
mod one_range;
mod other_readings;
mod page;
mod pilot;
pub mod pilot_by_distance;
mod pilot_comparison;
mod progress_sink;
pub mod range;
pub mod readings;
mod regimes;
pub mod results;
mod returns;
pub mod scan;
pub mod scope;
mod seed_spread;
pub mod shard;
pub mod statistics;
pub mod table;
mod text;
pub mod variation;
pub mod verdict;

use jcas_train::error::TrainError;
use jcas_train::store::write_whole;
pub use progress_sink::{Progress, ProgressSink};
use results::Results;
use scope::Scope;
use std::path::Path;
use table::Table;

/// Name of the table of results.
pub const TABLE: &str = "results.csv";
/// Name of the file that says from which trainer and policies published tables come.
pub const ORIGIN: &str = "origin.md";

/// Computes the missing results, then writes figures and reports of those that exist, also when
/// stopped.
pub fn reproduce(
    scope: &Scope,
    out: &Path,
    narrator: &mut dyn ProgressSink,
) -> Result<Progress, TrainError> {
    std::fs::create_dir_all(out).map_err(TrainError::file(out))?;
    let mut table = Table::open(&out.join(TABLE))?;
    let flown = flights::fly_all(scope, out, &mut table, None, narrator);
    table.write()?;
    let (progress, _) = flown?;
    narrator.chapter("figures and report");
    curves::gather(scope, out)?;
    let results = Results::open(scope, out)?;
    results.write(out)?;
    write_whole(&out.join("results.md"), results.markdown("").as_bytes())?;
    Ok(progress)
}

/// Writes the page of a reproduction to `page`, and its pictures and tables into a folder beside
/// it. A reproduction can make the same page from these tables.
pub fn publish(scope: &Scope, out: &Path, page: &Path) -> Result<(), TrainError> {
    let results = Results::open(scope, out)?;
    let folder = page.with_extension("");
    std::fs::create_dir_all(&folder).map_err(TrainError::file(&folder))?;
    let pictures = results.pictures_on_page().into_iter();
    let pictures = pictures.map(|name| format!("{name}.png"));
    for name in pictures.chain(tables(scope, out)) {
        let from = out.join(&name);
        let bytes = std::fs::read(&from).map_err(TrainError::file(&from))?;
        write_whole(&folder.join(&name), &bytes)?;
    }
    let beside = folder.file_name().unwrap_or_default().to_string_lossy();
    let text = results.markdown(&format!("{beside}/"));
    write_whole(page, text.as_bytes())
}

/// Tables in a reproduction's folder from which its page is made.
fn tables(scope: &Scope, out: &Path) -> Vec<String> {
    let approaches = pilot_by_distance::tables(scope, out).into_iter();
    let approaches = approaches.map(|(policy, seed, _)| pilot_by_distance::table(policy, seed));
    let names = [
        TABLE,
        comparison::COMPARISON,
        curves::TRAININGS,
        ORIGIN,
        scan::TRAININGS,
    ];
    let names = names.into_iter().chain(scan::TABLES).map(str::to_owned);
    let all = names.chain(approaches);
    all.filter(|name| out.join(name).exists()).collect()
}
