//! Handles: blocks of memory that begin with a seal.
//!
//! A seal mixes a constant of the handle's kind with the block's own address. A handle that is
//! freed, of another kind or copied therefore fails the check. In a block that changes, the mark of
//! the calls that use it follows ([`InUse`](crate::in_use::InUse)).
//!
//! | block | content |
//! | --- | --- |
//! | model | [`ModelBlock`](crate::model_block::ModelBlock), then the words of its tables |
//! | simulation | [`SimBlock`](crate::sim_block::SimBlock), then state, spare state, scratch |
//! | batch | [`BatchBlock`](crate::batch_block::BatchBlock), then states, working memory, threads |
//! | policy | [`PolicyBlock`](crate::policy_block::PolicyBlock), then what its network works with |
//! | plan | [`PlanBlock`](crate::plan_block::PlanBlock) alone; the plan itself is on the heap |

use std::alloc::{Layout, alloc, dealloc};
use std::slice;

use crate::status::{
    Fault, JCAS_ERROR_ALIGNMENT, JCAS_ERROR_HANDLE, JCAS_ERROR_IN_USE, JCAS_ERROR_LENGTH,
    JCAS_ERROR_NULL, JCAS_ERROR_RESOURCES,
};

/// The kind of a handle.
#[derive(Clone, Copy)]
pub(crate) enum Kind {
    Model,
    Sim,
    Batch,
    Policy,
    Plan,
}

impl Kind {
    const ALL: [Self; 5] = [
        Self::Model,
        Self::Sim,
        Self::Batch,
        Self::Policy,
        Self::Plan,
    ];

    /// Returns the seal of a block of this kind at an address.
    fn seal(self, address: usize) -> u64 {
        let name = match self {
            Self::Model => b"jcas mdl",
            Self::Sim => b"jcas sim",
            Self::Batch => b"jcas bat",
            Self::Policy => b"jcas pol",
            Self::Plan => b"jcas pln",
        };
        u64::from_le_bytes(*name) ^ address as u64
    }
}

/// A block of one kind.
///
/// # Safety
/// Implement it only for `repr(C)` structs whose first field is the seal, a `u64`.
pub(crate) unsafe trait Block: Sized {
    const KIND: Kind;

    /// Returns the seal of a block at an address.
    fn seal(at: *const Self) -> u64 {
        Self::KIND.seal(at.addr())
    }
}

/// The size and owner of a block's memory.
#[derive(Clone, Copy)]
pub(crate) struct Memory {
    layout: Layout,
    ours: bool,
}

impl Memory {
    /// Allocates memory of the library.
    pub(crate) fn allocate(layout: Layout) -> Result<(*mut u8, Self), Fault> {
        // SAFETY: the layout is not empty, as no block is.
        let at = unsafe { alloc(layout) };
        if at.is_null() {
            return Err(Fault::Status(JCAS_ERROR_RESOURCES));
        }
        Ok((at, Self { layout, ours: true }))
    }

    /// Checks the caller's memory.
    ///
    /// # Safety
    /// If `at` is neither null nor misaligned, `size` bytes can be read there.
    pub(crate) unsafe fn lent(
        at: *mut u8,
        size: usize,
        layout: Layout,
    ) -> Result<(*mut u8, Self), Fault> {
        // SAFETY: the caller's promises, passed on.
        unsafe { check_lent(at, size, layout) }?;
        let ours = false;
        Ok((at, Self { layout, ours }))
    }

    /// Returns the size of the block in bytes.
    pub(crate) const fn size(&self) -> usize {
        self.layout.size()
    }

    /// Frees memory of the library.
    ///
    /// # Safety
    /// `at` came with this value from [`Memory::allocate`] or [`Memory::lent`], and nothing uses
    /// it.
    pub(crate) unsafe fn release(self, at: *mut u8) {
        if self.ours {
            // SAFETY: allocated with this very layout.
            unsafe { dealloc(at, self.layout) };
        }
    }
}

/// Checks that the caller's memory fits a layout and holds no living handle.
///
/// # Safety
/// If `at` is neither null nor misaligned, `size` bytes can be read there.
pub(crate) unsafe fn check_lent(at: *mut u8, size: usize, layout: Layout) -> Result<(), Fault> {
    if at.is_null() {
        Err(Fault::Status(JCAS_ERROR_NULL))
    } else if !at.addr().is_multiple_of(layout.align()) {
        Err(Fault::Status(JCAS_ERROR_ALIGNMENT))
    } else if size < layout.size() {
        Err(Fault::Status(JCAS_ERROR_LENGTH))
    // SAFETY: large enough and aligned, as was just checked.
    } else if unsafe { holds_a_handle(at) } {
        Err(Fault::Status(JCAS_ERROR_IN_USE))
    } else {
        Ok(())
    }
}

/// Whether memory holds a living handle, which another block would overwrite.
///
/// # Safety
/// Eight bytes can be read at `at`, which is aligned for them.
unsafe fn holds_a_handle(at: *mut u8) -> bool {
    // SAFETY: the caller's promise; the read is volatile, as the memory may be uninitialised.
    let seal = unsafe { at.cast::<u64>().read_volatile() };
    Kind::ALL.iter().any(|kind| kind.seal(at.addr()) == seal)
}

/// Returns the layout of a block of type `B` followed by `words` words.
pub(crate) fn block_layout<B>(words: usize) -> Result<Layout, Fault> {
    let too_large = |_| Fault::Status(JCAS_ERROR_RESOURCES);
    let tail = Layout::array::<u64>(words).map_err(too_large)?;
    let (layout, offset) = Layout::new::<B>().extend(tail).map_err(too_large)?;
    debug_assert_eq!(offset, size_of::<B>(), "no gap before the words");
    Ok(layout.pad_to_align())
}

/// Returns the words after a block.
///
/// # Safety
/// `count` words lie after the block at `at`, initialised, and nothing else uses them for `'a`.
pub(crate) unsafe fn words_after<'a, B>(at: *mut B, count: usize) -> &'a mut [u64] {
    // SAFETY: within the block's memory by the caller's promise.
    let first = unsafe { at.add(1) };
    // SAFETY: the caller's promise; a block's size is a multiple of a word's alignment.
    unsafe { slice::from_raw_parts_mut(first.cast(), count) }
}

/// Checks a handle.
///
/// # Safety
/// If `at` is neither null nor misaligned, eight bytes can be read there. If they are a seal, the
/// block is alive.
pub(crate) unsafe fn check<B: Block>(at: *const B) -> Result<(), Fault> {
    if at.is_null() {
        return Err(Fault::Status(JCAS_ERROR_NULL));
    }
    if !at.is_aligned() {
        return Err(Fault::Status(JCAS_ERROR_ALIGNMENT));
    }
    // SAFETY: readable by the caller's promise.
    let seal = unsafe { at.cast::<u64>().read() };
    if seal == B::seal(at) {
        Ok(())
    } else {
        Err(Fault::Status(JCAS_ERROR_HANDLE))
    }
}
