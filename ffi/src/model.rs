//! Models: built in the caller's memory or in memory of the library, then only read.

use std::ffi::{c_char, c_void};

use jcas_core::Config;
use jcas_core::observation::fields::FIELD_NAMES;

use crate::config::jcas_config;
use crate::config_text::legal;
use crate::handle::Memory;
use crate::memory::{output, place, put_layout, record, sized_record};
use crate::model_block::{ModelBlock, model};
use crate::names::{joined, joined_len, name_at};
use crate::records::{
    JCAS_OBSERVATION_FIELDS, jcas_model_info, jcas_observation_field, jcas_radio,
};
use crate::status::{Fault, JCAS_ERROR_ARGUMENT, JCAS_ERROR_STRUCT_SIZE, guard, jcas_status};

/// A validated configuration with its precomputed tables. It never changes, so any number of
/// threads may use one model at once.
pub struct jcas_model(());

/// Writes the size and alignment of the memory that jcas_model_init needs.
///
/// `config`, `size`, `alignment`: not NULL. `size` in bytes. `message`: see the rules below.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, CONFIG, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_model_layout(
    config: *const jcas_config,
    size: *mut usize,
    alignment: *mut usize,
    message: *mut c_char,
    message_capacity: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promises for `config` and `message`.
        let config = unsafe { legal(config, message, message_capacity) }?;
        let layout = || ModelBlock::layout(&config);
        // SAFETY: the caller's promises for `size` and `alignment`.
        unsafe { put_layout(size, alignment, layout) }
    })
}

/// Builds a model in the caller's memory, which must not move until jcas_model_free.
///
/// `memory`: at least the size and alignment of jcas_model_layout; not NULL; the caller's.
/// `config`: not NULL; not needed after the call. `model`: not NULL; receives the handle.
/// `message`: see the rules below.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, CONFIG, IN_USE, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_model_init(
    memory: *mut c_void,
    size: usize,
    config: *const jcas_config,
    model: *mut *mut jcas_model,
    message: *mut c_char,
    message_capacity: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promises for `config` and `message`.
        let config = unsafe { legal(config, message, message_capacity) }?;
        // SAFETY: the caller's promise for `memory`.
        let memory = unsafe { Memory::lent(memory.cast(), size, ModelBlock::layout(&config)?) }?;
        // SAFETY: the caller's promises for `memory` and `model`.
        unsafe { build(config, memory, model) }
    })
}

/// Builds a model in memory from the system. jcas_model_free ends it.
///
/// `config`: not NULL; not needed after the call. `model`: not NULL; receives the handle.
/// `message`: see the rules below.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, CONFIG, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_model_new(
    config: *const jcas_config,
    model: *mut *mut jcas_model,
    message: *mut c_char,
    message_capacity: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promises for `config` and `message`.
        let config = unsafe { legal(config, message, message_capacity) }?;
        // SAFETY: the caller's promise for `model`; looked at before anything is allocated.
        unsafe { place(model) }?;
        let memory = Memory::allocate(ModelBlock::layout(&config)?)?;
        // SAFETY: the library allocated the memory, and the caller promised `model`.
        unsafe { build(config, memory, model) }
    })
}

/// Ends a model. Memory of jcas_model_init belongs to the caller again. NULL is allowed and does
/// nothing. It returns JCAS_ERROR_IN_USE until every simulation, batch and policy of the model has
/// been freed.
///
/// Threads: none may be using the model.
/// Statuses: NULL, ALIGNMENT, HANDLE, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_model_free(model: *mut jcas_model) -> jcas_status {
    if model.is_null() {
        return crate::JCAS_OK;
    }
    // SAFETY: the caller's promise for `model`.
    guard(|| unsafe { ModelBlock::free(model.cast()) })
}

/// Writes the sizes and constants of a model.
///
/// `model`, `info`: not NULL; info->struct_size set.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_model_get_info(
    model: *const jcas_model,
    info: *mut jcas_model_info,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?;
        // SAFETY: the caller's promise for `info`.
        let info = unsafe { record(info) }?;
        info.put(jcas_model_info::of(model.get()));
        Ok(())
    })
}

/// Writes the position of each field in the observation of one UAV. Together the fields cover every
/// entry exactly once.
///
/// `model`, `fields`: not NULL. `count`: JCAS_OBSERVATION_FIELDS. `struct_size`:
/// sizeof(jcas_observation_field).
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_model_observation_fields(
    model: *const jcas_model,
    fields: *mut jcas_observation_field,
    count: usize,
    struct_size: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?;
        if struct_size != size_of::<jcas_observation_field>() {
            return Err(Fault::Status(JCAS_ERROR_STRUCT_SIZE));
        }
        // SAFETY: the caller's promise for `fields`.
        let out = unsafe { output(fields, count, JCAS_OBSERVATION_FIELDS) }?;
        let all = jcas_core::observation::fields::fields(model.get());
        for (to, from) in out.iter_mut().zip(all) {
            *to = jcas_observation_field {
                offset: from.offset as u32,
                count: from.count as u32,
                stride: from.stride as u32,
            };
        }
        Ok(())
    })
}

/// Returns the name of a field of an observation, such as "soc" or "hotspot_dx". It is a static
/// string, or NULL for an index of JCAS_OBSERVATION_FIELDS or more.
/// Threads: any.
#[unsafe(no_mangle)]
pub extern "C" fn jcas_observation_field_name(index: u32) -> *const c_char {
    static NAMES: [u8; joined_len(&FIELD_NAMES)] = joined(&FIELD_NAMES);
    name_at(&NAMES, index)
}

/// Writes the configuration of a model.
///
/// `model`, `config`: not NULL. `struct_size`: sizeof(jcas_config).
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_model_get_config(
    model: *const jcas_model,
    config: *mut jcas_config,
    struct_size: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?;
        // SAFETY: the caller's promise for `config`.
        let config = unsafe { sized_record(config, struct_size) }?;
        config.put(jcas_config::from_core(model.get().config()));
        Ok(())
    })
}

/// Writes the radar and link budget over an offset of (dx, dy) cells at a pilot density of the
/// sender.
///
/// `model`, `radio`: not NULL; radio->struct_size set. `dx` below W, `dy` below H, `pilot_density`
/// from 0 to 1, or JCAS_ERROR_ARGUMENT.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE, ARGUMENT.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_model_get_radio(
    model: *const jcas_model,
    dx: u32,
    dy: u32,
    pilot_density: f64,
    radio: *mut jcas_radio,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?.get();
        // SAFETY: the caller's promise for `radio`.
        let radio = unsafe { record(radio) }?;
        let config = model.config();
        let on_grid = dx < config.grid_width && dy < config.grid_height;
        if !on_grid || !(0.0..=1.0).contains(&pilot_density) {
            return Err(Fault::Status(JCAS_ERROR_ARGUMENT));
        }
        radio.put(jcas_radio {
            struct_size: size_of::<jcas_radio>() as u32,
            reserved: 0,
            sensing_snr_db: model.sensing_snr_db(dx, dy),
            detection_probability: model.detection_probability(dx, dy, pilot_density),
            comm_snr_db: model.comm_snr_db(dx, dy),
            link_throughput: model.link_throughput(dx, dy, pilot_density),
        });
        Ok(())
    })
}

/// Builds the model and writes its handle.
///
/// # Safety
/// As [`ModelBlock::build`]; `out` as for [`place`].
unsafe fn build(
    config: Config,
    memory: (*mut u8, Memory),
    out: *mut *mut jcas_model,
) -> Result<(), Fault> {
    // SAFETY: the caller's promises, passed on.
    let out = unsafe { place(out) }?;
    // SAFETY: the caller's promises, passed on.
    let block = unsafe { ModelBlock::build(config, memory) }?;
    out.put(block.cast());
    Ok(())
}
