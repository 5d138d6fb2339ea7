//! Policies: trained networks from their files, and the baselines by name.

use std::alloc::Layout;
use std::ffi::{CStr, c_char, c_void};
use std::fmt::Display;

use ::jcas_policy::head::Mode;
use ::jcas_policy::network::Network;
use ::jcas_policy::{BaselineKind, PLAN, PilotMode, PolicyError, REPLAN};
use jcas_core::Model;
use jcas_plan::PlannedKind;

use crate::batch::jcas_batch;
use crate::batch_block::BatchBlock;
use crate::handle::Memory;
use crate::memory::{Message, bytes, message, output, place, put_layout};
use crate::model::jcas_model;
use crate::model_block::model;
use crate::names::{joined, joined_len, name_at};
use crate::policy_block::{PolicyBlock, fault};
use crate::scripted::{Script, Whom};
use crate::sim::jcas_sim;
use crate::sim_block::see;
use crate::status::{
    Fault, JCAS_ERROR_ARGUMENT, JCAS_ERROR_CORRUPT, JCAS_ERROR_NULL, JCAS_OK, guard, jcas_status,
};

/// A controller of a fleet for one model: a trained network or a baseline. One thread at a time may
/// use it; a model may have several policies.
pub struct jcas_policy(());

/// Actions are the most likely motion and the mean pilot density. UAVs that choose sequentially
/// stay on a depot to charge. They sample where they would turn back without a new confirmation.
pub const JCAS_POLICY_DETERMINISTIC: i32 = 0;
/// Actions are drawn from the network's distribution; the draws follow from the seed of the
/// episode, the step and the UAV.
pub const JCAS_POLICY_SAMPLED: i32 = 1;

/// Reads the network of a file and checks that it fits the model. The reason for a refusal goes to
/// the caller's buffer.
///
/// # Safety
/// As [`bytes`] and [`message`].
unsafe fn network(
    model: &Model<'_>,
    file: *const u8,
    length: usize,
    buffer: *mut c_char,
    capacity: usize,
) -> Result<(Network, &'static [u8]), Fault> {
    // SAFETY: the caller's promise; the slice does not outlive the call.
    let file: &'static [u8] = unsafe { bytes(file, length) }?;
    let network = Network::read(file).map_err(|error| {
        // SAFETY: the caller's promises, passed on.
        unsafe { message(&Message(error), buffer, capacity) };
        Fault::Status(JCAS_ERROR_CORRUPT)
    })?;
    network.check(model).map_err(|error| {
        // SAFETY: the caller's promises, passed on.
        unsafe { message(&Message(&error), buffer, capacity) };
        fault(error)
    })?;
    Ok((network, file))
}

/// Writes the size and alignment of the memory that jcas_policy_init needs.
///
/// `model`, `file`, `size`, `alignment`: not NULL. `file`: the bytes of a policy.safetensors.
/// `size` in bytes. `message`: see the rules below. JCAS_ERROR_CORRUPT means that the bytes are no
/// policy. JCAS_ERROR_MODEL_MISMATCH means that the policy reads observations of another shape.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_policy_layout(
    model: *const jcas_model,
    file: *const u8,
    length: usize,
    size: *mut usize,
    alignment: *mut usize,
    message: *mut c_char,
    message_capacity: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?;
        let layout = || {
            // SAFETY: the caller's promises for `file` and `message`.
            let (network, _) =
                unsafe { network(model.get(), file, length, message, message_capacity) }?;
            PolicyBlock::layout(model.get(), Some(&network))
        };
        // SAFETY: the caller's promises for `size` and `alignment`.
        unsafe { put_layout(size, alignment, layout) }
    })
}

/// Builds a trained policy in the caller's memory, which must not move until jcas_policy_free.
///
/// `memory`: at least the size and alignment of jcas_policy_layout; not NULL; the caller's.
/// `model`: not NULL; must not be freed before the policy. `file`: as for jcas_policy_layout; not
/// needed after the call. `policy`: not NULL; receives the handle. `message`: see the rules below.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT, IN_USE, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_policy_init(
    memory: *mut c_void,
    size: usize,
    model: *const jcas_model,
    file: *const u8,
    length: usize,
    policy: *mut *mut jcas_policy,
    message: *mut c_char,
    message_capacity: usize,
) -> jcas_status {
    let lent = |layout| {
        // SAFETY: the caller's promise for `memory`.
        unsafe { Memory::lent(memory.cast(), size, layout) }
    };
    let message = (message, message_capacity);
    // SAFETY: the caller's promises, passed on.
    unsafe { build(model, (file, length), policy, message, lent) }
}

/// Builds a trained policy in memory from the system. jcas_policy_free ends it.
///
/// It acts in the `mode` and with the `pilot_density` of its file. The mode is deterministic if the
/// file has none.
///
/// `model`: not NULL; must not be freed before the policy. `file`: the bytes of a
/// policy.safetensors; not needed after the call. `policy`: not NULL; receives the handle.
/// `message`: see the rules below. JCAS_ERROR_CORRUPT means that the bytes are no policy.
/// JCAS_ERROR_MODEL_MISMATCH means that the policy reads observations of another shape.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_policy_load(
    model: *const jcas_model,
    file: *const u8,
    length: usize,
    policy: *mut *mut jcas_policy,
    message: *mut c_char,
    message_capacity: usize,
) -> jcas_status {
    let message = (message, message_capacity);
    // SAFETY: the caller's promises, passed on.
    unsafe { build(model, (file, length), policy, message, Memory::allocate) }
}

/// Builds a trained policy in the memory that `memory` gives for its layout. The file and the
/// message come with their sizes.
///
/// # Safety
/// The pointers are as for [`jcas_policy_load`]. The memory stays valid until the policy is freed.
unsafe fn build(
    model: *const jcas_model,
    (file, length): (*const u8, usize),
    policy: *mut *mut jcas_policy,
    (message, message_capacity): (*mut c_char, usize),
    memory: impl FnOnce(Layout) -> Result<(*mut u8, Memory), Fault>,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?;
        // SAFETY: the caller's promise for `policy`.
        let out = unsafe { place(policy) }?;
        // SAFETY: the caller's promises for `file` and `message`.
        let (network, file) =
            unsafe { network(model.get(), file, length, message, message_capacity) }?;
        let memory = memory(PolicyBlock::layout(model.get(), Some(&network))?)?;
        // SAFETY: the memory has this layout and lives as long as the policy.
        let block = unsafe { PolicyBlock::build_network(model, &network, file, memory) }?;
        out.put(block.cast());
        Ok(())
    })
}

/// Builds a baseline by its name. jcas_policy_free ends it. The names are random, untrained,
/// greedy, teams, squads, line and answer, as for `jcas simulate --policy`; jcas_policy_name lists
/// them. Plans are on the heap: jcas_policy_act allocates in the first step of an episode and in
/// each step that plans.
///
/// Two more names stand for policies that anneal plans, as jcas_plan_search and jcas_plan_tour do.
/// `plan` follows one plan without feedback. `replan` plans again after each
/// confirmation, meeting and report. If the model hides hotspots, this call makes the first plan,
/// which takes seconds; otherwise the first step of each episode does.
///
/// `model`: not NULL; must not be freed before the policy. `name`: not NULL. `pilot`: min, mid,
/// max, adaptive or a density such as 0.15; NULL means adaptive. A plan has its own densities.
/// `policy`: not NULL; receives the handle. `message`: see the rules below. JCAS_ERROR_ARGUMENT
/// means that the name is unknown, or that the baseline needs positions that the model hides. It
/// also means that the fleet, the grid or the mission is too large for a plan.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_policy_baseline(
    model: *const jcas_model,
    name: *const c_char,
    pilot: *const c_char,
    policy: *mut *mut jcas_policy,
    message: *mut c_char,
    message_capacity: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?;
        // SAFETY: the caller's promise for `policy`.
        let out = unsafe { place(policy) }?;
        if name.is_null() {
            return Err(Fault::Status(JCAS_ERROR_NULL));
        }
        // SAFETY: the caller's promise for `name`.
        let name = unsafe { CStr::from_ptr(name) };
        let pilot = if pilot.is_null() {
            c"adaptive"
        } else {
            // SAFETY: the caller's promise for `pilot`.
            unsafe { CStr::from_ptr(pilot) }
        };
        // A text that is not UTF-8 is no name.
        let text = |words: &'static CStr| words.to_str().unwrap_or("?");
        // SAFETY: the caller's promise for `message`.
        let script = unsafe {
            script(
                model.get(),
                text(name),
                text(pilot),
                message,
                message_capacity,
            )
        }?;
        out.put(PolicyBlock::build_script(model, script)?.cast());
        Ok(())
    })
}

/// The names of all policies, and what each does.
const NAMES: [&str; NAMED] = listed(true);
const SUMMARIES: [&str; NAMED] = listed(false);
/// The number of policies that go by a name.
const NAMED: usize = BaselineKind::ALL.len() + 2;

const fn listed(names: bool) -> [&'static str; NAMED] {
    let mut texts = [""; NAMED];
    let mut index = 0;
    while index < NAMED {
        let policy = if index < BaselineKind::ALL.len() {
            BaselineKind::ALL[index].named_policy()
        } else if index == BaselineKind::ALL.len() {
            PLAN
        } else {
            REPLAN
        };
        texts[index] = if names { policy.name } else { policy.summary };
        index += 1;
    }
    texts
}

/// Returns the name of a policy for jcas_policy_baseline: a static string, or NULL for an index
/// beyond the last one. The baselines come first.
/// Threads: any.
#[unsafe(no_mangle)]
pub extern "C" fn jcas_policy_name(index: u32) -> *const c_char {
    static TEXT: [u8; joined_len(&NAMES)] = joined(&NAMES);
    name_at(&TEXT, index)
}

/// Returns what the policy with this index does, in a few words: a static string, or NULL for an
/// index beyond the last one.
/// Threads: any.
#[unsafe(no_mangle)]
pub extern "C" fn jcas_policy_summary(index: u32) -> *const c_char {
    static TEXT: [u8; joined_len(&SUMMARIES)] = joined(&SUMMARIES);
    name_at(&TEXT, index)
}

/// Returns the script of a name. The reason for a refusal goes to the caller's buffer.
///
/// # Safety
/// As [`message`].
unsafe fn script(
    model: &Model<'_>,
    name: &str,
    pilot: &str,
    buffer: *mut c_char,
    capacity: usize,
) -> Result<Script, Fault> {
    let refuse = |reason: &dyn Display, fault: Fault| {
        // SAFETY: the caller's promises, passed on.
        unsafe { message(&Message(reason), buffer, capacity) };
        fault
    };
    let argument = |error: PolicyError<'_>| refuse(&error, Fault::Status(JCAS_ERROR_ARGUMENT));
    let mode = PilotMode::named(pilot).map_err(argument)?;
    if let Some(kind) = PlannedKind::named(name) {
        mode.check(model.config()).map_err(argument)?;
        let planned = kind.build(model);
        let planned = planned.map_err(|error| refuse(&error, Fault::from(error)))?;
        return Ok(Script::Planned(planned));
    }
    let kind = BaselineKind::named(name).map_err(argument)?;
    kind.build(model, mode).map_err(argument)?;
    Ok(Script::Baseline(kind, mode))
}

/// Sets how a trained policy derives actions from its network. Baselines are not affected.
///
/// `policy`: not NULL. `mode`: JCAS_POLICY_DETERMINISTIC or JCAS_POLICY_SAMPLED.
/// Threads: only this one uses `policy`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_policy_set_mode(policy: *mut jcas_policy, mode: i32) -> jcas_status {
    guard(|| {
        let mode = match mode {
            JCAS_POLICY_DETERMINISTIC => Mode::Deterministic,
            JCAS_POLICY_SAMPLED => Mode::Sampled,
            _ => return Err(Fault::Status(JCAS_ERROR_ARGUMENT)),
        };
        // SAFETY: the caller's promise for `policy`.
        let _mark = unsafe { PolicyBlock::hold(policy.cast()) }?;
        // SAFETY: this call holds the policy.
        unsafe { PolicyBlock::set_mode(policy.cast(), mode) };
        Ok(())
    })
}

/// Writes the actions of the policy for the present state of a simulation, as jcas_sim_step takes
/// them.
///
/// The bits are the same on every platform. `sim` may belong to another model with the same
/// configuration; it does not change. After RESOURCES, which means no memory for a plan, the same
/// call may be repeated.
///
/// teams, squads, line, answer and replan remember what they planned. They begin anew at t = 0, and
/// in the first state of all. From then on they act in every state of one simulation. Another
/// state is JCAS_ERROR_MEMORY. It is one of another simulation, one after a step without them, or
/// one that was loaded or forked. The function jcas_policy_memory_load brings the memory of such a
/// state back, and jcas_policy_forget begins anew in it.
///
/// `policy`, `sim`, `actions`: not NULL. `action_count`: action_len.
/// Threads: only this one uses `policy`, none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, NAN, MODEL_MISMATCH, MEMORY, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_policy_act(
    policy: *mut jcas_policy,
    sim: *const jcas_sim,
    actions: *mut f32,
    action_count: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        // SAFETY: the caller's promise for `actions`.
        let actions = unsafe { output(actions, action_count, sim.model.action_len()) }?;
        // SAFETY: the caller's promise for `policy`.
        let _mark = unsafe { PolicyBlock::hold(policy.cast()) }?;
        // SAFETY: this call holds the policy.
        unsafe { PolicyBlock::plan(policy.cast(), Whom::Sim, sim.timeline, sim.model, sim.words) }?;
        // SAFETY: as above.
        unsafe { PolicyBlock::act(policy.cast(), Whom::Sim, sim.model, sim.words, actions) }
    })
}

/// Writes the actions for every environment of a batch, as jcas_policy_act does for one simulation.
/// Environments are processed in order on this thread. After JCAS_ERROR_NAN (a network output is
/// not finite), the actions of the environments before are written.
///
/// `policy`, `batch`, `actions`: not NULL. `action_count`: count * action_len.
/// Threads: only this one uses `policy`, none changes `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, NAN, MODEL_MISMATCH, MEMORY, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_policy_act_batch(
    policy: *mut jcas_policy,
    batch: *const jcas_batch,
    actions: *mut f32,
    action_count: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `batch`.
        let (batch, _mark) = unsafe { BatchBlock::see(batch.cast()) }?;
        // SAFETY: the caller's promise for `actions`.
        let actions = unsafe { output(actions, action_count, batch.sizes().actions) }?;
        // SAFETY: the caller's promise for `policy`.
        let _held = unsafe { PolicyBlock::hold(policy.cast()) }?;
        let each = actions.chunks_exact_mut(batch.model().action_len());
        for index in 0..each.len() {
            let words = batch.state(index)?;
            // SAFETY: this call holds the policy.
            unsafe {
                PolicyBlock::plan(
                    policy.cast(),
                    Whom::Environment(index),
                    batch.timeline(index),
                    batch.model(),
                    words,
                )
            }?;
        }
        for (index, actions) in each.enumerate() {
            let words = batch.state(index)?;
            // SAFETY: as above.
            unsafe {
                PolicyBlock::act(
                    policy.cast(),
                    Whom::Environment(index),
                    batch.model(),
                    words,
                    actions,
                )
            }?;
        }
        Ok(())
    })
}

/// Ends a policy. Memory of jcas_policy_init belongs to the caller again. NULL is allowed and does
/// nothing.
///
/// Threads: none may be using the policy.
/// Statuses: NULL, ALIGNMENT, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_policy_free(policy: *mut jcas_policy) -> jcas_status {
    if policy.is_null() {
        return JCAS_OK;
    }
    // SAFETY: the caller's promise for `policy`.
    guard(|| unsafe { PolicyBlock::free(policy.cast()) })
}
