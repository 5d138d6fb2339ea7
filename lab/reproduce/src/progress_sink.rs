//! Who is told how a reproduction goes, and how it ended.

use jcas_train::run::Observer;

/// What is told while it runs; also how it is stopped.
pub trait ProgressSink: Observer {
    /// What begins now.
    fn chapter(&mut self, title: &str);
}

/// Whether everything was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// All rows are there.
    Finished,
    /// Stopped when asked; figures and report show what was done.
    Stopped,
}
