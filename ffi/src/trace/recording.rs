//! A recording in progress: what a simulation does goes to the caller's sink, line by line.

use std::alloc::Layout;
use std::ffi::{c_char, c_void};
use std::fmt::{self, Write};
use std::slice;

use jcas_core::hash::{self, Fnv1a};
use jcas_core::{Cell, Error, Model, Scratch, StateRef, observation};

use super::host::Host;
use super::line::{self, Escaped, FORMAT_VERSION, Hashes, Header};
use crate::handle::check_lent;
use crate::status::{Fault, JCAS_ERROR_RESOURCES, JCAS_ERROR_SINK};

/// Where the caller wants bytes to go.
#[derive(Clone, Copy)]
pub(crate) struct Sink {
    pub(crate) write: unsafe extern "C" fn(*const c_char, usize, *mut c_void) -> i32,
    pub(crate) context: *mut c_void,
}

/// The caller's memory that recording and verifying work in.
#[derive(Clone, Copy)]
pub(crate) struct Workspace {
    at: *mut u64,
    lengths: Lengths,
}

#[derive(Clone, Copy)]
struct Lengths {
    observations: usize,
    actions: usize,
    uavs: usize,
    longest: usize,
    matrix: usize,
}

impl Lengths {
    fn of(model: &Model<'_>) -> Self {
        let (uavs, hotspots) = (model.uav_count(), model.hotspot_count());
        Self {
            observations: uavs * model.observation_len(),
            actions: model.action_len(),
            uavs,
            longest: uavs.max(hotspots),
            matrix: uavs * uavs.max(hotspots),
        }
    }

    fn words(&self) -> usize {
        let floats = (self.observations + self.actions).div_ceil(2);
        floats + self.longest + 2 * self.uavs + self.matrix.div_ceil(8)
    }
}

/// The parts of a workspace.
pub(crate) struct Parts<'a> {
    pub(crate) observations: &'a mut [f32],
    pub(crate) actions: &'a mut [f32],
    /// As many as there are UAVs or hotspots.
    pub(crate) cells: &'a mut [Cell],
    pub(crate) charges: &'a mut [u64],
    pub(crate) reals: &'a mut [f64],
    /// N rows of N or n.
    pub(crate) matrix: &'a mut [u8],
}

impl Workspace {
    pub(crate) fn layout(model: &Model<'_>) -> Result<Layout, Fault> {
        let scarce = |_| Fault::Status(JCAS_ERROR_RESOURCES);
        Layout::array::<u64>(Lengths::of(model).words()).map_err(scarce)
    }

    /// The caller's memory, checked and cleared.
    ///
    /// # Safety
    /// If `at` is neither null nor misaligned, `size` bytes can be written there, which are the workspace's alone
    /// for as long as it is used.
    pub(crate) unsafe fn lent(
        at: *mut c_void,
        size: usize,
        model: &Model<'_>,
    ) -> Result<Self, Fault> {
        let layout = Self::layout(model)?;
        // SAFETY: passed on.
        unsafe { check_lent(at.cast(), size, layout) }?;
        // SAFETY: large enough, as was just checked.
        unsafe { at.cast::<u8>().write_bytes(0, layout.size()) };
        Ok(Self {
            at: at.cast(),
            lengths: Lengths::of(model),
        })
    }

    /// # Safety
    /// Nothing else uses the workspace for `'a`.
    pub(crate) unsafe fn parts<'a>(&self) -> Parts<'a> {
        let lengths = &self.lengths;
        // SAFETY: as many words as `lent` checked and cleared; the caller promises that they are alone.
        let words = unsafe { slice::from_raw_parts_mut(self.at, lengths.words()) };
        let floats = (lengths.observations + lengths.actions).div_ceil(2);
        let (floats, rest) = words.split_at_mut(floats);
        let (cells, rest) = rest.split_at_mut(lengths.longest);
        let (charges, rest) = rest.split_at_mut(lengths.uavs);
        let (reals, bytes) = rest.split_at_mut(lengths.uavs);
        // SAFETY: every pattern of bits is two floats, of half the alignment.
        let floats =
            unsafe { slice::from_raw_parts_mut(floats.as_mut_ptr().cast(), 2 * floats.len()) };
        let (observations, actions) = floats.split_at_mut(lengths.observations);
        Parts {
            observations,
            actions: &mut actions[..lengths.actions],
            // SAFETY: a cell is two u32, asserted where cells come from C; of any bits.
            cells: unsafe { slice::from_raw_parts_mut(cells.as_mut_ptr().cast(), cells.len()) },
            charges,
            // SAFETY: every pattern of bits is a real, of the same size and alignment.
            reals: unsafe { slice::from_raw_parts_mut(reals.as_mut_ptr().cast(), reals.len()) },
            // SAFETY: every word is eight bytes.
            matrix: unsafe {
                slice::from_raw_parts_mut(bytes.as_mut_ptr().cast(), 8 * bytes.len())
            },
        }
    }
}

/// What a simulation keeps while it is recorded.
pub(crate) struct Recording {
    sink: Sink,
    workspace: Workspace,
    hash: Fnv1a,
    /// The sink has refused; nothing more goes to it.
    refused: bool,
}

impl Recording {
    /// Begins with the header, of a state at t = 0.
    pub(crate) fn begin(
        sink: Sink,
        workspace: Workspace,
        (policy, pilot): (&str, &str),
        model: &Model<'_>,
        words: &[u64],
        scratch: &mut [u64],
    ) -> Result<Self, Fault> {
        let mut recording = Self {
            sink,
            workspace,
            hash: Fnv1a::new(),
            refused: false,
        };
        let state = model.state(words)?;
        let hashes = recording.hashes(model, &state, words, scratch)?;
        let header = Header {
            version: FORMAT_VERSION,
            core_version: &jcas_core::VERSION,
            policy: &Escaped(policy),
            pilot: &Escaped(pilot),
            seed: state.seed(),
        };
        recording.line(|out| header.write(out, model, &state, hashes));
        if recording.refused {
            return Err(Fault::Status(JCAS_ERROR_SINK));
        }
        Ok(recording)
    }

    /// What the fleet does in the step that has begun.
    pub(crate) fn acts(&mut self, actions: &[f32]) {
        // SAFETY: the workspace is the recording's alone.
        unsafe { self.workspace.parts() }
            .actions
            .copy_from_slice(actions);
    }

    /// A call that the host has made.
    pub(crate) fn host(&mut self, call: &Host<'_>, uavs: usize) {
        self.line(|out| call.write(out, uavs));
    }

    /// The step that has ended in this state.
    pub(crate) fn step(
        &mut self,
        model: &Model<'_>,
        words: &[u64],
        scratch: &mut [u64],
    ) -> Result<(), Fault> {
        let state = model.state(words)?;
        let hashes = self.hashes(model, &state, words, scratch)?;
        // SAFETY: the workspace is the recording's alone.
        let actions = &*unsafe { self.workspace.parts() }.actions;
        self.line(|out| line::step(out, model, &state, actions, hashes));
        Ok(())
    }

    /// The end, and whether the sink has taken all of it.
    pub(crate) fn end(mut self, state: &StateRef<'_>) -> Result<(), Fault> {
        self.line(|out| line::end(out, &state.metrics()));
        let hash = self.hash.finish();
        self.line(|out| line::checksum(out, hash));
        if self.refused {
            return Err(Fault::Status(JCAS_ERROR_SINK));
        }
        Ok(())
    }

    fn hashes(
        &self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        words: &[u64],
        scratch: &mut [u64],
    ) -> Result<Hashes, Fault> {
        // SAFETY: the workspace is the recording's alone.
        let observations = unsafe { self.workspace.parts() }.observations;
        hashes(model, state, words, scratch, observations)
    }

    fn line(&mut self, write: impl FnOnce(&mut Pipe<'_>) -> fmt::Result) {
        let mut pipe = Pipe {
            recording: self,
            buffer: [0; 1024],
            filled: 0,
        };
        // A pipe takes everything; what the sink refuses, it remembers.
        let _always = write(&mut pipe);
        pipe.flush();
    }
}

/// The fingerprints of a state and of what it shows.
pub(crate) fn hashes(
    model: &Model<'_>,
    state: &StateRef<'_>,
    words: &[u64],
    scratch: &mut [u64],
    observations: &mut [f32],
) -> Result<Hashes, Fault> {
    let mut scratch = Scratch::new(model, scratch).ok_or(Error::ModelMismatch)?;
    observation::observe(model, state, &mut scratch, observations)?;
    Ok(Hashes {
        observations: hash::reals(observations),
        state: hash::words(words),
    })
}

/// Gathers text into larger pieces for the sink.
struct Pipe<'r> {
    recording: &'r mut Recording,
    buffer: [u8; 1024],
    filled: usize,
}

impl Pipe<'_> {
    fn flush(&mut self) {
        let Recording {
            sink,
            hash,
            refused,
            ..
        } = self.recording;
        let bytes = &self.buffer[..self.filled];
        hash.write(bytes);
        if !*refused && !bytes.is_empty() {
            // SAFETY: the caller promised a function that reads these bytes.
            let answer = unsafe { (sink.write)(bytes.as_ptr().cast(), bytes.len(), sink.context) };
            *refused = answer != 0;
        }
        self.filled = 0;
    }
}

impl Write for Pipe<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let mut rest = text.as_bytes();
        while !rest.is_empty() {
            if self.filled == self.buffer.len() {
                self.flush();
            }
            let (now, later) = rest.split_at(rest.len().min(self.buffer.len() - self.filled));
            self.buffer[self.filled..self.filled + now.len()].copy_from_slice(now);
            self.filled += now.len();
            rest = later;
        }
        Ok(())
    }
}
