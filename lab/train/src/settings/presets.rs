//! The four sets of settings that have a name.

use super::{
    Credit, CriticInput, Curriculum, Draws, NetworkKind, PilotCredit, Settings, SmallFleets,
};
use crate::ppo::schedule::Schedule;
use jcas_policy::head::Head;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Named settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// The paper's table; what it leaves open is RLlib's habit.
    Paper,
    /// What the measurements in `lab/log` kept.
    Tuned,
    /// The same for missions whose hotspots are hidden: paid for searching, not for coming nearer.
    Search,
    /// The same for missions whose radar detects in the own cell only: it is eased in, and pilot densities are
    /// judged by their own step.
    Mission,
}

impl std::str::FromStr for Preset {
    type Err = String;

    fn from_str(name: &str) -> Result<Preset, String> {
        match name {
            "paper" => Ok(Preset::Paper),
            "tuned" => Ok(Preset::Tuned),
            "search" => Ok(Preset::Search),
            "mission" => Ok(Preset::Mission),
            _ => Err(format!(
                "training preset: {name:?} is not one of paper, tuned, search, mission"
            )),
        }
    }
}

impl Settings {
    /// The settings of a preset.
    pub fn preset(preset: Preset) -> Settings {
        match preset {
            Preset::Paper => Settings::paper(),
            Preset::Tuned => Settings::tuned(),
            Preset::Search => Settings::search(),
            Preset::Mission => Settings::mission(),
        }
    }

    fn paper() -> Settings {
        Settings {
            seed: 0,
            device: "cpu".to_owned(),
            head: Head::Gaussian,
            draws: Draws::Independent,
            network: NetworkKind::Mlp,
            actor_hidden: vec![512, 256, 128],
            actor_tours: false,
            critic_hidden: vec![512, 256, 128],
            environments: 64,
            workers: 8,
            batch_steps: 4096,
            total_steps: 250_000,
            epochs: 10,
            minibatch_rows: 4096,
            critic_minibatch_rows: 512,
            shard_rows: 512,
            sample_share: 1.0,
            learning_rate: 3e-4,
            critic_learning_rate: 3e-4,
            schedule: Schedule::Constant,
            gradient_norm_max: 0.5,
            clip: 0.2,
            dual_clip: None,
            entropy_start: 0.0,
            entropy_end: 0.0,
            entropy_batches: None,
            kl_max: None,
            kl_undo: None,
            discount: 0.95,
            gae_lambda: 0.95,
            normalise_inputs: false,
            normalise_values: false,
            normalise_advantages: true,
            credit: Credit::Team,
            pilot_credit: PilotCredit::Return,
            critic_input: CriticInput::State,
            critic_survey: false,
            constant_pilot: None,
            mission: BTreeMap::new(),
            curriculum: None,
            reward_factors: BTreeMap::new(),
            step_cost: 0.0,
            progress_reward: 0.0,
            finding_reward: 0.0,
            informing_reward: 0.0,
            meeting_reward: 0.0,
            small_fleets: None,
            evaluate_every: 0,
            evaluation_episodes: 100,
            checkpoint_every: 10,
        }
    }

    fn tuned() -> Settings {
        Settings {
            head: Head::Hybrid,
            network: NetworkKind::Set,
            actor_hidden: vec![128, 64],
            critic_hidden: vec![128, 64],
            environments: 160,
            workers: 20,
            batch_steps: 5120,
            total_steps: 80 * 5120,
            epochs: 4,
            minibatch_rows: 512,
            critic_minibatch_rows: 256,
            shard_rows: 128,
            sample_share: 0.5,
            learning_rate: 1e-3,
            critic_learning_rate: 1e-3,
            schedule: Schedule::Linear,
            discount: 0.97,
            normalise_values: true,
            credit: Credit::Uav,
            mission: BTreeMap::from([
                ("inform_payment".to_owned(), "once".into()),
                // Three for each cell nearer on the paper's grid.
                ("shaping_goal_weight".to_owned(), 66.0.into()),
                ("shaping_unconfirmed_weight".to_owned(), 0.25.into()),
                ("shaping_discount".to_owned(), 1.0.into()),
            ]),
            reward_factors: BTreeMap::from([
                ("energy".to_owned(), 100.0),
                ("throughput".to_owned(), 0.2),
                ("shaping_charge".to_owned(), 0.0),
            ]),
            step_cost: 0.3,
            informing_reward: 5.0,
            meeting_reward: 3.0,
            ..Settings::paper()
        }
    }

    fn search() -> Settings {
        let mut settings = Settings::tuned();
        settings
            .mission
            .insert("shaping_goal_weight".to_owned(), 0.0.into());
        Settings {
            critic_survey: true,
            finding_reward: 20.0,
            informing_reward: 0.0,
            meeting_reward: 0.0,
            small_fleets: Some(SmallFleets {
                uavs_max: 5,
                step_cost: 2.0,
                finding_reward: 5.0,
                discount: 0.985,
            }),
            ..settings
        }
    }

    fn mission() -> Settings {
        let mut settings = Settings::tuned();
        settings.reward_factors.insert("energy".to_owned(), 10.0);
        Settings {
            actor_tours: true,
            total_steps: 400 * 5120,
            pilot_credit: PilotCredit::Step,
            curriculum: Some(Curriculum {
                threshold_db: -10.0,
                batches: 100,
                stages: 25,
            }),
            finding_reward: 60.0,
            // Five have to be paid more, or no pilot density of theirs seems worth its throughput.
            small_fleets: Some(SmallFleets {
                uavs_max: 5,
                step_cost: settings.step_cost,
                finding_reward: 240.0,
                discount: settings.discount,
            }),
            dual_clip: Some(3.0),
            // While the radar is easy nobody has to stay over a hotspot, and fleets would forget how.
            entropy_start: 0.02,
            entropy_batches: Some(120),
            kl_max: Some(0.05),
            kl_undo: Some(1.0),
            ..settings
        }
    }
}
