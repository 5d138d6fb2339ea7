//! Planning takes no more memory than its bound says, and a bound that cannot be had is refused.
//!
//! These tests catch a table that the bound forgets. A failed allocation would end the program.

use core::ops::ControlFlow;
use core::sync::atomic::{AtomicUsize, Ordering};
use std::alloc::{GlobalAlloc, Layout, System};

use jcas_core::{Cell, Config, Model, Preset, Sim, TargetVisibility};
use jcas_plan::{
    Follower, PlanError, Planned, Replanner, Settings, check_available, memory_bound, search, tour,
};
use jcas_policy::Policy;

/// The system's allocator, which counts the bytes in use and their peak.
struct Counting;

static IN_USE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);
/// The bytes above which an allocation is not counted: the request for the whole bound.
static COUNTED_MAX: AtomicUsize = AtomicUsize::new(usize::MAX);

fn grow(bytes: usize) {
    if bytes < COUNTED_MAX.load(Ordering::Relaxed) {
        let now = IN_USE.fetch_add(bytes, Ordering::Relaxed) + bytes;
        PEAK.fetch_max(now, Ordering::Relaxed);
    }
}

fn shrink(bytes: usize) {
    if bytes < COUNTED_MAX.load(Ordering::Relaxed) {
        IN_USE.fetch_sub(bytes, Ordering::Relaxed);
    }
}

// SAFETY: every call is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        grow(layout.size());
        // SAFETY: the caller's promises, passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        shrink(layout.size());
        // SAFETY: the caller's promises, passed on.
        unsafe { System.dealloc(memory, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Returns the peak of the memory that a call takes beyond what is in use before.
fn peak_of(bound: u64, call: impl FnOnce()) -> u64 {
    COUNTED_MAX.store(bound as usize, Ordering::Relaxed);
    let before = IN_USE.load(Ordering::Relaxed);
    PEAK.store(before, Ordering::Relaxed);
    call();
    (PEAK.load(Ordering::Relaxed) - before) as u64
}

const SETTINGS: Settings = Settings {
    iterations: 512,
    seed: 1,
};

fn model(config: Config) -> Model<'static> {
    Model::new(config).unwrap()
}

fn plan(model: &Model<'_>) {
    let go_on = &mut |_| ControlFlow::Continue(());
    let planned = if model.config().target_visibility == TargetVisibility::Hidden {
        search(model, &SETTINGS, go_on)
    } else {
        let hotspots: Vec<Cell> = (0..model.hotspot_count() as u32)
            .map(|hotspot| Cell {
                x: hotspot % model.config().grid_width,
                y: hotspot / model.config().grid_width,
            })
            .collect();
        tour(model, &hotspots, &SETTINGS, go_on)
    };
    let _plan = planned.unwrap();
}

/// A replanner flies an episode, with many meetings and confirmations.
fn replan(model: &Model<'_>) {
    let mut sim = Sim::new(model);
    let mut replanner = Replanner::new(512, SETTINGS);
    let mut actions = vec![0.0; model.action_len()];
    sim.reset(3);
    loop {
        replanner.try_plan(model, &sim.state()).unwrap();
        replanner.write(model, &sim.state(), &mut actions);
        let outcome = sim.step(&actions).unwrap();
        if outcome.terminated || outcome.truncated {
            return;
        }
    }
}

/// One test, as the counters are of the whole program.
#[test]
fn planning_stays_below_its_bound() {
    let sized = |preset: Preset, uavs: u32, hotspots: u32, side: u32| Config {
        uav_count: uavs,
        hotspot_count: hotspots,
        grid_width: side,
        grid_height: side,
        ..Config::preset(preset)
    };
    for config in [
        sized(Preset::Search, 3, 1, 8),
        sized(Preset::Search, 10, 7, 12),
        sized(Preset::Search, 100, 11, 24),
        sized(Preset::Paper, 5, 7, 12),
        sized(Preset::Paper, 10, 60, 12),
        sized(Preset::Mission, 100, 7, 40),
        Config {
            horizon_steps: 900,
            ..sized(Preset::Mission, 20, 11, 16)
        },
    ] {
        let model = model(config);
        let bound = memory_bound(&model);
        let peak = peak_of(bound, || plan(&model));
        let what = format!("{config:?}");
        assert!(peak <= bound, "{peak} of {bound} bytes: {what}");
        assert!(bound <= 8 * peak, "{peak} of {bound} bytes: {what}");
    }
    for config in [
        sized(Preset::Search, 10, 7, 12),
        sized(Preset::Isac, 10, 7, 12),
        sized(Preset::Paper, 7, 7, 12),
    ] {
        let model = model(config);
        let bound = memory_bound(&model);
        let peak = peak_of(bound, || replan(&model));
        assert!(peak <= 2 * bound, "{peak} of {bound} bytes");
    }
    copies_of_a_follower_take_no_memory();
    memory_that_cannot_be_had_is_refused();
    #[cfg(feature = "file")]
    reading_stays_below_its_bound();
}

fn copies_of_a_follower_take_no_memory() {
    let model = model(Config::preset(Preset::Search));
    let go_on = &mut |_| ControlFlow::Continue(());
    let plan = search(&model, &SETTINGS, go_on).unwrap();
    let mut planned = Planned::following(plan.clone());
    let follower = Follower::new(plan);
    let mut sim = Sim::new(&model);
    let mut actions = vec![0.0; model.action_len()];
    let flight = || {
        let _copies = (planned.clone(), follower.clone());
        sim.reset(1);
        planned.reset(&model, 1);
        for _ in 0..30 {
            planned.act(&model, &sim.state(), &mut actions);
            let outcome = sim.step(&actions).unwrap();
            if outcome.terminated || outcome.truncated {
                return;
            }
        }
    };
    assert_eq!(peak_of(u64::MAX, flight), 0);
}

fn memory_that_cannot_be_had_is_refused() {
    assert_eq!(check_available(1 << 20), Ok(()));
    let bytes = u64::MAX / 2;
    assert_eq!(
        check_available(bytes),
        Err(PlanError::OutOfMemory { bytes })
    );
}

/// The shortest texts for what they hold: long lists of short numbers, and many empty lists.
#[cfg(feature = "file")]
fn reading_stays_below_its_bound() {
    use jcas_plan::{PlanFile, READ_BYTES_MAX};

    let model = model(Config {
        uav_count: 1,
        pilot_density_min: 0.0,
        pilot_density_max: 1.0,
        ..Config::preset(Preset::Search)
    });
    let go_on = &mut |_| ControlFlow::Continue(());
    let plan = search(&model, &SETTINGS, go_on).unwrap();
    let text = PlanFile::new(&model, &plan, None).to_json().unwrap();
    let begin = text.find("\"uavs\":[").unwrap() + 8;
    let end = text.find(",\"config\":").unwrap();
    let with = |uavs: &str| format!("{}[{uavs}]{}", &text[..begin - 1], &text[end..]);
    let trajectory = |steps: usize| {
        let cells = vec!["[6,6]"; steps + 1].join(",");
        let densities = vec!["0"; steps].join(",");
        format!("{{\"cells\":[{cells}],\"pilot_density\":[{densities}]}}")
    };
    let read = |text: &str| PlanFile::parse(text).and_then(|file| file.plan(&model));
    let long = with(&trajectory(65_536 + 1));
    assert!(read(&long).is_ok());
    let empty = vec!["{\"cells\":[],\"pilot_density\":[]}"; 4_096 + 1].join(",");
    let lopsided = format!(
        "{{\"cells\":[],\"pilot_density\":[{}]}}",
        vec!["0"; 99_999].join(",")
    );
    for text in [text.clone(), long, with(&empty), with(&lopsided)] {
        let bound = READ_BYTES_MAX * text.len() as u64;
        let peak = peak_of(u64::MAX, || {
            let _read = read(&text);
        });
        assert!(peak <= bound, "{peak} of {bound} bytes");
    }
}
