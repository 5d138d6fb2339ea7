//! Recording and verification of the files of `jcas trace`.

use std::ffi::{CStr, c_char, c_void};

use jcas_core::header::Phase;
use jcas_trace::{Problem, Replay, VerifyError, configuration};

use crate::config::jcas_config;
use crate::memory::{
    Message, Plain, Record, bytes, message, output, put_layout, read_record, sized_record,
};
use crate::model::jcas_model;
use crate::model_block::model;
use crate::recording::{Recording, Sink, Workspace};
use crate::sim::jcas_sim;
use crate::sim_block::{SimMut, change, open};
use crate::status::{
    Fault, JCAS_ERROR_ARGUMENT, JCAS_ERROR_CORRUPT, JCAS_ERROR_DIFFERENT, JCAS_ERROR_INTERNAL,
    JCAS_ERROR_MODEL_MISMATCH, JCAS_ERROR_NULL, JCAS_ERROR_OUT_OF_ORDER, guard, jcas_status,
};

/// A function of the caller that takes the next `count` bytes of a trace. `context` is the pointer
/// from jcas_recorder. It returns 0, or another value if it could not take the bytes; then it is
/// not called again.
pub type jcas_write =
    Option<unsafe extern "C" fn(bytes: *const c_char, count: usize, context: *mut c_void) -> i32>;

/// The sink and the working memory of a recording. Everything that it points to, except the names,
/// must stay valid until the recording ends.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct jcas_recorder {
    /// sizeof(jcas_recorder).
    pub struct_size: u32,
    /// Reserved; set it to 0.
    pub reserved: u32,
    /// The function that takes the trace; not NULL.
    pub write: jcas_write,
    /// The pointer that is passed to `write`.
    pub write_context: *mut c_void,
    /// The name of the policy for the header of the trace, in UTF-8; NULL means "host".
    pub policy: *const c_char,
    /// The name of the pilot mode for the header of the trace, in UTF-8; NULL means "host".
    pub pilot: *const c_char,
    /// Working memory with at least the size and alignment of jcas_trace_layout; not NULL.
    pub memory: *mut c_void,
    /// The size of `memory` in bytes.
    pub memory_size: usize,
}

// SAFETY: the fields are integers, raw pointers and a nullable function pointer, whose validity the
// caller promises.
unsafe impl Plain for jcas_recorder {}
// SAFETY: `struct_size` comes first.
unsafe impl Record for jcas_recorder {}

/// Writes the size and alignment of the memory that recording and verification need.
///
/// `model`, `size`, `alignment`: not NULL. `size` in bytes.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, HANDLE, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_trace_layout(
    model: *const jcas_model,
    size: *mut usize,
    alignment: *mut usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?;
        let layout = || Workspace::layout(model.get());
        // SAFETY: the caller's promises for `size` and `alignment`.
        unsafe { put_layout(size, alignment, layout) }
    })
}

/// Begins the episode of a seed, as jcas_sim_reset does, and records it. Every step, and every call
/// that replaces a part of the kernel's step or state, becomes a line of the trace. `jcas trace
/// verify` repeats such a file bit for bit, and `jcas replay` shows it.
///
/// Calls that replace the state end the recording without its last line, which readers report.
/// These are jcas_sim_reset, _load, _free, a fork into the simulation, jcas_batch_get and
/// jcas_trace_verify. If the sink refuses the first line, the call returns JCAS_ERROR_SINK and
/// changes nothing. If it refuses a later one, the simulation goes on and jcas_sim_record_end
/// returns JCAS_ERROR_SINK.
///
/// `sim`, `recorder`: not NULL; recorder->struct_size set; the struct itself is not needed after
/// the call.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE, ARGUMENT, SINK.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_record(
    sim: *mut jcas_sim,
    seed: u64,
    recorder: *const jcas_recorder,
) -> jcas_status {
    let act = |sim: &mut SimMut<'_>| {
        // SAFETY: the caller's promise for `recorder`.
        let recorder = unsafe { read_record(recorder) }?;
        let write = recorder.write.ok_or(Fault::Status(JCAS_ERROR_NULL))?;
        if recorder.reserved != 0 {
            return Err(Fault::Status(JCAS_ERROR_ARGUMENT));
        }
        // SAFETY: the caller's promise for the names.
        let policy = unsafe { name(recorder.policy) }?;
        // SAFETY: as above.
        let pilot = unsafe { name(recorder.pilot) }?;
        // SAFETY: the caller's promise for `memory`.
        let workspace =
            unsafe { Workspace::lent(recorder.memory, recorder.memory_size, sim.model) }?;
        let sink = Sink {
            write,
            context: recorder.write_context,
        };
        sim.record(seed, sink, workspace, (policy, pilot))
    };
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Ends a recording between steps and writes its last line. It returns JCAS_ERROR_OUT_OF_ORDER in
/// the middle of a step or without a recording. It returns JCAS_ERROR_SINK if the sink has refused
/// any part of the trace; the recording has then ended too.
///
/// `sim`: not NULL.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, OUT_OF_ORDER, SINK.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_record_end(sim: *mut jcas_sim) -> jcas_status {
    let act = |sim: &mut SimMut<'_>| {
        let state = sim.model.state(sim.words)?;
        let within = [Phase::Moved, Phase::Sensed, Phase::Communicated];
        let parted = (state.header.phase()).is_some_and(|phase| within.contains(&phase));
        match sim.recording.take_if(|_| !parted) {
            Some(recording) => Recording::end(recording, &state),
            None if parted => Err(Fault::Status(JCAS_ERROR_OUT_OF_ORDER)),
            None => Err(Fault::Because(
                JCAS_ERROR_OUT_OF_ORDER,
                "nothing is recorded: jcas_sim_record begins a recording",
            )),
        }
    };
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Fills `config` with the configuration of a trace.
///
/// `trace`: `length` bytes of a file of `jcas trace record` or of jcas_sim_record; not NULL.
/// `config`: not NULL. `struct_size`: sizeof(jcas_config). `message`: see the rules below.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CORRUPT.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_trace_config(
    trace: *const c_char,
    length: usize,
    config: *mut jcas_config,
    struct_size: usize,
    message: *mut c_char,
    message_capacity: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promises for `trace` and `message`.
        let trace = unsafe { text(trace, length, message, message_capacity) }?;
        // SAFETY: the caller's promise for `config`.
        let out = unsafe { sized_record(config, struct_size) }?;
        let config = configuration(trace)
            // SAFETY: the caller's promise for `message`.
            .map_err(|error| unsafe { say(&error, message, message_capacity) })?;
        out.put(jcas_config::from_core(&config));
        Ok(())
    })
}

/// Repeats a trace and compares every line byte by byte. JCAS_OK means that this library reproduces
/// the file. JCAS_ERROR_DIFFERENT means that it does not; the message names the line and the field.
/// JCAS_ERROR_CORRUPT means that the file is cut, changed or no trace. The simulation is left where
/// the trace ends or differs.
///
/// `sim`: not NULL; of the trace's configuration (jcas_trace_config), or JCAS_ERROR_MODEL_MISMATCH.
/// `memory`: at least the size and alignment of jcas_trace_layout; not NULL; the caller's again
/// after the call. `trace`: `length` bytes, as jcas writes them; not NULL. `message`: see the rules
/// below.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT, DIFFERENT.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_trace_verify(
    sim: *mut jcas_sim,
    memory: *mut c_void,
    size: usize,
    trace: *const c_char,
    length: usize,
    message: *mut c_char,
    message_capacity: usize,
) -> jcas_status {
    let message = (message, message_capacity);
    // SAFETY: the caller's promises.
    unsafe { replay(sim, (memory, size), (trace, length), None, message) }
}

/// Repeats a trace to the end of its next step, and compares these lines as jcas_trace_verify does.
///
/// `offset`: where the lines begin, in bytes; not NULL. Set it to 0 for the first call, which
/// checks the whole file, resets the simulation and compares the first line. Each call moves it to
/// the end of the next step; the last call moves it to `length`. Between calls the simulation may
/// be read. The other arguments are as for jcas_trace_verify.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT, DIFFERENT.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_trace_step(
    sim: *mut jcas_sim,
    memory: *mut c_void,
    size: usize,
    trace: *const c_char,
    length: usize,
    offset: *mut usize,
    message: *mut c_char,
    message_capacity: usize,
) -> jcas_status {
    let message = (message, message_capacity);
    // SAFETY: the caller's promises.
    unsafe { replay(sim, (memory, size), (trace, length), Some(offset), message) }
}

/// Repeats a whole trace, or one step from an offset on.
///
/// # Safety
/// As [`jcas_trace_step`]; each pair is a pointer and the size of what it points to.
unsafe fn replay(
    sim: *mut jcas_sim,
    memory: (*mut c_void, usize),
    trace: (*const c_char, usize),
    offset: Option<*mut usize>,
    message: (*mut c_char, usize),
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { open(sim.cast()) }?;
        // SAFETY: the caller's promise for `memory`.
        let workspace = unsafe { Workspace::lent(memory.0, memory.1, sim.model) }?;
        // SAFETY: the caller's promises for `trace` and `message`.
        let trace = unsafe { text(trace.0, trace.1, message.0, message.1) }?;
        // SAFETY: the caller's promise for `offset`.
        let offset = offset.map(|at| unsafe { output(at, 1, 1) }).transpose()?;
        *sim.recording = None;
        // SAFETY: only this call uses the workspace.
        let workspace = unsafe { workspace.parts() };
        let mut replay = Replay::new(sim.model, sim.words, sim.scratch, workspace);
        let verified = match offset {
            None => replay.verify(trace),
            Some(offset) => {
                let next = replay.verify_step(trace, offset[0]);
                next.map(|next| offset[0] = next)
            }
        };
        // SAFETY: the caller's promise for `message`.
        verified.map_err(|error| unsafe { say(&error, message.0, message.1) })
    })
}

/// Reads a name for the header of a trace.
///
/// # Safety
/// A C string, or null; it does not change during the call.
unsafe fn name<'a>(name: *const c_char) -> Result<&'a str, Fault> {
    if name.is_null() {
        return Ok("host");
    }
    // SAFETY: the caller's promise.
    let name = unsafe { CStr::from_ptr(name) };
    name.to_str()
        .map_err(|_| Fault::Status(JCAS_ERROR_ARGUMENT))
}

/// Reads the text of a trace.
///
/// # Safety
/// As [`bytes`] and [`message`].
unsafe fn text<'a>(
    trace: *const c_char,
    length: usize,
    buffer: *mut c_char,
    capacity: usize,
) -> Result<&'a str, Fault> {
    // SAFETY: the caller's promises, passed on.
    let bytes = unsafe { bytes(trace.cast(), length) }?;
    std::str::from_utf8(bytes).map_err(|_| {
        // SAFETY: the caller's promises, passed on.
        unsafe { message("the trace is not UTF-8", buffer, capacity) };
        Fault::Status(JCAS_ERROR_CORRUPT)
    })
}

/// # Safety
/// As [`message`].
unsafe fn say(error: &VerifyError<'_>, buffer: *mut c_char, capacity: usize) -> Fault {
    // SAFETY: the caller's promises, passed on.
    unsafe { message(&Message(error), buffer, capacity) };
    Fault::Status(match error.problem {
        Problem::OtherModel => JCAS_ERROR_MODEL_MISMATCH,
        Problem::Differs(_) => JCAS_ERROR_DIFFERENT,
        Problem::Memory => JCAS_ERROR_INTERNAL,
        _ => JCAS_ERROR_CORRUPT,
    })
}
