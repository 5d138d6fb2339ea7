//! The trainings of a reproduction, and the flights of their policies.

use super::{Flights, GRID, key, sized_as};
use crate::campaign::pilot_name;
use crate::progress_sink::ProgressSink;
use crate::range;
use crate::scope::{CONSTANT_PILOT, Learner, Training};
use crate::table::Key;
use crate::variation::Variation;
use jcas_core::{Config, Preset};
use jcas_episode::card::{CARD, Card, StoredPolicy, load};
use jcas_train::error::TrainError;
use jcas_train::policy::files::Precision;
use jcas_train::run::{RunOutcome, RunSpec, Start};
use jcas_train::settings::Settings;

/// The folder of a training with the paper's settings in the preset `paper`.
pub(crate) fn paper_name(
    learner: &str,
    (uavs, hotspots): (u32, u32),
    constant: Option<f64>,
    seed: u64,
) -> String {
    format!(
        "{learner}-{uavs}x{hotspots}-{}-s{seed}",
        pilot_name(constant)
    )
}

/// The folder of a training with our settings.
pub(super) fn tuned_name(preset: Preset, constant: Option<f64>, seed: u64) -> String {
    format!("learned-{}-{}-s{seed}", preset.name(), pilot_name(constant))
}

impl Flights<'_> {
    /// The paper's training over the sensing range; false if stopped meanwhile.
    pub(super) fn trained_ranges(&mut self) -> Result<bool, TrainError> {
        let (ranges, trained) = self.scope.trained_ranges.clone();
        for &cells in &ranges {
            for &cell in &trained {
                for &seed in &self.scope.seeds {
                    for learner in self.scope.trained() {
                        let config = self.scope.ranged(cells, cell);
                        // The range of the preset is a cell of the grid.
                        let name = if config == self.scope.mission(Preset::Paper, cell) {
                            paper_name(learner.name, cell, None, seed)
                        } else {
                            let (uavs, hotspots) = cell;
                            format!("{}-{uavs}x{hotspots}-{cells}cells-s{seed}", learner.name)
                        };
                        let campaign = (range::EXPERIMENT, cells);
                        let flown = (learner.name, pilot_name(None));
                        let key = key(campaign, Preset::Paper, &config, flown, seed);
                        let settings = Settings {
                            seed,
                            ..learner.settings.clone()
                        };
                        if !self.trained_and_flown(&name, settings, config, &key)? {
                            return Ok(false);
                        }
                    }
                }
            }
        }
        Ok(true)
    }

    /// Our settings: one policy for the whole grid of each preset, the one that is given or one
    /// that is trained; false if stopped meanwhile.
    pub(super) fn all_tuned(&mut self) -> Result<bool, TrainError> {
        for &preset in &self.scope.presets {
            let given = self.given_for(&self.scope.mission(preset, (10, 5)));
            for (seed, policy) in given.iter().enumerate() {
                for held in [None, Some(CONSTANT_PILOT)] {
                    if self.turns.next(&(GRID, preset, seed, held), None) {
                        self.grid(preset, policy, seed as u64, held)?;
                    }
                }
                if self.turns.next(&("experiments", preset, seed), None) {
                    self.experiments(preset, policy, seed as u64)?;
                }
            }
            if !given.is_empty() {
                continue;
            }
            for &seed in &self.scope.seeds {
                for constant in [None, Some(CONSTANT_PILOT)] {
                    let name = tuned_name(preset, constant, seed);
                    if !self.turns.next(&name, Some(&name)) {
                        continue;
                    }
                    let Some(policy) = self.tuned(preset, seed, constant)? else {
                        return Ok(false);
                    };
                    self.grid(preset, &policy, seed, constant)?;
                    if constant.is_none() {
                        self.experiments(preset, &policy, seed)?;
                    }
                }
            }
        }
        Ok(true)
    }

    /// A policy with our settings for the whole grid; none if stopped meanwhile.
    fn tuned(
        &mut self,
        preset: Preset,
        seed: u64,
        constant: Option<f64>,
    ) -> Result<Option<StoredPolicy>, TrainError> {
        let name = tuned_name(preset, constant, seed);
        let settings = Settings {
            seed,
            constant_pilot: constant,
            ..self.scope.tuned.clone()
        };
        let cells = self.scope.cells();
        let configs = cells.iter().map(|&cell| self.scope.mission(preset, cell));
        self.trained(&name, settings, configs.collect())
    }

    /// The policy of a finished run, trained to the end if it is not there.
    fn trained(
        &mut self,
        name: &str,
        settings: Settings,
        configs: Vec<Config>,
    ) -> Result<Option<StoredPolicy>, TrainError> {
        let out = self.folder(name);
        if !out.join(CARD).exists() {
            self.narrator.chapter(&format!("training {name}"));
            let precision = Precision::Single;
            let plan = RunSpec {
                settings: settings.clone(),
                configs: configs.clone(),
                drawn_around: None,
                out: out.clone(),
                name: name.to_owned(),
                precision,
                device: "cpu".to_owned(),
            };
            let narrator: &mut dyn ProgressSink = self.narrator;
            if matches!(plan.train(&Start::Resume, narrator)?, RunOutcome::Stopped) {
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

    /// The paper's settings in every cell, with every credit; false if stopped meanwhile.
    pub(super) fn paper(&mut self) -> Result<bool, TrainError> {
        for training in self.scope.trainings() {
            for learner in self.scope.trained() {
                if !self.paper_cell(&learner, training)? {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    fn paper_cell(
        &mut self,
        learner: &Learner,
        Training {
            cell,
            constant,
            seed,
        }: Training,
    ) -> Result<bool, TrainError> {
        let name = paper_name(learner.name, cell, constant, seed);
        let settings = Settings {
            seed,
            constant_pilot: constant,
            ..learner.settings.clone()
        };
        let config = self.scope.mission(Preset::Paper, cell);
        let flown = (learner.name, pilot_name(constant));
        let key = key(GRID, Preset::Paper, &config, flown, seed);
        if !self.trained_and_flown(&name, settings, config, &key)? {
            return Ok(false);
        }
        let out = self.folder(&name);
        let here = self.turns.is_trained(&name) && out.join(CARD).exists();
        if here && constant.is_none() && self.scope.variation_cell() == Some(cell) {
            self.approach(learner.name, config, load(&out)?.policy(None), seed)?;
        }
        Ok(true)
    }

    /// One policy for one mission; false if stopped meanwhile. What the table has from elsewhere,
    /// without the policy, is not trained again.
    fn trained_and_flown(
        &mut self,
        name: &str,
        settings: Settings,
        config: Config,
        key: &Key,
    ) -> Result<bool, TrainError> {
        let here = self.turns.next(&(key, &settings), Some(name));
        if !here || self.is_there(key)? && !self.folder(name).join(CARD).exists() {
            return Ok(true);
        }
        let Some(policy) = self.trained(name, settings, vec![config])? else {
            return Ok(false);
        };
        self.campaign(key, config, &|| Box::new(policy.policy(None)))?;
        Ok(true)
    }

    /// The paper's settings with one thing changed at a time; false if stopped meanwhile.
    pub(super) fn variations(&mut self) -> Result<bool, TrainError> {
        let Some(cell) = self.scope.variation_cell() else {
            return Ok(true);
        };
        for variation in &self.scope.variations {
            for &seed in &self.scope.seeds {
                if !self.variation(variation, cell, seed)? {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    fn variation(
        &mut self,
        variation: &Variation,
        cell: (u32, u32),
        seed: u64,
    ) -> Result<bool, TrainError> {
        let mut config = self.scope.mission(Preset::Paper, cell);
        let mut settings = Settings {
            seed,
            ..self.scope.paper.clone()
        };
        (variation.apply)(&mut config, &mut settings);
        let name = format!("ppo-{}x{}-{}-s{seed}", cell.0, cell.1, variation.name);
        let campaign = ("variation", 0.0);
        let flown = (variation.name, pilot_name(None));
        let key = key(campaign, Preset::Paper, &config, flown, seed);
        self.trained_and_flown(&name, settings, config, &key)
    }
}

/// Whether a policy was trained with these settings and on these missions at least.
fn is_of(card: &Card, settings: &Settings, configs: &[Config]) -> bool {
    Settings::of_card(card).as_ref() == Some(settings)
        && configs.iter().all(|config| {
            let cell = (config.uav_count, config.hotspot_count);
            sized_as(config, &card.config) == card.config && card.trained_on.contains(&cell)
        })
}
