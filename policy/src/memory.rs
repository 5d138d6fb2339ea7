//! What policies remember between steps, as words that can be saved and loaded.
//!
//! A memory belongs to one episode and to the step at which the policy last acted. A policy that
//! remembers acts at the next step of that episode, or again at the same one. At the first step of
//! an episode it begins anew. So it does in any state after a reset, when it remembers nothing.

use core::fmt;

use jcas_core::{Cell, Model, StateRef};

/// A reason for which a policy cannot act in a state, or not load a memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemoryError {
    /// The policy remembers another episode or another step than those before the state.
    OtherState {
        /// The step at which it last acted.
        acted: Step,
        /// The step of the state.
        given: Step,
    },
    /// The words are no memory of this policy and model.
    Corrupt,
    /// The system has no memory for what is to be remembered.
    OutOfMemory,
}

impl fmt::Display for MemoryError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OtherState { acted, given } => write!(
                out,
                "the policy last acted at {acted} and is given {given}: load the memory of that \
                 state, or reset the policy"
            ),
            Self::Corrupt => out.write_str("the words are no memory of this policy and model"),
            Self::OutOfMemory => out.write_str("memory for a plan could not be had"),
        }
    }
}

impl core::error::Error for MemoryError {}

/// A step of an episode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// Seed of the episode.
    pub seed: u64,
    /// Steps of the episode so far.
    pub t: u32,
}

impl fmt::Display for Step {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "t = {} of seed 0x{:016x}", self.t, self.seed)
    }
}

impl Step {
    /// Returns the step of a state.
    #[must_use]
    pub fn of(state: &StateRef<'_>) -> Self {
        Self {
            seed: state.seed(),
            t: state.t(),
        }
    }
}

/// What a policy that remembers has to do in a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Due {
    /// Forget everything and decide.
    Begin,
    /// Decide by what it remembers.
    Continue,
    /// Repeat what it decided.
    Repeat,
}

/// The step at which a policy last acted, if it remembers any.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LastStep(Option<Step>);

impl LastStep {
    /// Returns what is due in a state.
    ///
    /// # Errors
    /// [`MemoryError::OtherState`] if the state does not follow from the remembered one.
    pub fn due(self, state: &StateRef<'_>) -> Result<Due, MemoryError> {
        let given = Step::of(state);
        match self.0 {
            Some(acted) if given.t > 0 => {
                if acted == given {
                    Ok(Due::Repeat)
                } else if acted.seed == given.seed && acted.t.checked_add(1) == Some(given.t) {
                    Ok(Due::Continue)
                } else {
                    Err(MemoryError::OtherState { acted, given })
                }
            }
            _ => Ok(Due::Begin),
        }
    }

    /// Returns the step, if one is remembered.
    #[must_use]
    pub const fn step(self) -> Option<Step> {
        self.0
    }

    /// Returns whether a step is remembered.
    #[must_use]
    pub const fn is_some(self) -> bool {
        self.0.is_some()
    }

    /// Returns the step of a state in which the policy has acted.
    #[must_use]
    pub fn at(state: &StateRef<'_>) -> Self {
        Self(Some(Step::of(state)))
    }

    /// Writes the step as three words.
    pub fn save(self, write: &mut dyn FnMut(u64)) {
        let Step { seed, t } = self.0.unwrap_or(Step { seed: 0, t: 0 });
        write(u64::from(self.0.is_some()));
        write(seed);
        write(u64::from(t));
    }

    /// Replaces the seed of the step at the head of a memory, for a state with another seed.
    pub fn reseed(memory: &mut [u64], seed: u64) {
        if let [some, word, ..] = memory
            && *some == 1
        {
            *word = seed;
        }
    }

    /// Reads the step.
    ///
    /// # Errors
    /// [`MemoryError::Corrupt`] if the words are none.
    pub fn load(read: &mut MemoryReader<'_>) -> Result<Self, MemoryError> {
        let (some, seed, t) = (read.flag()?, read.word()?, read.below(1 << 32)?);
        Ok(Self(some.then_some(Step { seed, t: t as u32 })))
    }
}

/// Writes an index that may be absent, as one word.
pub fn save_index(write: &mut dyn FnMut(u64), index: Option<usize>) {
    write(index.map_or(0, |index| index as u64 + 1));
}

/// Writes a cell, as one word.
pub fn save_cell(write: &mut dyn FnMut(u64), cell: Cell) {
    write(u64::from(cell.y) << 32 | u64::from(cell.x));
}

/// A reader of the words of a memory, which refuses every value out of its range.
#[derive(Clone, Debug)]
pub struct MemoryReader<'m> {
    words: &'m [u64],
}

impl<'m> MemoryReader<'m> {
    /// Reads these words.
    #[must_use]
    pub const fn new(words: &'m [u64]) -> Self {
        Self { words }
    }

    /// Reads a word.
    ///
    /// # Errors
    /// [`MemoryError::Corrupt`] at the end.
    pub fn word(&mut self) -> Result<u64, MemoryError> {
        let (&first, rest) = self.words.split_first().ok_or(MemoryError::Corrupt)?;
        self.words = rest;
        Ok(first)
    }

    /// Reads a number below a limit.
    ///
    /// # Errors
    /// [`MemoryError::Corrupt`] if it is none.
    pub fn below(&mut self, limit: u64) -> Result<u64, MemoryError> {
        let word = self.word()?;
        if word < limit {
            Ok(word)
        } else {
            Err(MemoryError::Corrupt)
        }
    }

    /// Reads a flag.
    ///
    /// # Errors
    /// [`MemoryError::Corrupt`] if it is none.
    pub fn flag(&mut self) -> Result<bool, MemoryError> {
        Ok(self.below(2)? == 1)
    }

    /// Reads the length of a list of which each item takes at least a word. So no memory is asked
    /// for that the words do not fill.
    ///
    /// # Errors
    /// [`MemoryError::Corrupt`] if more words are needed than there are.
    pub fn count(&mut self) -> Result<usize, MemoryError> {
        let left = self.words.len() as u64;
        Ok(self.below(left)? as usize)
    }

    /// Reads an index below a limit.
    ///
    /// # Errors
    /// [`MemoryError::Corrupt`] if it is none.
    pub fn index(&mut self, limit: usize) -> Result<usize, MemoryError> {
        Ok(self.below(limit as u64)? as usize)
    }

    /// Reads an index below a limit that may be absent.
    ///
    /// # Errors
    /// [`MemoryError::Corrupt`] if it is none.
    pub fn optional_index(&mut self, limit: usize) -> Result<Option<usize>, MemoryError> {
        Ok((self.below(limit as u64 + 1)? as usize).checked_sub(1))
    }

    /// Reads a cell of the grid.
    ///
    /// # Errors
    /// [`MemoryError::Corrupt`] if it is none.
    pub fn cell(&mut self, model: &Model<'_>) -> Result<Cell, MemoryError> {
        let word = self.word()?;
        let cell = Cell {
            x: word as u32,
            y: (word >> 32) as u32,
        };
        let config = model.config();
        if cell.x < config.grid_width && cell.y < config.grid_height {
            Ok(cell)
        } else {
            Err(MemoryError::Corrupt)
        }
    }

    /// Reads a real number that is not NaN.
    ///
    /// # Errors
    /// [`MemoryError::Corrupt`] if it is none.
    pub fn real(&mut self) -> Result<f64, MemoryError> {
        let real = f64::from_bits(self.word()?);
        if real.is_nan() {
            return Err(MemoryError::Corrupt);
        }
        Ok(real)
    }

    /// Checks that all words were read.
    ///
    /// # Errors
    /// [`MemoryError::Corrupt`] if some are left.
    pub const fn end(&self) -> Result<(), MemoryError> {
        if self.words.is_empty() {
            Ok(())
        } else {
            Err(MemoryError::Corrupt)
        }
    }
}
