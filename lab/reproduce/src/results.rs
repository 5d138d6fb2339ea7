//! What a reproduction has come to so far.

use crate::curves::Curve;
use crate::scope::Scope;
use crate::table::Table;

/// All that pages are made of.
pub struct Results<'a> {
    /// What was to be done.
    pub scope: &'a Scope,
    /// What was flown.
    pub table: &'a Table,
    /// What was trained with the paper's settings.
    pub curves: &'a [Curve],
}
