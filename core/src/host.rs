//! What a host simulator may own: where the UAVs are, who hears whom, where the hotspots lie, how full
//! the batteries start.

use crate::bits;
use crate::config::Cell;
use crate::error::{Allowed, ConfigError, Error, Value};
use crate::header::Phase;
use crate::model::Model;
use crate::scratch::Scratch;
use crate::state::StateMut;
use crate::step::expect;
use crate::{knowledge, link, potential};

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
    /// Puts the UAVs where the host has moved them, in place of the kernel's own motion. Between
    /// [`Model::step_begin`] and [`Model::step_sense`]. A UAV whose cell differs from the one before the
    /// step has moved, however far.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`], [`Error::Length`], or [`Error::Argument`] for a cell off the grid.
    pub fn set_positions(&self, state: &mut StateMut<'_>, cells: &[Cell]) -> Result<(), Error> {
        expect(state, Phase::Moved, "set_positions", "step_begin")?;
        check_len("positions", self.uav_count(), cells.len())?;
        self.check_cells("positions", cells)?;
        for (word, cell) in state.cells.iter_mut().zip(cells) {
            *word = cell.to_word();
        }
        Ok(())
    }

    /// Part 3 of a step over the host's graph, in place of [`Model::step_communicate`].
    ///
    /// `links` is an N × N matrix, row by row; any value but 0 is a link. It must be symmetric; the
    /// diagonal is ignored, and so are links of grounded UAVs. η̄_i is the link budget's over these links,
    /// or `throughput[i]` where the host measured it.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`], [`Error::Length`], or [`Error::Argument`] for a matrix that is not symmetric
    /// or a throughput that is not a finite number of at least 0.
    pub fn step_communicate_over(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
        links: &[u8],
        throughput: Option<&[f64]>,
    ) -> Result<(), Error> {
        expect(state, Phase::Sensed, "step_communicate_over", "step_sense")?;
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
            None => link::measure_throughput(self, state),
            Some(measured) => {
                let mut fleet = 0.0;
                for (i, &value) in measured.iter().enumerate() {
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

    /// Places the hotspots, in place of the drawn ones. At t = 0 only.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`] after the first step, [`Error::Length`], or [`Error::Argument`] for a cell off
    /// the grid, on a depot or given twice.
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

    /// Sets what each battery holds at the start, in place of the drawn charge. At t = 0 only.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`] after the first step, [`Error::Length`], or [`Error::Argument`] for a charge
    /// above the capacity.
    pub fn set_batteries(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
        charges_uj: &[u64],
    ) -> Result<(), Error> {
        expect_start(state, "set_batteries")?;
        check_len("batteries", self.uav_count(), charges_uj.len())?;
        for &charge in charges_uj {
            if charge > self.energy().capacity_uj {
                let rule = "at most the battery's capacity, in microjoules";
                return Err(refuse("batteries", Value::Integer(charge), rule));
            }
        }
        for (i, &charge) in charges_uj.iter().enumerate() {
            state.battery[i] = charge;
            state.initial[i] = charge;
            bits::assign(state.grounded, i, charge == 0);
        }
        link::build_graph(self, state, scratch);
        potential::update(self, state, scratch, false);
        Ok(())
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

fn expect_start(state: &StateMut<'_>, called: &'static str) -> Result<(), Error> {
    expect(state, Phase::Ready, called, "reset")?;
    if state.header.t() == 0 {
        Ok(())
    } else {
        Err(Error::OutOfOrder {
            called,
            after: "reset, before the first step,",
        })
    }
}
