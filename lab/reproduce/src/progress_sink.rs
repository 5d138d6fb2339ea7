//! Receiver of a reproduction's progress, and the outcome of a reproduction.

use jcas_train::run::{NoObserver, Observer};

/// Receives progress during a reproduction, and can stop it.
pub trait ProgressSink: Observer {
    /// Reports the part that begins.
    fn chapter(&mut self, title: &str);
}

impl ProgressSink for NoObserver {
    fn chapter(&mut self, _title: &str) {}
}

/// Whether everything was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// All rows are there.
    Finished,
    /// Stopped when asked; figures and report show what was done.
    Stopped,
}
