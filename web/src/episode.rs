//! An episode with the interventions of a person.

use jcas_core::host::Call;
use jcas_core::rng::derive_seed;
use jcas_core::{Cell, Config, Model, Motion, MotionMap};
use jcas_episode::replay;
use jcas_episode::trace::{self, EpisodeRecorder, Trace, TraceError};
use jcas_plan::{Planned, PlannedKind};
use jcas_policy::{BaselineKind, PilotMode, Policy, Trained};
use serde::Deserialize;
use serde_json::{Map, Value, json};

use crate::error::Refusal;
use crate::lines::Lines;

/// The largest number of UAVs, and of hotspots, that the page accepts.
pub const MOST_UAVS: u32 = 400;
/// The largest grid that the page draws.
pub const MOST_CELLS: u64 = 64 * 64;
/// The longest episode, in steps times UAVs.
const MOST_AGENT_STEPS: u64 = 200_000;

/// The largest fleet times grid that the page plans for.
const MOST_UAV_CELLS: u64 = 10_000;
/// The longest episode that the page plans for.
const MOST_PLANNED_STEPS: u32 = 2_000;
/// The moves of a plan of a search: a part of what the command takes, as a person waits for it.
const SEARCH_ITERATIONS: u64 = 50_000;

/// The trained policies that the page contains.
pub const SHIPPED: [(&str, &[u8]); 2] = [
    (
        "mission",
        include_bytes!("../../policies/mission/policy.safetensors"),
    ),
    (
        "paper",
        include_bytes!("../../policies/paper/policy.safetensors"),
    ),
];

/// An episode to run.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Episode {
    /// A configuration as `jcas` reads it: fields over a preset.
    #[serde(default)]
    config: Map<String, Value>,
    /// Name of a baseline, of a policy that plans or of a shipped policy. Without it the default
    /// one of the configuration flies.
    policy: Option<String>,
    /// Pilot mode: a number, `min`, `mid`, `max` or `adaptive`.
    pilot: String,
    /// Seed of the episode.
    seed: u32,
    /// Cells of the hotspots that the person has moved, in place of the drawn cells.
    #[serde(default)]
    moved: Vec<(usize, Cell)>,
    /// Interventions during the episode, in any order.
    #[serde(default)]
    interventions: Vec<Intervention>,
}

/// One intervention; `t` is the step that it changes, from 1.
#[derive(Clone, Copy, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
enum Intervention {
    /// The UAV makes this motion in place of its policy's.
    Steer { t: u32, uav: usize, motion: usize },
    /// The UAV's battery is emptied before the step.
    Ground { t: u32, uav: usize },
}

/// What flies the fleet: a policy that plans, whose plans are drawn, or another one.
enum Flyer {
    Planned(Planned),
    Other(Box<dyn Policy>),
}

impl Flyer {
    fn policy(&mut self) -> &mut dyn Policy {
        match self {
            Self::Planned(planned) => planned,
            Self::Other(policy) => policy.as_mut(),
        }
    }
}

/// A recorder that writes the episode into a text.
type Recorder<'m, 't> = EpisodeRecorder<'m, &'t mut Vec<u8>>;

impl Episode {
    /// Runs the episode. Returns it in the replay page's form, with the detection probability over
    /// distance, the planned trajectories and the hash of the last state.
    ///
    /// # Errors
    /// A message names the field, the value and the allowed values.
    pub(crate) fn fly(&self) -> Result<String, Refusal<'_>> {
        let config = Config::from_json(&Value::from(self.config.clone()).to_string())?;
        check_size(&config)?;
        let model = Model::new(config)?;
        let mut lines = Lines::new(model.uav_count(), config.horizon_steps);
        let trace = self.trace(&model, self.pilot(&model)?, &mut lines)?;
        let last = trace.steps.last().map(|step| step.state_hash);
        let data = replay::data_of(&trace)?;
        let hash = last.unwrap_or(trace.header.initial.state_hash);
        // The episode is long and already JSON, so it is not parsed to be written again.
        Ok(format!(
            r#"{{"state_hash":"{hash}","radar":{},"plans":{},"episode":{data}}}"#,
            radar(&model),
            lines.to_json(trace.steps.len())
        ))
    }

    fn pilot(&self, model: &Model<'_>) -> Result<Flyer, Refusal<'_>> {
        let default = BaselineKind::default_for(model.config()).name();
        let policy = self.policy.as_deref().unwrap_or(default);
        if let Some((name, bytes)) = SHIPPED.iter().find(|(name, _)| *name == policy) {
            let trained = Trained::read(name, bytes)?;
            trained.check(model)?;
            return Ok(Flyer::Other(Box::new(trained)));
        }
        if let Some(kind) = PlannedKind::named(policy) {
            return Ok(Flyer::Planned(planned(kind, model)?));
        }
        let kind = BaselineKind::named(policy).map_err(Refusal::Baseline)?;
        let pilot = PilotMode::named(&self.pilot).map_err(Refusal::Baseline)?;
        let baseline = kind.build(model, pilot).map_err(Refusal::Baseline)?;
        Ok(Flyer::Other(Box::new(baseline)))
    }

    fn trace(
        &self,
        model: &Model<'_>,
        pilot: Flyer,
        lines: &mut Lines,
    ) -> Result<Trace, Refusal<'_>> {
        self.check_interventions(model)?;
        let mut text = Vec::new();
        self.record(model, pilot, lines, &mut text)?;
        Ok(trace::read(text.as_slice())?)
    }

    fn record(
        &self,
        model: &Model<'_>,
        mut pilot: Flyer,
        lines: &mut Lines,
        text: &mut Vec<u8>,
    ) -> Result<(), TraceError> {
        let seed = derive_seed(u64::from(self.seed), 0);
        let policy = pilot.policy();
        let density = policy.pilot().to_string();
        let mut episode = EpisodeRecorder::begin(model, seed, (policy.name(), &density), text)?;
        policy.reset(model, seed);
        self.place(&mut episode)?;
        let mut actions = vec![0.0; model.action_len()];
        for t in 1.. {
            if episode.over() {
                break;
            }
            let now = || self.interventions.iter().filter(|given| given.step() == t);
            for intervention in now() {
                intervention.change(&mut episode)?;
            }
            episode.ask(pilot.policy(), &mut actions);
            if let Flyer::Planned(planned) = &pilot {
                lines.record(planned, t - 1);
            }
            for intervention in now() {
                intervention.steer(model.config().motion_map, &mut actions);
            }
            episode.step(&actions, &[])?;
        }
        episode.end().map(|_| ())
    }

    fn place(&self, episode: &mut Recorder<'_, '_>) -> Result<(), TraceError> {
        if self.moved.is_empty() {
            return Ok(());
        }
        let state = episode.state();
        let mut cells: Vec<Cell> = (0..state.hotspot_count())
            .map(|hotspot| state.hotspot_cell(hotspot))
            .collect();
        for &(hotspot, cell) in &self.moved {
            cells[hotspot] = cell;
        }
        episode.call(&Call::SetHotspots { cells: &cells })
    }

    fn check_interventions(&self, model: &Model<'_>) -> Result<(), Refusal<'_>> {
        let below = |what: &'static str, index: usize, count: usize| {
            let refused = Refusal::Index { what, index, count };
            if index < count { Ok(()) } else { Err(refused) }
        };
        for (hotspot, _) in &self.moved {
            below("hotspot", *hotspot, model.hotspot_count())?;
        }
        for intervention in &self.interventions {
            if intervention.step() == 0 {
                return Err(Refusal::StepZero);
            }
            match *intervention {
                Intervention::Steer { uav, motion, .. } => {
                    below("uav", uav, model.uav_count())?;
                    below("motion", motion, Motion::ALL.len())?;
                }
                Intervention::Ground { uav, .. } => below("uav", uav, model.uav_count())?,
            }
        }
        Ok(())
    }
}

impl Intervention {
    fn step(self) -> u32 {
        match self {
            Self::Steer { t, .. } | Self::Ground { t, .. } => t,
        }
    }

    /// Applies the interventions that change the state before a step.
    fn change(self, episode: &mut Recorder<'_, '_>) -> Result<(), TraceError> {
        match self {
            Self::Steer { .. } => Ok(()),
            Self::Ground { uav, .. } => episode.call(&Call::SetBattery { uav, charge_uj: 0 }),
        }
    }

    /// Applies the interventions that change the actions of a step.
    fn steer(self, map: MotionMap, actions: &mut [f32]) {
        if let Self::Steer { uav, motion, .. } = self {
            actions[2 * uav] = Motion::ALL[motion].to_action(map);
        }
    }
}

fn planned(kind: PlannedKind, model: &Model<'_>) -> Result<Planned, Refusal<'static>> {
    let uav_cells = model.uav_count() as u64 * model.config().cell_count() as u64;
    if uav_cells > MOST_UAV_CELLS {
        return Err(Refusal::PlanSize {
            field: "uav_count x grid_width x grid_height",
            value: uav_cells,
            most: MOST_UAV_CELLS,
        });
    }
    let steps = model.config().horizon_steps;
    if steps > MOST_PLANNED_STEPS {
        return Err(Refusal::PlanSize {
            field: "horizon_steps",
            value: steps.into(),
            most: MOST_PLANNED_STEPS.into(),
        });
    }
    Ok(kind.build_in(model, SEARCH_ITERATIONS)?)
}

/// Refuses an episode that would take minutes, since a person waits for the page.
fn check_size(config: &Config) -> Result<(), Refusal<'static>> {
    let agent_steps = u64::from(config.uav_count) * u64::from(config.horizon_steps);
    for (field, value, most) in [
        (
            "uav_count",
            u64::from(config.uav_count),
            u64::from(MOST_UAVS),
        ),
        (
            "hotspot_count",
            u64::from(config.hotspot_count),
            u64::from(MOST_UAVS),
        ),
        (
            "grid_width x grid_height",
            config.cell_count() as u64,
            MOST_CELLS,
        ),
        ("uav_count x horizon_steps", agent_steps, MOST_AGENT_STEPS),
    ] {
        if value > most {
            return Err(Refusal::RunSize { field, value, most });
        }
    }
    Ok(())
}

/// Radar and link over distance along a row, in cells. `low` and `high` are the probabilities that
/// one UAV detects, at the lowest and the highest pilot density. `quorum` is the probability at the
/// highest density that as many UAVs as the quorum, all at this distance, detect in one step.
fn radar(model: &Model<'_>) -> Value {
    let config = model.config();
    let quorum = f64::from(config.quorum);
    let farthest = config.grid_width.min(9);
    let rows = (0..farthest).map(|cells| {
        let (least, greatest) = (config.pilot_density_min, config.pilot_density_max);
        let detects = |density| model.detection_probability(cells, 0, density);
        let links =
            |density| model.link_throughput(cells, 0, density) >= config.link_throughput_min;
        json!({
            "cells": cells,
            "low": detects(least),
            "high": detects(greatest),
            "quorum": detects(greatest).powf(quorum),
            "link_low": links(least),
            "link_high": links(greatest),
        })
    });
    Value::Array(rows.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use jcas_episode::trace::Hex;

    fn fly(question: &Value) -> Value {
        serde_json::from_str(&crate::answer(&question.to_string())).unwrap()
    }

    fn episode(interventions: Value) -> Value {
        json!({
            "ask": "fly", "policy": "teams", "pilot": "max", "seed": 7,
            "interventions": interventions,
            "config": { "uav_count": 6, "hotspot_count": 2, "detection_threshold_db": -23.75 },
        })
    }

    fn last_hash(answer: &Value) -> &str {
        answer["state_hash"]
            .as_str()
            .unwrap_or_else(|| panic!("{answer}"))
    }

    #[test]
    fn without_deeds_it_is_the_mission_that_the_kernel_flies() {
        let config = Config::from_json(
            r#"{"uav_count": 6, "hotspot_count": 2, "detection_threshold_db": -23.75}"#,
        )
        .unwrap();
        let model = Model::new(config).unwrap();
        let mut policy = BaselineKind::Teams.build(&model, PilotMode::Max).unwrap();
        let mut sim = jcas_core::Sim::new(&model);
        let seed = derive_seed(7, 0);
        sim.reset(seed);
        policy.reset(&model, seed);
        let mut actions = vec![0.0; model.action_len()];
        while !(sim.state().terminated() || sim.state().truncated()) {
            policy.act(&model, &sim.state(), &mut actions);
            sim.step(&actions).unwrap();
        }
        let flown = fly(&episode(json!([])));
        assert_eq!(last_hash(&flown), Hex(sim.state_hash()).to_string());
    }

    #[test]
    fn a_plan_is_flown_and_its_time_is_bounded() {
        for (policy, preset) in [("plan", "search"), ("plan", "paper"), ("replan", "paper")] {
            let mut question = json!({
                "ask": "fly", "policy": policy, "pilot": "max", "seed": 7,
                "config": { "preset": preset, "uav_count": 6, "hotspot_count": 2 },
            });
            let flown = fly(&question);
            assert_eq!(flown["episode"]["header"]["policy"], policy, "{flown}");
            assert_eq!(last_hash(&flown), last_hash(&fly(&question)));
            assert_flown_as_planned(&flown);
            question["config"]["uav_count"] = json!(100);
            let refused = fly(&question);
            let reason = refused["error"].as_str().unwrap();
            assert!(
                reason.contains("= 14400: the page plans for at most 10000"),
                "{reason}"
            );
            question["config"]["uav_count"] = json!(6);
            question["config"]["horizon_steps"] = json!(2001);
            let refused = fly(&question);
            let reason = refused["error"].as_str().unwrap();
            assert!(
                reason.contains("horizon_steps = 2001: the page plans for at most 2000"),
                "{reason}"
            );
        }
    }

    /// Each UAV is where its last plan says. An answer to a script has no plans.
    fn assert_flown_as_planned(flown: &Value) {
        let steps = flown["episode"]["steps"].as_array().unwrap();
        for (uav, lines) in flown["plans"].as_array().unwrap().iter().enumerate() {
            for (t, step) in steps.iter().enumerate() {
                let lines = lines.as_array().unwrap();
                let first = |line: &&Value| line[0].as_u64().unwrap() as usize;
                let line = lines.iter().rfind(|line| first(line) <= t).unwrap();
                let cell = &line[1][t + 1 - first(&line)];
                let at = &step["positions"][uav];
                let index = at[0].as_u64().unwrap() + 12 * at[1].as_u64().unwrap();
                assert_eq!(cell.as_u64(), Some(index), "UAV {uav}, step {}", t + 1);
            }
        }
        let script = fly(&episode(json!([])));
        assert_eq!(script["plans"], json!([[], [], [], [], [], []]));
    }

    #[test]
    fn a_steered_uav_goes_where_it_is_sent_and_the_rest_of_the_mission_differs() {
        let steered = fly(&episode(
            json!([{ "do": "steer", "t": 1, "uav": 3, "motion": 0 }]),
        ));
        let start = &steered["episode"]["header"]["initial"]["positions"][3];
        let after = &steered["episode"]["steps"][0]["positions"][3];
        assert_eq!(after[0], start[0]);
        assert_eq!(after[1].as_u64(), start[1].as_u64().map(|y| y + 1));
        assert_ne!(last_hash(&steered), last_hash(&fly(&episode(json!([])))));
    }

    #[test]
    fn a_grounded_uav_stays_and_a_moved_hotspot_lies_elsewhere() {
        let mut question = episode(json!([{ "do": "ground", "t": 2, "uav": 0 }]));
        question["moved"] = json!([[1, [0, 0]]]);
        let flown = fly(&question);
        assert_eq!(flown["episode"]["header"]["hotspots"][1], json!([0, 0]));
        let step = |t: usize| &flown["episode"]["steps"][t - 1];
        assert_eq!(step(2)["grounded"], json!([0]));
        assert_eq!(step(2)["positions"][0], step(1)["positions"][0]);
    }

    #[test]
    fn what_cannot_be_flown_is_said() {
        let refused = |question: Value| fly(&question)["error"].as_str().unwrap().to_owned();
        let with = |key: &str, value: Value| {
            let mut question = episode(json!([]));
            question[key] = value;
            refused(question)
        };
        assert!(with("policy", json!("fly")).ends_with("answer, plan, replan"));
        assert!(with("config", json!({ "uav_count": 401 })).contains("uav_count = 401"));
        assert!(with("config", json!({ "quorum": -1 })).contains("quorum"));
        assert!(with("config", json!({ "target_visibility": "hidden" })).contains("teams"));
        let given = |intervention: Value| refused(episode(json!([intervention])));
        assert!(given(json!({ "do": "steer", "t": 1, "uav": 6, "motion": 0 })).contains("uav = 6"));
        assert!(
            given(json!({ "do": "steer", "t": 1, "uav": 0, "motion": 5 })).contains("motion = 5")
        );
        assert!(given(json!({ "do": "ground", "t": 0, "uav": 0 })).contains("t = 0"));
        assert!(with("moved", json!([[2, [0, 0]]])).contains("hotspot = 2"));
        assert!(with("moved", json!([[0, [12, 0]]])).contains("12"));
        assert!(refused(json!({ "ask": "sing" })).contains("sing"));
        assert!(crate::answer("{").contains("error"));
    }
}
