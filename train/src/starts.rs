//! How a fleet begins best that is flown stratified. For one phase of a mission after the other, all starts are tried on a
//! few missions, and the best quarter of them on four times as many, until one is left (successive halving: Z. Karnin,
//! T. Koren and O. Somekh, "Almost optimal exploration in multi-armed bandits", 2013). What is tried in a phase is tried
//! in those that follow it too.

use crate::error::TrainError;
use crate::policy::{Actor, Mode};
use crate::run::{evaluate, score};
use jcas_core::Model;
use jcas_evaluate::policy::strata::{FleetStarts, PHASES, Starts};
use std::sync::Arc;

/// Seed of the missions that starts are chosen on, which no evaluation flies.
pub const START_SEED: u64 = 2;
/// Of so many starts one is tried further, on as many times more missions.
const SHARE: u64 = 4;
/// Of the missions of an evaluation the first round flies one in so many.
const FIRST: u64 = 8;

/// The best starts, of `count` in each phase, in missions of these models, whose fleets are of one size; none where
/// `stop` says so, which is asked before each of them.
pub fn best(
    actor: &Actor,
    models: &[Arc<Model<'static>>],
    count: u16,
    evaluation_episodes: u64,
    stop: &mut dyn FnMut() -> bool,
) -> Result<Option<Starts>, TrainError> {
    let mut best = [0; PHASES];
    for phase in 0..PHASES {
        let with = |start| {
            let mut starts = best;
            starts[phase..].fill(start);
            starts
        };
        let mut left: Vec<Starts> = (0..count).map(with).collect();
        let mut episodes = (evaluation_episodes / FIRST).max(1);
        while left.len() > 1 {
            let mut tried = Vec::new();
            for starts in left {
                if stop() {
                    return Ok(None);
                }
                tried.push((starts, score_of(actor, starts, models, episodes)?));
            }
            // Of those that do as well the first stays first.
            tried.sort_by(|a, b| b.1.total_cmp(&a.1));
            tried.truncate(tried.len().div_ceil(SHARE as usize));
            left = tried.into_iter().map(|(starts, _)| starts).collect();
            episodes *= SHARE;
        }
        best = left[0];
    }
    Ok(Some(best))
}

/// How many [`best`] tries in all.
pub fn tries(count: u16) -> u64 {
    let mut left = u64::from(count);
    let mut of_phase = 0;
    while left > 1 {
        of_phase += left;
        left = left.div_ceil(SHARE);
    }
    PHASES as u64 * of_phase
}

fn score_of(
    actor: &Actor,
    starts: Starts,
    models: &[Arc<Model<'static>>],
    episodes: u64,
) -> Result<f64, TrainError> {
    let uavs = models[0].config().uav_count;
    let actor = Arc::new(Actor {
        starts: FleetStarts::new([(uavs, starts)]).expect("one"),
        ..actor.clone()
    });
    let flown: Result<Vec<_>, _> = models
        .iter()
        .map(|model| evaluate(model, &actor, Mode::Stratified, episodes, START_SEED))
        .collect();
    Ok(score(&flown?))
}
