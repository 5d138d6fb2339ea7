//! The paper's figures again, on this machine: what to fly and train, its results, its pictures.
//!
//! Everything is kept in one table, `results.csv`, whose rows are flown once; what is there already
//! is not flown again, so a reproduction goes on where it was stopped. Figures and texts are made
//! from the table alone.

mod approach;
pub mod bars;
mod chapter;
pub mod claims;
pub mod curves;
mod endurance;
pub mod figures;
pub mod fit;
mod flight;
mod flights;
mod narrator;
mod page;
mod pilot;
pub mod plan;
pub mod range;
mod regimes;
pub mod results;
mod search;
pub mod table;
mod text;
mod worth;

use jcas_train::error::TrainError;
use jcas_train::store::write_whole;
pub use narrator::{Narrator, Progress};
use plan::Scale;
use results::Results;
use std::path::Path;
use table::Table;

/// Name of the table of results.
pub const TABLE: &str = "results.csv";

/// Trains and flies whatever is missing, then draws and writes what is there, also when stopped.
pub fn reproduce(
    scale: &Scale,
    out: &Path,
    narrator: &mut dyn Narrator,
) -> Result<Progress, TrainError> {
    std::fs::create_dir_all(out).map_err(TrainError::file(out))?;
    let mut table = Table::open(&out.join(TABLE))?;
    let progress = flights::fly_all(scale, out, &mut table, narrator)?;
    narrator.chapter("figures and report");
    let curves = curves::curves(scale, out)?;
    let results = Results {
        scale,
        table: &table,
        curves: &curves,
    };
    results.write(out)?;
    write_whole(&out.join("results.md"), results.markdown("").as_bytes())?;
    Ok(progress)
}

/// Writes the page of a reproduction to a place of its own, its pictures and its table into a folder beside it.
pub fn publish(scale: &Scale, out: &Path, page: &Path) -> Result<(), TrainError> {
    let csv = out.join(TABLE);
    let table = Table::open(&csv)?;
    let curves = curves::curves(scale, out)?;
    let results = Results {
        scale,
        table: &table,
        curves: &curves,
    };
    let folder = page.with_extension("");
    std::fs::create_dir_all(&folder).map_err(TrainError::file(&folder))?;
    for name in results.pictures_on_page() {
        let picture = out.join(format!("{name}.png"));
        let bytes = std::fs::read(&picture).map_err(TrainError::file(&picture))?;
        write_whole(&folder.join(format!("{name}.png")), &bytes)?;
    }
    let rows = std::fs::read(&csv).map_err(TrainError::file(&csv))?;
    write_whole(&folder.join(TABLE), &rows)?;
    let beside = folder.file_name().unwrap_or_default().to_string_lossy();
    let text = results.markdown(&format!("{beside}/"));
    write_whole(page, text.as_bytes())
}
