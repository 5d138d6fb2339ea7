//! Numbers that follow from a configuration alone.

pub(crate) mod layout;
