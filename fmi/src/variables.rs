//! Every variable of the unit: reference, name, type, causality, dimensions, unit.

use jcas_core::Config;
use jcas_core::config::FieldValue;

/// The references of variables that are no field of the configuration.
pub mod reference {
    /// Simulated time.
    pub const TIME: u32 = 0;
    /// N.
    pub const UAV_COUNT: u32 = 1;
    /// n.
    pub const HOTSPOT_COUNT: u32 = 2;
    /// The preset of the fields that are not set.
    pub const PRESET: u32 = 3;
    /// Seed of the episode.
    pub const SEED: u32 = 4;
    /// The policy.
    pub const POLICY: u32 = 5;
    /// The pilot mode of a baseline.
    pub const PILOT: u32 = 6;
    /// Whether the importer moves the UAVs.
    pub const OWN_POSITIONS: u32 = 7;
    /// Whether the importer supplies the radio graph.
    pub const OWN_LINKS: u32 = 8;
    /// The fields of the configuration, in their order.
    pub const FIELDS: u32 = 1000;
    /// Inputs.
    pub const ACTIONS: u32 = 100;
    /// Positions that the importer supplies.
    pub const POSITIONS: u32 = 101;
    /// Links that the importer supplies.
    pub const LINKS: u32 = 102;
    /// Outputs, in the order of [`super::OUTPUTS`].
    pub const FIRST_OUTPUT: u32 = 200;
}

/// The types of FMI 3.0 that the unit uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VariableType {
    /// 32-bit float.
    Float32,
    /// 64-bit float.
    Float64,
    /// 32-bit unsigned integer.
    UInt32,
    /// 64-bit unsigned integer.
    UInt64,
    /// `bool`.
    Boolean,
    /// Text.
    String,
}

/// One extent of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// The number of UAVs.
    Uavs,
    /// The number of hotspots.
    Hotspots,
    /// x and y, or u_dir and u_pilot.
    Two,
}

/// The causality of a variable, which decides when an importer may set it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Simulated time.
    Independent,
    /// Sizes: set in configuration mode or before.
    Structural,
    /// Set before the episode begins.
    Parameter,
    /// Set before each step.
    Input,
    /// Read after each step.
    Output,
}

/// A variable of the unit.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Its value reference.
    pub reference: u32,
    /// Its name.
    pub name: &'static str,
    /// Its type.
    pub kind: VariableType,
    /// Its causality.
    pub causality: Causality,
    /// Its dimensions; none for a scalar.
    pub extents: &'static [Extent],
    /// Its unit, where it has one.
    pub unit: Option<&'static str>,
    /// Its legal range, if it is a number.
    pub range: Option<(f64, f64)>,
    /// Its description.
    pub doc: String,
}

/// An output: name, type, dimensions, unit, meaning.
type Output = (
    &'static str,
    VariableType,
    &'static [Extent],
    Option<&'static str>,
    &'static str,
);

/// The outputs.
#[rustfmt::skip]
pub const OUTPUTS: [Output; 23] = {
    use Extent::{Hotspots, Two, Uavs};
    use VariableType::{Boolean, Float64, UInt32, UInt64};
    [
        ("cell", UInt32, &[Uavs, Two], None, "Cell (x, y) of each UAV."),
        ("battery_kwh", Float64, &[Uavs], Some("kWh"), "Charge of each UAV."),
        ("pilot_density", Float64, &[Uavs], None,
         "Fraction of the waveform that each UAV uses for pilots."),
        ("throughput", Float64, &[Uavs], None,
         "Mean normalised throughput of each UAV over its neighbours."),
        ("grounded", Boolean, &[Uavs], None,
         "UAVs whose battery was empty at the start of the step."),
        ("knowledge", Boolean, &[Uavs, Hotspots], None, "Which UAV knows which hotspot."),
        ("link", Boolean, &[Uavs, Uavs], None, "Radio graph: true where two UAVs are neighbours."),
        ("hotspot_cell", UInt32, &[Hotspots, Two], None, "Cell (x, y) of each hotspot."),
        ("confirmed", Boolean, &[Hotspots], None, "Hotspots that a quorum has confirmed."),
        ("informed", Boolean, &[Hotspots], None, "Hotspots that every UAV knows."),
        ("confirmed_count", UInt32, &[], None, "Number of hotspots that are confirmed."),
        ("informed_count", UInt32, &[], None, "Number of hotspots that every UAV knows."),
        ("mean_throughput", Float64, &[], None,
         "Mean over the UAVs of their throughput in the last step."),
        ("energy_kwh", Float64, &[], Some("kWh"), "Energy spent by the fleet so far."),
        ("co2_kg", Float64, &[], Some("kg"), "Carbon emitted so far."),
        ("carbon_intensity", Float64, &[], Some("kg/kWh"),
         "Carbon intensity that the coming step is billed with."),
        ("reward", Float64, &[], None,
         "Team reward of the steps since the last communication point."),
        ("return_sum", Float64, &[], None, "Sum of all rewards so far."),
        ("terminated", Boolean, &[], None,
         "Every hotspot is informed; the state no longer changes."),
        ("truncated", Boolean, &[], None,
         "The horizon ended the episode; the state no longer changes."),
        ("state_hash", UInt64, &[], None,
         "Fingerprint of the kernel's state, the same as through every other interface."),
        ("reported_count", UInt32, &[Uavs], None,
         "Number of cells of which each UAV knows a report; 0 without report levels."),
        ("false_confirmation_count", UInt32, &[], None,
         "Number of cells without a hotspot that a quorum has confirmed."),
    ]
};

/// A variable that is neither an output nor a field: reference, name, type, causality, dimensions,
/// unit, legal values, meaning.
type Special = (
    u32,
    &'static str,
    VariableType,
    Causality,
    &'static [Extent],
    Option<&'static str>,
    Option<(f64, f64)>,
    &'static str,
);

/// The variables that are neither outputs nor fields of the configuration.
#[rustfmt::skip]
const SPECIAL: [Special; 12] = {
    use Causality::{Independent, Input, Parameter, Structural};
    use Extent::{Two, Uavs};
    use reference::*;
    const SIZE: Option<(f64, f64)> = Some((1.0, 4096.0));
    [
        (TIME, "time", VariableType::Float64, Independent, &[], Some("s"), None,
         "Simulated time."),
        (UAV_COUNT, "uav_count", VariableType::UInt64, Structural, &[], None, SIZE,
         "UAVs in the fleet (N)."),
        (HOTSPOT_COUNT, "hotspot_count", VariableType::UInt64, Structural, &[], None, SIZE,
         "Waste hotspots to find (n)."),
        (PRESET, "preset", VariableType::String, Parameter, &[], None, None,
         "Preset of the fields that are not set."),
        (SEED, "seed", VariableType::UInt64, Parameter, &[], None, None,
         "Seed of the episode, which determines every random draw."),
        (POLICY, "policy", VariableType::String, Parameter, &[], None, None,
         "Baseline, or trained policy or plan among the resources, that controls the fleet; \
          if empty, the input actions do."),
        (PILOT, "pilot", VariableType::String, Parameter, &[], None, None,
         "Pilot density of a baseline: a number, min, mid, max or adaptive."),
        (OWN_POSITIONS, "own_positions", VariableType::Boolean, Parameter, &[], None, None,
         "Whether the input positions replaces the kernel's motion."),
        (OWN_LINKS, "own_links", VariableType::Boolean, Parameter, &[], None, None,
         "Whether the input links replaces the kernel's radio graph."),
        (ACTIONS, "actions", VariableType::Float32, Input, &[Uavs, Two], None, Some((-1.0, 1.0)),
         "(u_dir, u_pilot) of each UAV, each clipped to [-1, 1]."),
        (POSITIONS, "positions", VariableType::UInt32, Input, &[Uavs, Two], None, None,
         "Cell (x, y) of each UAV, read while own_positions is true."),
        (LINKS, "links", VariableType::Boolean, Input, &[Uavs, Uavs], None, None,
         "Symmetric radio graph, read while own_links is true."),
    ]
};

/// Every variable, in the order of the description.
#[must_use]
pub fn all() -> Vec<Variable> {
    let outputs = (reference::FIRST_OUTPUT..).zip(OUTPUTS);
    let outputs = outputs.map(|(reference, (name, kind, extents, unit, doc))| {
        let causality = Causality::Output;
        (reference, name, kind, causality, extents, unit, None, doc)
    });
    let listed = SPECIAL.into_iter().chain(outputs);
    let listed = listed.map(
        |(reference, name, kind, causality, extents, unit, range, doc)| Variable {
            reference,
            name,
            kind,
            causality,
            extents,
            unit,
            range,
            doc: doc.to_owned(),
        },
    );
    listed.chain(fields()).collect()
}

/// The fields of the configuration but the two sizes, which are structural.
fn fields() -> Vec<Variable> {
    use VariableType::{Float64, String as Text, UInt32};
    let config = Config::default();
    let numbered = (reference::FIELDS..).zip(Config::FIELDS.iter().zip(config.values()));
    numbered
        .filter(|(_, (info, _))| !is_size(info.name))
        .map(|(reference, (info, value))| {
            let (number, unit) = (Some((info.low, info.high)), Some(info.unit));
            let choices = format!(" One of {}.", info.unit);
            let (kind, unit, range, how) = match value {
                FieldValue::Integer(_) => (UInt32, None, number, ""),
                FieldValue::Real(_) => (Float64, unit, number, ""),
                FieldValue::Optional(_) => (Float64, unit, None, " NaN: derived."),
                FieldValue::Choice(..) => (Text, None, None, choices.as_str()),
                FieldValue::Cells(_) => (Text, None, None, " A list of [x, y] in JSON."),
                FieldValue::Table(_) => (Text, None, None, " A list of [m, P_d] in JSON."),
            };
            Variable {
                reference,
                name: info.name,
                kind,
                causality: Causality::Parameter,
                extents: &[],
                unit: unit.filter(|unit| {
                    !["fraction", "dimensionless", "reward", "probability"].contains(unit)
                }),
                range,
                doc: format!("{}{how}", info.doc.trim()),
            }
        })
        .collect()
}

/// Whether a field is one of the two sizes of arrays.
#[must_use]
pub fn is_size(field: &str) -> bool {
    matches!(field, "uav_count" | "hotspot_count")
}
