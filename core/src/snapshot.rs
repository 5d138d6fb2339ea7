//! Snapshots: saved states as little-endian bytes, which are checked in full when they are loaded.
//!
//! | bytes | content |
//! | --- | --- |
//! | 8 | `JCASSNAP` |
//! | 8 | version of the format |
//! | 8 | fingerprint of the configuration |
//! | 8 · words | the state |
//! | 8 | FNV-1a hash of all bytes before |
//!
//! Words and bytes are moved one by one, because a model checker handles such loops better than
//! iterators and block copies.

#![allow(clippy::needless_range_loop, clippy::manual_memcpy)]

use crate::error::{Corruption, Error};
use crate::model::Model;
use crate::state::StateRef;
use crate::words::hash::Fnv1a;

/// Version of the snapshot format.
pub const FORMAT_VERSION: u64 = 2;

const MAGIC: u64 = u64::from_le_bytes(*b"JCASSNAP");
const PREFIX_WORDS: usize = 3;

impl Model<'_> {
    /// Number of bytes of a snapshot.
    #[must_use]
    pub const fn save_len(&self) -> usize {
        8 * (PREFIX_WORDS + self.state_words() + 1)
    }

    /// Saves a state as a snapshot.
    ///
    /// ```
    /// # #[cfg(feature = "alloc")] {
    /// use jcas_core::{Config, Model, Scratch};
    ///
    /// let model = Model::new(Config::default())?;
    /// let mut words = vec![0; model.state_words()];
    /// let mut memory = vec![0; Scratch::words_for(&model)];
    /// model.reset(&mut words, &mut Scratch::new(&model, &mut memory)?, 42)?;
    ///
    /// let mut snapshot = vec![0; model.save_len()];
    /// model.save(&words, &mut snapshot)?;
    ///
    /// let (mut loaded, mut spare) = (vec![0; words.len()], vec![0; words.len()]);
    /// model.load(&snapshot, &mut loaded, &mut spare)?;
    /// assert_eq!(loaded, words);
    /// # }
    /// # Ok::<(), jcas_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`Model::state`], and [`Error::Length`] unless `out` has [`Model::save_len`]
    /// bytes.
    pub fn save(&self, words: &[u64], out: &mut [u8]) -> Result<(), Error> {
        self.state(words)?;
        if out.len() != self.save_len() {
            return Err(Error::Length {
                what: "snapshot",
                expected: self.save_len(),
                got: out.len(),
            });
        }
        let prefix = [MAGIC, FORMAT_VERSION, self.config_hash()];
        let mut hash = Fnv1a::new();
        for index in 0..PREFIX_WORDS {
            put(out, index, prefix[index]);
            hash.write_u64(prefix[index]);
        }
        for index in 0..words.len() {
            put(out, PREFIX_WORDS + index, words[index]);
            hash.write_u64(words[index]);
        }
        put(out, PREFIX_WORDS + words.len(), hash.finish());
        Ok(())
    }

    /// Loads a snapshot; the loaded state continues with the same bits as the saved one.
    ///
    /// The content is checked after it was copied into `words`, so `spare` holds the earlier words
    /// until then. Both have [`Model::state_words`] elements.
    ///
    /// # Errors
    /// [`Error::Length`] for another number of elements; [`Error::ModelMismatch`] for a snapshot of
    /// another configuration; [`Error::Corrupt`] for bytes that are not a snapshot. `words` does
    /// not change then.
    pub fn load(&self, bytes: &[u8], words: &mut [u64], spare: &mut [u64]) -> Result<(), Error> {
        self.check_len(words.len())?;
        self.check_len(spare.len())?;
        self.check_snapshot(bytes)?;
        for index in 0..words.len() {
            spare[index] = words[index];
            words[index] = word(bytes, PREFIX_WORDS + index);
        }
        if StateRef::split(*self.layout(), words).is_valid(self) {
            return Ok(());
        }
        for index in 0..words.len() {
            words[index] = spare[index];
        }
        Err(Error::Corrupt(Corruption::Content))
    }

    fn check_snapshot(&self, bytes: &[u8]) -> Result<(), Error> {
        if bytes.len() < 8 * PREFIX_WORDS {
            return Err(Error::Corrupt(Corruption::Length));
        }
        if word(bytes, 0) != MAGIC {
            return Err(Error::Corrupt(Corruption::Magic));
        }
        if word(bytes, 1) != FORMAT_VERSION {
            return Err(Error::Corrupt(Corruption::Version));
        }
        if word(bytes, 2) != self.config_hash() {
            return Err(Error::ModelMismatch);
        }
        if bytes.len() != self.save_len() {
            return Err(Error::Corrupt(Corruption::Length));
        }
        let (content, checksum) = bytes.split_at(bytes.len() - 8);
        let mut hash = Fnv1a::new();
        hash.write(content);
        if word(checksum, 0) != hash.finish() {
            return Err(Error::Corrupt(Corruption::Checksum));
        }
        Ok(())
    }
}

/// The word at an index in little-endian bytes; 0 beyond the end.
fn word(bytes: &[u8], index: usize) -> u64 {
    let begin = 8 * index;
    if begin + 8 > bytes.len() {
        return 0;
    }
    let mut word = 0;
    for byte in 0..8 {
        word |= u64::from(bytes[begin + byte]) << (8 * byte);
    }
    word
}

/// Writes the word at an index as little-endian bytes.
pub(crate) fn put(bytes: &mut [u8], index: usize, word: u64) {
    for byte in 0..8 {
        bytes[8 * index + byte] = (word >> (8 * byte)) as u8;
    }
}
