//! Campaigns give the same results on any number of threads, errors name their episode, and traces
//! read back as they were written.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

use jcas_core::{Config, Error, Model, StateRef};
use jcas_episode::campaign::{self, Campaign, FlightError};
use jcas_episode::shard::Shard;
use jcas_episode::statistics::Summary;
use jcas_episode::trace;
use jcas_policy::{BaselineKind, PilotMode, Policy};

fn swarm() -> Box<dyn Policy> {
    Box::new(BaselineKind::Greedy.build_privileged(PilotMode::Adaptive))
}

const GO_ON: &(dyn Fn() -> ControlFlow<()> + Sync) = &|| ControlFlow::Continue(());

#[cfg(feature = "parallel")]
#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let model = Model::new(Config::default()).unwrap();
    let campaign = Campaign {
        episodes: 60,
        seed: 11,
    };
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| campaign::fly(&model, campaign, &swarm, GO_ON))
            .unwrap()
    };
    let one = with(1);
    assert_eq!(one, with(2));
    assert_eq!(one, with(5));
    let horizon = model.config().horizon_steps;
    assert_eq!(Summary::of(&one, horizon), Summary::of(&with(3), horizon));
}

#[test]
fn a_part_flies_its_own_missions_of_the_campaign() {
    let model = Model::new(Config::default()).unwrap();
    let campaign = Campaign {
        episodes: 7,
        seed: 11,
    };
    let whole = campaign::fly(&model, campaign, &swarm, GO_ON).unwrap();
    for part in ["1/3", "3/3", "8/9"] {
        let part: Shard = part.parse().unwrap();
        let flown = campaign::fly_part(&model, campaign, part, &swarm, GO_ON).unwrap();
        let own: Vec<_> = part.cells(7).map(|episode| whole[episode]).collect();
        assert_eq!(flown, own, "{part}");
    }
}

#[test]
fn progress_counts_every_episode_and_can_stop() {
    let model = Model::new(Config::default()).unwrap();
    let campaign = Campaign {
        episodes: 30,
        seed: 1,
    };
    let finished = AtomicU64::new(0);
    campaign::fly(&model, campaign, &swarm, &|| {
        finished.fetch_add(1, Ordering::SeqCst);
        ControlFlow::Continue(())
    })
    .unwrap();
    assert_eq!(finished.load(Ordering::SeqCst), 30);
    let stopped = campaign::fly(&model, campaign, &swarm, &|| ControlFlow::Break(()));
    assert_eq!(stopped, Err(FlightError::Stopped));
}

/// Returns NaN at a step of its second episode; reads observations.
struct Faulty {
    episodes: u32,
    seen: usize,
}

impl Policy for Faulty {
    fn name(&self) -> &str {
        "faulty"
    }

    fn reset(&mut self, _model: &Model<'_>, _seed: u64) {
        self.episodes += 1;
    }

    fn reads_observations(&self) -> bool {
        true
    }

    fn see(&mut self, observations: &[f32]) {
        self.seen = observations.len();
    }

    fn act(&mut self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        assert_eq!(self.seen, model.uav_count() * model.observation_len());
        actions.fill(0.0);
        if self.episodes == 2 && state.t() == 4 {
            actions[3] = f32::NAN;
        }
    }
}

#[test]
fn a_refused_action_names_its_episode() {
    let model = Model::new(Config::default()).unwrap();
    let campaign = Campaign {
        episodes: 2,
        seed: 1,
    };
    let mut sim = jcas_core::Sim::new(&model);
    let mut policy = Faulty {
        episodes: 0,
        seen: 0,
    };
    let first = campaign::fly_episode(&model, &mut sim, &mut policy, campaign.episode_seed(0));
    assert_eq!(first.unwrap().steps, 100);
    let second = campaign::fly_episode(&model, &mut sim, &mut policy, campaign.episode_seed(1));
    let error = Error::ActionNan {
        uav: 1,
        component: 1,
    };
    assert_eq!(second, Err(error));

    let make = || -> Box<dyn Policy> {
        Box::new(Faulty {
            episodes: 1,
            seen: 0,
        })
    };
    let failed = campaign::fly(&model, campaign, &make, GO_ON).unwrap_err();
    let told = failed.to_string();
    assert!(told.starts_with("episode "), "{told}");
    assert!(told.contains("actions[1][1] = NaN"), "{told}");
}

#[test]
fn a_mission_without_success_counts_with_its_horizon() {
    let config = Config {
        uav_count: 2,
        ..Config::default()
    };
    let model = Model::new(config).unwrap();
    let campaign = Campaign {
        episodes: 5,
        seed: 1,
    };
    // Two UAVs never make a quorum of three.
    let episodes = campaign::fly(&model, campaign, &swarm, GO_ON).unwrap();
    let summary = Summary::of(&episodes, config.horizon_steps);
    assert_eq!(summary.success_rate.value, 0.0);
    assert_eq!(summary.mission_steps.value, 100.0);
    assert_eq!(summary.mission_steps.low, 100.0);
}

#[test]
fn a_recorded_episode_is_the_one_that_a_campaign_flies() {
    let model = Model::new(Config::default()).unwrap();
    let campaign = Campaign {
        episodes: 1,
        seed: 4,
    };
    let episodes = campaign::fly(&model, campaign, &swarm, GO_ON).unwrap();
    let mut text = Vec::new();
    let end = trace::record(
        &model,
        swarm().as_mut(),
        campaign.episode_seed(0),
        &mut text,
    )
    .unwrap();
    assert_eq!(end.metrics, episodes[0]);
    let read = trace::read(text.as_slice()).unwrap();
    assert_eq!(read.end, end);
    assert_eq!(read.header.policy, "greedy");
    assert_eq!(read.header.pilot, "adaptive");
    assert_eq!(trace::verify(&read).unwrap(), None);

    // A requested action outside the range, infinity included, has a text and reads back.
    let mut text = Vec::new();
    trace::record(&model, &mut Boundless, 9, &mut text).unwrap();
    let read = trace::read(text.as_slice()).unwrap();
    assert_eq!(trace::verify(&read).unwrap(), None);
}

struct Boundless;

impl Policy for Boundless {
    fn name(&self) -> &str {
        "boundless"
    }

    fn act(&mut self, _model: &Model<'_>, _state: &StateRef<'_>, actions: &mut [f32]) {
        actions.fill(f32::INFINITY);
        actions[0] = -3.5;
        actions[1] = f32::NEG_INFINITY;
    }
}
