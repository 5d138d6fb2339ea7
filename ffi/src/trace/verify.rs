//! A trace flown again: what each line supplies is read from it, and the line is then written anew and compared
//! byte by byte.

use std::fmt::{self, Write};

use jcas_core::hash::Fnv1a;
use jcas_core::header::Phase;
use jcas_core::{Config, Error, Model, Scratch, StateMut};

use super::line::{self, CHECKSUM, Hashes, Header};
use super::reader::{Reader, Refusal, STEP, Told, Why, expect, hexadecimal};
use super::recording::{Parts, hashes};
use crate::handle::Open;

/// The configuration that a trace says it was flown with.
pub(crate) fn configuration(trace: &str) -> Result<Config, Refusal<'_>> {
    Ok(Reader::new(trace).header()?.config)
}

/// Flies a trace again in a simulation of its configuration.
pub(crate) fn verify<'t>(
    sim: &mut Open<'_>,
    parts: Parts<'_>,
    trace: &'t str,
) -> Result<(), Refusal<'t>> {
    check_whole(trace)?;
    let mut reader = Reader::new(trace);
    let header = reader.header()?;
    if header.config.hash() != sim.model.config_hash() {
        return Err(reader.refuse(Why::Model));
    }
    let mut flight = Flight {
        model: sim.model,
        words: sim.words,
        scratch: sim.scratch,
        parts,
    };
    flight
        .reset(header.seed)
        .map_err(|why| reader.refuse(why))?;
    flight
        .compare_header(&header)
        .map_err(|why| reader.refuse(why))?;
    loop {
        reader.next_line();
        match flight.line(&mut reader) {
            Ok(true) => {}
            Ok(false) => return Ok(()),
            Err(why) => return Err(reader.refuse(why)),
        }
    }
}

/// The checksum stands last, and fits.
fn check_whole(trace: &str) -> Result<(), Refusal<'_>> {
    let whole = || {
        let at = trace.rfind(CHECKSUM)?;
        let (digits, rest) = trace[at + CHECKSUM.len()..].split_at_checked(16)?;
        let mut hash = Fnv1a::new();
        hash.write(&trace.as_bytes()[..at]);
        (rest == "\"}\n" && hexadecimal(digits)? == hash.finish()).then_some(())
    };
    whole().ok_or(Refusal::WHOLE)
}

/// The simulation that flies, and what it works in.
struct Flight<'f> {
    model: &'f Model<'static>,
    words: &'f mut [u64],
    scratch: &'f mut [u64],
    parts: Parts<'f>,
}

impl Flight<'_> {
    fn reset<'t>(&mut self, seed: u64) -> Result<(), Why<'t>> {
        let mut scratch = Scratch::new(self.model, self.scratch).ok_or(Why::Internal)?;
        let reset = self.model.reset(self.words, &mut scratch, seed);
        reset.map_err(Why::Kernel)
    }

    fn act<'t>(
        &mut self,
        act: impl FnOnce(
            &Model<'_>,
            &mut StateMut<'_>,
            &mut Scratch<'_>,
            &Parts<'_>,
        ) -> Result<(), Error>,
    ) -> Result<(), Why<'t>> {
        let mut scratch = Scratch::new(self.model, self.scratch).ok_or(Why::Internal)?;
        let mut state = self.model.state_mut(self.words).map_err(Why::Kernel)?;
        act(self.model, &mut state, &mut scratch, &self.parts).map_err(Why::Kernel)
    }

    fn phase(&self) -> Option<Phase> {
        let state = self.model.state(self.words).ok()?;
        state.header.phase()
    }

    /// Takes up a line; whether another must follow.
    fn line<'t>(&mut self, reader: &mut Reader<'t>) -> Result<bool, Why<'t>> {
        if reader.line.starts_with(STEP) {
            self.step(reader)?;
            return Ok(true);
        }
        reader.skip("{\"kind\":\"")?;
        let kind = reader.text()?;
        reader.skip("\",")?;
        if kind == "end" {
            self.end(reader)?;
            return Ok(false);
        }
        self.host(kind, reader)?;
        expect(reader.rest == "}\n")?;
        Ok(true)
    }

    /// Stands between `step_begin` and `step_sense` of the step whose line comes next.
    fn begin<'t>(&mut self, reader: &Reader<'t>) -> Result<(), Why<'t>> {
        if matches!(
            self.phase(),
            Some(Phase::Moved | Phase::Sensed | Phase::Communicated)
        ) {
            return Ok(());
        }
        reader.actions(self.parts.actions)?;
        self.act(|model, state, _, parts| model.step_begin(state, parts.actions))
    }

    /// Goes on to where the host's graph or the kernel's is due.
    fn sense<'t>(&mut self) -> Result<(), Why<'t>> {
        if self.phase() == Some(Phase::Moved) {
            self.act(|model, state, scratch, _| model.step_sense(state, scratch))?;
        }
        Ok(())
    }

    fn step<'t>(&mut self, reader: &Reader<'t>) -> Result<(), Why<'t>> {
        self.begin(reader)?;
        self.sense()?;
        if self.phase() == Some(Phase::Sensed) {
            self.act(|model, state, scratch, _| model.step_communicate(state, scratch))?;
        }
        self.act(|model, state, scratch, _| model.step_end(state, scratch).map(|_| ()))?;
        let hashes = self.hashes()?;
        let state = self.model.state(self.words).map_err(Why::Kernel)?;
        compare(reader.line, |out| {
            line::step(out, self.model, &state, self.parts.actions, hashes)
        })
    }

    fn hashes<'t>(&mut self) -> Result<Hashes, Why<'t>> {
        let state = self.model.state(self.words).map_err(Why::Kernel)?;
        let observations = &mut *self.parts.observations;
        hashes(self.model, &state, self.words, self.scratch, observations)
            .map_err(|_| Why::Internal)
    }

    fn compare_header<'t>(&mut self, told: &Told<'t>) -> Result<(), Why<'t>> {
        let hashes = self.hashes()?;
        let state = self.model.state(self.words).map_err(Why::Kernel)?;
        let header = Header {
            version: told.version,
            core_version: &told.core_version,
            policy: &told.policy,
            pilot: &told.pilot,
            seed: told.seed,
        };
        compare(told.line, |out| {
            header.write(out, self.model, &state, hashes)
        })
    }

    fn end<'t>(&mut self, reader: &Reader<'t>) -> Result<(), Why<'t>> {
        expect(reader.later.is_empty())?;
        let within = [Phase::Moved, Phase::Sensed, Phase::Communicated];
        expect(!self.phase().is_some_and(|phase| within.contains(&phase)))?;
        let state = self.model.state(self.words).map_err(Why::Kernel)?;
        let at = reader.line.rfind(CHECKSUM).ok_or(Why::Form)?;
        compare(&reader.line[..at], |out| line::end(out, &state.metrics()))
    }

    /// A call of the host, with what is read of its arguments.
    fn host<'t>(&mut self, kind: &str, reader: &mut Reader<'t>) -> Result<(), Why<'t>> {
        let (uavs, hotspots) = (self.model.uav_count(), self.model.hotspot_count());
        match kind {
            "set_starts" => {
                self.cells(reader, uavs)?;
                self.act(|model, state, scratch, parts| {
                    model.set_starts(state, scratch, &parts.cells[..uavs])
                })
            }
            "set_hotspots" => {
                self.cells(reader, hotspots)?;
                self.act(|model, state, scratch, parts| {
                    model.set_hotspots(state, scratch, &parts.cells[..hotspots])
                })
            }
            "set_batteries" => {
                reader.skip("\"charges_uj\":")?;
                expect(reader.fill(self.parts.charges, Reader::number)? == uavs)?;
                self.act(|model, state, scratch, parts| {
                    model.set_batteries(state, scratch, parts.charges)
                })
            }
            "set_battery" => {
                reader.skip("\"uav\":")?;
                let uav = reader.number()?;
                reader.skip(",\"charge_uj\":")?;
                let charge = reader.number()?;
                self.act(|model, state, scratch, _| model.set_battery(state, scratch, uav, charge))
            }
            "move_hotspot" => {
                reader.skip("\"hotspot\":")?;
                let hotspot = reader.number()?;
                reader.skip(",\"cell\":")?;
                let cell = reader.cell()?;
                self.act(|model, state, scratch, _| {
                    model.move_hotspot(state, scratch, hotspot, cell)
                })
            }
            "set_positions" => {
                self.begin(reader)?;
                self.cells(reader, uavs)?;
                self.act(|model, state, _, parts| model.set_positions(state, &parts.cells[..uavs]))
            }
            "ground" => {
                self.begin(reader)?;
                reader.skip("\"uav\":")?;
                let uav = reader.number()?;
                self.act(|model, state, _, _| model.ground(state, uav))
            }
            "confirm_hotspot" => {
                self.begin(reader)?;
                reader.skip("\"hotspot\":")?;
                let hotspot = reader.number()?;
                self.act(|model, state, _, _| model.confirm_hotspot(state, hotspot))
            }
            "step_sense_with" => {
                self.begin(reader)?;
                reader.skip("\"detections\":")?;
                self.matrix(reader, hotspots, false)?;
                self.act(|model, state, scratch, parts| {
                    model.step_sense_with(state, scratch, &parts.matrix[..uavs * hotspots])
                })
            }
            "step_communicate_with" => {
                self.begin(reader)?;
                self.sense()?;
                reader.skip("\"links\":")?;
                self.matrix(reader, uavs, true)?;
                reader.skip(",\"throughput\":")?;
                let measured = if reader.rest.starts_with('[') {
                    expect(reader.fill(self.parts.reals, Reader::number)? == uavs)?;
                    true
                } else {
                    reader.skip("null")?;
                    false
                };
                self.act(|model, state, scratch, parts| {
                    let links = &parts.matrix[..uavs * uavs];
                    let throughput = measured.then_some(&*parts.reals);
                    model.step_communicate_with(state, scratch, links, throughput)
                })
            }
            _ => Err(Why::Form),
        }
    }

    fn cells<'t>(&mut self, reader: &mut Reader<'t>, count: usize) -> Result<(), Why<'t>> {
        reader.skip("\"cells\":")?;
        expect(reader.fill(&mut self.parts.cells[..count], Reader::cell)? == count)
    }

    /// A matrix of N rows, by the pairs where it is not 0.
    fn matrix<'t>(
        &mut self,
        reader: &mut Reader<'t>,
        columns: usize,
        symmetric: bool,
    ) -> Result<(), Why<'t>> {
        let rows = self.model.uav_count();
        let matrix = &mut self.parts.matrix[..rows * columns];
        matrix.fill(0);
        reader.list(|reader, _| {
            let [row, column] = reader.pair::<usize>()?;
            expect(row < rows && column < columns)?;
            matrix[row * columns + column] = 1;
            if symmetric {
                matrix[column * columns + row] = 1;
            }
            Ok(())
        })?;
        Ok(())
    }
}

/// Writes a line anew beside the one in the file.
fn compare<'t>(
    line: &'t str,
    write: impl FnOnce(&mut Beside<'t>) -> fmt::Result,
) -> Result<(), Why<'t>> {
    let mut beside = Beside { line, alike: 0 };
    match write(&mut beside) {
        Ok(()) if beside.alike == line.len() => Ok(()),
        _ => Err(Why::Differs(field_at(line, beside.alike))),
    }
}

struct Beside<'t> {
    line: &'t str,
    alike: usize,
}

impl Write for Beside<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let rest = &self.line.as_bytes()[self.alike..];
        let same = rest.iter().zip(text.as_bytes()).take_while(|(a, b)| a == b);
        let same = same.count();
        self.alike += same;
        if same == text.len() {
            Ok(())
        } else {
            Err(fmt::Error)
        }
    }
}

/// The name of the field that a byte of a line belongs to.
fn field_at(line: &str, at: usize) -> &str {
    let mut end = at.min(line.len());
    while !line.is_char_boundary(end) {
        end -= 1;
    }
    let name = || {
        let before = &line[..line[..end].rfind("\":")?];
        Some(&before[before.rfind('"')? + 1..])
    };
    name().unwrap_or("kind")
}
