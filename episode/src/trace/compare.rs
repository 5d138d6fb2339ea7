//! Finds the first difference of two traces.

use core::fmt;

use serde::Serialize;
use serde_json::Value;

use super::format::Trace;
use super::host::Host;

/// Fields of a header in the order of comparison. `core_version` is left out, since a trace shows
/// that two versions agree.
const HEADER_FIELDS: [&str; 8] = [
    "config",
    "config_hash",
    "seed",
    "policy",
    "pilot",
    "hotspots",
    "depots",
    "initial",
];
/// Fields of a step in the order in which a step computes them.
const STEP_FIELDS: [&str; 20] = [
    "t",
    "actions",
    "positions",
    "pilot_density",
    "battery_uj",
    "grounded",
    "returning",
    "links",
    "knowledge",
    "confirmed",
    "informed",
    "false_alarms",
    "falsely_confirmed",
    "reports",
    "carbon_intensity_mg_per_kwh",
    "co2_ng",
    "throughput",
    "reward",
    "observation_hash",
    "state_hash",
];
/// Fields of the end line; its checksum follows from the rest.
const END_FIELDS: [&str; 4] = ["steps", "terminated", "truncated", "metrics"];

/// The first difference of two traces.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// Step of the difference; 0 for the header. A difference in the end line has the last step.
    pub step: u32,
    /// Path of the field, for example `battery_uj[3]` or `reward.detect`.
    pub field: String,
    /// The value in the first trace.
    pub left: String,
    /// The value in the second.
    pub right: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.step {
            0 => out.write_str("header")?,
            step => write!(out, "step {step}")?,
        }
        write!(
            out,
            ", {}: {} against {}",
            self.field, self.left, self.right
        )
    }
}

/// Returns the first step and field at which two traces differ; `None` where they agree bit for
/// bit.
#[must_use]
pub fn diff(left: &Trace, right: &Trace) -> Option<Difference> {
    if let Some(difference) = lines(0, &left.header, &right.header, &HEADER_FIELDS) {
        return Some(difference);
    }
    for (a, b) in left.steps.iter().zip(&right.steps) {
        if let Some(difference) = hosts(a.t, &a.host, &b.host) {
            return Some(difference);
        }
        if let Some(difference) = lines(a.t, a, b, &STEP_FIELDS) {
            return Some(difference);
        }
    }
    let last = left.steps.len().min(right.steps.len()) as u32;
    if left.steps.len() != right.steps.len() {
        return Some(Difference {
            step: last + 1,
            field: "t".to_owned(),
            left: presence(left.steps.len() as u32 > last),
            right: presence(right.steps.len() as u32 > last),
        });
    }
    hosts(last, &left.end.host, &right.end.host)
        .or_else(|| lines(last, &left.end, &right.end, &END_FIELDS))
}

/// The first difference in the calls of two hosts.
fn hosts(step: u32, left: &[Host], right: &[Host]) -> Option<Difference> {
    let (field, a, b) = first_difference("host", &value(&left), &value(&right))?;
    Some(Difference {
        step,
        field,
        left: a,
        right: b,
    })
}

fn presence(present: bool) -> String {
    if present { "present" } else { "absent" }.to_owned()
}

/// The first field in which two lines of one kind differ.
fn lines<T: Serialize + PartialEq>(
    step: u32,
    left: &T,
    right: &T,
    fields: &[&str],
) -> Option<Difference> {
    if left == right {
        return None;
    }
    let (left, right) = (value(left), value(right));
    fields.iter().find_map(|field| {
        let (path, a, b) = first_difference(field, &left[*field], &right[*field])?;
        Some(Difference {
            step,
            field: path,
            left: a,
            right: b,
        })
    })
}

fn value(line: &impl Serialize) -> Value {
    serde_json::to_value(line).expect("a line of a trace has a JSON value")
}

/// Descends into lists and objects to the first leaf that differs. The depth is that of the format.
fn first_difference(path: &str, left: &Value, right: &Value) -> Option<(String, String, String)> {
    if left == right {
        return None;
    }
    match (left, right) {
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            (0..a.len()).find_map(|k| first_difference(&format!("{path}[{k}]"), &a[k], &b[k]))
        }
        (Value::Object(a), Value::Object(b)) => a.keys().chain(b.keys()).find_map(|key| {
            let of = |object: &serde_json::Map<String, Value>| {
                object.get(key).cloned().unwrap_or(Value::Null)
            };
            first_difference(&format!("{path}.{key}"), &of(a), &of(b))
        }),
        _ => Some((path.to_owned(), left.to_string(), right.to_string())),
    }
}
