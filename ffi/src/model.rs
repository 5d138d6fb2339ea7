//! Models: built in the caller's memory or in memory of ours, then only read.

use std::ffi::{c_char, c_void};

use jcas_core::Config;

use crate::config::jcas_config;
use crate::config_text::legal;
use crate::handle::{Memory, ModelBlock, model};
use crate::memory::{place, record, sized_record};
use crate::records::{jcas_model_info, jcas_radio};
use crate::status::{Fault, JCAS_ERROR_ARGUMENT, guard};

/// A validated configuration with everything that can be worked out before the first step. It never
/// changes: any number of threads may use one model at once.
pub struct jcas_model(());

/// How much memory a model takes, for jcas_model_init.
///
/// `config`, `size`, `alignment`: not NULL. `size` in bytes. `message`: see the introduction.
/// Threads: any.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_model_layout(
    config: *const jcas_config,
    size: *mut usize,
    alignment: *mut usize,
    message: *mut c_char,
    message_capacity: usize,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promises for `config` and `message`.
        let config = unsafe { legal(config, message, message_capacity) }?;
        // SAFETY: the caller's promise for `size`.
        let size = unsafe { place(size) }?;
        // SAFETY: the caller's promise for `alignment`.
        let alignment = unsafe { place(alignment) }?;
        let layout = ModelBlock::layout(&config)?;
        size.put(layout.size());
        alignment.put(layout.align());
        Ok(())
    })
}

/// Builds a model in the caller's memory, which holds it until jcas_model_free and may not be moved.
///
/// `memory`: at least the size and alignment of jcas_model_layout; not NULL; the caller's.
/// `config`: not NULL; not needed after the call. `model`: not NULL; receives the handle.
/// `message`: see the introduction. Threads: any.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_model_init(
    memory: *mut c_void,
    size: usize,
    config: *const jcas_config,
    model: *mut *mut jcas_model,
    message: *mut c_char,
    message_capacity: usize,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promises for `config` and `message`.
        let config = unsafe { legal(config, message, message_capacity) }?;
        let memory = Memory::lent(memory.cast(), size, ModelBlock::layout(&config)?)?;
        // SAFETY: the caller's promises for `memory` and `model`.
        unsafe { build(config, memory, model) }
    })
}

/// Builds a model in memory of its own, to be ended by jcas_model_free.
///
/// `config`: not NULL; not needed after the call. `model`: not NULL; receives the handle.
/// `message`: see the introduction. Threads: any.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_model_new(
    config: *const jcas_config,
    model: *mut *mut jcas_model,
    message: *mut c_char,
    message_capacity: usize,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promises for `config` and `message`.
        let config = unsafe { legal(config, message, message_capacity) }?;
        // SAFETY: the caller's promise for `model`; looked at before anything is allocated.
        unsafe { place(model) }?;
        let memory = Memory::allocate(ModelBlock::layout(&config)?)?;
        // SAFETY: the memory is ours, `model` is the caller's.
        unsafe { build(config, memory, model) }
    })
}

/// Ends a model; memory of the caller is the caller's again. NULL is allowed and does nothing.
/// JCAS_ERROR_IN_USE while simulations or batches of the model have not been freed.
///
/// Threads: none may be using the model.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_model_free(model: *mut jcas_model) -> i32 {
    if model.is_null() {
        return crate::JCAS_OK;
    }
    // SAFETY: the caller's promise for `model`.
    guard(|| unsafe { ModelBlock::free(model.cast()) })
}

/// Sizes and constants of a model.
///
/// `model`, `info`: not NULL; info->struct_size set. Threads: any.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_model_get_info(
    model: *const jcas_model,
    info: *mut jcas_model_info,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?;
        // SAFETY: the caller's promise for `info`.
        let info = unsafe { record(info) }?;
        info.put(jcas_model_info::of(model.get()));
        Ok(())
    })
}

/// The configuration of a model.
///
/// `model`, `config`: not NULL. `struct_size`: sizeof(jcas_config). Threads: any.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_model_get_config(
    model: *const jcas_model,
    config: *mut jcas_config,
    struct_size: usize,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?;
        // SAFETY: the caller's promise for `config`.
        let config = unsafe { sized_record(config, struct_size) }?;
        config.put(jcas_config::from_core(model.get().config()));
        Ok(())
    })
}

/// Radar and link over an offset of (dx, dy) cells, at a pilot density of the sender.
///
/// `model`, `radio`: not NULL; radio->struct_size set. `dx` below W, `dy` below H, `pilot_density` from
/// 0 to 1, or JCAS_ERROR_ARGUMENT. Threads: any.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_model_get_radio(
    model: *const jcas_model,
    dx: u32,
    dy: u32,
    pilot_density: f64,
    radio: *mut jcas_radio,
) -> i32 {
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

/// Builds the model and hands it out.
///
/// # Safety
/// As [`ModelBlock::build`]; `out` as for [`place`].
unsafe fn build(
    config: Config,
    memory: (*mut u8, Memory),
    out: *mut *mut jcas_model,
) -> Result<(), Fault> {
    // SAFETY: passed on.
    let out = unsafe { place(out) }?;
    // SAFETY: passed on.
    let block = unsafe { ModelBlock::build(config, memory) }?;
    out.put(block.cast());
    Ok(())
}
