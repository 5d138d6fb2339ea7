//! A trace flown again: what each line supplies is read from it, and the line is then written anew and compared
//! byte by byte.

use std::fmt::{self, Write};
use std::str::FromStr;

use jcas_core::hash::Fnv1a;
use jcas_core::header::Phase;
use jcas_core::{Cell, Config, Error, Model, Scratch, StateMut};

use super::line::{self, CHECKSUM, FORMAT_VERSION, Header};
use super::recording::{Parts, hashes};
use crate::handle::Open;
use crate::status::{
    Fault, JCAS_ERROR_CORRUPT, JCAS_ERROR_DIFFERENT, JCAS_ERROR_INTERNAL, JCAS_ERROR_MODEL_MISMATCH,
};

/// Why a trace is not reproduced, at which line of the file; 0 for the whole of it.
pub(crate) struct Refusal<'t> {
    line: usize,
    why: Why<'t>,
}

enum Why<'t> {
    Whole,
    Form,
    Model,
    Kernel(Error),
    Config,
    Differs(&'t str),
    Internal,
}

impl Refusal<'_> {
    pub(crate) fn status(&self) -> Fault {
        Fault::Status(match self.why {
            Why::Whole | Why::Form | Why::Kernel(_) | Why::Config => JCAS_ERROR_CORRUPT,
            Why::Model => JCAS_ERROR_MODEL_MISMATCH,
            Why::Differs(_) => JCAS_ERROR_DIFFERENT,
            Why::Internal => JCAS_ERROR_INTERNAL,
        })
    }
}

impl fmt::Display for Refusal<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line > 0 {
            write!(out, "line {}: ", self.line)?;
        }
        match &self.why {
            Why::Whole => out.write_str("not a whole trace: must end with a checksum that fits"),
            Why::Form => out.write_str("not as jcas writes traces"),
            Why::Model => out.write_str("the simulation has another configuration"),
            Why::Kernel(error) => error.fmt(out),
            Why::Config => out.write_str("the configuration is not legal"),
            Why::Differs(field) => write!(out, "{field} differs from what is flown"),
            Why::Internal => out.write_str("a fault of the library itself"),
        }
    }
}

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
    whole().ok_or(Refusal {
        line: 0,
        why: Why::Whole,
    })
}

/// Sixteen digits.
fn hexadecimal(digits: &str) -> Option<u64> {
    let legal = digits.len() == 16 && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
    legal
        .then(|| u64::from_str_radix(digits, 16).ok())
        .flatten()
}

/// The first line, as far as it is not for comparison alone.
struct Told<'t> {
    version: u32,
    core_version: &'t str,
    config: Config,
    seed: u64,
    policy: &'t str,
    pilot: &'t str,
    line: &'t str,
}

/// A place in a trace.
#[derive(Clone)]
struct Reader<'t> {
    /// This line, whole.
    line: &'t str,
    /// What of it is still to be read.
    rest: &'t str,
    /// The lines after it.
    later: &'t str,
    number: usize,
}

impl<'t> Reader<'t> {
    fn new(trace: &'t str) -> Self {
        let mut reader = Self {
            line: "",
            rest: "",
            later: trace,
            number: 0,
        };
        reader.next_line();
        reader
    }

    fn next_line(&mut self) {
        let end = self.later.find('\n').map_or(self.later.len(), |at| at + 1);
        let (line, later) = self.later.split_at(end);
        self.line = line;
        self.rest = line;
        self.later = later;
        self.number += 1;
    }

    fn refuse(&self, why: Why<'t>) -> Refusal<'t> {
        Refusal {
            line: self.number,
            why,
        }
    }

    fn skip(&mut self, text: &str) -> Result<(), Why<'t>> {
        self.rest = self.rest.strip_prefix(text).ok_or(Why::Form)?;
        Ok(())
    }

    /// Up to a character, which stays.
    fn until(&mut self, stop: impl Fn(char) -> bool) -> Result<&'t str, Why<'t>> {
        let at = self.rest.find(stop).ok_or(Why::Form)?;
        let (text, rest) = self.rest.split_at(at);
        self.rest = rest;
        Ok(text)
    }

    fn number<T: FromStr>(&mut self) -> Result<T, Why<'t>> {
        let digits = |c: char| !matches!(c, '0'..='9' | '-' | '+' | '.' | 'e');
        self.until(digits)?.parse().map_err(|_| Why::Form)
    }

    /// What stands between quotes, with its escapes.
    fn text(&mut self) -> Result<&'t str, Why<'t>> {
        let mut escaped = false;
        let at = self.rest.find(|c| {
            let ends = c == '"' && !escaped;
            escaped = c == '\\' && !escaped;
            ends
        });
        let (text, rest) = self.rest.split_at(at.ok_or(Why::Form)?);
        self.rest = rest;
        Ok(text)
    }

    fn hex(&mut self) -> Result<u64, Why<'t>> {
        let (digits, rest) = self.rest.split_at_checked(16).ok_or(Why::Form)?;
        self.rest = rest;
        hexadecimal(digits).ok_or(Why::Form)
    }

    /// `[..]`: calls `each` before every element with its index.
    fn list(
        &mut self,
        mut each: impl FnMut(&mut Self, usize) -> Result<(), Why<'t>>,
    ) -> Result<usize, Why<'t>> {
        self.skip("[")?;
        let mut count = 0;
        while !self.rest.starts_with(']') {
            if count > 0 {
                self.skip(",")?;
            }
            each(self, count)?;
            count += 1;
        }
        self.skip("]")?;
        Ok(count)
    }

    /// As many elements as `out` has, or fewer; how many.
    fn fill<T>(
        &mut self,
        out: &mut [T],
        mut read: impl FnMut(&mut Self) -> Result<T, Why<'t>>,
    ) -> Result<usize, Why<'t>> {
        self.list(|reader, index| {
            *out.get_mut(index).ok_or(Why::Form)? = read(reader)?;
            Ok(())
        })
    }

    fn pair<T: FromStr>(&mut self) -> Result<[T; 2], Why<'t>> {
        self.skip("[")?;
        let first = self.number()?;
        self.skip(",")?;
        let second = self.number()?;
        self.skip("]")?;
        Ok([first, second])
    }

    fn cell(&mut self) -> Result<Cell, Why<'t>> {
        let [x, y] = self.pair()?;
        Ok(Cell { x, y })
    }

    fn header(&mut self) -> Result<Told<'t>, Refusal<'t>> {
        self.told().map_err(|why| self.refuse(why))
    }

    fn told(&mut self) -> Result<Told<'t>, Why<'t>> {
        self.skip("{\"kind\":\"header\",\"format\":\"jcas-trace\",\"format_version\":")?;
        let version = self.number()?;
        if !(1..=FORMAT_VERSION).contains(&version) {
            return Err(Why::Form);
        }
        self.skip(",\"core_version\":\"")?;
        let core_version = self.text()?;
        self.skip("\",\"config\":")?;
        let text = self.rest;
        let braced = self.until(|c| c == '}')?.len() + 1;
        let config = Config::from_json(&text[..braced]).map_err(|_| Why::Config)?;
        self.skip("},\"config_hash\":\"0x")?;
        self.hex()?;
        self.skip("\",\"seed\":\"0x")?;
        let seed = self.hex()?;
        self.skip("\",\"policy\":\"")?;
        let policy = self.text()?;
        self.skip("\",\"pilot\":\"")?;
        let pilot = self.text()?;
        Ok(Told {
            version,
            core_version,
            config,
            seed,
            policy,
            pilot,
            line: self.line,
        })
    }

    /// The actions of the next step in the file, from this line on.
    fn actions(&self, actions: &mut [f32]) -> Result<(), Why<'t>> {
        let mut ahead = self.clone();
        while !ahead.line.starts_with(STEP) {
            if ahead.later.is_empty() {
                return Err(Why::Form);
            }
            ahead.next_line();
        }
        ahead.rest = ahead.line;
        ahead.skip(STEP)?;
        ahead.number::<u32>()?;
        ahead.skip(",\"actions\":")?;
        let count = ahead.list(|reader, index| {
            let place = actions.get_mut(2 * index..2 * index + 2);
            place.ok_or(Why::Form)?.copy_from_slice(&reader.pair()?);
            Ok(())
        })?;
        expect(2 * count == actions.len())
    }
}

const STEP: &str = "{\"kind\":\"step\",\"t\":";

fn expect<'t>(legal: bool) -> Result<(), Why<'t>> {
    if legal { Ok(()) } else { Err(Why::Form) }
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
        let Self {
            model,
            words,
            scratch,
            parts,
        } = self;
        let state = model.state(words).map_err(Why::Kernel)?;
        let hashes = hashes(model, &state, words, scratch, parts.observations);
        let hashes = hashes.map_err(|_| Why::Internal)?;
        compare(reader.line, |out| {
            line::step(out, model, &state, parts.actions, hashes)
        })
    }

    fn compare_header<'t>(&mut self, told: &Told<'t>) -> Result<(), Why<'t>> {
        let Self {
            model,
            words,
            scratch,
            parts,
        } = self;
        let state = model.state(words).map_err(Why::Kernel)?;
        let hashes = hashes(model, &state, words, scratch, parts.observations);
        let hashes = hashes.map_err(|_| Why::Internal)?;
        let header = Header {
            version: told.version,
            core_version: &told.core_version,
            policy: &told.policy,
            pilot: &told.pilot,
            seed: told.seed,
        };
        compare(told.line, |out| header.write(out, model, &state, hashes))
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
            "step_sense_over" => {
                self.begin(reader)?;
                reader.skip("\"detections\":")?;
                self.matrix(reader, hotspots, false)?;
                self.act(|model, state, scratch, parts| {
                    model.step_sense_over(state, scratch, &parts.matrix[..uavs * hotspots])
                })
            }
            "step_communicate_over" => {
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
                    model.step_communicate_over(state, scratch, links, throughput)
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
