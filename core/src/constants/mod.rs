//! Numbers that follow from a configuration alone.

pub(crate) mod carbon;
pub(crate) mod energy;
pub(crate) mod layout;
mod ledgers;
pub(crate) mod observation;
pub(crate) mod reward;
