//! The fields, presets and policies that a page offers.

use crate::mission::SHIPPED;
use jcas_core::{Config, Preset};
use jcas_policy::named_policies;
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

/// Returns the fields with unit and range, each preset's values, and all policies' names, in JSON.
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
    let shipped = SHIPPED.iter().map(|(name, _)| *name);
    let named = named_policies().map(|policy| policy.name);
    let policies: Vec<&str> = named.chain(shipped).collect();
    json!({
        "version": jcas_core::VERSION,
        "fields": fields,
        "presets": presets,
        "policies": policies,
        "largest": { "uavs": super::mission::MOST_UAVS, "cells": super::mission::MOST_CELLS },
    })
    .to_string()
}
