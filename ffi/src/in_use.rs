//! The mark of an object in use: any number of calls read it, or one call changes it.
//!
//! A call that may not use the object is refused before it reads anything but the mark.

use crate::status::{Fault, JCAS_ERROR_BUSY};
use crate::sync::{AtomicU32, Ordering};

/// The number of calls that read an object at present, or [`CHANGING`].
pub(crate) struct InUse(AtomicU32);

/// The value of a mark while a call changes the object.
const CHANGING: u32 = u32::MAX;

/// The right to change an object, until it is dropped.
pub(crate) struct Changing<'a>(&'a InUse);

/// The right to read an object, until it is dropped.
pub(crate) struct Reading<'a>(&'a InUse);

impl InUse {
    pub(crate) fn new() -> Self {
        Self(AtomicU32::new(0))
    }

    /// Marks the object as being changed, unless any call uses it.
    #[inline]
    pub(crate) fn change(&self) -> Result<Changing<'_>, Fault> {
        // Acquire makes the writes of the call that last released the mark visible.
        let marked = (self.0).compare_exchange(0, CHANGING, Ordering::Acquire, Ordering::Relaxed);
        match marked {
            Ok(_) => Ok(Changing(self)),
            Err(_) => Err(Fault::Status(JCAS_ERROR_BUSY)),
        }
    }

    /// Counts another call that reads the object, unless a call changes it.
    #[inline]
    pub(crate) fn read(&self) -> Result<Reading<'_>, Fault> {
        let one_more = |calls: u32| calls.checked_add(1).filter(|&calls| calls != CHANGING);
        let counted = (self.0).fetch_update(Ordering::Acquire, Ordering::Relaxed, one_more);
        match counted {
            Ok(_) => Ok(Reading(self)),
            Err(_) => Err(Fault::Status(JCAS_ERROR_BUSY)),
        }
    }
}

impl Changing<'_> {
    /// Keeps the mark set in an object that is freed.
    pub(crate) fn keep(self) {
        std::mem::forget(self);
    }
}

impl Drop for Changing<'_> {
    #[inline]
    fn drop(&mut self) {
        (self.0.0).store(0, Ordering::Release);
    }
}

impl Drop for Reading<'_> {
    #[inline]
    fn drop(&mut self) {
        (self.0.0).fetch_sub(1, Ordering::Release);
    }
}

#[cfg(all(test, not(loom)))]
mod tests {
    use super::*;

    #[test]
    fn readers_share_an_object_and_a_change_is_alone() {
        let mark = InUse::new();
        let (first, second) = (mark.read().ok(), mark.read().ok());
        assert!(first.is_some() && second.is_some() && mark.change().is_err());
        drop(first);
        assert!(mark.change().is_err());
        drop(second);
        let change = mark.change().ok();
        assert!(change.is_some() && mark.read().is_err() && mark.change().is_err());
        drop(change);
        assert!(mark.read().is_ok());
    }

    #[test]
    fn a_mark_that_is_kept_stays() {
        let mark = InUse::new();
        if let Ok(change) = mark.change() {
            change.keep();
        }
        assert!(mark.read().is_err() && mark.change().is_err());
    }
}
