//! The sets of settings that have a name.

use super::{Credit, NetworkKind, Settings, Shaping};
use crate::ppo::schedule::Schedule;
use jcas_core::reward::NAMES;
use jcas_policy::head::Head;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Named settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// The paper's table; what it leaves open is the choice of this trainer.
    Paper,
    /// What the measurements kept.
    Tuned,
    /// Imitation of the baseline `squads`, for a radar that detects in the own cell only.
    Mission,
    /// UAVs that choose in turn, for whom a step costs one and nothing else counts. For a policy
    /// that ends its episodes already.
    Time,
}

impl Settings {
    /// The settings of a preset.
    pub fn preset(preset: Preset) -> Settings {
        match preset {
            Preset::Paper => Settings::paper(),
            Preset::Tuned => Settings::tuned(),
            Preset::Mission => Settings::mission(),
            Preset::Time => Settings::time(),
        }
    }

    fn paper() -> Settings {
        Settings {
            seed: 0,
            head: Head::Gaussian,
            network: NetworkKind::Mlp,
            actor_hidden: vec![512, 256, 128],
            critic_hidden: vec![512, 256, 128],
            normalise_values: false,
            environments: 64,
            workers: 8,
            batch_steps: 4096,
            total_steps: 250_000,
            epochs: 10,
            minibatch_rows: 4096,
            critic_minibatch_rows: 512,
            sample_fraction: 1.0,
            learning_rate: 3e-4,
            schedule: Schedule::Constant,
            clip: 0.2,
            discount: 0.95,
            gae_lambda: 0.95,
            credit: Credit::Team,
            constant_pilot: None,
            config_overrides: BTreeMap::new(),
            shaping: Shaping::default(),
            evaluation_episodes: 100,
        }
    }

    fn tuned() -> Settings {
        Settings {
            head: Head::Hybrid,
            network: NetworkKind::Set,
            actor_hidden: vec![128, 64],
            critic_hidden: vec![128, 64],
            normalise_values: true,
            environments: 160,
            workers: 20,
            batch_steps: 5120,
            total_steps: 80 * 5120,
            epochs: 4,
            minibatch_rows: 512,
            critic_minibatch_rows: 256,
            sample_fraction: 0.5,
            learning_rate: 1e-3,
            schedule: Schedule::Linear,
            discount: 0.97,
            credit: Credit::Uav,
            config_overrides: BTreeMap::from([
                ("inform_payment".to_owned(), "once".into()),
                // Three for each cell nearer on the paper's grid.
                ("shaping_goal_weight".to_owned(), 66.0.into()),
                ("shaping_unconfirmed_weight".to_owned(), 0.25.into()),
                ("shaping_discount".to_owned(), 1.0.into()),
            ]),
            shaping: Shaping {
                factors: BTreeMap::from([
                    ("energy".to_owned(), 100.0),
                    ("throughput".to_owned(), 0.2),
                    ("shaping_charge".to_owned(), 0.0),
                ]),
                time_penalty: 0.3,
                informing: 5.0,
            },
            ..Settings::paper()
        }
    }

    fn mission() -> Settings {
        Settings {
            total_steps: 45 * 25_600,
            minibatch_rows: 1024,
            learning_rate: 1e-3,
            credit: Credit::Teacher,
            config_overrides: BTreeMap::from([("horizon_steps".to_owned(), 300.into())]),
            ..Settings::time()
        }
    }

    fn time() -> Settings {
        let unpaid = NAMES.iter().map(|&name| (name.to_owned(), 0.0));
        Settings {
            network: NetworkKind::Turns,
            environments: 400,
            workers: 50,
            batch_steps: 25_600,
            total_steps: 80 * 25_600,
            minibatch_rows: 4096,
            learning_rate: 5e-4,
            discount: 0.99,
            credit: Credit::Team,
            shaping: Shaping {
                factors: unpaid.collect(),
                time_penalty: 1.0,
                ..Shaping::default()
            },
            ..Settings::tuned()
        }
    }
}
