//! Writes include/jcas.h from the sources of this crate, and include/jcas_dl.h from that:
//! `cargo run -p jcas-ffi --example generate_header`. Its test says whether both are fresh.

use std::fs;
use std::path::{Path, PathBuf};

fn main() {
    for (path, text) in headers() {
        let new = path.with_extension("h.new");
        fs::write(&new, text).expect("include/ can be written");
        fs::rename(&new, &path).expect("include/ can be written");
    }
}

#[test]
fn headers_are_what_the_sources_generate() {
    for (path, text) in headers() {
        let fresh = fs::read_to_string(&path).is_ok_and(|kept| kept == text);
        assert!(
            fresh,
            "{} is stale: cargo run -p jcas-ffi --example generate_header",
            path.display()
        );
    }
}

/// Where each header lies, and what it has to say.
fn headers() -> [(PathBuf, String); 2] {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let header = generate(root);
    let types = function_types(&header);
    let include = root.join("../include");
    [
        (include.join("jcas.h"), header),
        (include.join("jcas_dl.h"), types),
    ]
}

/// A type for each function of the header, for programs that load the library when they run.
fn function_types(header: &str) -> String {
    let mut text = String::from(
        "/* Types of the functions of jcas.h, for programs that load the library when they run:\n \
         *\n \
         *     jcas_sim_step_fn *step = (jcas_sim_step_fn *)dlsym(library, \"jcas_sim_step\");\n \
         *\n \
         * SPDX-License-Identifier: MIT OR Apache-2.0\n \
         */\n\
         #ifndef JCAS_DL_H\n#define JCAS_DL_H\n\n#include \"jcas.h\"\n\n",
    );
    let code: String = header
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .map(|line| format!("{line}\n"))
        .collect();
    for declaration in code.split("\nJCAS_API").skip(1) {
        let declaration = declaration.split(';').next().unwrap_or_default();
        let words = declaration.replace("JCAS_NODISCARD", " ");
        let words: Vec<&str> = words.split_whitespace().collect();
        let words = words.join(" ");
        let (before, arguments) = words.split_once('(').expect("a function has arguments");
        text += &format!("typedef {before}_fn({arguments};\n");
    }
    text + "\n#endif\n"
}

fn generate(root: &Path) -> String {
    let settings = cbindgen::Config::from_file(root.join("cbindgen.toml")).expect("legal settings");
    let bindings = cbindgen::Builder::new()
        .with_crate(root)
        .with_config(settings)
        .generate()
        .expect("the crate has a header");
    let mut text = Vec::new();
    bindings.write(&mut text);
    let text = String::from_utf8(text).expect("sources are UTF-8");
    let mut lines: Vec<String> = text.trim_start().lines().map(macro_value).collect();
    lines.dedup_by(|a, b| a.is_empty() && b.is_empty());
    lines.join("\n") + "\n"
}

/// Numbers of macros as C wants them: negative ones in parentheses, floats as floats.
fn macro_value(line: &str) -> String {
    let mut words = line.split_whitespace();
    let (Some("#define"), Some(name), Some(value), None) =
        (words.next(), words.next(), words.next(), words.next())
    else {
        return line.to_owned();
    };
    let Ok(number) = value.parse::<f64>() else {
        return line.to_owned();
    };
    let suffix = if value.contains('.') { "f" } else { "" };
    if number < 0.0 {
        format!("#define {name} ({value}{suffix})")
    } else {
        format!("#define {name} {value}{suffix}")
    }
}
