//! The text of `modelDescription.xml`, from the table of variables.

use std::collections::BTreeSet;
use std::fmt::Write;

use crate::error::Error;
use crate::instance::Instance;
use crate::values::Values;
use crate::variables::{Causality, Extent, Variable, VariableType, all, reference};

/// Returns the instantiation token. Instantiation refuses an importer that has read another
/// description.
#[must_use]
pub fn token() -> String {
    let mut hash = jcas_core::hash::Fnv1a::new();
    for variable in all() {
        hash.write(format!("{variable:?}").as_bytes());
    }
    format!("{{jcas-{}-{:016x}}}", jcas_core::VERSION, hash.finish())
}

/// Returns the whole description.
///
/// # Errors
/// The call fails if a default value cannot be read, which is a fault of the table.
pub fn xml() -> Result<String, Error> {
    let variables = all();
    let mut defaults = Instance::new(None)?;
    let step_s = jcas_core::Config::default().step_duration_s;
    let stop_s = step_s * f64::from(jcas_core::Config::default().horizon_steps);
    let mut xml = format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="jcas" instantiationToken="{}" version="{}"
    generationTool="jcas" license="MIT OR Apache-2.0" variableNamingConvention="flat"
    description="Fleets of UAVs that sense and communicate with one OFDM waveform">
  <CoSimulation modelIdentifier="jcas" canHandleVariableCommunicationStepSize="true"
      canGetAndSetFMUState="true" canSerializeFMUState="true" fixedInternalStepSize="{step_s}"/>
  <UnitDefinitions>
"#,
        token(),
        jcas_core::VERSION,
    );
    let units: BTreeSet<&str> = variables
        .iter()
        .filter_map(|variable| variable.unit)
        .collect();
    for unit in units {
        let _ = writeln!(xml, r#"    <Unit name="{unit}"/>"#);
    }
    let _ = write!(
        xml,
        r#"  </UnitDefinitions>
  <LogCategories>
    <Category name="logStatusError" description="Why a call was refused"/>
  </LogCategories>
  <DefaultExperiment startTime="0" stopTime="{stop_s}" stepSize="{step_s}"/>
  <ModelVariables>
"#
    );
    for variable in &variables {
        write_variable(&mut xml, variable, &mut defaults)?;
    }
    xml.push_str("  </ModelVariables>\n  <ModelStructure>\n");
    let outputs = || {
        variables
            .iter()
            .filter(|variable| variable.causality == Causality::Output)
    };
    for element in ["Output", "InitialUnknown"] {
        for variable in outputs() {
            let _ = writeln!(
                xml,
                r#"    <{element} valueReference="{}"/>"#,
                variable.reference
            );
        }
    }
    xml.push_str("  </ModelStructure>\n</fmiModelDescription>\n");
    Ok(xml)
}

fn write_variable(
    xml: &mut String,
    variable: &Variable,
    defaults: &mut Instance,
) -> Result<(), Error> {
    let element = match variable.kind {
        VariableType::Float32 => "Float32",
        VariableType::Float64 => "Float64",
        VariableType::UInt32 => "UInt32",
        VariableType::UInt64 => "UInt64",
        VariableType::Boolean => "Boolean",
        VariableType::String => "String",
    };
    let (causality, variability) = match variable.causality {
        Causality::Independent => ("independent", "continuous"),
        Causality::Structural => ("structuralParameter", "fixed"),
        Causality::Parameter => ("parameter", "fixed"),
        Causality::Input => ("input", "discrete"),
        Causality::Output => ("output", "discrete"),
    };
    let _ = write!(
        xml,
        r#"    <{element} name="{}" valueReference="{}" causality="{causality}""#,
        variable.name, variable.reference
    );
    let doc = escape(&variable.doc);
    let _ = write!(xml, r#" variability="{variability}" description="{doc}""#);
    if let Some(unit) = variable.unit {
        let _ = write!(xml, r#" unit="{unit}""#);
    }
    if let Some((low, high)) = variable.range {
        let _ = write!(xml, r#" min="{low}" max="{high}""#);
    }
    let mut inside = String::new();
    for extent in variable.extents {
        inside += &match extent {
            Extent::Uavs => format!(
                "      <Dimension valueReference=\"{}\"/>\n",
                reference::UAV_COUNT
            ),
            Extent::Hotspots => format!(
                "      <Dimension valueReference=\"{}\"/>\n",
                reference::HOTSPOT_COUNT
            ),
            Extent::Two => "      <Dimension start=\"2\"/>\n".to_owned(),
        };
    }
    let starts = matches!(
        variable.causality,
        Causality::Structural | Causality::Parameter | Causality::Input
    );
    if starts {
        match defaults.get(variable.reference)? {
            Values::String(texts) => {
                for text in texts {
                    let _ = writeln!(inside, "      <Start value=\"{}\"/>", escape(&text));
                }
            }
            values => {
                let _ = write!(xml, r#" start="{}""#, list(&values));
            }
        }
    }
    if inside.is_empty() {
        xml.push_str("/>\n");
    } else {
        let _ = write!(xml, ">\n{inside}    </{element}>\n");
    }
    Ok(())
}

fn list(values: &Values) -> String {
    fn joined<T: ToString>(values: &[T]) -> String {
        values
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>()
            .join(" ")
    }
    match values {
        Values::Float32(values) => joined(values),
        Values::Float64(values) => joined(values),
        Values::UInt32(values) => joined(values),
        Values::UInt64(values) => joined(values),
        Values::Boolean(values) => joined(values),
        Values::String(values) => joined(values),
    }
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
