//! The block of a model.

use std::alloc::Layout;
use std::sync::atomic::{AtomicU32, Ordering};

use jcas_core::{Config, Error, Model};

use crate::handle::{Block, Kind, Memory, block_layout, check, words_after};
use crate::status::{Fault, JCAS_ERROR_IN_USE};

#[repr(C)]
pub(crate) struct ModelBlock {
    seal: u64,
    memory: Memory,
    /// Number of simulations, batches and policies that use this model.
    users: AtomicU32,
    model: Model<'static>,
}

// SAFETY: `repr(C)`, the seal comes first.
unsafe impl Block for ModelBlock {
    const KIND: Kind = Kind::Model;
}

/// Opens a model to read.
///
/// # Safety
/// The conditions of [`check`] hold, and the model is not freed for `'a`.
pub(crate) unsafe fn model<'a>(at: *const ModelBlock) -> Result<&'a ModelBlock, Fault> {
    // SAFETY: the caller's promises, passed on.
    unsafe { check(at) }?;
    // SAFETY: a living model block; no call changes it.
    Ok(unsafe { &*at })
}

impl ModelBlock {
    pub(crate) fn layout(config: &Config) -> Result<Layout, Fault> {
        block_layout::<Self>(Model::table_words(config).map_err(Error::from)?)
    }

    /// Builds a model in memory that has its layout.
    ///
    /// # Safety
    /// `at` and `memory` come from [`Memory`] with [`ModelBlock::layout`] of this configuration.
    pub(crate) unsafe fn build(
        config: Config,
        (at, memory): (*mut u8, Memory),
    ) -> Result<*mut Self, Fault> {
        let block = at.cast::<Self>();
        let count = Model::table_words(&config).map_err(Error::from)?;
        // SAFETY: the layout has room for the block and the words; all zero bits are a valid word.
        unsafe { at.write_bytes(0, memory.size()) };
        // SAFETY: just initialised; the tables stay with the model for as long as the block lives.
        let words = unsafe { words_after(block, count) };
        let model = Model::new_in(config, words)?;
        let value = Self {
            seal: Self::seal(block),
            memory,
            users: AtomicU32::new(0),
            model,
        };
        // SAFETY: in front of the words, aligned by the layout.
        unsafe { block.write(value) };
        Ok(block)
    }

    /// Ends a model.
    ///
    /// # Safety
    /// The conditions of [`check`] hold, and no other thread uses the model.
    pub(crate) unsafe fn free(at: *mut Self) -> Result<(), Fault> {
        // SAFETY: the caller's promises, passed on.
        let block = unsafe { model(at) }?;
        if block.users.load(Ordering::Acquire) != 0 {
            return Err(Fault::Status(JCAS_ERROR_IN_USE));
        }
        let memory = block.memory;
        // SAFETY: only this call uses the block, and a later check finds no seal.
        unsafe { (&raw mut (*at).seal).write(0) };
        // SAFETY: nothing uses the block any more; a model over lent words owns nothing else.
        unsafe { memory.release(at.cast()) };
        Ok(())
    }

    pub(crate) fn get(&self) -> &Model<'static> {
        &self.model
    }

    pub(crate) fn add_user(&self) {
        self.users.fetch_add(1, Ordering::AcqRel);
    }

    pub(crate) fn drop_user(&self) {
        self.users.fetch_sub(1, Ordering::AcqRel);
    }
}
