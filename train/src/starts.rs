//! How a fleet begins best that is flown stratified. For one phase of a mission after the other, all starts are tried on a
//! few missions, and the best quarter of them on four times as many, until one is left (successive halving: Z. Karnin,
//! T. Koren and O. Somekh, "Almost optimal exploration in multi-armed bandits", 2013). What is tried in a phase is tried
//! in those that follow it too.

use crate::error::TrainError;
use crate::policy::{Actor, Mode};
use crate::run::{evaluate, score};
use jcas_core::Model;
use jcas_evaluate::policy::network::Flight;
use jcas_evaluate::policy::strata::{FleetStarts, PHASES, Starts};
use std::iter::successors;
use std::sync::Arc;

/// Seed of the missions that starts are chosen on, which no evaluation of a training flies.
pub const START_SEED: u64 = 2;
/// Of so many starts one is tried further, on as many times more missions.
const SHARE: u64 = 4;
/// Of the missions of an evaluation the first round flies one in so many.
const FIRST: u64 = 8;

/// The best starts, of `count` in each phase, in missions of these models, whose fleets are of one size. `stop` hears
/// before each of them how many missions it will fly; none where it says so.
pub fn best(
    actor: &Actor,
    models: &[Arc<Model<'static>>],
    count: u16,
    evaluation_episodes: u64,
    stop: &mut dyn FnMut(u64) -> bool,
) -> Result<Option<Starts>, TrainError> {
    let uavs = models[0].config().uav_count;
    let policy = actor.fly("policy", Mode::Stratified);
    let score_of = |starts, episodes| {
        let policy = policy.clone().with_flight(Flight {
            starts: FleetStarts::new([(uavs, starts)]).expect("one"),
            ..actor.flight(Mode::Stratified)
        });
        let flown: Result<Vec<_>, _> = models
            .iter()
            .map(|model| evaluate(model, &policy, Mode::Stratified, episodes, START_SEED))
            .collect();
        Ok(score(&flown?))
    };
    let mut best = [0; PHASES];
    for phase in 0..PHASES {
        let with = |start| {
            let mut starts = best;
            starts[phase..].fill(start);
            starts
        };
        let mut left: Vec<Starts> = (0..count).map(with).collect();
        for (_, episodes) in rounds(count, evaluation_episodes) {
            let mut tried = Vec::new();
            for starts in left {
                if stop(episodes * models.len() as u64) {
                    return Ok(None);
                }
                tried.push((starts, score_of(starts, episodes)?));
            }
            // Of those that do as well the first stays first.
            tried.sort_by(|a, b| b.1.total_cmp(&a.1));
            tried.truncate(tried.len().div_ceil(SHARE as usize));
            left = tried.into_iter().map(|(starts, _)| starts).collect();
        }
        best = left[0];
    }
    Ok(Some(best))
}

/// How many missions of each model [`best`] flies.
pub fn missions(count: u16, evaluation_episodes: u64) -> u64 {
    let of_phase = rounds(count, evaluation_episodes).map(|(left, episodes)| left * episodes);
    PHASES as u64 * of_phase.sum::<u64>()
}

/// Of each round of a phase: how many starts it tries, and on how many missions of each model.
fn rounds(count: u16, evaluation_episodes: u64) -> impl Iterator<Item = (u64, u64)> {
    let first = (u64::from(count), (evaluation_episodes / FIRST).max(1));
    successors(Some(first), |&(left, episodes)| {
        Some((left.div_ceil(SHARE), episodes * SHARE))
    })
    .take_while(|&(left, _)| left > 1)
}
