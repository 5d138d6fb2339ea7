//! Allocation for plans that returns an error when memory runs out.

use core::fmt;
use std::collections::TryReserveError;

use crate::MemoryError;

/// The error of a failed allocation for a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutOfMemory;

impl fmt::Display for OutOfMemory {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("memory for a plan could not be had")
    }
}

impl std::error::Error for OutOfMemory {}

impl From<OutOfMemory> for MemoryError {
    fn from(_: OutOfMemory) -> Self {
        Self::OutOfMemory
    }
}

impl From<TryReserveError> for OutOfMemory {
    fn from(_: TryReserveError) -> Self {
        Self
    }
}

/// Collects the items, with room for as many as their size hint states.
pub(super) fn collect<T>(items: impl Iterator<Item = T>) -> Result<Vec<T>, OutOfMemory> {
    let mut list = Vec::new();
    list.try_reserve(items.size_hint().1.unwrap_or(0))?;
    for item in items {
        push(&mut list, item)?;
    }
    Ok(list)
}

/// Returns a list of `count` equal values.
pub(super) fn filled<T: Clone>(value: T, count: usize) -> Result<Vec<T>, OutOfMemory> {
    let mut list = Vec::new();
    list.try_reserve_exact(count)?;
    list.resize(count, value);
    Ok(list)
}

/// Appends an item.
pub(super) fn push<T>(list: &mut Vec<T>, item: T) -> Result<(), OutOfMemory> {
    list.try_reserve(1)?;
    list.push(item);
    Ok(())
}
