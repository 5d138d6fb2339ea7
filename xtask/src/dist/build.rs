//! Builds what is served for a platform, by Cargo with the linker of that platform.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::targets::{System, Target};
use crate::error::Error;
use crate::paths::{absolute, without_paths};

/// The name under which a program looks for the shared library. Below 1.0 a new minor version
/// may change the interface, so the name has both numbers.
pub const SONAME: &str = concat!(
    "libjcas.so.",
    env!("CARGO_PKG_VERSION_MAJOR"),
    ".",
    env!("CARGO_PKG_VERSION_MINOR")
);

/// Builds the libraries and the command, and returns the folder that holds them.
pub fn build(target: &Target, epoch: u32) -> Result<PathBuf, Error> {
    let folder = folder()?;
    let flags = flags(target, &folder)?.join("\u{1f}");
    let cargo = |program: &str, subcommand: &str| {
        let mut command = Command::new(program);
        command
            .args([subcommand, "--locked", "--profile", "dist", "--target"])
            .arg(target.with_libc())
            .arg("--target-dir")
            .arg(&folder)
            .env("CARGO_ENCODED_RUSTFLAGS", &flags)
            .env("SOURCE_DATE_EPOCH", epoch.to_string())
            // It would be preferred to Zig, and link against the C library of this machine.
            .env_remove(linker_variable(target));
        command
    };
    // Zig brings the old C library. The linker mingw-w64 is found without help.
    let (program, subcommand) = match target.system {
        System::Linux => ("cargo-zigbuild", "zigbuild"),
        System::Windows => ("cargo", "build"),
    };
    execute(cargo(program, subcommand).args(["--package", "jcas-fmi", "--package", "jcas-cli"]))?;
    // Alone, since other packages switch features on that the library does not need.
    let mut library = cargo(program, "rustc");
    library.args(["--package", "jcas-ffi", "--lib"]);
    if target.system == System::Linux {
        library.args(["--", "-C", &format!("link-arg=-Wl,-soname,{SONAME}")]);
    }
    execute(&mut library)?;
    Ok(folder.join(target.triple).join("dist"))
}

/// The variable by which Cargo takes another linker.
fn linker_variable(target: &Target) -> String {
    let name = target.triple.to_uppercase().replace('-', "_");
    format!("CARGO_TARGET_{name}_LINKER")
}

/// Options of the compiler that keep the paths of this machine and the time out of the binaries.
fn flags(target: &Target, folder: &Path) -> Result<Vec<String>, Error> {
    let mut flags = without_paths(folder)?;
    if target.system == System::Windows {
        flags.push("-Clink-arg=-Wl,--no-insert-timestamp".to_owned());
    }
    Ok(flags)
}

/// Runs a command to its end, which must be a success.
pub fn execute(command: &mut Command) -> Result<(), Error> {
    let program = command.get_program().display().to_string();
    let status = command
        .status()
        .map_err(|source| Error::StartDist { program, source })?;
    if status.success() {
        return Ok(());
    }
    Err(Error::failed(command, status))
}

/// The folder that Cargo builds in, an absolute path.
pub fn folder() -> Result<PathBuf, Error> {
    let target = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into());
    Ok(absolute(Path::new(&target))?.join("served"))
}
