//! One file for each command.

use jcas_cli::error::CliError;
use jcas_train::error::TrainError;

pub mod train;

/// The command's error for an error of training.
fn failed(error: TrainError) -> CliError {
    match error {
        TrainError::File(path, error) => CliError::Io(path, error),
        other => CliError::input(other),
    }
}
