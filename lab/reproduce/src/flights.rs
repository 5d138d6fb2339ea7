//! Training and flying what the table lacks.

use crate::campaign::{CampaignSpec, HELD, OURS, Who, pilot_name};
use crate::progress_sink::{Progress, ProgressSink};
use crate::scope::{Part, Scope};
use crate::shard::{Comparisons, Turns};
use crate::table::{Key, Table};
use crate::{comparison, endurance, pilot, pilot_by_distance, range};
use jcas_core::{Config, Model, Preset};
use jcas_episode::card::{CARD, CardError, EVALUATION_SEED, StoredPolicy, load};
use jcas_episode::mission::{Campaign, fly};
use jcas_episode::shard::Shard;
use jcas_episode::statistics::Summary;
use jcas_policy::{BaselineKind, PilotMode, Policy, Trained, action_of};
use jcas_train::error::TrainError;
use jcas_train::store::write_whole;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

mod mission;
mod trainings;

pub(crate) use trainings::paper_name;
use trainings::tuned_name;

/// The baselines that stand beside learned policies; the other searchers have nothing to search
/// here.
pub(crate) const BASELINES: [BaselineKind; 5] = [
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
    scope: &'a Scope,
    out: &'a Path,
    table: &'a mut Table,
    narrator: &'a mut dyn ProgressSink,
    given: Vec<Arc<StoredPolicy>>,
    shard: Option<Shard>,
    turns: Turns,
}

/// The parts that are asked for, in an order in which early ones already tell something; in a shard
/// its units only. The caller writes the table.
pub(crate) fn fly_all(
    scope: &Scope,
    out: &Path,
    table: &mut Table,
    shard: Option<Shard>,
    narrator: &mut dyn ProgressSink,
) -> Result<(Progress, Turns), TrainError> {
    let turns = Turns::new(shard, scope)?;
    let given = scope.given.iter().map(|at| load(at).map(Arc::new));
    let given: Result<_, CardError> = given.collect();
    let mut flights = Flights {
        scope,
        out,
        table,
        narrator,
        given: given?,
        shard,
        turns,
    };
    let progress = flights.all_parts()?;
    Ok((progress, flights.turns))
}

fn key(
    (experiment, x): (&str, f64),
    preset: Preset,
    config: &Config,
    (policy, pilot): (&str, &str),
    seed: u64,
) -> Key {
    Key {
        experiment: experiment.to_owned(),
        preset: preset.name().to_owned(),
        uavs: config.uav_count,
        hotspots: config.hotspot_count,
        policy: policy.to_owned(),
        pilot: pilot.to_owned(),
        seed,
        x,
        config_hash: format!("0x{:016x}", config.hash()),
    }
}

/// A setting that the kernel does not accept.
fn refused(error: impl std::fmt::Display) -> TrainError {
    TrainError::Setting(error.to_string())
}

const GRID: (&str, f64) = ("grid", 0.0);

impl Flights<'_> {
    fn all_parts(&mut self) -> Result<Progress, TrainError> {
        for part in Part::ALL {
            if !self.scope.parts.contains(&part) {
                continue;
            }
            let whole = match part {
                Part::Baselines => self.baselines()?,
                Part::SensingRange => {
                    self.flown("success over the sensing range", range::flights(self.scope))?
                }
                Part::Pilot => self.flown("adaptive pilots", pilot::flights(self.scope))?,
                Part::Endurance => self.flown("endurance", endurance::flights(self.scope))?,
                Part::Tuned => self.all_tuned()?,
                Part::Comparison => self.comparison()?,
                Part::Paper => self.paper()?,
                Part::TrainedRanges => self.trained_ranges()?,
                Part::Variations => self.variations()?,
            };
            if !whole || self.stopped() {
                return Ok(Progress::Stopped);
            }
        }
        Ok(Progress::Finished)
    }

    fn folder(&self, policy: &str) -> PathBuf {
        self.out.join(POLICIES).join(policy)
    }

    fn stopped(&mut self) -> bool {
        self.narrator.stop()
    }

    /// The given policies that were trained on missions like this, for any number of UAVs and
    /// hotspots.
    fn given_for(&self, config: &Config) -> Vec<Arc<StoredPolicy>> {
        let like = |policy: &&Arc<StoredPolicy>| {
            sized_as(config, &policy.card.config) == policy.card.config
        };
        self.given.iter().filter(like).cloned().collect()
    }

    /// Campaigns without training.
    fn flown(&mut self, chapter: &str, flights: Vec<CampaignSpec>) -> Result<bool, TrainError> {
        self.narrator.chapter(chapter);
        for flight in flights {
            let CampaignSpec {
                experiment: (experiment, x),
                preset,
                config,
                who,
            } = flight;
            let campaign = (experiment.as_str(), x);
            match who {
                Who::Script(kind, pilot) => {
                    let mode = match pilot {
                        PilotMode::Fixed(_) => HELD.to_owned(),
                        named => named.name(),
                    };
                    let key = key(campaign, preset, &config, (kind.name(), &mode), 0);
                    if self.turns.next(&key, None) {
                        self.campaign(&key, config, &|| Box::new(kind.build_privileged(pilot)))?;
                    }
                }
                Who::Ours { base, held } => {
                    for (seed, policy) in self.given_for(&base).iter().enumerate() {
                        let pilot = held.map_or(pilot_name(None), |_| HELD);
                        let key = key(campaign, preset, &config, (OURS, pilot), seed as u64);
                        if self.turns.next(&key, None) {
                            self.ours(&key, config, policy, held)?;
                        }
                    }
                }
            }
        }
        Ok(true)
    }

    /// Scripts, plans and our policy in every cell; false if stopped meanwhile.
    fn comparison(&mut self) -> Result<bool, TrainError> {
        let mut compared = Comparisons::open(self.out, self.shard)?;
        let mut presets = self.scope.presets.clone();
        presets.insert(1, Preset::Search);
        for units in comparison::Unit::PASSES {
            for &preset in &presets {
                for &unit in units {
                    self.narrator
                        .chapter(&format!("comparing in {}: {unit:?}", preset.name()));
                    for cell in self.scope.cells() {
                        if self.stopped() {
                            return Ok(false);
                        }
                        let place = comparison::ComparedCell {
                            preset,
                            config: self.scope.mission(preset, cell),
                            missions: comparison::MISSIONS.min(self.scope.episodes),
                            densities: &self.scope.pilot_densities.0,
                        };
                        let here = self.compared_here(&place, unit)?;
                        if !here || place.is_there(unit, &compared.rows)? {
                            continue;
                        }
                        let ours = self.compared(preset)?;
                        let rows = place.rows(unit, ours.as_deref())?;
                        compared.add(self.turns.unit(), rows)?;
                    }
                }
            }
        }
        Ok(true)
    }

    /// Whether a unit of the comparison is flown here. A policy that this reproduction trains flies
    /// in the shard that trains it.
    fn compared_here(
        &mut self,
        place: &comparison::ComparedCell,
        unit: comparison::Unit,
    ) -> Result<bool, TrainError> {
        let what = (place.preset, place.config.hash(), unit);
        if unit != comparison::Unit::Ours {
            return Ok(self.turns.next(&what, None));
        }
        let name = tuned_name(place.preset, None, 0);
        let is_trained = self.turns.is_trained(&name);
        let folder = self.folder(&name);
        if !is_trained && folder.join(CARD).exists() {
            self.turns.add_policy(&folder)?;
        }
        let policy = is_trained.then_some(name.as_str());
        Ok(self.turns.next(&what, policy))
    }

    /// The first of our policies for a preset, given or trained here.
    fn compared(&self, preset: Preset) -> Result<Option<Arc<StoredPolicy>>, TrainError> {
        let given = self.given_for(&self.scope.mission(preset, (10, 5)));
        let out = self.folder(&tuned_name(preset, None, 0));
        match given.into_iter().next() {
            None if out.join(CARD).exists() => Ok(Some(Arc::new(load(&out)?))),
            first => Ok(first),
        }
    }

    /// A policy of ours, as it is or with its pilot density held.
    fn ours(
        &mut self,
        key: &Key,
        config: Config,
        policy: &StoredPolicy,
        held: Option<f64>,
    ) -> Result<(), TrainError> {
        let held = held.map(|density| policy.clone().holding(action_of(&config, density)));
        let policy = held.as_ref().unwrap_or(policy);
        self.campaign(key, config, &|| Box::new(policy.policy(None)))
    }

    /// Whether a campaign is in the table; refused where the table is of another reproduction.
    fn is_there(&self, key: &Key) -> Result<bool, TrainError> {
        let episodes = self.scope.episodes;
        match self.table.find(key) {
            Some(row) if row.episodes != episodes => Err(TrainError::Setting(format!(
                "{}: holds campaigns of {} missions, this reproduction flies {episodes}; \
                 give another folder",
                self.out.display(),
                row.episodes
            ))),
            Some(row) if row.config_hash != key.config_hash => Err(TrainError::Setting(format!(
                "{}: holds {} {} at N = {}, n = {} of another configuration; give another folder",
                self.out.display(),
                row.experiment,
                row.policy,
                row.uavs,
                row.hotspots
            ))),
            found => Ok(found.is_some()),
        }
    }

    /// One campaign, unless it is there.
    fn campaign(&mut self, key: &Key, config: Config, make: Factory) -> Result<(), TrainError> {
        if self.is_there(key)? {
            return Ok(());
        }
        if self.stopped() {
            return Ok(());
        }
        let model = Model::new(config).map_err(refused)?;
        let campaign = Campaign {
            episodes: self.scope.episodes,
            seed: EVALUATION_SEED,
        };
        let missions =
            fly(&model, campaign, make, &|| ControlFlow::Continue(())).map_err(refused)?;
        let summary = Summary::of(&missions, config.horizon_steps);
        self.table.add(self.turns.unit(), key, &summary)
    }

    /// Pilot density over distance to the nearest unconfirmed hotspot, as a table of its own.
    fn approach(
        &mut self,
        name: &str,
        config: Config,
        policy: Trained,
        seed: u64,
    ) -> Result<(), TrainError> {
        let path = self.out.join(pilot_by_distance::table(name, seed));
        if path.exists() || self.stopped() {
            return Ok(());
        }
        let model = Model::new(config).map_err(refused)?;
        let missions = pilot_by_distance::missions(self.scope);
        let bins = pilot_by_distance::observe(&model, policy, missions).map_err(refused)?;
        write_whole(&path, pilot_by_distance::text(&bins).as_bytes())
    }

    fn baselines(&mut self) -> Result<bool, TrainError> {
        self.narrator.chapter("baselines over the grid");
        for &preset in &self.scope.presets {
            for cell in self.scope.cells() {
                let config = self.scope.mission(preset, cell);
                for kind in BASELINES {
                    for pilot in [PilotMode::Adaptive, PilotMode::Mid, PilotMode::Max] {
                        let flown = (kind.name(), pilot.name());
                        let key = key(GRID, preset, &config, (flown.0, &flown.1), 0);
                        if self.turns.next(&key, None) {
                            self.campaign(&key, config, &|| {
                                Box::new(kind.build_privileged(pilot))
                            })?;
                        }
                    }
                }
            }
        }
        Ok(true)
    }

    fn grid(
        &mut self,
        preset: Preset,
        policy: &StoredPolicy,
        seed: u64,
        constant: Option<f64>,
    ) -> Result<(), TrainError> {
        self.narrator
            .chapter(&format!("flying {} over the grid", policy.card.name));
        for cell in self.scope.cells() {
            let config = self.scope.mission(preset, cell);
            let key = key(GRID, preset, &config, (OURS, pilot_name(constant)), seed);
            self.ours(&key, config, policy, constant)?;
        }
        Ok(())
    }
}

/// A mission with the numbers of UAVs and hotspots of another, and with its tags. Without tags in
/// the mission, a policy that reads them numbers the UAVs itself.
fn sized_as(config: &Config, other: &Config) -> Config {
    Config {
        uav_count: other.uav_count,
        hotspot_count: other.hotspot_count,
        uav_tag: other.uav_tag,
        ..*config
    }
}
