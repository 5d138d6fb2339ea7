//! Reads traces strictly: a text that the writer could not have written is refused.

use std::io::BufRead;

use jcas_core::hash::Fnv1a;
use jcas_core::host::Call;
use jcas_trace::{CHECKSUM, FORMAT, FORMAT_VERSION};
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::error::TraceError;
use super::format::{End, Header, Hex, Step, Trace};
use super::host::Host;

/// The part of a line that determines the form of the rest.
#[derive(Deserialize)]
struct Probe {
    kind: String,
    format: Option<String>,
    format_version: Option<u64>,
}

/// Reads a complete trace and checks its form and its checksum. [`verify`](super::verify()) checks
/// that the kernel reproduces it.
///
/// # Errors
/// Every [`TraceError`] except those of the kernel.
pub fn read(mut input: impl BufRead) -> Result<Trace, TraceError> {
    let mut header: Option<Header> = None;
    let mut steps = Vec::new();
    let mut end: Option<End> = None;
    let mut host = Vec::new();
    let mut whole = String::new();
    for line in 1.. {
        let begin = whole.len();
        match input.read_line(&mut whole) {
            Ok(0) => break,
            Ok(_) => {}
            Err(error) if error.kind() == std::io::ErrorKind::InvalidData => {
                return Err(malformed(line, "is not UTF-8 text"));
            }
            Err(error) => return Err(error.into()),
        }
        let text = &whole[begin..];
        if end.is_some() {
            return Err(TraceError::Trailing { line });
        }
        if !text.ends_with('\n') {
            break;
        }
        let Some(header) = &header else {
            header = Some(read_header(text)?);
            continue;
        };
        match parse::<Probe>(text, line)?.kind.as_str() {
            "step" => {
                let mut step: Step = parse(text, line)?;
                check_step(&step, header, steps.len() + 1, line)?;
                step.host = std::mem::take(&mut host);
                steps.push(step);
            }
            "end" => end = Some(read_end(text, std::mem::take(&mut host), line)?),
            kind if Call::KINDS.contains(&kind) => {
                host.push(read_host(text, header, line)?);
            }
            other => {
                return Err(malformed(
                    line,
                    &format!("kind = \"{other}\": must be step, end or a call of the host"),
                ));
            }
        }
    }
    let header = header.ok_or(TraceError::Empty)?;
    let end = end.ok_or(TraceError::Truncated { steps: steps.len() })?;
    let covered = whole.rfind(CHECKSUM).unwrap_or(whole.len());
    let mut hash = Fnv1a::new();
    hash.write(&whole.as_bytes()[..covered]);
    let computed = Hex(hash.finish());
    if end.checksum != computed {
        return Err(TraceError::Checksum {
            stated: end.checksum,
            computed,
        });
    }
    Ok(Trace {
        text: whole,
        header,
        steps,
        end,
    })
}

/// Reads the last line. `host` holds the calls since the last step.
fn read_end(text: &str, host: Vec<Host>, line: usize) -> Result<End, TraceError> {
    let end: End = parse(text, line)?;
    if host.iter().any(Host::within_a_step) {
        return Err(malformed(
            line,
            "the step that the host's calls are part of is missing",
        ));
    }
    Ok(End { host, ..end })
}

/// The version is read first, since another version may have other fields.
fn read_header(text: &str) -> Result<Header, TraceError> {
    let probe: Probe =
        serde_json::from_str(text).map_err(|error| TraceError::NotATrace(explain(&error)))?;
    match probe {
        Probe {
            kind,
            format: Some(format),
            format_version: Some(version),
        } if kind == "header" && format == FORMAT => {
            if version != u64::from(FORMAT_VERSION) {
                return Err(TraceError::Version(version));
            }
            parse(text, 1)
        }
        Probe { kind, format, .. } => Err(TraceError::NotATrace(format!(
            "kind = \"{kind}\", format = \"{}\"",
            format.unwrap_or_default()
        ))),
    }
}

/// Checks that the pairs of a host's call exist; the kernel checks the other arguments.
fn read_host(text: &str, header: &Header, line: usize) -> Result<Host, TraceError> {
    let call: Host = parse(text, line)?;
    let config = &header.config;
    match call.stray_pair(config.uav_count as usize, config.hotspot_count as usize) {
        None => Ok(call),
        Some([i, k]) => Err(malformed(
            line,
            &format!("[{i}, {k}]: there is no such pair"),
        )),
    }
}

/// Checks the lengths by which later code indexes.
fn check_step(step: &Step, header: &Header, t: usize, line: usize) -> Result<(), TraceError> {
    if step.t as usize != t {
        return Err(malformed(line, &format!("t = {}: must be {t}", step.t)));
    }
    let uavs = header.config.uav_count as usize;
    for (field, length) in [
        ("actions", step.actions.len()),
        ("positions", step.positions.len()),
        ("pilot_density", step.pilot_density.len()),
        ("battery_uj", step.battery_uj.len()),
        ("knowledge", step.knowledge.len()),
    ] {
        if length != uavs {
            return Err(malformed(
                line,
                &format!("{field} has {length} elements: must have {uavs}"),
            ));
        }
    }
    Ok(())
}

fn parse<T: DeserializeOwned>(text: &str, line: usize) -> Result<T, TraceError> {
    serde_json::from_str(text).map_err(|error| malformed(line, &explain(&error)))
}

fn malformed(line: usize, problem: &str) -> TraceError {
    TraceError::Malformed {
        line,
        problem: problem.to_owned(),
    }
}

/// serde_json counts lines from the start of its input, which is always one line.
fn explain(error: &serde_json::Error) -> String {
    let text = error.to_string();
    match text.rsplit_once(" at line ") {
        Some((problem, _)) => format!("{problem} (column {})", error.column()),
        None => text,
    }
}
