//! Steps, parts of steps and a host's calls in any order. A call that is refused changes nothing,
//! and each state that is reached is valid.

#![no_main]

use arbitrary::{Arbitrary, Unstructured};
use jcas_core::host::Call;
use jcas_core::{Cell, Model, Sim};
use jcas_fuzz::{HOTSPOTS, UAVS, small_model};
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static MODEL: LazyLock<Model<'static>> = LazyLock::new(small_model);

/// A call, with values that may be out of range. It owns its lists, since `arbitrary` makes them
/// from bytes. The kernel's [`Call`] borrows its lists.
#[derive(Arbitrary, Debug)]
enum Operation {
    Reset(u64),
    Step([f32; 2 * UAVS]),
    Begin([f32; 2 * UAVS]),
    Sense,
    Communicate,
    End,
    Starts([(u8, u8); UAVS]),
    Hotspots([(u8, u8); HOTSPOTS]),
    Batteries([u64; UAVS]),
    Battery(u8, u64),
    Move(u8, (u8, u8)),
    Positions([(u8, u8); UAVS]),
    Ground(u8),
    Confirm(u8),
    SenseWith([bool; UAVS * HOTSPOTS]),
    CommunicateWith([bool; UAVS * (UAVS - 1) / 2], Option<[f64; UAVS]>),
}

/// Cells on the grid and just outside.
fn cell((x, y): (u8, u8)) -> Cell {
    Cell {
        x: u32::from(x % 6),
        y: u32::from(y % 5),
    }
}

/// Identifiers in range and just outside.
fn id(value: u8) -> usize {
    usize::from(value % 6)
}

fn perform(sim: &mut Sim<'_>, operation: &Operation) -> bool {
    let cells = |of: &[(u8, u8)]| of.iter().copied().map(cell).collect::<Vec<_>>();
    let bits = |of: &[bool]| of.iter().map(|bit| u8::from(*bit)).collect::<Vec<_>>();
    match operation {
        Operation::Reset(seed) => {
            sim.reset(*seed);
            true
        }
        Operation::Step(actions) => sim.step(actions).is_ok(),
        Operation::Begin(actions) => sim.step_begin(actions).is_ok(),
        Operation::Sense => sim.step_sense().is_ok(),
        Operation::Communicate => sim.step_communicate().is_ok(),
        Operation::End => sim.step_end().is_ok(),
        Operation::Starts(at) => sim.set_starts(&cells(at)).is_ok(),
        Operation::Hotspots(at) => sim.set_hotspots(&cells(at)).is_ok(),
        Operation::Batteries(charges_uj) => sim.set_batteries(charges_uj).is_ok(),
        Operation::Battery(uav, charge_uj) => sim.set_battery(id(*uav), *charge_uj).is_ok(),
        Operation::Move(hotspot, to) => sim.move_hotspot(id(*hotspot), cell(*to)).is_ok(),
        Operation::Positions(at) => sim.set_positions(&cells(at)).is_ok(),
        Operation::Ground(uav) => sim.ground(id(*uav)).is_ok(),
        Operation::Confirm(hotspot) => sim.confirm_hotspot(id(*hotspot)).is_ok(),
        Operation::SenseWith(detections) => sim.step_sense_with(&bits(detections)).is_ok(),
        Operation::CommunicateWith(links, throughput) => sim
            .apply(&Call::StepCommunicateWith {
                links: &bits(links),
                throughput: throughput.as_ref().map(|all| &all[..]),
            })
            .is_ok(),
    }
}

fuzz_target!(|data: &[u8]| {
    let mut input = Unstructured::new(data);
    let mut sim = Sim::new(&MODEL);
    sim.reset(1);
    let mut spare = vec![0; MODEL.state_words()];
    while !input.is_empty() {
        let Ok(operation) = Operation::arbitrary(&mut input) else {
            return;
        };
        let before = sim.words().to_vec();
        if !perform(&mut sim, &operation) {
            assert_eq!(sim.words(), before, "{operation:?} was refused");
        }
        let snapshot = sim.save();
        let mut loaded = before;
        MODEL
            .load(&snapshot, &mut loaded, &mut spare)
            .expect("the state is valid");
    }
});
