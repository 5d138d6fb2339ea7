//! Replays every golden trace and compares each field of each step, with the hashes of states and
//! observations. It also runs shipped policies. The bits are the same on x86-64, AArch64,
//! ARMv7, s390x and wasm32.

#[cfg(target_family = "wasm")]
mod wasm;

#[path = "../../../policy/tests/episode/mod.rs"]
mod episode;

use jcas_episode::trace;
use jcas_policy::network::MatmulKernel;

/// Name and text of each trace in `tests/golden`.
const GOLDEN: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/golden.rs"));

/// The results of all traces.
pub struct Report {
    /// One line for each trace.
    pub text: String,
    /// Number of traces that differ.
    pub failures: u32,
}

/// Verifies all traces, in the order of their names, then the episodes of shipped policies.
#[must_use]
pub fn verify_all() -> Report {
    let mut report = Report {
        text: String::new(),
        failures: 0,
    };
    for (name, text) in GOLDEN {
        let line = match verify(text) {
            Ok(steps) => format!("ok    {name}: {steps} steps\n"),
            Err(problem) => {
                report.failures += 1;
                format!("FAIL  {name}: {problem}\n")
            }
        };
        report.text.push_str(&line);
    }
    for expected in episode::EPISODES {
        let found = episode::fly(expected, MatmulKernel::default());
        if found == expected {
            let steps = found.steps;
            report.text += &format!("ok    policy of {:?}: {steps} steps\n", expected.preset);
        } else {
            report.failures += 1;
            report.text += &format!("FAIL  {found:?}, not {expected:?}\n");
        }
    }
    report
}

/// The number of steps of a trace that this build reproduces, or the first difference.
fn verify(text: &str) -> Result<usize, String> {
    let trace = trace::read(text.as_bytes()).map_err(|error| error.to_string())?;
    match trace::verify(&trace).map_err(|error| error.to_string())? {
        None => Ok(trace.steps.len()),
        Some(difference) => Err(difference.to_string()),
    }
}
