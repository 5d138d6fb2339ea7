//! The fields, presets and policies that a page offers.

use crate::episode::SHIPPED;
use crate::scenes::scenes;
use jcas_core::{Config, Preset};
use jcas_policy::{BaselineKind, named_policies};
use serde::Serialize;
use serde_json::{Map, Value, json};

/// One field of the configuration, with the data that a form needs.
#[derive(Serialize)]
struct Field {
    name: &'static str,
    unit: &'static str,
    low: f64,
    high: f64,
    doc: &'static str,
}

/// Returns the fields with unit and range, each preset's values and default policy, all policies
/// with what they do, and the scenes, in JSON.
pub(crate) fn about() -> String {
    let fields: Vec<Field> = Config::FIELDS
        .iter()
        .map(|info| Field {
            name: info.name,
            unit: info.unit,
            low: info.low,
            high: info.high,
            doc: info.doc.trim(),
        })
        .collect();
    let presets: Map<String, Value> = Preset::ALL
        .iter()
        .map(|preset| (preset.name().to_owned(), json!(Config::preset(*preset))))
        .collect();
    let default_policies: Map<String, Value> = Preset::ALL
        .iter()
        .map(|preset| {
            let kind = BaselineKind::default_for(&Config::preset(*preset));
            (preset.name().to_owned(), json!(kind.name()))
        })
        .collect();
    let named = named_policies().map(|policy| (policy.name, policy.summary));
    let shipped = SHIPPED
        .iter()
        .map(|(name, _)| (*name, "a network that was trained"));
    let policies: Vec<Value> = named
        .chain(shipped)
        .map(|(name, summary)| json!({ "name": name, "summary": summary }))
        .collect();
    json!({
        "version": jcas_core::VERSION,
        "fields": fields,
        "presets": presets,
        "policies": policies,
        "default_policies": default_policies,
        "scenes": scenes(),
        "largest": { "uavs": super::episode::MOST_UAVS, "cells": super::episode::MOST_CELLS },
    })
    .to_string()
}
