//! Writes include/jcas.h from the sources of this crate: `cargo run -p jcas-ffi --example
//! generate_header`. From that it writes include/jcas_dl.h, and the buffers of a batch in
//! include/jcas.hpp. Its test fails if one of them is stale.

use std::path::{Path, PathBuf};
use std::{env, fs, process};

/// The first item of each group of the header, and the group's name and title.
const GROUPS: [(&str, &str, &str); 17] = [
    ("JCAS_VERSION_MAJOR", "constants", "Constants"),
    ("JCAS_OK", "status", "Statuses"),
    (
        "JCAS_MAX_DEPOTS",
        "values",
        "Values of fields and arguments",
    ),
    ("jcas_batch", "handles", "Handles"),
    ("jcas_cell", "structs", "Structs"),
    ("jcas_version", "version", "Versions and words of a status"),
    ("jcas_config_default", "config", "Configurations"),
    ("jcas_model_layout", "model", "Models"),
    ("jcas_sim_layout", "sim", "Simulations"),
    (
        "jcas_sim_step_begin",
        "parts",
        "A step by parts, for a host simulator",
    ),
    ("jcas_sim_get_episode", "queries", "Queries of a simulation"),
    ("jcas_sim_save", "snapshot", "Snapshots"),
    ("jcas_trace_layout", "trace", "Traces"),
    ("jcas_batch_new", "batch", "Batches"),
    ("jcas_batch_reset", "batch_step", "Steps of a batch"),
    ("jcas_policy_layout", "policy", "Policies"),
    ("jcas_batch_fork", "futures", "Futures of a state"),
];

fn main() {
    for (path, text) in headers() {
        let new = path.with_extension("new");
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

/// Returns the path and the expected text of each header.
fn headers() -> [(PathBuf, String); 3] {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let header = generate(root);
    let types = function_types(&header);
    let include = root.join("../include");
    let cpp = include.join("jcas.hpp");
    let wrapper = fs::read_to_string(&cpp).expect("the wrapper is there");
    [
        (cpp, with_batch_buffers(&wrapper, &header)),
        (include.join("jcas.h"), header),
        (include.join("jcas_dl.h"), types),
    ]
}

/// Returns a type for each function of the header, for programs that load the library at run time.
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

/// Returns the C++ wrapper with a vector for each buffer of jcas_batch_out, and their addresses.
fn with_batch_buffers(wrapper: &str, header: &str) -> String {
    let (_, fields) = header
        .split_once("typedef struct jcas_batch_out {\n")
        .expect("the struct");
    let (fields, _) = fields.split_once("} jcas_batch_out;").expect("its end");
    let mut vectors = String::new();
    let mut addresses = String::new();
    let (mut element, mut buffer) = ("", "");
    for field in fields.lines().filter(|line| !line.contains("///")) {
        let field = field.trim().trim_end_matches(';');
        if let Some((kind, name)) = field.split_once(" *") {
            (element, buffer) = (kind.trim_start_matches("struct "), name);
            vectors += &format!("    std::vector<{element}> {name};\n");
            addresses += &format!("        out.{name} = {name}.data();\n");
        } else if let Some(name) = field.strip_prefix("size_t ") {
            let value = if name.ends_with("_count") {
                format!("{buffer}.size()")
            } else {
                format!("sizeof({element})")
            };
            addresses += &format!("        out.{name} = {value};\n");
        }
    }
    let vectors = vectors.replace("<uint8_t>", "<std::uint8_t>");
    let begin = "do not edit.\n";
    let (before, rest) = wrapper.split_once(begin).expect("where the buffers begin");
    let end = "    // End of the generated part.";
    let (_, after) = rest.split_once(end).expect("where they end");
    format!(
        "{before}{begin}    \
         /// The buffers that reset and step write; see jcas_batch_out for their shapes.\n\
         {vectors}\nprivate:\n    jcas_batch_out buffers() noexcept\n    {{\n        \
         auto out = detail::sized<jcas_batch_out>();\n{addresses}        return out;\n    }}\n\
         {end}{after}"
    )
}

fn generate(root: &Path) -> String {
    let settings = cbindgen::Config::from_file(root.join("cbindgen.toml")).expect("legal settings");
    let batch_out = env::temp_dir().join(format!("jcas_batch_out_{}.rs", process::id()));
    fs::write(&batch_out, jcas::BATCH_OUT_SOURCE).expect("the temporary folder can be written");
    let bindings = cbindgen::Builder::new()
        .with_src(&batch_out)
        .with_crate(root)
        .with_config(settings)
        .generate();
    fs::remove_file(batch_out).expect("the file is there");
    let bindings = bindings.expect("the crate has a header");
    let mut text = Vec::new();
    bindings.write(&mut text);
    let text = String::from_utf8(text).expect("sources are UTF-8");
    let mut lines: Vec<String> = text.trim_start().lines().map(macro_value).collect();
    group(&mut lines);
    lines.dedup_by(|a, b| a.is_empty() && b.is_empty());
    lines.join("\n") + "\n"
}

/// Encloses the groups in Doxygen marks.
fn group(lines: &mut Vec<String>) {
    for (index, (item, name, title)) in GROUPS.iter().enumerate() {
        let declares = [
            format!("#define {item} "),
            format!("typedef struct {item}"),
            format!(" {item}("),
            format!("*{item}("),
        ];
        let is_declaration = |line: &String| {
            !line.starts_with(['/', ' ']) && declares.iter().any(|text| line.contains(text))
        };
        let mut at = lines
            .iter()
            .position(is_declaration)
            .expect("the first item of a group");
        while !lines[at - 1].is_empty() {
            at -= 1;
        }
        let mut marks = vec![
            format!("/** @defgroup {name} {title}"),
            " *  @{ */".into(),
            String::new(),
        ];
        if index > 0 {
            marks.splice(0..0, ["/** @} */".to_owned(), String::new()]);
        }
        lines.splice(at..at, marks);
    }
    let is_end = |line: &String| line == "#ifdef __cplusplus";
    let end = lines
        .iter()
        .rposition(is_end)
        .expect("the end of the declarations");
    lines.splice(end..end, ["/** @} */".to_owned(), String::new()]);
}

/// Rewrites a number of a macro for C: negative ones in parentheses, floats as floats.
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
