//! A mission on a microcontroller: no operating system, no allocator, all memory static.
//!
//! The program flies the golden trace `fifteen_uavs` and compares the fingerprints of every state
//! and of all observations. It prints what it found, and the memory that it took, by semihosting.
#![no_std]
#![no_main]

mod memory;

use core::panic::PanicInfo;

// Printing enters its critical section.
use cortex_m as _;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use jcas_core::{Config, Error, Model, Preset, Scratch, hash, observation};

/// Number of words of the tables of the model, of the state and of its working memory together.
const WORDS: usize = 4096;
/// Number of observed reals of the fleet.
const REALS: usize = 2048;
const UAVS: usize = 15;

/// All memory that the kernel works in.
struct Memory {
    words: [u64; WORDS],
    observations: [f32; REALS],
}

/// Fingerprints of a state and of its observations.
#[derive(PartialEq)]
struct Hashes {
    observations: u64,
    state: u64,
}

/// A step of the trace.
struct Step {
    actions: [f32; 2 * UAVS],
    hashes: Hashes,
}

include!(concat!(env!("OUT_DIR"), "/golden.rs"));

/// What a mission took.
struct Flown {
    table_words: usize,
    state_words: usize,
    scratch_words: usize,
    observed: usize,
}

#[entry]
fn main() -> ! {
    static mut MEMORY: Memory = Memory {
        words: [0; WORDS],
        observations: [0.0; REALS],
    };
    match fly(MEMORY) {
        Ok(flown) => {
            let last = &STEPS[STEPS.len() - 1].hashes;
            hprintln!("{} steps, state hash {:#018x}", STEPS.len(), last.state);
            report(&flown);
            debug::exit(debug::EXIT_SUCCESS);
        }
        Err(error) => {
            hprintln!("FAIL  {}", error);
            debug::exit(debug::EXIT_FAILURE);
        }
    }
    unreachable!("the debugger has ended the program")
}

/// Flies the trace and returns the memory that it took.
fn fly(memory: &mut Memory) -> Result<Flown, Error> {
    let config = Config {
        uav_count: UAVS as u32,
        hotspot_count: 5,
        ..Config::preset(Preset::Paper)
    };
    let table_words = Model::table_words(&config)?;
    let (tables, rest) = memory.words.split_at_mut(table_words);
    let model = Model::new_in(config, tables)?;
    assert_eq!(model.config_hash(), CONFIG_HASH, "another configuration");
    let (words, rest) = rest.split_at_mut(model.state_words());
    let scratch_words = Scratch::words_for(&model);
    let mut scratch = Scratch::new(&model, &mut rest[..scratch_words])?;
    let observed = UAVS * model.observation_len();
    let observations = &mut memory.observations[..observed];

    let mut compare = |t, words: &[u64], scratch: &mut _, expected: &Hashes| {
        observation::observe(&model, &model.state(words)?, scratch, observations)?;
        let found = Hashes {
            observations: hash::reals(observations),
            state: hash::words(words),
        };
        assert!(found == *expected, "step {t} differs from the trace");
        Ok::<_, Error>(())
    };
    model.reset(words, &mut scratch, SEED)?;
    compare(0, words, &mut scratch, &INITIAL)?;
    for (t, step) in STEPS.iter().enumerate() {
        model.step(&mut model.state_mut(words)?, &mut scratch, &step.actions)?;
        compare(t + 1, words, &mut scratch, &step.hashes)?;
    }
    Ok(Flown {
        table_words,
        state_words: words.len(),
        scratch_words,
        observed,
    })
}

/// Prints the memory that the mission took, and that the image takes.
fn report(flown: &Flown) {
    let words = [flown.table_words, flown.state_words, flown.scratch_words];
    let [tables, state, scratch] = words.map(|count| count * size_of::<u64>());
    let observations = flown.observed * size_of::<f32>();
    hprintln!(
        "static memory: {} bytes (tables {}, state {}, scratch {}, observations {})",
        tables + state + scratch + observations,
        tables,
        state,
        scratch,
        observations
    );
    hprintln!(
        "stack: at most {} bytes, {} of them the model",
        memory::stack_used(),
        size_of::<Model<'_>>()
    );
    hprintln!(
        "flash: {} bytes, {} of them the trace",
        memory::flash_used(),
        size_of_val(STEPS)
    );
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    hprintln!("FAIL  {}", info);
    debug::exit(debug::EXIT_FAILURE);
    loop {}
}
