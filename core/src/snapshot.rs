//! Saved states: little-endian bytes that load only where they are exactly right.
//!
//! | bytes | content |
//! | --- | --- |
//! | 8 | `JCASSNAP` |
//! | 8 | version of the format |
//! | 8 | fingerprint of the configuration |
//! | 8 · words | the state |
//! | 8 | FNV-1a of all before |

use crate::error::{Corruption, Error};
use crate::hash::Fnv1a;
use crate::model::Model;
use crate::state::StateRef;

/// Version of the format.
pub const FORMAT_VERSION: u64 = 1;

const MAGIC: u64 = u64::from_le_bytes(*b"JCASSNAP");
const PREFIX_WORDS: usize = 3;

impl Model<'_> {
    /// Bytes of a saved state.
    #[must_use]
    pub const fn save_len(&self) -> usize {
        8 * (PREFIX_WORDS + self.state_words() + 1)
    }

    /// Saves a state.
    ///
    /// # Errors
    /// As [`Model::state`]; [`Error::Length`] unless `out` has [`Model::save_len`] bytes.
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
        let mut bytes = out.chunks_exact_mut(8);
        for &word in prefix.iter().chain(words) {
            if let Some(chunk) = bytes.next() {
                chunk.copy_from_slice(&word.to_le_bytes());
            }
            hash.write_u64(word);
        }
        if let Some(chunk) = bytes.next() {
            chunk.copy_from_slice(&hash.finish().to_le_bytes());
        }
        Ok(())
    }

    /// Loads a state, which goes on exactly as the saved one would have. The content can only be judged as
    /// a state, so `spare` keeps what `words` held until then.
    ///
    /// # Errors
    /// [`Error::Length`] unless `words` has [`Model::state_words`] elements; [`Error::ModelMismatch`] for a
    /// snapshot of another configuration; [`Error::Corrupt`] for anything but a snapshot. `words` is then
    /// as it was.
    pub fn load(&self, bytes: &[u8], words: &mut [u64], spare: &mut [u64]) -> Result<(), Error> {
        self.check_len(words.len())?;
        self.check_len(spare.len())?;
        self.check_snapshot(bytes)?;
        let body = &bytes[8 * PREFIX_WORDS..bytes.len() - 8];
        spare.copy_from_slice(words);
        for (target, chunk) in words.iter_mut().zip(body.chunks_exact(8)) {
            *target = word(chunk, 0);
        }
        if StateRef::split(*self.layout(), words).is_valid(self) {
            return Ok(());
        }
        words.copy_from_slice(spare);
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

/// The word at a position in little-endian bytes; 0 beyond the end.
fn word(bytes: &[u8], index: usize) -> u64 {
    let mut word = [0; 8];
    if let Some(chunk) = bytes.get(8 * index..8 * index + 8) {
        word.copy_from_slice(chunk);
    }
    u64::from_le_bytes(word)
}
