//! Plans: made, read, on file, and flown.

use std::ffi::{c_char, c_void};
use std::ops::ControlFlow;
use std::sync::Arc;

use ::jcas_plan::{
    PlanFile, PlanFileError, Planned, Progress, READ_BYTES_MAX, Settings, check_available, search,
    tour,
};
use jcas_core::{Cell, Model};

use crate::config::jcas_cell;
use crate::memory::{
    Message, Plain, Record, bytes, input, message, output, place, read_record, record, text_out,
};
use crate::model::jcas_model;
use crate::model_block::model;
use crate::parts::kernel_cells;
use crate::plan_block::PlanBlock;
use crate::policy::jcas_policy;
use crate::policy_block::PolicyBlock;
use crate::scripted::Script;
use crate::status::{
    Fault, JCAS_ERROR_ARGUMENT, JCAS_ERROR_CORRUPT, JCAS_ERROR_MODEL_MISMATCH, guard, jcas_status,
};

/// A plan of an episode: the cell and the pilot density of each UAV in each step. It never changes,
/// and it outlives its model.
pub struct jcas_plan(());

/// A function of the caller that hears of the progress of a planning. `iterations` counts the moves
/// tried so far; it is 0 while initial trajectories are evaluated. `best_steps` is the expected
/// time of the best plan so far, infinite before the first one. `context` is the pointer from
/// jcas_plan_settings. It returns 0 to go on; another value ends the planning early, with the best
/// plan so far.
pub type jcas_plan_progress =
    Option<unsafe extern "C" fn(iterations: u64, best_steps: f64, context: *mut c_void) -> i32>;

/// The length and the seed of an annealing. A plan depends on them and on the configuration only,
/// unless `progress` ends it early.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct jcas_plan_settings {
    /// sizeof(jcas_plan_settings).
    pub struct_size: u32,
    /// Reserved; set it to 0.
    pub reserved: u32,
    /// Moves that the annealing tries. A search of ten UAVs takes some 200 000 in a second.
    pub iterations: u64,
    /// Seed of the annealing.
    pub seed: u64,
    /// The function that hears of the progress; may be NULL.
    pub progress: jcas_plan_progress,
    /// The pointer that is passed to `progress`.
    pub progress_context: *mut c_void,
}

// SAFETY: the fields are integers, a raw pointer and a nullable function pointer, whose validity
// the caller promises.
unsafe impl Plain for jcas_plan_settings {}
// SAFETY: `struct_size` comes first.
unsafe impl Record for jcas_plan_settings {}

/// The size of a plan and what it promises.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct jcas_plan_info {
    /// sizeof(jcas_plan_info); set it before the call.
    pub struct_size: u32,
    /// UAVs (N).
    pub uav_count: u32,
    /// Steps of the trajectories; the fleet stays in its last cells after them.
    pub step_count: u32,
    /// 1 if the annealing ended before the requested number of moves, else 0.
    pub stopped: u32,
    /// Fingerprint of the configuration, as jcas_config_hash.
    pub config_hash: u64,
    /// Seed of the annealing.
    pub seed: u64,
    /// Moves that the annealing tried.
    pub iterations: u64,
    /// Expected steps until the episode ends; one without success counts with its horizon.
    pub expected_steps: f64,
    /// Expected steps until every hotspot is confirmed.
    pub expected_confirmed_steps: f64,
    /// Probability that the episode ends before the horizon.
    pub success: f64,
    /// Expected steps of the trajectories that the annealing began with.
    pub start_steps: f64,
    /// A lower bound on the expected steps of every plan without feedback.
    pub bound_steps: f64,
}

// SAFETY: the struct has only integers and floats.
unsafe impl Plain for jcas_plan_info {}
// SAFETY: `struct_size` comes first.
unsafe impl Record for jcas_plan_info {}

/// Refuses a text that holds no plan for the model.
///
/// # Safety
/// As [`message`].
unsafe fn unfit(error: &PlanFileError, buffer: *mut c_char, capacity: usize) -> Fault {
    // SAFETY: the caller's promises, passed on.
    unsafe { message(&Message(error), buffer, capacity) };
    Fault::Status(match error {
        PlanFileError::Configuration { .. } => JCAS_ERROR_MODEL_MISMATCH,
        _ => JCAS_ERROR_CORRUPT,
    })
}

/// Anneals a plan for hidden hotspots or for those in known cells, and writes its handle.
///
/// # Safety
/// As the arguments of [`jcas_plan_tour`].
unsafe fn make(
    model: &Model<'_>,
    hotspots: Option<&[Cell]>,
    settings: *const jcas_plan_settings,
    plan: *mut *mut jcas_plan,
    (buffer, capacity): (*mut c_char, usize),
) -> Result<(), Fault> {
    // SAFETY: the caller's promise for `settings`.
    let given = unsafe { read_record(settings) }?;
    // SAFETY: the caller's promise for `plan`.
    let out = unsafe { place(plan) }?;
    if given.reserved != 0 {
        let reason = Message(format_args!("reserved = {}: must be 0", given.reserved));
        // SAFETY: the caller's promise for the message.
        unsafe { message(&reason, buffer, capacity) };
        return Err(Fault::Status(JCAS_ERROR_ARGUMENT));
    }
    let settings = Settings {
        iterations: given.iterations,
        seed: given.seed,
    };
    let mut progress = |now: Progress| {
        let told = given.progress.map(|tell| {
            // SAFETY: the caller's promise for `progress` and its context.
            unsafe { tell(now.iterations, now.best_steps, given.progress_context) }
        });
        match told {
            None | Some(0) => ControlFlow::Continue(()),
            Some(_) => ControlFlow::Break(()),
        }
    };
    let made = match hotspots {
        Some(cells) => tour(model, cells, &settings, &mut progress),
        None => search(model, &settings, &mut progress),
    };
    let made = made.map_err(|error| {
        // SAFETY: the caller's promise for the message.
        unsafe { message(&Message(error), buffer, capacity) };
        Fault::from(error)
    })?;
    let file = PlanFile::new(model, &made, hotspots.map(<[Cell]>::to_vec));
    out.put(PlanBlock::build(file, made)?.cast());
    Ok(())
}

/// Plans an episode whose hotspots are hidden: any set of distinct cells without a depot is as
/// likely as any other. The annealing runs on this thread. jcas_plan_free ends the plan.
///
/// `model`, `settings`, `plan`: not NULL; settings->struct_size set. `plan` receives the handle.
/// `message`: see the rules below. JCAS_ERROR_ARGUMENT means that `reserved` is not 0,
/// or that the fleet, the grid, the number of hotspots or the horizon is too large.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE, ARGUMENT, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_plan_search(
    model: *const jcas_model,
    settings: *const jcas_plan_settings,
    plan: *mut *mut jcas_plan,
    message: *mut c_char,
    message_capacity: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?.get();
        // SAFETY: the caller's promises, passed on.
        unsafe { make(model, None, settings, plan, (message, message_capacity)) }
    })
}

/// Plans an episode whose hotspots lie in known cells. The plan decides which UAVs visit them, in
/// which order, how many together and for how long. The annealing runs on this thread.
/// jcas_plan_free ends the plan.
///
/// `model`, `hotspots`, `settings`, `plan`: not NULL; settings->struct_size set. `hotspots`: one
/// cell of the grid for each hotspot. `hotspot_count`: that of the model. `plan` receives the
/// handle. `message`: see the rules below. JCAS_ERROR_ARGUMENT means that a cell lies off the grid.
/// It also means what it means for jcas_plan_search.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE, ARGUMENT, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_plan_tour(
    model: *const jcas_model,
    hotspots: *const jcas_cell,
    hotspot_count: usize,
    settings: *const jcas_plan_settings,
    plan: *mut *mut jcas_plan,
    message: *mut c_char,
    message_capacity: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?.get();
        // SAFETY: the caller's promise for `hotspots`.
        let cells = unsafe { input(hotspots, hotspot_count, model.hotspot_count()) }?;
        let cells = Some(kernel_cells(cells));
        // SAFETY: the caller's promises, passed on.
        unsafe { make(model, cells, settings, plan, (message, message_capacity)) }
    })
}

/// Reads a plan from the JSON text of jcas_plan_to_json or `jcas plan`. jcas_plan_free ends it.
///
/// `model`, `text`, `plan`: not NULL. `text`: `text_length` bytes of UTF-8, no terminating zero
/// needed. `plan` receives the handle. `message`: see the rules below. JCAS_ERROR_CORRUPT means
/// that the text is no plan of this fleet. JCAS_ERROR_MODEL_MISMATCH means that the plan was made
/// for another configuration.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_plan_from_json(
    model: *const jcas_model,
    text: *const c_char,
    text_length: usize,
    plan: *mut *mut jcas_plan,
    message: *mut c_char,
    message_capacity: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?.get();
        // SAFETY: the caller's promise for `plan`.
        let out = unsafe { place(plan) }?;
        // SAFETY: the caller's promise for `text`.
        let text = unsafe { bytes(text.cast(), text_length) }?;
        check_available(READ_BYTES_MAX.saturating_mul(text_length as u64))?;
        let text = std::str::from_utf8(text).map_err(|_| {
            // SAFETY: the caller's promise for the message.
            unsafe { self::message("no plan: not UTF-8", message, message_capacity) };
            Fault::Status(JCAS_ERROR_CORRUPT)
        })?;
        let read = PlanFile::parse(text).and_then(|file| {
            let plan = file.plan(model)?;
            Ok((file, plan))
        });
        // SAFETY: the caller's promise for the message.
        let (file, plan) =
            read.map_err(|error| unsafe { unfit(&error, message, message_capacity) })?;
        out.put(PlanBlock::build(file, plan)?.cast());
        Ok(())
    })
}

/// Writes a plan as JSON text, as `jcas plan` does. It holds the configuration too.
///
/// `plan`: not NULL. `text`: `capacity` bytes, or NULL with a capacity of 0 to ask for the length.
/// `length`: not NULL; receives the length without the terminating zero. `capacity` must be at
/// least one more; otherwise the call writes only the length and returns JCAS_ERROR_LENGTH.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_plan_to_json(
    plan: *const jcas_plan,
    text: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `plan`.
        let plan = unsafe { PlanBlock::see(plan.cast()) }?;
        // SAFETY: the caller's promises for `text` and `length`.
        unsafe { text_out(plan.text, text, capacity, length) }
    })
}

/// Writes the size of a plan and what it promises.
///
/// `plan`, `info`: not NULL; info->struct_size set.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_plan_get_info(
    plan: *const jcas_plan,
    info: *mut jcas_plan_info,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `plan`.
        let seen = unsafe { PlanBlock::see(plan.cast()) }?;
        let (file, plan) = (seen.file, seen.plan);
        // SAFETY: the caller's promise for `info`.
        let out = unsafe { record(info) }?;
        out.put(jcas_plan_info {
            struct_size: jcas_plan_info::SIZE,
            uav_count: file.uavs.len() as u32,
            step_count: plan.paths.steps() as u32,
            stopped: u32::from(file.stopped),
            config_hash: plan.config_hash,
            seed: file.seed,
            iterations: file.iterations,
            expected_steps: file.expected_steps,
            expected_confirmed_steps: file.expected_confirmed_steps,
            success: file.success,
            start_steps: file.start_steps,
            bound_steps: file.bound_steps,
        });
        Ok(())
    })
}

/// Writes the cells of a plan: for each UAV its cell before the first step, then after each step.
///
/// `plan`, `cells`: not NULL. `count`: uav_count * (step_count + 1).
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_plan_get_cells(
    plan: *const jcas_plan,
    cells: *mut jcas_cell,
    count: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `plan`.
        let seen = unsafe { PlanBlock::see(plan.cast()) }?;
        let file = seen.file;
        let expected = file.uavs.len() * (seen.plan.paths.steps() + 1);
        // SAFETY: the caller's promise for `cells`.
        let cells = unsafe { output(cells, count, expected) }?;
        let planned = file.uavs.iter().flat_map(|uav| &uav.cells);
        for (cell, &planned) in cells.iter_mut().zip(planned) {
            *cell = jcas_cell {
                x: planned.x,
                y: planned.y,
            };
        }
        Ok(())
    })
}

/// Writes the pilot densities of a plan, for each UAV one for each step.
///
/// `plan`, `densities`: not NULL. `count`: uav_count * step_count.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_plan_get_pilot_densities(
    plan: *const jcas_plan,
    densities: *mut f64,
    count: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `plan`.
        let seen = unsafe { PlanBlock::see(plan.cast()) }?;
        let file = seen.file;
        let expected = file.uavs.len() * seen.plan.paths.steps();
        // SAFETY: the caller's promise for `densities`.
        let densities = unsafe { output(densities, count, expected) }?;
        let planned = file.uavs.iter().flat_map(|uav| &uav.pilot_density);
        for (density, &planned) in densities.iter_mut().zip(planned) {
            *density = planned;
        }
        Ok(())
    })
}

/// Builds the policy that follows a plan, which jcas_policy_act flies. The fleet follows the plan
/// without feedback; the plan makes it meet. jcas_policy_free ends the policy.
///
/// `model`, `plan`, `policy`: not NULL. `model` must not be freed before the policy; the plan is
/// copied. `policy` receives the handle.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, HANDLE, MODEL_MISMATCH, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_policy_follow(
    model: *const jcas_model,
    plan: *const jcas_plan,
    policy: *mut *mut jcas_policy,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?;
        // SAFETY: the caller's promise for `plan`.
        let plan = unsafe { PlanBlock::see(plan.cast()) }?;
        // SAFETY: the caller's promise for `policy`.
        let out = unsafe { place(policy) }?;
        if plan.plan.config_hash != model.get().config_hash() {
            return Err(Fault::Status(JCAS_ERROR_MODEL_MISMATCH));
        }
        let script = Script::Planned(Planned::following(Arc::clone(plan.plan)));
        out.put(PolicyBlock::build_script(model, script)?.cast());
        Ok(())
    })
}

/// Ends a plan. NULL is allowed and does nothing.
///
/// Threads: none may be using the plan.
/// Statuses: ALIGNMENT, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_plan_free(plan: *mut jcas_plan) -> jcas_status {
    guard(|| {
        if plan.is_null() {
            return Ok(());
        }
        // SAFETY: the caller's promise for `plan`.
        unsafe { PlanBlock::free(plan.cast()) }
    })
}
