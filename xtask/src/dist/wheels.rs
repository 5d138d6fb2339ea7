//! Python's wheels around libraries that are built already, and the source distribution.

use std::path::Path;
use std::process::Command;

use super::build::execute;
use super::targets::{System, Target};
use crate::error::Error;

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Writes the wheel of a platform into the folder, an absolute path, and returns its name.
pub fn wheel(target: &Target, built: &Path, into: &Path, epoch: u32) -> Result<String, Error> {
    let library = built.join(match target.system {
        System::Linux => "libjcas.so",
        System::Windows => "jcas.dll",
    });
    let mut command = hatchling("wheel", into, epoch);
    command
        .env("JCAS_WHEEL_LIBRARY", library)
        .env("JCAS_WHEEL_PLATFORM", target.wheel);
    execute(&mut command)?;
    Ok(format!("jcas-{VERSION}-py3-none-{}.whl", target.wheel))
}

/// Writes the source distribution, which takes the library's crates along, into the folder, and
/// returns its name.
pub fn sdist(into: &Path, epoch: u32) -> Result<String, Error> {
    execute(&mut hatchling("sdist", into, epoch))?;
    Ok(format!("jcas-{VERSION}.tar.gz"))
}

/// The build backend without the isolation of a front end, which would fetch it once more.
fn hatchling(what: &str, into: &Path, epoch: u32) -> Command {
    let mut command = Command::new("python3");
    command
        .args(["-m", "hatchling", "build", "--target", what, "--directory"])
        .arg(into)
        .current_dir("python")
        .env("SOURCE_DATE_EPOCH", epoch.to_string());
    command
}
