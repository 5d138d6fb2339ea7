//! Configurations by preset, and from and to text.

use std::ffi::c_char;
use std::fmt::{self, Display, Write};

use jcas_core::config::text::{Excerpt, TextError};
use jcas_core::{Config, Preset};

use crate::config::jcas_config;
use crate::memory::{Message, Text, bytes, message, place, read_record, sized_record, text_out};
use crate::status::{Fault, JCAS_ERROR_CONFIG, guard, jcas_status};

/// Says why a configuration was refused.
///
/// # Safety
/// As [`message`].
pub(crate) unsafe fn refuse(error: impl Display, buffer: *mut c_char, capacity: usize) -> Fault {
    // SAFETY: the caller's promises, passed on.
    unsafe { message(&Message(error), buffer, capacity) };
    Fault::Status(JCAS_ERROR_CONFIG)
}

/// Reads and validates a configuration, and writes the reason for a refusal.
///
/// # Safety
/// `config` as for `read_record`, the buffer as for [`message`].
pub(crate) unsafe fn legal(
    config: *const jcas_config,
    buffer: *mut c_char,
    capacity: usize,
) -> Result<Config, Fault> {
    // SAFETY: the caller's promises, passed on.
    let record = unsafe { read_record(config) }?;
    let checked = record
        .to_core()
        .and_then(|config| config.validate().map(|()| config));
    // SAFETY: the caller's promises, passed on.
    checked.map_err(|error| unsafe { refuse(error, buffer, capacity) })
}

/// Fills `config` with the default, the preset "mission". Pass sizeof(jcas_config) as
/// `struct_size`.
///
/// `config`: not NULL.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_config_default(
    config: *mut jcas_config,
    struct_size: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `config`.
        let out = unsafe { sized_record(config, struct_size) }?;
        out.put(jcas_config::from_core(&Config::default()));
        Ok(())
    })
}

/// Fills `config` with a preset: "mission", "paper", "search" or "isac". "paper" takes every
/// equation exactly as in the paper. "search" has hidden hotspots and shared search maps. "isac" is
/// a search with coherent pilots, a fluctuating echo, false alarms and reports.
///
/// `name`: `name_length` bytes, not NULL, no terminating zero needed. `message`: see the rules
/// below.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CONFIG.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_config_preset(
    name: *const c_char,
    name_length: usize,
    config: *mut jcas_config,
    struct_size: usize,
    message: *mut c_char,
    message_capacity: usize,
) -> jcas_status {
    let parse = |name: &str| match name.parse::<Preset>() {
        Ok(preset) => Ok(Config::preset(preset)),
        Err(error) => Err(TextError::Preset(Excerpt::of(name), error)),
    };
    // SAFETY: the caller's promises, passed on.
    guard(|| unsafe {
        let (name, message) = ((name, name_length), (message, message_capacity));
        from_text(name, (config, struct_size), message, parse)
    })
}

/// Fills `config` from a TOML text. It may name a `preset` (else "mission"); every other key is a
/// field and replaces the preset's value; unknown keys are errors. The result is validated.
///
/// `text`: `text_length` bytes of UTF-8, not NULL, no terminating zero needed. `message`: see the
/// rules below.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CONFIG.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_config_from_toml(
    text: *const c_char,
    text_length: usize,
    config: *mut jcas_config,
    struct_size: usize,
    message: *mut c_char,
    message_capacity: usize,
) -> jcas_status {
    // SAFETY: the caller's promises, passed on.
    guard(|| unsafe {
        let (text, message) = ((text, text_length), (message, message_capacity));
        from_text(text, (config, struct_size), message, Config::from_toml)
    })
}

/// Fills `config` from a JSON object, with the rules of jcas_config_from_toml. The value null
/// restores a field to being derived.
///
/// `text`, `message`: as for jcas_config_from_toml.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CONFIG.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_config_from_json(
    text: *const c_char,
    text_length: usize,
    config: *mut jcas_config,
    struct_size: usize,
    message: *mut c_char,
    message_capacity: usize,
) -> jcas_status {
    // SAFETY: the caller's promises, passed on.
    guard(|| unsafe {
        let (text, message) = ((text, text_length), (message, message_capacity));
        from_text(text, (config, struct_size), message, Config::from_json)
    })
}

/// Checks a configuration. It returns JCAS_OK or JCAS_ERROR_CONFIG, with a message that names the
/// field, its value and what is allowed.
///
/// `config`: not NULL, struct_size set. `message`: see the rules below.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, CONFIG.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_config_validate(
    config: *const jcas_config,
    message: *mut c_char,
    message_capacity: usize,
) -> jcas_status {
    // SAFETY: the caller's promises, passed on.
    guard(|| unsafe { legal(config, message, message_capacity) }.map(|_| ()))
}

/// Writes the fingerprint of a legal configuration, which is part of every state and snapshot.
///
/// `config`, `hash`: not NULL, struct_size set.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, CONFIG.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_config_hash(
    config: *const jcas_config,
    hash: *mut u64,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `config`; no message is wanted.
        let config = unsafe { legal(config, std::ptr::null_mut(), 0) }?;
        // SAFETY: the caller's promise for `hash`.
        let hash = unsafe { place(hash) }?;
        hash.put(config.hash());
        Ok(())
    })
}

/// Writes a legal configuration as JSON text, which jcas_config_from_json reads back. Derived
/// fields are absent.
///
/// `text`: `capacity` bytes, or NULL with a capacity of 0 to ask for the length. `length`: not
/// NULL; receives the length without the terminating zero. `capacity` must be at least one more;
/// otherwise the call writes only the length and returns JCAS_ERROR_LENGTH.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CONFIG.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_config_to_json(
    config: *const jcas_config,
    text: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `config`; no message is wanted.
        let config = unsafe { legal(config, std::ptr::null_mut(), 0) }?;
        let json = Written(|mut out: &mut dyn Write| config.write_json(&mut out));
        // SAFETY: the caller's promises for `text` and `length`.
        unsafe { text_out(&json, text, capacity, length) }
    })
}

/// Writes a legal configuration as TOML text, which jcas_config_from_toml reads back. Derived
/// fields are absent.
///
/// `text`, `capacity`, `length`: as for jcas_config_to_json.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CONFIG.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_config_to_toml(
    config: *const jcas_config,
    text: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `config`; no message is wanted.
        let config = unsafe { legal(config, std::ptr::null_mut(), 0) }?;
        let toml = Written(|mut out: &mut dyn Write| config.write_toml(&mut out));
        // SAFETY: the caller's promises for `text` and `length`.
        unsafe { text_out(&toml, text, capacity, length) }
    })
}

/// Writes the fields of the configuration as JSON text: a list of objects with name, unit, low,
/// high, default (null: derived) and doc.
///
/// `text`, `capacity`, `length`: as for jcas_config_to_json.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_config_fields(
    text: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> jcas_status {
    let fields = Written(|mut out: &mut dyn Write| Config::write_fields(&mut out));
    // SAFETY: the caller's promises for `text` and `length`.
    guard(|| unsafe { text_out(&fields, text, capacity, length) })
}

/// Reads a text by `parse` into the caller's record. Each pointer comes with its size.
///
/// # Safety
/// The promises that each exported function above names.
unsafe fn from_text(
    (text, text_length): (*const c_char, usize),
    (config, struct_size): (*mut jcas_config, usize),
    (message, message_capacity): (*mut c_char, usize),
    parse: impl Fn(&str) -> Result<Config, TextError>,
) -> Result<(), Fault> {
    // SAFETY: the caller's promises, passed on.
    let text = unsafe { bytes(text.cast(), text_length) }?;
    // SAFETY: the caller's promises, passed on.
    let out = unsafe { sized_record(config, struct_size) }?;
    let refused = match std::str::from_utf8(text).map(parse) {
        Ok(Ok(config)) => {
            out.put(jcas_config::from_core(&config));
            return Ok(());
        }
        // SAFETY: the caller's promises, passed on.
        Ok(Err(error)) => unsafe { refuse(error, message, message_capacity) },
        // SAFETY: the caller's promises, passed on.
        Err(_) => unsafe { refuse("the text is not UTF-8", message, message_capacity) },
    };
    Err(refused)
}

/// The text that a function writes.
struct Written<F>(F);

impl<F: Fn(&mut dyn Write) -> fmt::Result> Text for Written<F> {
    fn write_to(&self, out: &mut impl Write) -> fmt::Result {
        (self.0)(out)
    }
}
