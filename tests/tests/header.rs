//! The header compiles by itself in every language that it promises, in the terms of C.
//!
//! These tests catch an internal symbol in the header, and a configuration field that the C struct
//! lacks. `ffi/examples/generate_header.rs` tests that the header is up to date.

mod abi_support;

use std::fs;
use std::process::Command;

use abi_support::{c_compilers, cpp_compilers, declared_functions, libraries, root, run};
use jcas_core::Config;

fn header() -> String {
    fs::read_to_string(root().join("include/jcas.h")).expect("the header is there")
}

#[test]
fn headers_compile_alone() {
    let strict = ["-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only"];
    let cpp = cpp_compilers();
    for (compilers, language, standards, file) in [
        (
            &c_compilers(),
            "c",
            ["c99", "c11", "c17"].as_slice(),
            "jcas.h",
        ),
        (&cpp, "c++", &["c++17", "c++20"], "jcas.h"),
        (&cpp, "c++", &["c++17", "c++20"], "jcas.hpp"),
    ] {
        for compiler in compilers {
            for standard in standards {
                let mut command = Command::new(compiler);
                command
                    .arg(format!("-std={standard}"))
                    .args(strict)
                    .args(["-x", language])
                    .arg(root().join("include").join(file));
                // A compiler warns of `#pragma once` in a main file, which these files lack.
                run(&mut command);
            }
        }
    }
    for compiler in cpp {
        for option in ["-DJCAS_EXCEPTIONS", "-fno-exceptions"] {
            run(Command::new(compiler)
                .args(["-std=c++17", option])
                .args(strict)
                .args(["-x", "c++"])
                .arg(root().join("include/jcas.hpp")));
        }
    }
}

#[test]
fn the_library_exports_what_the_header_declares_and_nothing_else() {
    let output = run(Command::new("nm")
        .args(["--dynamic", "--defined-only", "--format=posix"])
        .arg(&libraries().1));
    let mut exported: Vec<String> = String::from_utf8(output.stdout)
        .expect("symbols are text")
        .lines()
        .filter_map(|line| line.split(' ').next().map(str::to_owned))
        .collect();
    exported.sort();
    assert_eq!(exported, declared_functions(&header()));
}

#[test]
fn the_header_speaks_c() {
    let text = header();
    for word in [
        "Rust", "panic", "crate", "slice", "Option<", "usize", "unsafe", "trait", "&mut", "Vec",
        "enum",
    ] {
        assert!(!text.contains(word), "the header says `{word}`");
    }
    for line in text.lines().filter(|line| line.starts_with("#define ")) {
        assert!(line.starts_with("#define JCAS_"), "{line}");
    }
    assert!(text.lines().all(|line| line.chars().count() <= 110));
}

/// Each declaration states which threads may call it and which statuses it returns.
#[test]
fn every_declaration_says_threads_and_statuses() {
    let text = header();
    for block in text
        .split("\n\n")
        .filter(|block| block.contains("\nJCAS_API"))
    {
        assert!(block.contains("Threads:"), "no threads: {block}");
        let fails = block.contains("jcas_status jcas_");
        assert_eq!(
            fails,
            block.contains("\n/// Statuses:"),
            "statuses: {block}"
        );
    }
}

/// Each function has a function pointer type with its own signature.
#[test]
fn function_types_fit_their_functions() {
    let mut program = String::from("#include <jcas_dl.h>\n");
    for function in declared_functions(&header()) {
        program += &format!("static {function}_fn *const a_{function} = {function};\n");
    }
    program += "int main(void)\n{\n";
    for function in declared_functions(&header()) {
        program += &format!("    (void)a_{function};\n");
    }
    program += "    return 0;\n}\n";
    let source = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("function_types.c");
    fs::write(&source, program).expect("the target folder can be written");
    abi_support::compile(c_compilers()[0], "c11", "types", &[source]);
}

/// The C struct has the kernel's fields, in their order.
#[test]
fn jcas_config_has_every_field_of_the_configuration() {
    let text = header();
    let begin = text
        .find("typedef struct jcas_config {")
        .expect("the struct");
    let end = begin + text[begin..].find("} jcas_config;").expect("its end");
    let fields: Vec<&str> = text[begin..end]
        .lines()
        .filter(|line| line.ends_with(';') && !line.contains("//"))
        .filter_map(|line| line.trim_end_matches(';').split(' ').next_back())
        .map(|name| name.split('[').next().unwrap_or(name))
        .filter(|name| !["struct_size", "depot_count", "detection_point_count"].contains(name))
        .collect();
    let kernel: Vec<&str> = Config::FIELDS.iter().map(|field| field.name).collect();
    assert_eq!(fields, kernel);
}
