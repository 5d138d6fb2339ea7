//! The platforms that are served with binaries.

use crate::error::Error;

/// The oldest C library that the Linux binaries run on, that of manylinux2014.
const GLIBC: &str = "2.17";

/// A platform, under the names that Rust, archives, wheels and FMI give it.
#[derive(Debug, PartialEq)]
pub struct Target {
    /// Rust's target triple.
    pub triple: &'static str,
    /// The end of an archive's name, and the platform in the FMI standard.
    pub name: &'static str,
    /// The platform's tag of a wheel.
    pub wheel: &'static str,
    pub system: System,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum System {
    Linux,
    Windows,
}

pub const TARGETS: [Target; 3] = [
    Target {
        triple: "x86_64-unknown-linux-gnu",
        name: "x86_64-linux",
        wheel: "manylinux2014_x86_64",
        system: System::Linux,
    },
    Target {
        triple: "aarch64-unknown-linux-gnu",
        name: "aarch64-linux",
        wheel: "manylinux2014_aarch64",
        system: System::Linux,
    },
    Target {
        triple: "x86_64-pc-windows-gnu",
        name: "x86_64-windows",
        wheel: "win_amd64",
        system: System::Windows,
    },
];

impl Target {
    /// The target of this triple, or an error with all triples.
    pub fn find(triple: &str) -> Result<&'static Target, Error> {
        let found = TARGETS.iter().find(|target| target.triple == triple);
        found.ok_or_else(|| {
            let allowed = TARGETS.map(|target| target.triple).join(", ");
            let triple = triple.to_owned();
            Error::UnknownTarget { triple, allowed }
        })
    }

    /// The triple as cargo-zigbuild takes it, with the version of the C library.
    pub fn with_libc(&self) -> String {
        match self.system {
            System::Linux => format!("{}.{GLIBC}", self.triple),
            System::Windows => self.triple.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_target_is_refused_with_the_known_ones() {
        let refused = Target::find("riscv64gc-unknown-linux-gnu").unwrap_err();
        let said = refused.to_string();
        assert!(said.contains("riscv64gc") && said.contains("aarch64-unknown-linux-gnu"));
        assert_eq!(Target::find("x86_64-pc-windows-gnu").unwrap(), &TARGETS[2]);
    }
}
