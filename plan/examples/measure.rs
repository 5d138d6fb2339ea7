//! The table of `docs/plan.md`: expected steps of plans of the preset `search`, and what a move
//! costs: `cargo run --release -p jcas-plan --example measure [ITERATIONS]`.

use core::ops::ControlFlow;
use std::hint::black_box;
use std::time::Instant;

use jcas_core::config::Depots;
use jcas_core::{Cell, Config, Model, Preset};
use jcas_plan::{Annealer, Problem, Settings, Situation, Targets, expect, search, starts};

/// The number of moves and of plain sums that are timed.
const MOVES: u32 = 100_000;
const SUMS: u32 = 300;

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let iterations = match std::env::args().nth(1) {
        Some(text) => text.parse()?,
        None => 1_000_000,
    };
    let settings = Settings {
        iterations,
        seed: 1,
    };
    speed()?;
    println!("uavs hotspots depot | steps success start bound");
    let centre = Cell { x: 6, y: 6 };
    for (uavs, hotspots, depot) in [
        (10, 3, centre),
        (10, 7, centre),
        (10, 11, centre),
        (6, 7, centre),
        (8, 7, centre),
        (12, 7, centre),
        (15, 7, centre),
        (20, 7, centre),
        (10, 7, Cell { x: 0, y: 0 }),
        (10, 7, Cell { x: 3, y: 8 }),
    ] {
        let config = Config {
            uav_count: uavs,
            hotspot_count: hotspots,
            depots: Depots::one(depot),
            ..Config::preset(Preset::Search)
        };
        let model = Model::new(config)?;
        let plan = search(&model, &settings, &mut |_| ControlFlow::Continue(()))?;
        println!(
            "{uavs} {hotspots} ({}, {}) | {:.2} {:.4} {:.2} {:.2}",
            depot.x,
            depot.y,
            plan.expected.steps,
            plan.expected.success,
            plan.start_steps,
            plan.bound_steps
        );
    }
    Ok(())
}

/// Prints the moves per second of the annealing, and the plain sums over all steps and cells per
/// second.
fn speed() -> Result<(), Box<dyn core::error::Error>> {
    let config = Config {
        hotspot_count: 7,
        ..Config::preset(Preset::Search)
    };
    let model = Model::new(config)?;
    let targets = Targets::hidden(&model);
    let problem = Problem::new(&model, &targets, Situation::at_reset(&model))?;
    let first = starts(&problem).swap_remove(0);
    let start = Instant::now();
    for _ in 0..SUMS {
        black_box(expect(&problem, black_box(&first)));
    }
    let plain = f64::from(SUMS) / start.elapsed().as_secs_f64();
    let mut annealer = Annealer::new(&problem, first, 1);
    let start = Instant::now();
    for index in 0..MOVES {
        if index % 256 == 0 {
            annealer.take_turn((index / 256) as usize % model.uav_count());
        }
        black_box(annealer.try_move(0.02));
    }
    let moves = f64::from(MOVES) / start.elapsed().as_secs_f64();
    println!("moves a second: {moves:.0} incremental, {plain:.0} by plain sums");
    Ok(())
}
