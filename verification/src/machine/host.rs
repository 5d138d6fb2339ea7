//! Legal and illegal calls of a host, and their effect on the specification.

use super::{Done, Machine, judge};
use crate::sampling::Dice;
use crate::specification::Position;
use jcas_core::header::Phase;
use jcas_core::host::Call;
use jcas_core::{Cell, Error};

impl Machine<'_> {
    /// Makes a call of a host.
    fn call(&mut self, dice: &mut Dice, call: &Call<'_>) -> Result<(), Error> {
        self.open(dice, |model, state, scratch| {
            call.apply(model, state, scratch)
        })
    }

    /// Draws any cell, one time in ten off the grid.
    fn any_cell(&self, dice: &mut Dice) -> Cell {
        let config = self.model.config();
        let beyond = u32::from(dice.one_in(10));
        Cell {
            x: dice.integer(0, config.grid_width - 1 + beyond),
            y: dice.integer(0, config.grid_height - 1),
        }
    }

    fn on_grid(&self, cell: Cell) -> bool {
        let config = self.model.config();
        cell.x < config.grid_width && cell.y < config.grid_height
    }

    pub(super) fn set_positions(&mut self, dice: &mut Dice) -> Done {
        let uavs = self.model.uav_count();
        let cells: Vec<Cell> = (0..uavs).map(|_| self.any_cell(dice)).collect();
        let legal = cells.iter().all(|&cell| self.on_grid(cell));
        let due = self.phase() == Phase::Moved;
        let done = self.call(dice, &Call::SetPositions { cells: &cells });
        if done.is_ok() {
            self.shadow.host.positions = Some(cells.iter().copied().map(position).collect());
            // The specification keeps UAVs on the ground last, as the calls' documentation says to
            // do.
            if !self.shadow.host.grounded.is_empty() {
                self.shadow.world = None;
            }
        }
        judge(&done, legal && due)
    }

    /// An index below `count`, one time in ten `count` itself.
    fn any_index(dice: &mut Dice, count: usize) -> usize {
        let beyond = u32::from(dice.one_in(10));
        dice.integer(0, count as u32 - 1 + beyond) as usize
    }

    pub(super) fn ground(&mut self, dice: &mut Dice) -> Done {
        let uavs = self.model.uav_count();
        let uav = Self::any_index(dice, uavs);
        let due = self.phase() == Phase::Moved;
        let done = self.call(dice, &Call::Ground { uav });
        if done.is_ok() {
            self.shadow.host.grounded.push(uav);
        }
        judge(&done, due && uav < uavs)
    }

    pub(super) fn confirm_hotspot(&mut self, dice: &mut Dice) -> Done {
        let hotspots = self.model.hotspot_count();
        let hotspot = Self::any_index(dice, hotspots);
        let due = self.phase() == Phase::Moved;
        let done = self.call(dice, &Call::ConfirmHotspot { hotspot });
        if done.is_ok() {
            self.shadow.host.confirmed.push(hotspot);
        }
        judge(&done, due && hotspot < hotspots)
    }

    pub(super) fn sense_with(&mut self, dice: &mut Dice) -> Done {
        let (uavs, hotspots) = (self.model.uav_count(), self.model.hotspot_count());
        let mut detections: Vec<u8> = (0..uavs * hotspots)
            .map(|_| u8::from(dice.one_in(3)))
            .collect();
        let legal = !dice.one_in(10);
        if !legal {
            detections.push(1);
        }
        let due = self.phase() == Phase::Moved;
        let done = self.call(
            dice,
            &Call::StepSenseWith {
                detections: &detections,
            },
        );
        if done.is_ok() {
            let rows = detections.chunks(hotspots);
            let rows = rows.map(|row| row.iter().map(|&byte| byte != 0).collect());
            self.shadow.host.detections = Some(rows.collect());
        }
        judge(&done, due && legal)
    }

    pub(super) fn communicate_with(&mut self, dice: &mut Dice) -> Done {
        let uavs = self.model.uav_count();
        let mut links = vec![0; uavs * uavs];
        for i in 0..uavs {
            for k in 0..=i {
                let linked = u8::from(dice.one_in(3));
                (links[i * uavs + k], links[k * uavs + i]) = (linked, linked);
            }
        }
        let lopsided = uavs > 1 && dice.one_in(5);
        if lopsided {
            links[1] ^= 1;
        }
        let mut measured: Vec<f64> = (0..uavs).map(|_| dice.real(0.0, 5.0)).collect();
        if dice.one_in(10) {
            measured[0] = [f64::NAN, -1.0, 1e10][dice.integer(0, 2) as usize];
        }
        let measured = dice.one_in(2).then_some(measured);
        let legal = measured
            .iter()
            .flatten()
            .all(|value| (0.0..=1e9).contains(value));
        let due = self.phase() == Phase::Sensed;
        let done = self.call(
            dice,
            &Call::StepCommunicateWith {
                links: &links,
                throughput: measured.as_deref(),
            },
        );
        if done.is_ok() {
            let rows = links.chunks(uavs);
            let rows = rows.map(|row| row.iter().map(|&byte| byte != 0).collect());
            self.shadow.host.links = Some(rows.collect());
            self.shadow.host.throughput = measured;
        }
        judge(&done, due && legal && !lopsided)
    }

    pub(super) fn set_starts(&mut self, dice: &mut Dice) -> Done {
        let uavs = self.model.uav_count();
        let cells: Vec<Cell> = (0..uavs).map(|_| self.any_cell(dice)).collect();
        let legal = cells.iter().all(|&cell| self.on_grid(cell));
        let due = self.at_the_start();
        let done = self.call(dice, &Call::SetStarts { cells: &cells });
        if let (Ok(()), Some(world)) = (&done, &mut self.shadow.world) {
            let starts: Vec<Position> = cells.iter().copied().map(position).collect();
            self.spec.set_starts(world, &starts);
        }
        judge(&done, due && legal)
    }

    pub(super) fn set_hotspots(&mut self, dice: &mut Dice) -> Done {
        let count = self.model.hotspot_count();
        let mut cells: Vec<Cell> = Vec::new();
        // An illegal cell is drawn again a few times, so that the call is often legal.
        for _ in 0..count {
            let mut cell = self.any_cell(dice);
            for _ in 0..20 {
                if self.model.depots().contains(&cell) || cells.contains(&cell) {
                    cell = self.any_cell(dice);
                }
            }
            cells.push(cell);
        }
        let apart = |index: usize| !cells[..index].contains(&cells[index]);
        let fits = |index: usize| {
            self.on_grid(cells[index]) && !self.model.depots().contains(&cells[index])
        };
        let legal = (0..count).all(|index| apart(index) && fits(index));
        let due = self.at_the_start();
        let done = self.call(dice, &Call::SetHotspots { cells: &cells });
        if let (Ok(()), Some(world)) = (&done, &mut self.shadow.world) {
            world.hotspot = cells.iter().map(|&cell| position(cell)).collect();
        }
        judge(&done, due && legal)
    }

    pub(super) fn set_batteries(&mut self, dice: &mut Dice) -> Done {
        let capacity = self.model.energy().capacity_uj;
        let mut charges: Vec<u64> = (0..self.model.uav_count())
            .map(|_| any_charge(dice, capacity))
            .collect();
        let legal = !dice.one_in(5);
        if !legal {
            charges[0] = capacity + 1;
        }
        let due = self.at_the_start();
        let done = self.call(
            dice,
            &Call::SetBatteries {
                charges_uj: &charges,
            },
        );
        if let (Ok(()), Some(world)) = (&done, &mut self.shadow.world) {
            self.spec.set_batteries(world, &charges);
        }
        judge(&done, due && legal)
    }

    pub(super) fn set_battery(&mut self, dice: &mut Dice) -> Done {
        let (uavs, capacity) = (self.model.uav_count(), self.model.energy().capacity_uj);
        let uav = Self::any_index(dice, uavs);
        let charge = if dice.one_in(10) {
            capacity + 1
        } else {
            any_charge(dice, capacity)
        };
        let due = self.phase() == Phase::Ready;
        let done = self.call(
            dice,
            &Call::SetBattery {
                uav,
                charge_uj: charge,
            },
        );
        if let (Ok(()), Some(world)) = (&done, &mut self.shadow.world) {
            self.spec.set_battery(world, uav, charge);
        }
        judge(&done, due && uav < uavs && charge <= capacity)
    }

    pub(super) fn move_hotspot(&mut self, dice: &mut Dice) -> Done {
        let hotspots = self.model.hotspot_count();
        let hotspot = Self::any_index(dice, hotspots);
        let cell = self.any_cell(dice);
        let state = self.model.state(&self.words).expect("a state of the model");
        let taken =
            (0..hotspots).any(|other| other != hotspot && state.hotspot_cell(other) == cell);
        let free = self.on_grid(cell) && !taken && !self.model.depots().contains(&cell);
        let due = self.phase() == Phase::Ready;
        let done = self.call(dice, &Call::MoveHotspot { hotspot, cell });
        if let (Ok(()), Some(world)) = (&done, &mut self.shadow.world) {
            world.hotspot[hotspot] = position(cell);
        }
        judge(&done, due && hotspot < hotspots && free)
    }

    fn at_the_start(&self) -> bool {
        let state = self.model.state(&self.words).expect("a state of the model");
        self.phase() == Phase::Ready && state.t() == 0
    }
}

/// Draws the charge of a battery, which is often zero or the capacity.
fn any_charge(dice: &mut Dice, capacity: u64) -> u64 {
    match dice.integer(0, 9) {
        0 => 0,
        1 => capacity,
        _ => dice.bits() % (capacity + 1),
    }
}

fn position(cell: Cell) -> Position {
    Position {
        x: i64::from(cell.x),
        y: i64::from(cell.y),
    }
}
