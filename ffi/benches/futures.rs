//! Measures futures of one state on one thread, beside plain steps:
//! `cargo bench -p jcas-ffi --bench futures`.
//!
//! The calls take turns, so that other load on the machine affects all alike. The figure of each is
//! its fastest tenth. Given actions cost what plain steps cost; the policy is forked with its
//! memory, as a planner does.

use std::ptr::{null, null_mut};
use std::time::Instant;

use jcas::*;

const UAVS: usize = 15;
const HOTSPOTS: usize = 7;
const MEMBERS: usize = 256;
const STEPS: usize = 20;
const ROUNDS: usize = 100;

fn ok(status: i32) {
    assert_eq!(status, JCAS_OK);
}

/// Returns a struct of C whose bits are zero.
fn zeroed<T>() -> T {
    // SAFETY: used for structs of numbers and pointers alone.
    unsafe { std::mem::zeroed() }
}

/// The handles that are measured.
struct Subject {
    sim: *mut jcas_sim,
    batch: *mut jcas_batch,
    teams: *mut jcas_policy,
    snapshot_size: usize,
}

/// Builds a mission that `teams` has flown for a step.
fn subject() -> Subject {
    let text = format!("uav_count = {UAVS}\nhotspot_count = {HOTSPOTS}");
    let mut config = zeroed::<jcas_config>();
    let (mut model, mut sim, mut batch, mut teams) =
        (null_mut(), null_mut(), null_mut(), null_mut());
    let mut info = zeroed::<jcas_model_info>();
    info.struct_size = size_of::<jcas_model_info>() as u32;
    let mut outcome = zeroed::<jcas_outcome>();
    outcome.struct_size = size_of::<jcas_outcome>() as u32;
    let mut actions = [0.0; 2 * UAVS];
    // SAFETY: places and texts of these sizes, and living handles.
    unsafe {
        ok(jcas_config_from_toml(
            text.as_ptr().cast(),
            text.len(),
            &raw mut config,
            size_of::<jcas_config>(),
            null_mut(),
            0,
        ));
        ok(jcas_model_new(&config, &raw mut model, null_mut(), 0));
        ok(jcas_model_get_info(model, &raw mut info));
        ok(jcas_sim_new(model, &raw mut sim));
        ok(jcas_batch_new(model, MEMBERS as u32, 1, &raw mut batch));
        let (name, pilot) = (c"teams".as_ptr(), c"max".as_ptr());
        let made = jcas_policy_baseline(model, name, pilot, &raw mut teams, null_mut(), 0);
        ok(made);
        ok(jcas_sim_reset(sim, 1));
        let acted = jcas_policy_act(teams, sim, actions.as_mut_ptr(), actions.len());
        ok(acted);
        let stepped = jcas_sim_step(sim, actions.as_ptr(), actions.len(), &raw mut outcome);
        ok(stepped);
    }
    Subject {
        sim,
        batch,
        teams,
        snapshot_size: info.snapshot_size as usize,
    }
}

fn main() {
    let Subject {
        sim,
        batch,
        teams,
        snapshot_size,
    } = subject();
    let seeds: Vec<u64> = (0..MEMBERS as u64).collect();
    let actions = vec![0.3f32; MEMBERS * STEPS * UAVS * 2];
    let mut returns = vec![0.0; MEMBERS];
    let mut snapshots = vec![0u8; MEMBERS * snapshot_size];
    let mut out = zeroed::<jcas_rollout_out>();
    out.struct_size = size_of::<jcas_rollout_out>() as u32;
    (out.returns, out.return_count) = (returns.as_mut_ptr(), MEMBERS);
    let fork = |policy| {
        // SAFETY: living handles, and seeds of this length.
        ok(unsafe { jcas_batch_fork(batch, sim, policy, seeds.as_ptr(), MEMBERS) });
    };
    let roll_out = |policy, actions: &[f32]| {
        let (data, count) = match actions.len() {
            0 => (null(), 0),
            count => (actions.as_ptr(), count),
        };
        // SAFETY: living handles, and buffers of these lengths.
        ok(unsafe { jcas_batch_rollout(batch, policy, data, count, STEPS as u32, &out) });
    };
    let size = snapshots.len();
    let at = snapshots.as_mut_ptr();
    let mut calls: [(&str, &mut dyn FnMut()); 6] = [
        ("fork", &mut || fork(null_mut())),
        ("20 given steps", &mut || roll_out(null_mut(), &actions)),
        ("fork with the memory of teams", &mut || fork(teams)),
        ("20 steps by teams", &mut || roll_out(teams, &[])),
        // SAFETY: a living batch, and bytes for all of its snapshots.
        ("save", &mut || {
            ok(unsafe { jcas_batch_save(batch, at.cast(), size) })
        }),
        // SAFETY: as above.
        ("load", &mut || {
            ok(unsafe { jcas_batch_load(batch, at.cast(), size) })
        }),
    ];
    let mut times = [const { Vec::new() }; 6];
    for _ in 0..ROUNDS {
        for ((_, call), times) in calls.iter_mut().zip(&mut times) {
            let begun = Instant::now();
            call();
            times.push(begun.elapsed().as_secs_f64());
        }
    }
    println!("N = {UAVS}, n = {HOTSPOTS}: a snapshot has {snapshot_size} bytes");
    println!("| of one environment | µs | in a second |\n| --- | ---: | ---: |");
    for ((what, _), times) in calls.iter().zip(&mut times) {
        times.sort_by(f64::total_cmp);
        let seconds = times[ROUNDS / 10] / MEMBERS as f64;
        println!("| {what} | {:.2} | {:.0} |", seconds * 1e6, 1.0 / seconds);
    }
}
