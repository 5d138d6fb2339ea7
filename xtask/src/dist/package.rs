//! The archive of a platform: what its user unpacks and compiles against, without Rust.

use std::path::Path;

use super::archive::{Content, Tree};
use super::build::SONAME;
use super::targets::{System, Target};
use crate::error::Error;
use crate::fmu::Binary;

const VERSION: &str = env!("CARGO_PKG_VERSION");

const TEXTS: [(&str, &str); 7] = [
    ("include/jcas.h", include_str!("../../../include/jcas.h")),
    (
        "include/jcas_dl.h",
        include_str!("../../../include/jcas_dl.h"),
    ),
    (
        "include/jcas.hpp",
        include_str!("../../../include/jcas.hpp"),
    ),
    (
        "lib/cmake/jcas/jcas-config.cmake",
        include_str!("../../../cmake/jcas-config.cmake"),
    ),
    (
        "lib/cmake/jcas/jcas-config-version.cmake",
        include_str!("../../../cmake/jcas-config-version.cmake"),
    ),
    (
        "share/licenses/jcas/LICENSE-APACHE",
        include_str!("../../../LICENSE-APACHE"),
    ),
    (
        "share/licenses/jcas/LICENSE-MIT",
        include_str!("../../../LICENSE-MIT"),
    ),
];

const PKG_CONFIG: &str = include_str!("../../../cmake/jcas.pc.in");

/// What the platform's archive holds, from the folder that its build wrote.
pub fn tree(target: &Target, built: &Path) -> Result<Tree, Error> {
    let mut tree =
        Tree::from_iter(TEXTS.map(|(path, text)| (path.to_owned(), Content::file(text))));
    let pkg_config = Content::file(pkg_config(target.system));
    tree.insert("lib/pkgconfig/jcas.pc".to_owned(), pkg_config);
    for (path, built_name, executable) in binaries(target.system) {
        let bytes = read(&built.join(built_name))?;
        tree.insert(path, Content::File { bytes, executable });
    }
    if target.system == System::Linux {
        let full = format!("libjcas.so.{VERSION}");
        tree.insert(format!("lib/{SONAME}"), Content::Link(full));
        tree.insert(
            "lib/libjcas.so".to_owned(),
            Content::Link(SONAME.to_owned()),
        );
    }
    Ok(tree)
}

/// The platform's library in the FMU.
pub fn unit_binary(target: &Target, built: &Path) -> Result<Binary, Error> {
    let (file, extension) = match target.system {
        System::Linux => ("libjcas_fmi.so", "so"),
        System::Windows => ("jcas_fmi.dll", "dll"),
    };
    let platform = target.name.to_owned();
    let library = read(&built.join(file))?;
    Ok(Binary {
        platform,
        extension,
        library,
    })
}

fn read(file: &Path) -> Result<Vec<u8>, Error> {
    std::fs::read(file).map_err(Error::file(file))
}

/// The path in the archive, the name that Cargo gives, and whether the file is executable.
fn binaries(system: System) -> Vec<(String, &'static str, bool)> {
    match system {
        System::Linux => vec![
            ("bin/jcas".to_owned(), "jcas", true),
            (format!("lib/libjcas.so.{VERSION}"), "libjcas.so", true),
            ("lib/libjcas.a".to_owned(), "libjcas.a", false),
        ],
        System::Windows => vec![
            ("bin/jcas.exe".to_owned(), "jcas.exe", true),
            ("bin/jcas.dll".to_owned(), "jcas.dll", true),
            ("lib/libjcas.dll.a".to_owned(), "libjcas.dll.a", false),
            ("lib/libjcas.a".to_owned(), "libjcas.a", false),
        ],
    }
}

/// The pkg-config file, filled as CMake fills it.
fn pkg_config(system: System) -> String {
    let libraries = match system {
        System::Linux => "-lpthread -ldl -lm",
        System::Windows => "-lkernel32 -lntdll -luserenv -lws2_32 -ldbghelp",
    };
    PKG_CONFIG
        .replace("@CMAKE_INSTALL_LIBDIR@", "lib")
        .replace("@CMAKE_INSTALL_INCLUDEDIR@", "include")
        .replace("@PROJECT_VERSION@", VERSION)
        .replace("@JCAS_SYSTEM_LIBRARIES@", libraries)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Recipes and CMake have the version a second time.
    #[test]
    fn recipes_have_the_version() {
        let recipe = include_str!("../../../packaging/conda-forge/recipe.yaml");
        let port = include_str!("../../../packaging/vcpkg/vcpkg.json");
        let npm = include_str!("../../../packaging/npm/package.json");
        let cmake = include_str!("../../../CMakeLists.txt");
        assert!(recipe.contains(&format!("version: \"{VERSION}\"")));
        let json = format!("\"version\": \"{VERSION}\"");
        assert!(port.contains(&json) && npm.contains(&json));
        assert!(cmake.contains(&format!("VERSION {VERSION} ")));
    }

    /// A name of CMake that stays would reach the compiler's command line.
    #[test]
    fn the_pkg_config_file_is_filled() {
        for system in [System::Linux, System::Windows] {
            let text = pkg_config(system);
            assert!(!text.contains('@'), "{text}");
            assert!(text.contains("libdir=${prefix}/lib\n") && text.contains(VERSION));
        }
    }
}
