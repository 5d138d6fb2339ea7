//! Training and flying what the table lacks.

use super::plan::{CONSTANT_PILOT, Scale, Variation};
use super::table::{Key, Table};
use super::{Narrator, Progress};
use jcas_core::{Config, Model, Sim};
use jcas_evaluate::mission::{Campaign, fly};
use jcas_evaluate::policy::{BaselineKind, PilotMode, Policy, action_of};
use jcas_evaluate::statistics::Summary;
use jcas_train::error::TrainError;
use jcas_train::policy::files::{CARD, Card, Precision, Stored, load};
use jcas_train::policy::{Actor, LearnedPolicy, Mode};
use jcas_train::run::{EVALUATION_SEED, Ending, Plan};
use jcas_train::settings::Settings;
use jcas_train::store::write_whole;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

/// The baselines that stand beside learned policies; the other searchers have nothing to search here.
const BASELINES: [BaselineKind; 5] = [
    BaselineKind::Random,
    BaselineKind::Greedy,
    BaselineKind::Swarm,
    BaselineKind::Teams,
    BaselineKind::Sweep,
];

type Factory<'a> = &'a (dyn Fn() -> Box<dyn Policy> + Sync);

/// Where the trained policies of a reproduction lie.
pub const POLICIES: &str = "policies";

struct Flights<'a> {
    scale: &'a Scale,
    out: &'a Path,
    table: &'a mut Table,
    narrator: &'a mut dyn Narrator,
}

/// Everything, in an order in which early parts already tell something.
pub(super) fn fly_all(
    scale: &Scale,
    out: &Path,
    table: &mut Table,
    narrator: &mut dyn Narrator,
) -> Result<Progress, TrainError> {
    let mut flights = Flights {
        scale,
        out,
        table,
        narrator,
    };
    flights.baselines()?;
    for &seed in &scale.seeds {
        for constant in [None, Some(CONSTANT_PILOT)] {
            let Some(policy) = flights.tuned(seed, constant)? else {
                return Ok(Progress::Stopped);
            };
            flights.grid(&policy, seed, constant)?;
            if constant.is_none() {
                flights.trade_off(&policy, seed)?;
                flights.batteries(&policy, seed)?;
                flights.approach(&policy, seed)?;
            }
        }
    }
    for &(uavs, hotspots) in &scale.paper_cells {
        for &seed in &scale.seeds {
            for constant in [None, Some(CONSTANT_PILOT)] {
                if !flights.paper(uavs, hotspots, seed, constant)? {
                    return Ok(Progress::Stopped);
                }
            }
        }
    }
    for variation in &scale.variations {
        for &seed in &scale.seeds {
            if !flights.variation(variation, seed)? {
                return Ok(Progress::Stopped);
            }
        }
    }
    Ok(if flights.stopped() {
        Progress::Stopped
    } else {
        Progress::Finished
    })
}

fn key(experiment: &str, config: &Config, policy: &str, pilot: &str, seed: u64, x: f64) -> Key {
    let paper = jcas_core::Preset::Paper;
    let as_paper = Config {
        uav_count: config.uav_count,
        hotspot_count: config.hotspot_count,
        ..Config::preset(paper)
    };
    Key {
        experiment: experiment.to_owned(),
        preset: if *config == as_paper {
            "paper"
        } else {
            "mission"
        }
        .to_owned(),
        uavs: config.uav_count,
        hotspots: config.hotspot_count,
        policy: policy.to_owned(),
        pilot: pilot.to_owned(),
        seed,
        x,
    }
}

impl Flights<'_> {
    fn stopped(&mut self) -> bool {
        self.narrator.stop()
    }

    /// One campaign, unless it is there.
    fn campaign(&mut self, key: &Key, config: Config, make: Factory) -> Result<(), TrainError> {
        let episodes = self.scale.episodes;
        match self.table.find(key) {
            Some(row) if row.episodes != episodes => {
                return Err(TrainError::Setting(format!(
                    "{}: holds campaigns of {} missions, this reproduction flies {episodes}; \
                     give another folder",
                    self.out.display(),
                    row.episodes
                )));
            }
            Some(_) => return Ok(()),
            None => {}
        }
        if self.stopped() {
            return Ok(());
        }
        let refused = |error: &dyn std::fmt::Display| TrainError::Setting(error.to_string());
        let model = Model::new(config).map_err(|error| refused(&error))?;
        let campaign = Campaign {
            episodes: self.scale.episodes,
            seed: EVALUATION_SEED,
        };
        let missions = fly(&model, campaign, make, &|| ControlFlow::Continue(()))
            .map_err(|error| refused(&error))?;
        self.table
            .add(key, &Summary::of(&missions, config.horizon_steps))
    }

    fn baselines(&mut self) -> Result<(), TrainError> {
        self.narrator.chapter("baselines over the grid");
        for (uavs, hotspots) in self.scale.cells() {
            let config = self.scale.mission(uavs, hotspots);
            for kind in BASELINES {
                for pilot in [PilotMode::Adaptive, PilotMode::Max] {
                    let key = key("grid", &config, kind.name(), &pilot.name(), 0, 0.0);
                    self.campaign(&key, config, &|| Box::new(kind.build_privileged(pilot)))?;
                }
            }
        }
        Ok(())
    }

    /// A policy with our settings for the whole grid; none if stopped meanwhile.
    fn tuned(&mut self, seed: u64, constant: Option<f64>) -> Result<Option<Stored>, TrainError> {
        let name = format!("learned-{}-s{seed}", pilot_name(constant));
        let settings = Settings {
            seed,
            constant_pilot: constant,
            ..self.scale.tuned.clone()
        };
        let cells = self.scale.cells();
        let configs = cells
            .iter()
            .map(|&(uavs, hotspots)| self.scale.mission(uavs, hotspots));
        self.trained(&name, settings, configs.collect())
    }

    /// The policy of a finished run, trained to the end if it is not there.
    fn trained(
        &mut self,
        name: &str,
        settings: Settings,
        configs: Vec<Config>,
    ) -> Result<Option<Stored>, TrainError> {
        let out = self.out.join(POLICIES).join(name);
        if !out.join(CARD).exists() {
            self.narrator.chapter(&format!("training {name}"));
            let precision = Precision::Single;
            let plan = Plan {
                settings: settings.clone(),
                configs: configs.clone(),
                out: out.clone(),
                name: name.to_owned(),
                precision,
            };
            let narrator: &mut dyn Narrator = self.narrator;
            if matches!(plan.train(true, narrator)?, Ending::Stopped) {
                return Ok(None);
            }
        }
        let policy = load(&out)?;
        if !is_of(&policy.card, &settings, &configs) {
            return Err(TrainError::Setting(format!(
                "{}: was trained with other settings or on other missions; give another folder",
                out.display()
            )));
        }
        Ok(Some(policy))
    }

    fn grid(
        &mut self,
        policy: &Stored,
        seed: u64,
        constant: Option<f64>,
    ) -> Result<(), TrainError> {
        self.narrator
            .chapter(&format!("flying {} over the grid", policy.card.name));
        for (uavs, hotspots) in self.scale.cells() {
            let config = self.scale.mission(uavs, hotspots);
            let key = key("grid", &config, "learned", pilot_name(constant), seed, 0.0);
            self.campaign(&key, config, &|| Box::new(policy.policy(None)))?;
        }
        Ok(())
    }

    /// Success against throughput: the motions of the learned policy and of `teams`, the pilot density held.
    fn trade_off(&mut self, policy: &Stored, seed: u64) -> Result<(), TrainError> {
        self.narrator.chapter("sensing against communication");
        let (uavs, hotspots) = self.scale.hard_cell();
        let config = self.scale.mission(uavs, hotspots);
        for &density in &self.scale.densities {
            let held = action_of(&config, density);
            let actor = Arc::new(Actor {
                constant_pilot: Some(held),
                ..Actor::clone(&policy.actor)
            });
            let key_of = |policy, seed| key("density", &config, policy, "held", seed, density);
            let key = key_of("learned", seed);
            let mode = policy.card.mode;
            self.campaign(&key, config, &|| {
                Box::new(LearnedPolicy::new("held", &actor, mode))
            })?;
            let key = key_of("teams", 0);
            let pilot = PilotMode::Held(density);
            self.campaign(&key, config, &|| {
                Box::new(BaselineKind::Teams.build_privileged(pilot))
            })?;
        }
        Ok(())
    }

    fn batteries(&mut self, policy: &Stored, seed: u64) -> Result<(), TrainError> {
        self.narrator.chapter("small batteries");
        for &share in &self.scale.renewable_shares {
            let config = self.scale.small_battery(share);
            let learned = key("battery", &config, "learned", "adaptive", seed, share);
            self.campaign(&learned, config, &|| Box::new(policy.policy(None)))?;
            let teams = key("battery", &config, "teams", "adaptive", 0, share);
            self.campaign(&teams, config, &|| {
                Box::new(BaselineKind::Teams.build_privileged(PilotMode::Adaptive))
            })?;
        }
        Ok(())
    }

    /// Pilot density over distance to the nearest unconfirmed hotspot, as a table of its own.
    fn approach(&mut self, policy: &Stored, seed: u64) -> Result<(), TrainError> {
        let path = self.out.join(format!("approach-s{seed}.csv"));
        if path.exists() || self.stopped() {
            return Ok(());
        }
        let (uavs, hotspots) = self.scale.hard_cell();
        let config = self.scale.mission(uavs, hotspots);
        let model = Model::new(config).map_err(|error| TrainError::Setting(error.to_string()))?;
        let bins = observe_approach(&model, policy, self.scale.episodes.min(100))
            .map_err(|error| TrainError::Setting(error.to_string()))?;
        let mut text = String::from("distance_cells,uav_steps,pilot_density_mean\n");
        for (distance, (count, sum)) in bins.iter().enumerate() {
            if *count > 0 {
                text += &format!("{distance},{count},{:.6}\n", sum / *count as f64);
            }
        }
        write_whole(&path, text.as_bytes())
    }

    /// The paper's settings on one cell; false if stopped meanwhile.
    fn paper(
        &mut self,
        uavs: u32,
        hotspots: u32,
        seed: u64,
        constant: Option<f64>,
    ) -> Result<bool, TrainError> {
        let pilot = pilot_name(constant);
        let name = format!("ppo-{uavs}x{hotspots}-{pilot}-s{seed}");
        let settings = Settings {
            seed,
            constant_pilot: constant,
            ..self.scale.paper.clone()
        };
        let config = self.scale.paper_mission(uavs, hotspots);
        let Some(policy) = self.trained(&name, settings, vec![config])? else {
            return Ok(false);
        };
        let key = key("grid", &config, "ppo", pilot, seed, 0.0);
        self.campaign(&key, config, &|| Box::new(policy.policy(None)))?;
        Ok(true)
    }

    /// The paper's settings with one thing changed; false if stopped meanwhile.
    fn variation(&mut self, variation: &Variation, seed: u64) -> Result<bool, TrainError> {
        let Some((uavs, hotspots)) = self.scale.variation_cell() else {
            return Ok(true);
        };
        let mut config = self.scale.paper_mission(uavs, hotspots);
        let mut settings = Settings {
            seed,
            ..self.scale.paper.clone()
        };
        (variation.apply)(&mut config, &mut settings);
        let name = format!("ppo-{uavs}x{hotspots}-{}-s{seed}", variation.name);
        let Some(policy) = self.trained(&name, settings, vec![config])? else {
            return Ok(false);
        };
        let key = key("variation", &config, variation.name, "adaptive", seed, 0.0);
        self.campaign(&key, config, &|| Box::new(policy.policy(None)))?;
        Ok(true)
    }
}

/// Whether a policy was trained with these settings and on these missions at least.
fn is_of(card: &Card, settings: &Settings, configs: &[Config]) -> bool {
    card.settings.as_ref() == Some(settings)
        && configs.iter().all(|config| {
            let sized = Config {
                uav_count: card.config.uav_count,
                hotspot_count: card.config.hotspot_count,
                ..*config
            };
            let cell = (config.uav_count, config.hotspot_count);
            sized == card.config && card.trained_on.contains(&cell)
        })
}

fn pilot_name(constant: Option<f64>) -> &'static str {
    if constant.is_some() {
        "constant"
    } else {
        "adaptive"
    }
}

/// For each Manhattan distance: how many UAV-steps, and the sum of their pilot densities.
fn observe_approach(
    model: &Model<'static>,
    policy: &Stored,
    episodes: u64,
) -> Result<Vec<(u64, f64)>, jcas_core::Error> {
    let config = model.config();
    let mut bins = vec![(0, 0.0); (config.grid_width + config.grid_height) as usize];
    let mut sim = Sim::new(model);
    let mut policy = policy.policy(Some(Mode::Deterministic));
    let mut observations = vec![0.0; model.uav_count() * model.observation_len()];
    let mut actions = vec![0.0; model.action_len()];
    let campaign = Campaign {
        episodes,
        seed: EVALUATION_SEED,
    };
    for episode in 0..episodes {
        let seed = campaign.episode_seed(episode);
        sim.reset(seed);
        policy.reset(model, seed);
        for _ in 0..config.horizon_steps {
            sim.observe(&mut observations)?;
            policy.see(&observations);
            policy.act(model, &sim.state(), &mut actions);
            let before: Vec<Option<u32>> = nearest_unconfirmed(model, &sim);
            let outcome = sim.step(&actions)?;
            for (uav, distance) in before.iter().enumerate() {
                if let Some(distance) = distance {
                    let bin = &mut bins[*distance as usize];
                    bin.0 += 1;
                    bin.1 += sim.state().pilot_density(uav);
                }
            }
            if outcome.terminated || outcome.truncated {
                break;
            }
        }
    }
    Ok(bins)
}

fn nearest_unconfirmed(model: &Model<'static>, sim: &Sim<'_>) -> Vec<Option<u32>> {
    let state = sim.state();
    (0..model.uav_count())
        .map(|uav| {
            (0..model.hotspot_count())
                .filter(|&hotspot| !state.confirmed(hotspot))
                .map(|hotspot| state.cell(uav).manhattan(state.hotspot_cell(hotspot)))
                .min()
        })
        .collect()
}
