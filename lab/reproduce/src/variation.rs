//! Variations of the paper's model and training, which test what a result depends on.

use jcas_core::{Config, InformPayment};
use jcas_policy::head::Head;
use jcas_train::settings::{Credit, CriticInput, Settings};

/// One change of the paper's model or of its training.
#[derive(Clone, Debug)]
pub struct Variation {
    /// Name in files.
    pub name: &'static str,
    /// What is changed, and what it tests.
    pub tests: &'static str,
    /// The change.
    pub apply: fn(&mut Config, &mut Settings),
}

/// Changes that could explain what PPO learns under the paper's equations.
pub fn variations() -> Vec<Variation> {
    let variation = |name, tests, apply| Variation { name, tests, apply };
    vec![
        variation(
            "inform_once",
            "an informed hotspot pays once, not at every step: finishing late no longer pays more",
            |config, _| config.inform_payment = InformPayment::Once,
        ),
        variation(
            "no_throughput_reward",
            "no reward for throughput, which pays for stalling as well",
            |config, _| config.reward_throughput = 0.0,
        ),
        variation(
            "discount_099",
            "γ = 0.99: a far reward counts",
            |_, settings| settings.discount = 0.99,
        ),
        variation(
            "detection_theory",
            "a threshold of 13.1 dB, from the probabilities of detection and false alarm, for a \
             range of 150 m",
            |config, _| config.sensing_range_m = None,
        ),
        variation(
            "uav_credit",
            "each UAV is judged by its own reward, not by the team's",
            |_, settings| uav_credit(settings),
        ),
        variation(
            "uav_credit_inform_once",
            "the same, and an informed hotspot pays once",
            |config, settings| {
                uav_credit(settings);
                config.inform_payment = InformPayment::Once;
            },
        ),
        variation(
            "hybrid_head",
            "categorical motion and Beta pilot density, not five bins of a normal variable",
            |_, settings| settings.head = Head::Hybrid,
        ),
    ]
}

/// Trains with each UAV's own credit, for a critic whose rows are UAVs.
pub(crate) fn uav_credit(settings: &mut Settings) {
    settings.credit = Credit::Uav;
    settings.critic_input = CriticInput::StateAndUav;
    // The rows of the critic are UAVs then, as those of the actor.
    settings.critic_minibatch_rows = settings.minibatch_rows;
}
