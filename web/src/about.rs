//! What a mission on the page can be made of.

use crate::mission::SHIPPED;
use jcas_core::{Config, Preset};
use jcas_policy::BaselineKind;
use serde::Serialize;
use serde_json::{Map, Value, json};

/// One field of the configuration, as a form needs it.
#[derive(Serialize)]
struct Field {
    name: &'static str,
    unit: &'static str,
    low: f64,
    high: f64,
    doc: &'static str,
}

/// Fields with unit and range, the values of each preset, and the names of all policies, in JSON.
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
    let baselines = BaselineKind::ALL.iter().map(|kind| kind.name());
    let policies: Vec<&str> = baselines.chain(shipped).collect();
    json!({
        "version": jcas_core::VERSION,
        "fields": fields,
        "presets": presets,
        "policies": policies,
        "largest": { "uavs": super::mission::MOST_UAVS, "cells": super::mission::MOST_CELLS },
    })
    .to_string()
}
