//! The calls by which a host simulator replaces parts of the model.
//!
//! A host may own the positions of the UAVs, their detections, the radio graph, the hotspots and
//! the charge of the batteries. It calls the four parts of a step, and replaces parts of the model
//! between them:
//!
//! ```
//! # #[cfg(feature = "alloc")] {
//! use jcas_core::{Cell, Config, Model, Sim};
//!
//! let model = Model::new(Config { uav_count: 2, ..Config::default() })?;
//! let mut sim = Sim::new(&model);
//! sim.step_begin(&vec![0.0; model.action_len()])?;
//! sim.set_positions(&[Cell { x: 3, y: 4 }, Cell { x: 5, y: 4 }])?;
//! sim.step_sense()?;
//! sim.step_communicate_with(&[0, 1, 1, 0], Some(&[0.5, 0.25]))?;
//! let outcome = sim.step_end()?;
//! assert!(!outcome.truncated);
//! assert_eq!(sim.state().throughput(1), 0.25);
//! # }
//! # Ok::<(), jcas_core::Error>(())
//! ```

mod call;

pub use call::Call;

use crate::config::Cell;
use crate::error::{Allowed, ConfigError, Error, Value};
use crate::model::Model;
use crate::rules::{alarms, graph, knowledge, potential, reports, sensing};
use crate::state::header::Phase;
use crate::state::scratch::Scratch;
use crate::state::{StateMut, StateRef};
use crate::step::require_phase;
use crate::words::bits;

fn check_len(what: &'static str, expected: usize, got: usize) -> Result<(), Error> {
    if expected == got {
        Ok(())
    } else {
        Err(Error::Length {
            what,
            expected,
            got,
        })
    }
}

fn refuse(field: &'static str, value: Value, rule: &'static str) -> Error {
    Error::Argument(ConfigError {
        field,
        value,
        allowed: Allowed::Rule(rule),
    })
}

impl Model<'_> {
    /// Sets the positions of the UAVs, in place of the kernel's own motion.
    ///
    /// The call comes between [`Model::step_begin`] and [`Model::step_sense`]. `cells` has one cell
    /// for each UAV. A UAV has moved if its cell differs from the one before the step, at any
    /// distance.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`], [`Error::Length`], or [`Error::Argument`] for a cell off the grid.
    pub fn set_positions(&self, state: &mut StateMut<'_>, cells: &[Cell]) -> Result<(), Error> {
        require_phase(state, Phase::Moved, "set_positions", "step_begin")?;
        check_len("positions", self.uav_count(), cells.len())?;
        self.check_cells("positions", cells)?;
        for (word, cell) in state.cells.iter_mut().zip(cells) {
            *word = cell.to_word();
        }
        Ok(())
    }

    /// Grounds a UAV for this step: it does not move, sense, communicate or spend energy.
    ///
    /// The call comes between [`Model::step_begin`] and [`Model::step_sense`], after
    /// [`Model::set_positions`] if both are called. The UAV keeps the cell that it had before the
    /// step, and its charge does not matter.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`], or [`Error::Argument`] if `uav` is not below N.
    pub fn ground(&self, state: &mut StateMut<'_>, uav: usize) -> Result<(), Error> {
        require_phase(state, Phase::Moved, "ground", "step_begin")?;
        check_index("uav", uav, self.uav_count(), "below uav_count")?;
        bits::set(state.grounded, uav);
        bits::assign(state.returning, uav, false);
        state.cells[uav] = state.previous[uav];
        Ok(())
    }

    /// Runs part 2 of a step with the host's detections, in place of [`Model::step_sense`].
    ///
    /// `detections` is an N × n matrix, row by row; any value but 0 is a detection. Detections by
    /// grounded UAVs are ignored, and those of confirmed hotspots that the UAV knows: the kernel
    /// draws none there. No UAV raises a false alarm in this step.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`] or [`Error::Length`].
    pub fn step_sense_with(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
        detections: &[u8],
    ) -> Result<(), Error> {
        require_phase(state, Phase::Moved, "step_sense_with", "step_begin")?;
        let expected = self.uav_count() * self.hotspot_count();
        check_len("detections", expected, detections.len())?;
        sensing::look_around(self, state);
        sensing::learn_from(self, state, scratch, detections);
        alarms::silence(state);
        reports::sight(self, state);
        state.header.set_phase(Phase::Sensed);
        Ok(())
    }

    /// Confirms a hotspot in this step without a quorum of detections.
    ///
    /// The call comes between [`Model::step_begin`] and [`Model::step_sense`], so that UAVs that
    /// detect the hotspot in this step learn it. Nothing changes if it is confirmed already.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`], or [`Error::Argument`] if `hotspot` is not below n.
    pub fn confirm_hotspot(&self, state: &mut StateMut<'_>, hotspot: usize) -> Result<(), Error> {
        require_phase(state, Phase::Moved, "confirm_hotspot", "step_begin")?;
        check_index(
            "hotspot",
            hotspot,
            self.hotspot_count(),
            "below hotspot_count",
        )?;
        if !bits::get(state.confirmed, hotspot) {
            bits::set(state.confirmed, hotspot);
            state.confirmed_at[hotspot] = u64::from(state.header.t());
        }
        Ok(())
    }

    /// Runs part 3 of a step over the host's radio graph, in place of [`Model::step_communicate`].
    ///
    /// `links` is an N × N matrix, row by row; any value but 0 is a link. It must be symmetric. The
    /// diagonal is ignored, and so are links of grounded UAVs.
    ///
    /// `throughput` is the mean normalised throughput η̄_i of each UAV, from 0 to 1e9, if the host
    /// measured it. Otherwise it follows from the link budget over these links. A UAV without
    /// neighbours has a throughput of 0 in both cases.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`], [`Error::Length`], or [`Error::Argument`] for a matrix that is not
    /// symmetric or a throughput out of range.
    pub fn step_communicate_with(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
        links: &[u8],
        throughput: Option<&[f64]>,
    ) -> Result<(), Error> {
        require_phase(state, Phase::Sensed, "step_communicate_with", "step_sense")?;
        let uavs = self.uav_count();
        check_len("links", uavs * uavs, links.len())?;
        for i in 0..uavs {
            for k in 0..i {
                if (links[i * uavs + k] != 0) != (links[k * uavs + i] != 0) {
                    let pair = Value::Cell(i as u32, k as u32);
                    return Err(refuse("links", pair, "the same in both directions"));
                }
            }
        }
        if let Some(measured) = throughput {
            check_len("throughput", uavs, measured.len())?;
            for &value in measured {
                if !(0.0..=1e9).contains(&value) {
                    return Err(refuse(
                        "throughput",
                        Value::Real(value),
                        "a number from 0 to 1e9",
                    ));
                }
            }
        }

        let row = self.uav_words();
        state.links.fill(0);
        for i in 0..uavs {
            for k in 0..uavs {
                let both_fly = !bits::get(state.grounded, i) && !bits::get(state.grounded, k);
                if i != k && both_fly && links[i * uavs + k] != 0 {
                    bits::set(&mut state.links[i * row..], k);
                }
            }
        }
        match throughput {
            None => graph::measure_throughput(self, state),
            Some(measured) => {
                let mut fleet = 0.0;
                for (i, &value) in measured.iter().enumerate() {
                    let alone = bits::is_empty(&state.links[i * row..(i + 1) * row]);
                    let value = if alone { 0.0 } else { value };
                    state.set_throughput(i, value);
                    fleet += value;
                }
                state.header.set_mean_throughput(fleet / uavs as f64);
            }
        }
        knowledge::communicate(self, state, scratch);
        state.header.set_phase(Phase::Communicated);
        Ok(())
    }

    /// Places all hotspots, in place of the drawn cells. The call is legal at t = 0 only.
    ///
    /// `cells` has one cell for each hotspot.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`] after the first step, [`Error::Length`], or [`Error::Argument`] for a
    /// cell off the grid, on a depot or given twice.
    pub fn set_hotspots(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
        cells: &[Cell],
    ) -> Result<(), Error> {
        expect_start(state, "set_hotspots")?;
        check_len("hotspots", self.hotspot_count(), cells.len())?;
        self.check_cells("hotspots", cells)?;
        for (index, cell) in cells.iter().enumerate() {
            let rule = if self.depots().contains(cell) {
                "a cell without a depot"
            } else if cells[..index].contains(cell) {
                "distinct from the other hotspots"
            } else {
                continue;
            };
            return Err(refuse("hotspots", Value::Cell(cell.x, cell.y), rule));
        }
        for (word, cell) in state.hotspots.iter_mut().zip(cells) {
            *word = cell.to_word();
        }
        potential::update(self, state, scratch, false);
        Ok(())
    }

    /// Moves a hotspot to a free cell. The call comes between two steps.
    ///
    /// The hotspot stays confirmed if it was, and UAVs that know it still do.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`], [`Error::EpisodeOver`], or [`Error::Argument`] if `hotspot` is not
    /// below n or the cell is off the grid, on a depot or taken by another hotspot.
    pub fn move_hotspot(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
        hotspot: usize,
        cell: Cell,
    ) -> Result<(), Error> {
        require_phase(state, Phase::Ready, "move_hotspot", "reset or step_end")?;
        check_index(
            "hotspot",
            hotspot,
            self.hotspot_count(),
            "below hotspot_count",
        )?;
        self.check_cells("cell", &[cell])?;
        let mut taken = false;
        for (other, word) in state.hotspots.iter().enumerate() {
            taken |= other != hotspot && *word == cell.to_word();
        }
        let rule = if self.depots().contains(&cell) {
            "a cell without a depot"
        } else {
            "distinct from the other hotspots"
        };
        if taken || self.depots().contains(&cell) {
            return Err(refuse("cell", Value::Cell(cell.x, cell.y), rule));
        }
        state.hotspots[hotspot] = cell.to_word();
        potential::update(self, state, scratch, false);
        Ok(())
    }

    /// Places the UAVs at the start, in place of the first depot. The call is legal at t = 0 only.
    ///
    /// `cells` has one cell for each UAV; two UAVs may share a cell. These cells count as visited,
    /// and the depot no longer does.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`] after the first step, [`Error::Length`], or [`Error::Argument`] for a
    /// cell off the grid.
    pub fn set_starts(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
        cells: &[Cell],
    ) -> Result<(), Error> {
        expect_start(state, "set_starts")?;
        check_len("starts", self.uav_count(), cells.len())?;
        self.check_cells("starts", cells)?;
        state.visited.fill(0);
        for (i, &cell) in cells.iter().enumerate() {
            state.cells[i] = cell.to_word();
            state.previous[i] = cell.to_word();
            bits::set(state.visited, self.cell_index(cell));
        }
        graph::build_graph(self, state, scratch);
        potential::update(self, state, scratch, false);
        Ok(())
    }

    /// Sets the present charge of one battery. The call comes between two steps.
    ///
    /// `charge_uj` is in microjoules, from 0 to the battery's capacity. The difference enters the
    /// ledger as the host's adjustment: initial + accepted + given = stored + spent.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`], [`Error::EpisodeOver`], or [`Error::Argument`] if `uav` is not below
    /// N or the charge is above the capacity.
    pub fn set_battery(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
        uav: usize,
        charge_uj: u64,
    ) -> Result<(), Error> {
        require_phase(state, Phase::Ready, "set_battery", "reset or step_end")?;
        check_index("uav", uav, self.uav_count(), "below uav_count")?;
        self.check_charge(charge_uj)?;
        state.given[uav] = given_after(state.given[uav], state.battery[uav], charge_uj);
        state.battery[uav] = charge_uj;
        if state.header.t() == 0 {
            bits::assign(state.grounded, uav, charge_uj == 0);
            graph::build_graph(self, state, scratch);
        }
        potential::update(self, state, scratch, false);
        Ok(())
    }

    /// Sets the initial charge of all batteries, in place of the drawn charges. The call is legal
    /// at t = 0 only.
    ///
    /// `charges_uj` has one charge for each UAV in microjoules, from 0 to the battery's capacity.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`] after the first step, [`Error::Length`], or [`Error::Argument`] for a
    /// charge above the capacity.
    pub fn set_batteries(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
        charges_uj: &[u64],
    ) -> Result<(), Error> {
        expect_start(state, "set_batteries")?;
        check_len("batteries", self.uav_count(), charges_uj.len())?;
        for &charge in charges_uj {
            self.check_charge(charge)?;
        }
        for (i, &charge) in charges_uj.iter().enumerate() {
            state.battery[i] = charge;
            state.initial[i] = charge;
            state.given[i] = 0;
            bits::assign(state.grounded, i, charge == 0);
        }
        graph::build_graph(self, state, scratch);
        potential::update(self, state, scratch, false);
        Ok(())
    }

    fn check_charge(&self, charge_uj: u64) -> Result<(), Error> {
        if charge_uj <= self.energy().capacity_uj {
            return Ok(());
        }
        let rule = "at most the battery's capacity, in microjoules";
        Err(refuse("battery", Value::Integer(charge_uj), rule))
    }

    /// The normalised throughput η_ik of UAV `i` toward UAV `k` in the present graph, without a
    /// unit.
    ///
    /// It is 0 if the two UAVs are not neighbours.
    #[must_use]
    pub fn pair_throughput(&self, state: &StateRef<'_>, i: usize, k: usize) -> f64 {
        if !state.linked(i, k) {
            return 0.0;
        }
        let full = self.full_throughput().between(state.cell(i), state.cell(k));
        (1.0 - state.pilot_density(i)) * full
    }

    fn check_cells(&self, what: &'static str, cells: &[Cell]) -> Result<(), Error> {
        for &cell in cells {
            if !self.contains(cell) {
                return Err(refuse(
                    what,
                    Value::Cell(cell.x, cell.y),
                    "cells of the grid",
                ));
            }
        }
        Ok(())
    }
}

/// The host's adjustment in a battery's ledger after it has set the charge, as bits of i64.
#[inline]
#[must_use]
pub(crate) const fn given_after(given: u64, battery_uj: u64, charge_uj: u64) -> u64 {
    given.wrapping_add(charge_uj).wrapping_sub(battery_uj)
}

fn check_index(
    field: &'static str,
    index: usize,
    count: usize,
    rule: &'static str,
) -> Result<(), Error> {
    if index < count {
        Ok(())
    } else {
        Err(refuse(field, Value::Integer(index as u64), rule))
    }
}

fn expect_start(state: &StateMut<'_>, called: &'static str) -> Result<(), Error> {
    require_phase(state, Phase::Ready, called, "reset")?;
    if state.header.t() == 0 {
        Ok(())
    } else {
        Err(Error::OutOfOrder {
            called,
            after: "reset, before the first step,",
        })
    }
}
