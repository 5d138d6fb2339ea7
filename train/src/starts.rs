//! From which start a fleet divides best that is flown stratified: all are tried on a few missions, and the best quarter
//! of them on four times as many, until one is left (successive halving: Z. Karnin, T. Koren and O. Somekh, "Almost
//! optimal exploration in multi-armed bandits", 2013).

use crate::error::TrainError;
use crate::policy::{Actor, Mode};
use crate::run::{evaluate, score};
use jcas_core::Model;
use jcas_evaluate::policy::strata::Starts;
use std::sync::Arc;

/// Seed of the missions that starts are chosen on, which no evaluation flies.
pub const START_SEED: u64 = 2;
/// Of so many starts one is tried further, on as many times more missions.
const SHARE: u64 = 4;
/// Of the missions of an evaluation the first round flies one in so many.
const FIRST: u64 = 8;

/// The best of the starts 0 to `count` - 1 in missions of these models, whose fleets are of one size.
pub fn best(
    actor: &Actor,
    models: &[Arc<Model<'static>>],
    count: u32,
    evaluation_episodes: u64,
) -> Result<u32, TrainError> {
    let uavs = models[0].config().uav_count;
    let mut left: Vec<u32> = (0..count).collect();
    let mut episodes = (evaluation_episodes / FIRST).max(1);
    while left.len() > 1 {
        let mut tried = Vec::new();
        for start in left {
            let actor = Arc::new(Actor {
                starts: Starts::new([(uavs, start)]).expect("one"),
                ..actor.clone()
            });
            let flown: Result<Vec<_>, _> = models
                .iter()
                .map(|model| evaluate(model, &actor, Mode::Stratified, episodes, START_SEED))
                .collect();
            tried.push((start, score(&flown?)));
        }
        // Of those that do as well the first stays first.
        tried.sort_by(|a, b| b.1.total_cmp(&a.1));
        tried.truncate(tried.len().div_ceil(SHARE as usize));
        left = tried.into_iter().map(|(start, _)| start).collect();
        episodes *= SHARE;
    }
    Ok(left[0])
}
