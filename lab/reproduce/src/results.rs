//! What a reproduction has come to so far.

use crate::comparison;
use crate::curves::{Curve, curves};
use crate::pilot_by_distance::{Approach, approaches};
use crate::scan::Scan;
use crate::scope::Scope;
use crate::table::Table;
use crate::{ORIGIN, TABLE};
use jcas_train::error::TrainError;
use std::path::Path;

/// All that pages are made of.
pub struct Results<'a> {
    /// What was to be done.
    pub scope: &'a Scope,
    /// What was flown.
    pub table: Table,
    /// What flew the same missions.
    pub comparison: Vec<comparison::ComparedRow>,
    /// What was trained with the paper's settings.
    pub curves: Vec<Curve>,
    /// What pilot density our policies hold at which distance.
    pub approach: Vec<Approach>,
    /// What the scan of the sensing range has come to.
    pub scan: Scan,
    /// Where the tables come from, if a file says so.
    pub origin: Option<String>,
}

impl<'a> Results<'a> {
    /// Reads the tables of a folder.
    pub fn open(scope: &'a Scope, out: &Path) -> Result<Self, TrainError> {
        Ok(Results {
            scope,
            table: Table::open(&out.join(TABLE))?,
            comparison: comparison::open(out)?,
            curves: curves(scope, out)?,
            approach: approaches(scope, out)?,
            scan: Scan::open(out)?,
            origin: std::fs::read_to_string(out.join(ORIGIN)).ok(),
        })
    }
}
