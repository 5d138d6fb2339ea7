//! A recording in progress, which passes the lines of a trace to the caller's sink.

use std::alloc::Layout;
use std::ffi::{c_char, c_void};
use std::slice;

use jcas_core::host::Call;
use jcas_core::{Model, StateRef};
use jcas_trace::{
    self as trace, Arguments, CallLine, EndLine, Escaped, Hashes, HeaderLine, StepLine,
    WorkspaceSizes, Writer,
};

use crate::handle::check_lent;
use crate::status::{Fault, JCAS_ERROR_RESOURCES, JCAS_ERROR_SINK};

/// The caller's function that takes a trace, and its context.
#[derive(Clone, Copy)]
pub(crate) struct Sink {
    pub(crate) write: unsafe extern "C" fn(*const c_char, usize, *mut c_void) -> i32,
    pub(crate) context: *mut c_void,
}

impl trace::Sink for Sink {
    type Error = Fault;

    fn take(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        // SAFETY: the caller promised a function that reads these bytes.
        let answer = unsafe { (self.write)(bytes.as_ptr().cast(), bytes.len(), self.context) };
        if answer == 0 {
            Ok(())
        } else {
            Err(Fault::Status(JCAS_ERROR_SINK))
        }
    }
}

/// The caller's working memory for recording and verification.
#[derive(Clone, Copy)]
pub(crate) struct Workspace {
    at: *mut u64,
    sizes: WorkspaceSizes,
}

/// Returns the number of words for the observations and the actions.
fn floats_of(sizes: &WorkspaceSizes) -> usize {
    (sizes.observations + sizes.actions).div_ceil(2)
}

/// Returns the number of words of a whole workspace.
fn words_of(sizes: &WorkspaceSizes) -> usize {
    floats_of(sizes) + sizes.cells + 2 * sizes.uavs + sizes.matrix.div_ceil(8)
}

impl Workspace {
    pub(crate) fn layout(model: &Model<'_>) -> Result<Layout, Fault> {
        let scarce = |_| Fault::Status(JCAS_ERROR_RESOURCES);
        Layout::array::<u64>(words_of(&WorkspaceSizes::of(model))).map_err(scarce)
    }

    /// Checks and clears the caller's memory.
    ///
    /// # Safety
    /// If `at` is neither null nor misaligned, `size` bytes can be written there. Nothing else uses
    /// them while the workspace is in use.
    pub(crate) unsafe fn lent(
        at: *mut c_void,
        size: usize,
        model: &Model<'_>,
    ) -> Result<Self, Fault> {
        let layout = Self::layout(model)?;
        // SAFETY: the caller's promises, passed on.
        unsafe { check_lent(at.cast(), size, layout) }?;
        // SAFETY: large enough, as was just checked.
        unsafe { at.cast::<u8>().write_bytes(0, layout.size()) };
        Ok(Self {
            at: at.cast(),
            sizes: WorkspaceSizes::of(model),
        })
    }

    /// # Safety
    /// Nothing else uses the workspace for `'a`.
    pub(crate) unsafe fn parts<'a>(&self) -> trace::Workspace<'a> {
        let sizes = &self.sizes;
        // SAFETY: as many words as `lent` checked and cleared; nothing else uses them.
        let words = unsafe { slice::from_raw_parts_mut(self.at, words_of(sizes)) };
        let floats = floats_of(sizes);
        let (floats, rest) = words.split_at_mut(floats);
        let (cells, rest) = rest.split_at_mut(sizes.cells);
        let (charges_uj, rest) = rest.split_at_mut(sizes.uavs);
        let (reals, bytes) = rest.split_at_mut(sizes.uavs);
        // SAFETY: every pattern of bits is two floats, of half the alignment.
        let floats =
            unsafe { slice::from_raw_parts_mut(floats.as_mut_ptr().cast(), 2 * floats.len()) };
        let (observations, actions) = floats.split_at_mut(sizes.observations);
        let arguments = Arguments {
            // SAFETY: a cell is two u32, asserted where cells come from C; of any bits.
            cells: unsafe { slice::from_raw_parts_mut(cells.as_mut_ptr().cast(), cells.len()) },
            charges_uj,
            // SAFETY: every pattern of bits is a real, of the same size and alignment.
            throughput: unsafe {
                slice::from_raw_parts_mut(reals.as_mut_ptr().cast(), reals.len())
            },
            // SAFETY: every word is eight bytes.
            matrix: unsafe {
                slice::from_raw_parts_mut(bytes.as_mut_ptr().cast(), 8 * bytes.len())
            },
        };
        trace::Workspace {
            observations,
            actions: &mut actions[..sizes.actions],
            arguments,
        }
    }
}

/// The state of a recording.
pub(crate) struct Recording {
    writer: Writer<Sink>,
    workspace: Workspace,
}

impl Recording {
    /// Begins a recording with the header, from a state at t = 0.
    pub(crate) fn begin(
        sink: Sink,
        workspace: Workspace,
        (policy, pilot): (&str, &str),
        model: &Model<'_>,
        words: &[u64],
        scratch: &mut [u64],
    ) -> Result<Self, Fault> {
        let mut recording = Self {
            writer: Writer::new(sink),
            workspace,
        };
        let hashes = recording.hashes(model, words, scratch)?;
        recording.writer.line(&HeaderLine {
            core_version: &jcas_core::VERSION,
            policy: &Escaped(policy),
            pilot: &Escaped(pilot),
            model,
            state: &model.state(words)?,
            hashes,
        });
        recording.writer.check()?;
        Ok(recording)
    }

    /// Keeps the actions of the step that has begun.
    pub(crate) fn acts(&mut self, actions: &[f32]) {
        // SAFETY: the workspace is the recording's alone.
        unsafe { self.workspace.parts() }
            .actions
            .copy_from_slice(actions);
    }

    /// Writes a call that the host has made.
    pub(crate) fn host(&mut self, call: &Call<'_>, uavs: usize) {
        self.writer.line(&CallLine { call, uavs });
    }

    /// Writes the step that led to a state.
    pub(crate) fn step(
        &mut self,
        model: &Model<'_>,
        words: &[u64],
        scratch: &mut [u64],
    ) -> Result<(), Fault> {
        let hashes = self.hashes(model, words, scratch)?;
        // SAFETY: the workspace is the recording's alone.
        let actions = unsafe { self.workspace.parts() }.actions;
        self.writer.line(&StepLine {
            model,
            state: &model.state(words)?,
            actions,
            hashes,
        });
        Ok(())
    }

    /// Writes the last line. The call fails if the sink has refused any part of the trace.
    pub(crate) fn end(mut self, state: &StateRef<'_>) -> Result<(), Fault> {
        let metrics = state.metrics();
        self.writer.line(&EndLine { metrics });
        self.writer.finish().map(|_| ())
    }

    fn hashes(
        &self,
        model: &Model<'_>,
        words: &[u64],
        scratch: &mut [u64],
    ) -> Result<Hashes, Fault> {
        // SAFETY: the workspace is the recording's alone.
        let observations = unsafe { self.workspace.parts() }.observations;
        Ok(Hashes::of(model, words, scratch, observations)?)
    }
}
