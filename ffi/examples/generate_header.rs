//! Writes include/jcas.h from the sources of this crate: `cargo run -p jcas-ffi --example generate_header`.
//! With `--check` it only says whether the header is fresh.

use std::fs;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let generated = generate(root);
    let header = root.join("../include/jcas.h");
    if !std::env::args().any(|argument| argument == "--check") {
        let new = header.with_extension("h.new");
        fs::write(&new, generated).expect("include/ can be written");
        fs::rename(&new, &header).expect("include/ can be written");
        return ExitCode::SUCCESS;
    }
    if fs::read_to_string(&header).is_ok_and(|kept| kept == generated) {
        return ExitCode::SUCCESS;
    }
    eprintln!("include/jcas.h is stale: cargo run -p jcas-ffi --example generate_header");
    ExitCode::FAILURE
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
