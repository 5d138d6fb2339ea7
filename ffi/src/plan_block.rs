//! The memory block of a plan, with its file and its text.

use std::sync::Arc;

use jcas_plan::{Plan, PlanFile};

use crate::handle::{Block, Kind, Memory, block_layout, check};
use crate::in_use::{InUse, Reading};
use crate::status::{Fault, JCAS_ERROR_INTERNAL};

#[repr(C)]
pub(crate) struct PlanBlock {
    seal: u64,
    in_use: InUse,
    memory: Memory,
    file: PlanFile,
    /// The plan, which the policies that follow it share.
    plan: Arc<Plan>,
    /// The file as JSON, written once so that no later call allocates.
    text: String,
}

// SAFETY: `repr(C)`, the seal comes first.
unsafe impl Block for PlanBlock {
    const KIND: Kind = Kind::Plan;
}

/// A plan opened to read, which is not freed meanwhile.
pub(crate) struct PlanRef<'a> {
    _mark: Reading<'a>,
    pub(crate) file: &'a PlanFile,
    pub(crate) plan: &'a Arc<Plan>,
    pub(crate) text: &'a str,
}

impl PlanBlock {
    /// Builds a plan in memory of the library.
    pub(crate) fn build(file: PlanFile, plan: Plan) -> Result<*mut Self, Fault> {
        let text = file
            .to_json()
            .map_err(|_| Fault::Status(JCAS_ERROR_INTERNAL))?;
        let (at, memory) = Memory::allocate(block_layout::<Self>(0)?)?;
        let block = at.cast::<Self>();
        let value = Self {
            seal: Self::seal(block),
            in_use: InUse::new(),
            memory,
            file,
            plan: Arc::new(plan),
            text,
        };
        // SAFETY: the memory has the layout of the block.
        unsafe { block.write(value) };
        Ok(block)
    }

    /// Opens a plan to read.
    ///
    /// # Safety
    /// The conditions of [`check`] hold, and the plan is not freed for `'a`.
    pub(crate) unsafe fn see<'a>(at: *const Self) -> Result<PlanRef<'a>, Fault> {
        // SAFETY: the caller's promises, passed on.
        unsafe { check(at) }?;
        // SAFETY: the block is alive, and only its mark is read.
        let mark = unsafe { &(*at).in_use }.read()?;
        // SAFETY: no call changes a plan before it is freed.
        let block = unsafe { &*at };
        Ok(PlanRef {
            _mark: mark,
            file: &block.file,
            plan: &block.plan,
            text: &block.text,
        })
    }

    /// Ends a plan.
    ///
    /// # Safety
    /// The conditions of [`check`] hold, and no other thread frees the plan.
    pub(crate) unsafe fn free(at: *mut Self) -> Result<(), Fault> {
        // SAFETY: the caller's promises, passed on.
        unsafe { check(at) }?;
        // SAFETY: the block is alive, and only its mark is read.
        unsafe { &(*at).in_use }.change()?.keep();
        // SAFETY: by the mark, only this call uses the block, which is read out whole and not used
        // again.
        let block = unsafe { at.read() };
        // SAFETY: as above; a later call finds no seal.
        unsafe { (&raw mut (*at).seal).write(0) };
        // SAFETY: nothing uses the block any more.
        unsafe { block.memory.release(at.cast()) };
        Ok(())
    }
}
