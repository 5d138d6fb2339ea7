//! A mission on a microcontroller: no operating system, no allocator, all memory static.
//!
//! The program verifies the golden trace `fifteen_uavs`, byte by byte. It prints the memory that it
//! took by semihosting.
#![no_std]
#![no_main]

mod memory;

use core::panic::PanicInfo;

// Printing enters its critical section.
use cortex_m as _;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use jcas_core::{Cell, Error, Model, Scratch, hash};
use jcas_trace::{Arguments, Replay, Workspace, WorkspaceSizes, configuration};

const TRACE: &str = include_str!("../../golden/fifteen_uavs.jsonl");
/// Number of words of the tables of the model, of the state and of its working memory together.
const WORDS: usize = 4096;
/// Number of observed reals of the fleet.
const REALS: usize = 2048;
const UAVS: usize = 15;

/// All memory that the kernel and the trace work in.
struct Memory {
    words: [u64; WORDS],
    observations: [f32; REALS],
    actions: [f32; 2 * UAVS],
    cells: [Cell; UAVS],
    charges_uj: [u64; UAVS],
    throughput: [f64; UAVS],
    matrix: [u8; UAVS * UAVS],
}

/// What a mission took.
struct Flown {
    steps: u32,
    state_hash: u64,
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
        actions: [0.0; 2 * UAVS],
        cells: [Cell { x: 0, y: 0 }; UAVS],
        charges_uj: [0; UAVS],
        throughput: [0.0; UAVS],
        matrix: [0; UAVS * UAVS],
    };
    match fly(MEMORY) {
        Ok(flown) => {
            hprintln!(
                "{} steps, state hash {:#018x}",
                flown.steps,
                flown.state_hash
            );
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

/// Flies the trace, compares each of its lines, and returns the memory that it took.
fn fly(memory: &mut Memory) -> Result<Flown, Error> {
    let config = configuration(TRACE).expect("a header");
    let table_words = Model::table_words(&config)?;
    let (tables, rest) = memory.words.split_at_mut(table_words);
    let model = Model::new_in(config, tables)?;
    let (words, rest) = rest.split_at_mut(model.state_words());
    let scratch_words = Scratch::words_for(&model);
    let sizes = WorkspaceSizes::of(&model);
    let workspace = Workspace {
        observations: &mut memory.observations[..sizes.observations],
        actions: &mut memory.actions[..sizes.actions],
        arguments: Arguments {
            cells: &mut memory.cells[..sizes.cells],
            charges_uj: &mut memory.charges_uj[..sizes.uavs],
            throughput: &mut memory.throughput[..sizes.uavs],
            matrix: &mut memory.matrix[..sizes.matrix],
        },
    };
    let scratch = &mut rest[..scratch_words];
    if let Err(error) = Replay::new(&model, words, scratch, workspace).verify(TRACE) {
        panic!("{error}");
    }
    Ok(Flown {
        steps: model.state(words)?.t(),
        state_hash: hash::words(words),
        table_words,
        state_words: words.len(),
        scratch_words,
        observed: sizes.observations,
    })
}

/// Prints the memory that the mission took, and that the image takes.
fn report(flown: &Flown) {
    let words = [flown.table_words, flown.state_words, flown.scratch_words];
    let [tables, state, scratch] = words.map(|count| count * size_of::<u64>());
    let observations = flown.observed * size_of::<f32>();
    hprintln!(
        "static memory of the kernel: {} bytes (tables {}, state {}, scratch {}, observations {})",
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
        TRACE.len()
    );
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    hprintln!("FAIL  {}", info);
    debug::exit(debug::EXIT_FAILURE);
    loop {}
}
