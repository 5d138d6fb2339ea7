//! A training run from its plan to its policy files: checkpoints, metrics, evaluation.

use crate::checkpoint;
use crate::environment::VectorEnvironment;
use crate::environment::fleet::{Fleet, RewardShaping};
use crate::environment::task::TrainingTask;
use crate::error::{SettingError, TrainError};
use crate::metrics::{MetricsFile, Row};
use crate::policy::Actor;
use crate::policy::files::{self, Precision, save};
use crate::ppo::normalise::Affine;
use crate::settings::Settings;
use crate::speed::Speed;
use crate::store::write_whole;
use crate::trainer::Trainer;
use jcas_core::{Config, Metrics, Model};
use jcas_episode::campaign::{self, Campaign};
use jcas_episode::card::{self, Card, EVALUATION_SEED, Evaluation};
use jcas_episode::statistics::bootstrap_means;
use jcas_policy::head::Mode;
use jcas_policy::{Trained, action_of};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Checkpoint of a run in its folder.
pub const CHECKPOINT: &str = "checkpoint.safetensors";
/// Batches between checkpoints.
const CHECKPOINT_EVERY: u64 = 10;
/// Batches in which a new critic learns alone, before the actor of a policy follows it. Until then
/// the critic knows nothing of that policy, and its advantages would be noise.
const CRITIC_ONLY_BATCHES: u64 = 10;
/// Metrics of a run in its folder.
pub const METRICS: &str = "metrics.csv";
/// Times and rates of a run in its folder; they differ from run to run.
pub const SPEED: &str = "speed.json";

/// Specification of a run: the task, the settings and the folder.
#[derive(Clone, Debug)]
pub struct RunSpec {
    /// Settings of the trainer.
    pub settings: Settings,
    /// Configurations to train on. Several give one policy for all (network `set`).
    pub configs: Vec<Config>,
    /// The configuration that they were drawn around. The card then shows it and has its
    /// evaluations, with the fleets and hotspots of the others.
    pub drawn_around: Option<Config>,
    /// Folder of the run.
    pub out: PathBuf,
    /// Name of the policy in reports.
    pub name: String,
    /// Width of the stored weights.
    pub precision: Precision,
    /// Device of the tensors: `cpu`, or `cuda`, `wgpu` where built in.
    pub device: String,
}

/// Start of a run: random weights, or those of another run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Start {
    /// Random weights; a folder that holds a run already is refused.
    Fresh,
    /// Random weights, or the run that the folder holds already.
    Resume,
    /// The weights, moments and statistics of the run in that folder, under new settings. A folder
    /// with a policy alone gives the actor's weights.
    Run(PathBuf),
}

/// Watches a run.
pub trait Observer {
    /// After every iteration: its row, iterations in all, seconds left as forecast.
    fn iteration(&mut self, row: &Row, total: u64, left_s: f64);
    /// Before every iteration: whether to stop here, with a checkpoint.
    fn stop(&mut self) -> bool;
}

/// An observer that ignores everything.
pub struct NoObserver;

impl Observer for NoObserver {
    fn iteration(&mut self, _row: &Row, _total: u64, _left_s: f64) {}

    fn stop(&mut self) -> bool {
        false
    }
}

/// How a run ended.
pub enum RunOutcome {
    /// Trained to the end; the policy is written.
    Finished(Box<Card>),
    /// Stopped when asked; the checkpoint is written.
    Stopped,
}

fn models(configs: &[Config]) -> Result<Vec<Arc<Model<'static>>>, TrainError> {
    configs
        .iter()
        .map(|&config| Ok(Arc::new(Model::new(config).map_err(SettingError::Model)?)))
        .collect()
}

/// Gives a fresh trainer what a folder holds: a run, or a policy alone.
fn begin_from(trainer: &mut Trainer, folder: &Path) -> Result<(), TrainError> {
    let checkpoint = folder.join(CHECKPOINT);
    if checkpoint.exists() || !folder.join(card::CARD).exists() {
        return checkpoint::load_learnt(trainer, &checkpoint);
    }
    let (card, actor) = files::load(folder)?;
    let own = &trainer.actor.network.architecture;
    let stored = &actor.network.architecture;
    if own != stored {
        return Err(TrainError::Network {
            folder: folder.to_owned(),
            stored: format!("{stored:?}"),
            own: format!("{own:?}"),
        });
    }
    if actor.inputs != Affine::default() {
        return Err(TrainError::ScaledInputs(folder.to_owned()));
    }
    trainer.actor.parameters = actor.parameters;
    trainer.environment_steps = card.environment_steps.unwrap_or(0);
    trainer.critic_only_batches = CRITIC_ONLY_BATCHES;
    Ok(())
}

impl RunSpec {
    /// Names the run in its checkpoint, so that another is not continued by mistake.
    fn identity(&self) -> String {
        let hashes: Vec<String> = self
            .configs
            .iter()
            .map(|config| format!("0x{:016x}", config.hash()))
            .collect();
        let settings = serde_json::to_string(&self.settings).unwrap_or_default();
        format!(
            "configurations {}; device {}; settings {settings}",
            hashes.join(", "),
            self.device
        )
    }

    fn constant_pilot(&self) -> Option<f32> {
        let density = self.settings.constant_pilot?;
        Some(action_of(&self.configs[0], density))
    }

    /// A trainer at its start.
    pub fn trainer(&self) -> Result<Trainer, TrainError> {
        let settings = &self.settings;
        settings.validate()?;
        let count = self.configs.len();
        if count == 0 || count > settings.workers {
            let allowed = format!("at least one for each configuration ({count})");
            return Err(SettingError::value("workers", settings.workers, allowed).into());
        }
        let missions = settings.environments / settings.workers;
        let fleets: Vec<(TrainingTask, RewardShaping)> = self
            .configs
            .iter()
            .map(|config| {
                let task = TrainingTask::new(config, settings)?;
                Ok((task, RewardShaping::new(settings, self.constant_pilot())?))
            })
            .collect::<Result<_, SettingError>>()?;
        let workers = (0..settings.workers)
            .map(|worker| {
                let (task, treatment) = fleets[worker * count / settings.workers].clone();
                Box::new(Fleet::new(task, missions, treatment)) as Box<dyn VectorEnvironment>
            })
            .collect();
        Ok(Trainer::new(settings.clone(), workers, &self.device)?)
    }

    /// The trainer as the run begins.
    fn begin(&self, origin: &Start) -> Result<Trainer, TrainError> {
        let checkpoint = self.out.join(CHECKPOINT);
        let mut trainer = self.trainer()?;
        match origin {
            Start::Resume if checkpoint.exists() => {
                checkpoint::load(&mut trainer, &self.identity(), &checkpoint)?;
            }
            _ if checkpoint.exists() => {
                return Err(TrainError::Taken(self.out.clone()));
            }
            Start::Run(folder) => {
                begin_from(&mut trainer, folder)?;
            }
            Start::Fresh | Start::Resume => {}
        }
        Ok(trainer)
    }

    /// Trains to the end, or until the observer stops it.
    pub fn train(
        &self,
        origin: &Start,
        observer: &mut dyn Observer,
    ) -> Result<RunOutcome, TrainError> {
        let mut trainer = self.begin(origin)?;
        std::fs::create_dir_all(&self.out).map_err(TrainError::file(&self.out))?;
        let checkpoint = self.out.join(CHECKPOINT);
        if let Start::Run(_) = origin {
            // The settings do not say what it began with: killed before its first batch, it could
            // not go on.
            checkpoint::save(&trainer, &self.identity(), &checkpoint)?;
        }
        let mut metrics = MetricsFile::open(&self.out.join(METRICS), trainer.iterations)?;
        let mut speed = Speed::default();
        let horizons = self.configs.iter().map(|c| u64::from(c.horizon_steps));
        let horizon = horizons.max().unwrap_or(0);
        while !trainer.finished() {
            if observer.stop() {
                checkpoint::save(&trainer, &self.identity(), &checkpoint)?;
                metrics.write()?;
                return Ok(RunOutcome::Stopped);
            }
            let iteration = trainer.iterate();
            let samples = trainer
                .workers
                .iter()
                .map(|worker| (worker.shape().rows() * trainer.settings.steps_per_batch()) as u64)
                .sum();
            let mut row = Row::of(&iteration, trainer.settings.batch_steps as u64, samples);
            let flown = trainer.iterations * trainer.settings.steps_per_batch() as u64;
            row.first_to_end = flown < horizon;
            speed.add(&row);
            metrics.push(&row)?;
            let total = trainer.total_iterations();
            let left_s = speed.seconds_per_iteration() * (total - trainer.iterations) as f64;
            observer.iteration(&row, total, left_s);
            let due = trainer.iterations.is_multiple_of(CHECKPOINT_EVERY);
            if due || trainer.finished() {
                checkpoint::save(&trainer, &self.identity(), &checkpoint)?;
                metrics.write()?;
            }
        }
        self.conclude(&trainer, &mut speed)
    }

    /// A copy of the present actor.
    pub fn actor(&self, trainer: &Trainer) -> Actor {
        Actor {
            network: trainer.actor.network.clone(),
            parameters: trainer.actor.parameters.clone(),
            head: trainer.settings.head,
            inputs: Affine::default(),
            constant_pilot: self.constant_pilot(),
        }
    }

    /// The missions of the card, each once, however often it is flown.
    fn missions(&self) -> Vec<Config> {
        let mut missions: Vec<Config> = Vec::new();
        for config in &self.configs {
            let mission = Config {
                uav_count: config.uav_count,
                hotspot_count: config.hotspot_count,
                ..self.drawn_around.unwrap_or(*config)
            };
            if !missions.contains(&mission) {
                missions.push(mission);
            }
        }
        missions
    }

    /// Evaluates the present policy on every mission of the card, in every mode.
    fn evaluations(&self, actor: &Actor) -> Result<Vec<Evaluation>, TrainError> {
        let episodes = self.settings.evaluation_episodes as u64;
        let policies = Mode::ALL.map(|mode| (mode, actor.fly("policy", mode)));
        let mut evaluations = Vec::new();
        for model in models(&self.missions())? {
            for (mode, policy) in &policies {
                evaluations.push(evaluate(&model, policy, *mode, episodes, EVALUATION_SEED)?);
            }
        }
        Ok(evaluations)
    }

    /// Evaluates in every mode, chooses one, writes policy and speed.
    fn conclude(&self, trainer: &Trainer, speed: &mut Speed) -> Result<RunOutcome, TrainError> {
        let actor = self.actor(trainer);
        let started = Instant::now();
        let evaluations = self.evaluations(&actor)?;
        speed.evaluation_s = started.elapsed().as_secs_f64();
        let missions = self.missions();
        let config = missions[0];
        let card = Card {
            format: card::FORMAT,
            name: self.name.clone(),
            head: actor.head,
            architecture: json(&actor.network.architecture)?,
            normalised_inputs: false,
            constant_pilot_density: self.settings.constant_pilot,
            mode: best_mode(&evaluations),
            trained_on: missions
                .iter()
                .map(|c| (c.uav_count, c.hotspot_count))
                .collect(),
            config,
            config_hash: format!("0x{:016x}", config.hash()),
            settings: Some(json(&self.settings)?),
            environment_steps: Some(trainer.environment_steps),
            evaluations,
        };
        save(&self.out, &actor, &card, self.precision)?;
        // A finished run that is only written again has timed nothing.
        if speed.iterations > 0 {
            let path = self.out.join(SPEED);
            let text = serde_json::to_string_pretty(speed).map_err(TrainError::format(&path))?;
            write_whole(&path, (text + "\n").as_bytes())?;
        }
        Ok(RunOutcome::Finished(Box::new(card)))
    }
}

/// The value as a card holds it. The detour by way of text keeps the short form of an f32.
fn json(value: &impl serde::Serialize) -> Result<serde_json::Value, TrainError> {
    let text = serde_json::to_string(value);
    let value = text.and_then(|text| serde_json::from_str(&text));
    Ok(value.map_err(SettingError::Overrides)?)
}

/// The sampled mode if missions go better in it by more than chance, or else the deterministic
/// mode. The 95 % interval of the mean over the configurations decides. One configuration alone has
/// no interval, and its value decides.
///
/// Two percent of the steps weigh as much as one mission in a hundred, so that long missions do not
/// outweigh short ones. Both modes have flown the same configurations, in the same order.
fn best_mode(evaluations: &[Evaluation]) -> Mode {
    let scores = |mode| {
        let flown = evaluations.iter().filter(move |flown| flown.mode == mode);
        flown.map(|flown| flown.success_rate - 0.5 * flown.mission_steps_mean.ln())
    };
    let pairs = scores(Mode::Sampled).zip(scores(Mode::Deterministic));
    let gains: Vec<[f64; 1]> = pairs.map(|(sampled, likely)| [sampled - likely]).collect();
    let [gain] = bootstrap_means(&gains);
    if gain.low > 0.0 {
        Mode::Sampled
    } else {
        Mode::Deterministic
    }
}

/// Flies missions with an actor that flies in this mode, and sums them up.
pub fn evaluate(
    model: &Model<'static>,
    policy: &Trained,
    mode: Mode,
    episodes: u64,
    seed: u64,
) -> Result<Evaluation, TrainError> {
    let missions = campaign::fly(
        model,
        Campaign { episodes, seed },
        &|| Box::new(policy.clone()),
        &|| ControlFlow::Continue(()),
    )
    .map_err(|error| SettingError::Evaluation(error.to_string()))?;
    let horizon = model.config().horizon_steps;
    let mean =
        |of: &dyn Fn(&Metrics) -> f64| missions.iter().map(of).sum::<f64>() / missions.len() as f64;
    Ok(Evaluation {
        uav_count: model.config().uav_count,
        hotspot_count: model.config().hotspot_count,
        mode,
        episodes,
        seed,
        success_rate: mean(&|m| f64::from(u8::from(m.terminated))),
        mission_steps_mean: mean(&|m| f64::from(if m.terminated { m.steps } else { horizon })),
        energy_kwh_mean: mean(&|m| m.energy_kwh),
        throughput_mean: mean(&|m| m.throughput_mean),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flown(mode: Mode, success_rate: f64, mission_steps_mean: f64) -> Evaluation {
        Evaluation {
            uav_count: 3,
            hotspot_count: 3,
            mode,
            episodes: 100,
            seed: 1,
            success_rate,
            mission_steps_mean,
            energy_kwh_mean: 0.0,
            throughput_mean: 0.0,
        }
    }

    // One mode saves 1 of 100 steps in long missions, the other 0.4 of 4.4 in short ones.
    #[test]
    fn short_missions_count_as_much_as_long_ones() {
        let evaluations = |success_rate| -> Vec<Evaluation> {
            let both = [
                flown(Mode::Deterministic, 1.0, 99.0),
                flown(Mode::Deterministic, 1.0, 4.4),
                flown(Mode::Sampled, success_rate, 100.0),
                flown(Mode::Sampled, 1.0, 4.0),
            ];
            vec![both; 5].into_iter().flatten().collect()
        };
        assert_eq!(best_mode(&evaluations(1.0)), Mode::Sampled);
        assert_eq!(best_mode(&evaluations(0.9)), Mode::Deterministic);
    }

    // The sampled mode is better in one configuration of two by more than it is worse in the other.
    #[test]
    fn the_sampled_mode_has_to_be_better_than_by_chance() {
        let evaluations = [
            flown(Mode::Deterministic, 1.0, 40.0),
            flown(Mode::Sampled, 1.0, 30.0),
            flown(Mode::Deterministic, 1.0, 30.0),
            flown(Mode::Sampled, 1.0, 35.0),
        ];
        assert_eq!(best_mode(&evaluations), Mode::Deterministic);
        assert_eq!(best_mode(&evaluations[..2]), Mode::Sampled);
    }
}
