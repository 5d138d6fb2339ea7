//! One step with observations and reward written, over fleet size, hotspots and grid:
//! `cargo bench -p jcas-core --features alloc`.

mod flight;

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

use flight::Flight;

fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("step");
    // Fleet, hotspots, side of the grid, neighbour slots.
    for (uavs, hotspots, side, slots) in [
        (5, 3, 12, 4095),
        (15, 7, 12, 4095),
        (20, 11, 12, 4095),
        (15, 28, 24, 4095),
        (100, 7, 31, 14),
        (1000, 7, 98, 14),
        (1000, 7, 98, 4095),
    ] {
        let model = flight::model(uavs, hotspots, side, slots).expect("a legal configuration");
        let mut flight = Flight::new(&model);
        let name = format!(
            "N={uavs} n={hotspots} grid={side}x{side} slots={}",
            model.neighbour_slots()
        );
        group.throughput(Throughput::Elements(u64::from(uavs)));
        group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
            bencher.iter(|| black_box(flight.step()));
        });
    }
    group.finish();
}

criterion_group!(benches, steps);
criterion_main!(benches);
