//! Measures the cost of the C ABI: one run steps the same episodes by the kernel's own interface
//! and through the exported functions. Run it by `cargo bench -p jcas-ffi`.
//!
//! Both paths take turns in short blocks, so that other load on the machine affects both alike. The
//! figure of each path is its fastest tenth of blocks. Exported functions are called through opaque
//! pointers, as a C program calls them.

use std::hint::black_box;
use std::ptr;
use std::time::Instant;

use jcas::*;
use jcas_core::batch::BatchOut;
use jcas_core::{Config, Model, Scratch, Sim};

const BLOCKS: usize = 1001;
const BLOCK_SECONDS: f64 = 1e-3;

/// The calls of the two paths: the kernel's and the ABI's.
type Paths<'a> = (&'a mut dyn FnMut(), &'a mut dyn FnMut());

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if let Some(at) = arguments.iter().position(|argument| argument == "count") {
        return count(&arguments[at + 1..]);
    }
    println!("| what | kernel, µs | C ABI, µs | ABI costs |");
    println!("| --- | --- | --- | --- |");
    for uavs in [1, 5, 10, 50] {
        one_by_one(uavs, false, &mut |paths| {
            report(&format!("step, N = {uavs}"), paths)
        });
    }
    for uavs in [5, 50] {
        let what = format!("step and observe, N = {uavs}");
        one_by_one(uavs, true, &mut |paths| report(&what, paths));
    }
    for (environments, uavs, hotspots) in [(64, 5, 5), (256, 10, 5), (256, 15, 7)] {
        let what = format!("batch step of {environments} environments, N = {uavs}, n = {hotspots}");
        batch(environments, uavs, hotspots, &mut |paths| {
            report(&what, paths)
        });
    }
}

/// Handles `count kernel|abi UAVS CALLS`, which makes only these calls, for a profiler that counts
/// instructions. A fourth number, ENVIRONMENTS, selects a batch.
fn count(arguments: &[String]) {
    let number = |index: usize| {
        arguments
            .get(index)
            .and_then(|text| text.parse::<usize>().ok())
    };
    let (Some(uavs), Some(calls)) = (number(1), number(2)) else {
        panic!("count kernel|abi UAVS CALLS [ENVIRONMENTS]");
    };
    let mut run = |(kernel, abi): Paths<'_>| {
        for _ in 0..calls {
            if arguments[0] == "abi" {
                abi()
            } else {
                kernel()
            }
        }
    };
    match number(3) {
        Some(environments) => batch(environments, uavs as u32, 5, &mut run),
        None => one_by_one(uavs as u32, false, &mut run),
    }
}

fn report(what: &str, (kernel, abi): Paths<'_>) {
    let (kernel_us, abi_us) = compare(kernel, abi);
    let cost = (abi_us / kernel_us - 1.0) * 100.0;
    println!("| {what} | {kernel_us:.3} | {abi_us:.3} | {cost:+.1} % |");
}

/// Returns the time of one call of each path in the fastest tenth of its blocks, in microseconds.
fn compare(a: &mut dyn FnMut(), b: &mut dyn FnMut()) -> (f64, f64) {
    let calls = calls_per_block(a);
    let mut times = [Vec::with_capacity(BLOCKS), Vec::with_capacity(BLOCKS)];
    for block in 0..2 * BLOCKS {
        let begun = Instant::now();
        for _ in 0..calls {
            if block % 2 == 0 { a() } else { b() }
        }
        times[block % 2].push(begun.elapsed().as_secs_f64() / calls as f64 * 1e6);
    }
    let [a, b] = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[BLOCKS / 10]
    });
    (a, b)
}

fn calls_per_block(call: &mut dyn FnMut()) -> usize {
    let begun = Instant::now();
    let mut calls = 0;
    while begun.elapsed().as_secs_f64() < 0.1 {
        call();
        calls += 1;
    }
    ((BLOCK_SECONDS * f64::from(calls) / 0.1) as usize).max(1)
}

/// Returns actions that keep a fleet moving, the same for both paths.
fn actions_of(step: usize, actions: &mut [f32]) {
    for (index, action) in actions.iter_mut().enumerate() {
        *action = ((step * 7 + index * 13) % 11) as f32 / 5.0 - 1.0;
    }
}

fn one_by_one(uavs: u32, observed: bool, use_paths: &mut dyn FnMut(Paths<'_>)) {
    let config = Config {
        uav_count: uavs,
        ..Config::default()
    };
    let model = Model::new(config).expect("a legal configuration");
    let observation_len = model.uav_count() * model.observation_len();

    let mut sim = Sim::new(&model);
    let (mut actions, mut seen) = (vec![0.0; model.action_len()], vec![0.0; observation_len]);
    let mut step = 0;
    let mut kernel = || {
        actions_of(step, &mut actions);
        step += 1;
        let outcome = sim.step(&actions).expect("a legal step");
        if observed {
            sim.observe(&mut seen).expect("the right length");
        }
        if outcome.terminated || outcome.truncated {
            sim.reset(step as u64);
        }
    };

    let c_model = c_model(uavs, Config::default().hotspot_count);
    let c_sim = c_sim(c_model);
    let c_step = black_box(jcas_sim_step as unsafe extern "C" fn(_, _, _, _) -> i32);
    let c_observe = black_box(jcas_sim_observe as unsafe extern "C" fn(_, _, _) -> i32);
    let c_reset = black_box(jcas_sim_reset as unsafe extern "C" fn(_, _) -> i32);
    let (mut c_actions, mut c_seen) = (vec![0.0; 2 * uavs as usize], vec![0.0f32; observation_len]);
    let mut c_steps = 0;
    let mut abi = || {
        actions_of(c_steps, &mut c_actions);
        c_steps += 1;
        let mut outcome = jcas_outcome {
            struct_size: size_of::<jcas_outcome>() as u32,
            terminated: 0,
            truncated: 0,
            false_confirmations: 0,
            reward: 0.0,
        };
        // SAFETY: a living simulation, and buffers of these lengths.
        ok(unsafe { c_step(c_sim, c_actions.as_ptr(), c_actions.len(), &raw mut outcome) });
        if observed {
            // SAFETY: as above.
            ok(unsafe { c_observe(c_sim, c_seen.as_mut_ptr(), c_seen.len()) });
        }
        if outcome.terminated + outcome.truncated > 0 {
            // SAFETY: as above.
            ok(unsafe { c_reset(c_sim, c_steps as u64) });
        }
    };
    use_paths((&mut kernel, &mut abi));
    // SAFETY: both handles are alive and not used any more.
    unsafe {
        ok(jcas_sim_free(c_sim));
        ok(jcas_model_free(c_model));
    }
}

fn batch(environments: usize, uavs: u32, hotspots: u32, use_paths: &mut dyn FnMut(Paths<'_>)) {
    let config = Config {
        uav_count: uavs,
        hotspot_count: hotspots,
        ..Config::default()
    };
    let model = Model::new(config).expect("a legal configuration");
    let seeds: Vec<u64> = (0..environments as u64).collect();
    let mut buffers = Buffers::new(&model, environments);
    let mut c_buffers = Buffers::new(&model, environments);

    let mut states = vec![0; environments * model.state_words()];
    let mut scratch_words = vec![0; Scratch::words_for(&model)];
    let mut scratch = Scratch::new(&model, &mut scratch_words).expect("enough memory");
    model
        .batch_reset(
            &mut states,
            &mut scratch,
            &seeds,
            &mut buffers.observations,
            &mut [],
        )
        .expect("buffers of the right lengths");
    let mut step = 0;
    let mut kernel = || {
        actions_of(step, &mut buffers.actions);
        step += 1;
        let mut out = BatchOut {
            observations: &mut buffers.observations,
            rewards: &mut buffers.rewards,
            terminated: &mut buffers.terminated,
            truncated: &mut buffers.truncated,
            ..BatchOut::default()
        };
        model
            .batch_step(&mut states, &mut scratch, &buffers.actions, true, &mut out)
            .expect("a legal step");
    };

    let c_model = c_model(uavs, hotspots);
    let c_batch = c_batch(c_model, &seeds, &mut c_buffers.observations);
    let c_step = black_box(jcas_batch_step as unsafe extern "C" fn(_, _, _, _, _) -> i32);
    let mut c_steps = 0;
    let mut abi = || {
        actions_of(c_steps, &mut c_buffers.actions);
        c_steps += 1;
        let out = c_buffers.out();
        let actions = &c_buffers.actions;
        // SAFETY: a living batch, and buffers of these lengths.
        ok(unsafe { c_step(c_batch, actions.as_ptr(), actions.len(), 1, &raw const out) });
    };
    use_paths((&mut kernel, &mut abi));
    // SAFETY: both handles are alive and not used any more.
    unsafe {
        ok(jcas_batch_free(c_batch));
        ok(jcas_model_free(c_model));
    }
}

/// Builds a batch with one environment for each seed, and resets it.
fn c_batch(c_model: *mut jcas_model, seeds: &[u64], observations: &mut [f32]) -> *mut jcas_batch {
    let mut c_batch = ptr::null_mut();
    // SAFETY: living handles, buffers of these lengths.
    unsafe {
        ok(jcas_batch_new(
            c_model,
            seeds.len() as u32,
            1,
            &raw mut c_batch,
        ));
        ok(jcas_batch_reset(
            c_batch,
            seeds.as_ptr(),
            seeds.len(),
            observations.as_mut_ptr(),
            observations.len(),
            ptr::null_mut(),
            0,
        ));
    }
    c_batch
}

struct Buffers {
    actions: Vec<f32>,
    observations: Vec<f32>,
    rewards: Vec<f32>,
    terminated: Vec<u8>,
    truncated: Vec<u8>,
}

impl Buffers {
    fn new(model: &Model<'_>, environments: usize) -> Self {
        Self {
            actions: vec![0.0; environments * model.action_len()],
            observations: vec![0.0; environments * model.uav_count() * model.observation_len()],
            rewards: vec![0.0; environments],
            terminated: vec![0; environments],
            truncated: vec![0; environments],
        }
    }

    fn out(&mut self) -> jcas_batch_out {
        jcas_batch_out {
            struct_size: size_of::<jcas_batch_out>() as u32,
            reserved: 0,
            observations: self.observations.as_mut_ptr(),
            observation_count: self.observations.len(),
            rewards: self.rewards.as_mut_ptr(),
            reward_count: self.rewards.len(),
            terminated: self.terminated.as_mut_ptr(),
            terminated_count: self.terminated.len(),
            truncated: self.truncated.as_mut_ptr(),
            truncated_count: self.truncated.len(),
            global: ptr::null_mut(),
            global_count: 0,
            components: ptr::null_mut(),
            component_count: 0,
            final_observations: ptr::null_mut(),
            final_observation_count: 0,
            final_global: ptr::null_mut(),
            final_global_count: 0,
            final_metrics: ptr::null_mut(),
            final_metrics_count: 0,
            metrics_size: 0,
            uav_rewards: ptr::null_mut(),
            uav_reward_count: 0,
        }
    }
}

fn c_model(uavs: u32, hotspots: u32) -> *mut jcas_model {
    let text = format!("uav_count = {uavs}\nhotspot_count = {hotspots}");
    let mut config = std::mem::MaybeUninit::<jcas_config>::uninit();
    let mut model = ptr::null_mut();
    // SAFETY: places of these sizes, a text of this length; no message is wanted.
    unsafe {
        ok(jcas_config_from_toml(
            text.as_ptr().cast(),
            text.len(),
            config.as_mut_ptr(),
            size_of::<jcas_config>(),
            ptr::null_mut(),
            0,
        ));
        ok(jcas_model_new(
            config.as_ptr(),
            &raw mut model,
            ptr::null_mut(),
            0,
        ));
    }
    model
}

fn c_sim(model: *const jcas_model) -> *mut jcas_sim {
    let mut sim = ptr::null_mut();
    // SAFETY: a living model.
    ok(unsafe { jcas_sim_new(model, &raw mut sim) });
    sim
}

fn ok(status: i32) {
    assert_eq!(status, JCAS_OK);
}
