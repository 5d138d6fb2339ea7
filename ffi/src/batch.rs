//! Batches: how they are built, sized and freed, and which threads step them.

use std::ffi::c_void;

use crate::batch_block::{BatchBlock, BatchShape};
use crate::batch_job::Runner;
use crate::handle::Memory;
use crate::memory::{Plain, Record, place, put_layout, read_record};
use crate::model::jcas_model;
use crate::model_block::model;
use crate::status::{Fault, JCAS_ERROR_ARGUMENT, JCAS_OK, guard, jcas_status};

/// M environments of one model, with their working memory and optional worker threads. One thread
/// at a time may use a batch.
pub struct jcas_batch(());

/// One task of a batch step. It is called with its own task_context and an index below `count`.
pub type jcas_task = Option<unsafe extern "C" fn(task_context: *mut c_void, index: u32)>;

/// A function of the caller that runs the tasks of a step. It calls `task(task_context, index)`
/// once for each index from 0 to count - 1, in any order and on any threads. It returns when all of
/// these calls have returned. `context` is the pointer from jcas_batch_options. The step itself
/// runs tasks that were left out; if none was run, the step returns JCAS_ERROR_ARGUMENT.
pub type jcas_run_tasks = Option<
    unsafe extern "C" fn(
        task: jcas_task,
        task_context: *mut c_void,
        count: u32,
        context: *mut c_void,
    ),
>;

/// The options of jcas_batch_init.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct jcas_batch_options {
    /// sizeof(jcas_batch_options).
    pub struct_size: u32,
    /// Number of environments (M), at least 1.
    pub environments: u32,
    /// Threads that step at once, including the caller's. 1 starts no thread. 0 means one for each
    /// processor. With `run` it is the number of tasks of a step, and no thread is started.
    pub threads: u32,
    /// Reserved; set it to 0.
    pub reserved: u32,
    /// The function that runs the tasks of a step, or NULL for the library's own threads.
    pub run: jcas_run_tasks,
    /// The pointer that is passed to `run`.
    pub run_context: *mut c_void,
}

// SAFETY: the fields are integers, a raw pointer and a nullable function pointer, whose validity
// the caller promises.
unsafe impl Plain for jcas_batch_options {}
// SAFETY: `struct_size` comes first.
unsafe impl Record for jcas_batch_options {}

impl jcas_batch_options {
    fn shape(&self) -> Result<BatchShape, Fault> {
        if self.reserved != 0 {
            return Err(Fault::Status(JCAS_ERROR_ARGUMENT));
        }
        let runner = self.run.map(|run| Runner {
            run,
            context: self.run_context,
        });
        BatchShape::new(self.environments as usize, self.threads as usize, runner)
    }
}

/// Builds M environments in memory of their own, each at t = 0 of seed 0.
///
/// `model`: not NULL; must not be freed before the batch. `environments`: Number of environments
/// (M), at least 1. `threads`: threads that step at once, including the caller's; 1 starts none, 0
/// means one for each processor. Results do not depend on it. If the machine has enough processors,
/// workers spin for some tens of microseconds after a step before they sleep. `batch`: not NULL;
/// receives the handle, which jcas_batch_free ends.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_new(
    model: *const jcas_model,
    environments: u32,
    threads: u32,
    batch: *mut *mut jcas_batch,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?;
        // SAFETY: the caller's promise for `batch`.
        let out = unsafe { place(batch) }?;
        let shape = BatchShape::new(environments as usize, threads as usize, None)?;
        let memory = Memory::allocate(shape.layout(model.get())?)?;
        // SAFETY: the library allocated this memory with this layout.
        let block = unsafe { BatchBlock::build(model, shape, memory) }?;
        out.put(block.cast());
        Ok(())
    })
}

/// Writes the size and alignment of the memory that jcas_batch_init needs.
///
/// `model`, `options`, `size`, `alignment`: not NULL; options->struct_size set. `size` in bytes.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE, ARGUMENT, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_layout(
    model: *const jcas_model,
    options: *const jcas_batch_options,
    size: *mut usize,
    alignment: *mut usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?;
        // SAFETY: the caller's promise for `options`.
        let shape = unsafe { read_record(options) }?.shape()?;
        let layout = || shape.layout(model.get());
        // SAFETY: the caller's promises for `size` and `alignment`.
        unsafe { put_layout(size, alignment, layout) }
    })
}

/// Builds a batch in the caller's memory, which must not move until jcas_batch_free. Each
/// environment is at t = 0 of seed 0.
///
/// `memory`: at least the size and alignment of jcas_batch_layout; not NULL; the caller's. `model`:
/// not NULL; must not be freed before the batch. `options`: not NULL, struct_size set; not needed
/// after the call. `batch`: not NULL; receives the handle.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE, ARGUMENT, IN_USE, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_init(
    memory: *mut c_void,
    size: usize,
    model: *const jcas_model,
    options: *const jcas_batch_options,
    batch: *mut *mut jcas_batch,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?;
        // SAFETY: the caller's promise for `options`.
        let shape = unsafe { read_record(options) }?.shape()?;
        // SAFETY: the caller's promise for `batch`.
        let out = unsafe { place(batch) }?;
        // SAFETY: the caller's promise for `memory`.
        let memory = unsafe { Memory::lent(memory.cast(), size, shape.layout(model.get())?) }?;
        // SAFETY: checked memory that the caller lends for as long as the batch lives.
        let block = unsafe { BatchBlock::build(model, shape, memory) }?;
        out.put(block.cast());
        Ok(())
    })
}

/// Ends a batch and joins its threads. Memory of jcas_batch_init belongs to the caller again. NULL
/// is allowed and does nothing.
///
/// Threads: none may be using the batch.
/// Statuses: NULL, ALIGNMENT, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_free(batch: *mut jcas_batch) -> jcas_status {
    if batch.is_null() {
        return JCAS_OK;
    }
    // SAFETY: the caller's promise for `batch`.
    guard(|| unsafe { BatchBlock::free(batch.cast()) })
}
