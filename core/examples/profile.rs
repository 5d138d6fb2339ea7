//! A fixed number of steps, for profilers that count instructions instead of seconds:
//!
//! ```console
//! $ cargo build --release -p jcas-core --features alloc --example profile
//! $ valgrind --tool=callgrind target/release/examples/profile 15 7 12 1000
//! ```
//!
//! UAVs, hotspots, side of the grid, steps, and at most how many neighbour slots (default: all).

#[path = "../benches/flight/mod.rs"]
mod flight;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let numbers: Vec<u32> = std::env::args()
        .skip(1)
        .map(|argument| argument.parse())
        .collect::<Result<_, _>>()?;
    let &[uavs, hotspots, side, steps, ref slots @ ..] = numbers.as_slice() else {
        return Err("usage: profile UAVS HOTSPOTS SIDE STEPS [SLOTS]".into());
    };
    let model = flight::model(uavs, hotspots, side, slots.first().copied().unwrap_or(4095))?;
    let mut flight = flight::Flight::new(&model);
    let mut total = 0.0;
    for _ in 0..steps {
        total += flight.step();
    }
    println!("{steps} steps, {total:.3} reward");
    Ok(())
}
