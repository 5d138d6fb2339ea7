//! A machine that makes random sequences of every public call, and judges each call.
//!
//! What a model checker does for a fleet of two, this does at length for fleets of any size: a call that is
//! accepted leaves a valid state, and after every whole step the state of the specification; a call that is
//! refused leaves every word as it was. Working memory is filled with rubbish before each call, so that a
//! call that reads it is noticed.
//!
//! A sequence is a list of words, each of which stands for one call, so that a failing sequence can be
//! made shorter word by word.

use crate::comparison;
use crate::sampling::{self, Dice};
use crate::specification::{Host, Position, Specification, World};
use jcas_core::header::Phase;
use jcas_core::{Cell, Error, Model, Scratch, StateMut};

/// What a sequence may do.
const CALLS: [Call; 32] = [
    Call::Step,
    Call::Step,
    Call::Step,
    Call::Step,
    Call::Fly,
    Call::Fly,
    Call::NextPart,
    Call::NextPart,
    Call::NextPart,
    Call::NextPart,
    Call::NextPart,
    Call::NextPart,
    Call::AnyPart,
    Call::Reset,
    Call::Save,
    Call::Load,
    Call::LoadDamaged,
    Call::NotANumber,
    Call::WrongLength,
    Call::SetPositions,
    Call::Ground,
    Call::ConfirmHotspot,
    Call::SenseOver,
    Call::SenseOver,
    Call::CommunicateOver,
    Call::CommunicateOver,
    Call::SetStarts,
    Call::SetHotspots,
    Call::SetBatteries,
    Call::SetBattery,
    Call::MoveHotspot,
    Call::MoveHotspot,
];

/// Kinds of calls.
pub const KINDS: usize = Call::CommunicateOver as usize + 1;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Call {
    Step,
    NextPart,
    AnyPart,
    Reset,
    Save,
    Load,
    LoadDamaged,
    NotANumber,
    WrongLength,
    SetPositions,
    Ground,
    ConfirmHotspot,
    SenseOver,
    SetStarts,
    SetHotspots,
    SetBatteries,
    SetBattery,
    MoveHotspot,
    /// Whole steps, and a reset where an episode is over.
    Fly,
    CommunicateOver,
}

/// What a sequence came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Whole steps, each counted once for every UAV.
    pub agent_steps: u64,
    /// Whole steps compared with the specification, counted likewise.
    pub compared: u64,
    /// Calls that were accepted, by kind.
    pub accepted: [u64; KINDS],
    /// Calls that were refused, by kind.
    pub refused: [u64; KINDS],
}

impl Tally {
    /// Adds another sequence's.
    pub fn add(&mut self, other: &Tally) {
        self.agent_steps += other.agent_steps;
        self.compared += other.compared;
        for kind in 0..KINDS {
            self.accepted[kind] += other.accepted[kind];
            self.refused[kind] += other.refused[kind];
        }
    }
}

/// What the specification knows of a state.
#[derive(Clone)]
struct Shadow {
    /// The state before the step under way; none in a sequence that is not compared, and once a host has
    /// moved UAVs after keeping some on the ground, until the next reset.
    world: Option<World>,
    /// The actions of that step.
    actions: Vec<(f32, f32)>,
    /// What the host owns of it so far.
    host: Host,
}

struct Machine<'m> {
    model: &'m Model<'m>,
    spec: Specification,
    words: Vec<u64>,
    scratch: Vec<u64>,
    /// Whether the specification flies along.
    compares: bool,
    /// A world to choose actions in where the specification does not know the present one.
    start: World,
    shadow: Shadow,
    saved: Option<(Vec<u8>, Shadow)>,
    tally: Tally,
}

/// Plays the calls that `calls` stand for on the model that `seed` stands for; with `compares`, every whole
/// step against the specification, which takes many times as long. Without, half of the fleets are larger.
///
/// # Errors
/// The first call that did not do what it must.
pub fn play(seed: u64, calls: &[u64], compares: bool) -> Result<Tally, String> {
    let mut dice = Dice::new(seed);
    let mut config = if dice.one_in(500) {
        sampling::large_configuration(&mut dice)
    } else {
        sampling::configuration(&mut dice)
    };
    if !compares && config.uav_count > 6 {
        config.uav_count = config.uav_count.max(dice.integer(7, 48));
    }
    let model = Model::new(config).map_err(|error| error.to_string())?;
    let spec = Specification::new(&config);
    let mut machine = Machine {
        words: vec![0; model.state_words()],
        scratch: vec![0; Scratch::words_for(&model)],
        shadow: Shadow {
            world: None,
            actions: Vec::new(),
            host: Host::default(),
        },
        saved: None,
        tally: Tally::default(),
        model: &model,
        compares,
        start: spec.reset(0),
        spec,
    };
    machine.reset(dice.bits());
    machine.check()?;
    for (index, &word) in calls.iter().enumerate() {
        let call = CALLS[(word % CALLS.len() as u64) as usize];
        machine
            .make(call, &mut Dice::new(word))
            .map_err(|why| format!("call {index}, {call:?}: {why}\n{config:?}"))?;
    }
    Ok(machine.tally)
}

impl Machine<'_> {
    fn phase(&self) -> Phase {
        let state = self.model.state(&self.words).expect("a state of the model");
        state.header.phase().expect("reset before")
    }

    /// Makes a call and judges it.
    fn make(&mut self, call: Call, dice: &mut Dice) -> Result<(), String> {
        let before = self.words.clone();
        let done = match call {
            Call::Step => self.step(dice),
            Call::NextPart => {
                let phase = self.phase();
                self.part(phase, dice)
            }
            Call::AnyPart => {
                let parts = [
                    Phase::Ready,
                    Phase::Moved,
                    Phase::Sensed,
                    Phase::Communicated,
                ];
                self.part(parts[dice.integer(0, 3) as usize], dice)
            }
            Call::Reset => {
                self.reset(dice.bits());
                Ok(())
            }
            Call::Save => self.save(),
            Call::Load => self.load(),
            Call::LoadDamaged => self.load_damaged(dice),
            Call::NotANumber => self.begin_with_a_nan(dice),
            Call::WrongLength => self.begin_with_another_length(dice),
            Call::SetPositions => self.set_positions(dice),
            Call::Ground => self.ground(dice),
            Call::ConfirmHotspot => self.confirm_hotspot(dice),
            Call::SenseOver => self.sense_over(dice),
            Call::CommunicateOver => self.communicate_over(dice),
            Call::SetStarts => self.set_starts(dice),
            Call::SetHotspots => self.set_hotspots(dice),
            Call::SetBatteries => self.set_batteries(dice),
            Call::SetBattery => self.set_battery(dice),
            Call::MoveHotspot => self.move_hotspot(dice),
            Call::Fly => self.fly(dice),
        };
        match done {
            Ok(()) => self.tally.accepted[call as usize] += 1,
            Err(Refusal::Refused) => {
                self.tally.refused[call as usize] += 1;
                if self.words != before {
                    return Err("refused, and the state is another".to_owned());
                }
            }
            Err(Refusal::Wrong(why)) => return Err(why),
        }
        self.check()
    }

    /// The state is valid, and the specification's where that has come as far.
    fn check(&self) -> Result<(), String> {
        let state = self
            .model
            .state(&self.words)
            .map_err(|error| error.to_string())?;
        comparison::equal("is_valid", true, state.is_valid(self.model))?;
        match (&self.shadow.world, self.phase()) {
            (None, _) | (_, Phase::Moved | Phase::Sensed | Phase::Communicated) => Ok(()),
            (Some(world), _) => comparison::states(&self.spec, world, &state),
        }
    }

    /// A call on the open state, with working memory full of rubbish.
    fn open<T>(
        &mut self,
        dice: &mut Dice,
        call: impl FnOnce(&Model<'_>, &mut StateMut<'_>, &mut Scratch<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let rubbish = dice.bits();
        for (index, word) in (1..).zip(&mut self.scratch) {
            *word = rubbish.wrapping_mul(2 * index + 1);
        }
        let mut scratch = Scratch::new(self.model, &mut self.scratch).expect("enough memory");
        let mut state = self.model.state_mut(&mut self.words)?;
        call(self.model, &mut state, &mut scratch)
    }

    fn reset(&mut self, seed: u64) {
        let mut scratch = Scratch::new(self.model, &mut self.scratch).expect("enough memory");
        self.model
            .reset(&mut self.words, &mut scratch, seed)
            .expect("memory of the right size");
        self.shadow.world = self.compares.then(|| self.spec.reset(seed));
        self.shadow.host = Host::default();
    }

    /// Flies on, whatever the phase.
    fn fly(&mut self, dice: &mut Dice) -> Done {
        for _ in 0..dice.integer(1, 60) {
            if self.phase().is_over() {
                self.reset(dice.bits());
            }
            if self.phase() == Phase::Ready {
                self.step(dice)?;
            } else {
                self.part(self.phase(), dice)?;
            }
            self.check().map_err(Refusal::Wrong)?;
        }
        Ok(())
    }

    /// Actions for the coming step, and the same as the kernel takes them.
    fn choose(&mut self, dice: &mut Dice) -> Vec<f32> {
        let pilot = sampling::pilot(dice);
        let world = self.shadow.world.as_ref().unwrap_or(&self.start);
        self.shadow.actions = sampling::actions(dice, pilot, &self.spec, world);
        let pairs = self.shadow.actions.iter();
        pairs.flat_map(|&(dir, density)| [dir, density]).collect()
    }

    fn step(&mut self, dice: &mut Dice) -> Done {
        let kept = self.shadow.actions.clone();
        let flat = self.choose(dice);
        let ready = self.phase() == Phase::Ready;
        match self.open(dice, |model, state, scratch| {
            model.step(state, scratch, &flat)
        }) {
            Ok(outcome) => self.ended(outcome.reward),
            Err(_) => {
                self.shadow.actions = kept;
                refused_if(!ready)
            }
        }
    }

    /// The part of a step that belongs to a phase.
    fn part(&mut self, part: Phase, dice: &mut Dice) -> Done {
        let in_order = self.phase() == part;
        let kept = self.shadow.actions.clone();
        let done = match part {
            Phase::Moved => self.open(dice, |model, state, scratch| {
                model.step_sense(state, scratch)
            }),
            Phase::Sensed => self.open(dice, |model, state, scratch| {
                model.step_communicate(state, scratch)
            }),
            Phase::Communicated => {
                let done = self.open(dice, |model, state, scratch| model.step_end(state, scratch));
                match done {
                    Ok(outcome) => return self.ended(outcome.reward),
                    Err(error) => Err(error),
                }
            }
            Phase::Ready | Phase::Terminated | Phase::Truncated => {
                let flat = self.choose(dice);
                self.open(dice, |model, state, _| model.step_begin(state, &flat))
            }
        };
        match done {
            Ok(()) => accepted_if(in_order && !part.is_over()),
            Err(_) => {
                self.shadow.actions = kept;
                refused_if(!in_order || part.is_over())
            }
        }
    }

    /// A step is whole: the specification makes it too.
    fn ended(&mut self, reward: f64) -> Done {
        let uavs = self.model.uav_count() as u64;
        self.tally.agent_steps += uavs;
        let host = std::mem::take(&mut self.shadow.host);
        if let Some(world) = &mut self.shadow.world {
            self.tally.compared += uavs;
            self.spec.step_with(world, &self.shadow.actions, &host);
            comparison::real("reward", world.rewards.sum(), reward).map_err(Refusal::Wrong)?;
        }
        Ok(())
    }

    fn save(&mut self) -> Done {
        let mut bytes = vec![0; self.model.save_len()];
        let saved = self.model.save(&self.words, &mut bytes);
        self.saved = Some((bytes, self.shadow.clone()));
        accepted_if(saved.is_ok())
    }

    fn load(&mut self) -> Done {
        let Some((bytes, shadow)) = self.saved.clone() else {
            return Err(Refusal::Refused);
        };
        let mut spare = vec![0; self.words.len()];
        let loaded = self.model.load(&bytes, &mut self.words, &mut spare);
        self.shadow = shadow;
        let mut again = vec![0; bytes.len()];
        let saved = self.model.save(&self.words, &mut again);
        accepted_if(loaded.is_ok() && saved.is_ok() && again == bytes)
    }

    /// A snapshot with one bit of it changed, cut or grown.
    fn load_damaged(&mut self, dice: &mut Dice) -> Done {
        let mut bytes = vec![0; self.model.save_len()];
        self.model
            .save(&self.words, &mut bytes)
            .map_err(|error| Refusal::Wrong(error.to_string()))?;
        match dice.integer(0, 3) {
            0 => bytes.truncate(dice.integer(0, bytes.len() as u32 - 1) as usize),
            1 => bytes.push(0),
            _ => {
                let place = dice.integer(0, bytes.len() as u32 - 1) as usize;
                bytes[place] ^= 1 << dice.integer(0, 7);
            }
        }
        let mut spare = vec![0; self.words.len()];
        refused_if(
            self.model
                .load(&bytes, &mut self.words, &mut spare)
                .is_err(),
        )
    }

    fn begin_with_a_nan(&mut self, dice: &mut Dice) -> Done {
        let mut flat = vec![0.0; self.model.action_len()];
        let place = dice.integer(0, flat.len() as u32 - 1) as usize;
        flat[place] = f32::NAN;
        let done = self.open(dice, |model, state, scratch| {
            model.step(state, scratch, &flat)
        });
        refused_if(done.is_err())
    }

    fn begin_with_another_length(&mut self, dice: &mut Dice) -> Done {
        let right = self.model.action_len();
        let len = dice.integer(0, 2 * right as u32) as usize;
        let flat = vec![0.0; if len == right { right + 1 } else { len }];
        let done = self.open(dice, |model, state, _| model.step_begin(state, &flat));
        refused_if(done.is_err())
    }

    /// Any cell, one time in ten off the grid.
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

    fn set_positions(&mut self, dice: &mut Dice) -> Done {
        let uavs = self.model.uav_count();
        let cells: Vec<Cell> = (0..uavs).map(|_| self.any_cell(dice)).collect();
        let legal = cells.iter().all(|&cell| self.on_grid(cell));
        let due = self.phase() == Phase::Moved;
        let done = self.open(dice, |model, state, _| model.set_positions(state, &cells));
        if done.is_ok() {
            self.shadow.host.positions = Some(cells.iter().copied().map(position).collect());
            // The specification keeps UAVs on the ground last, as the calls' documentation says to do.
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

    fn ground(&mut self, dice: &mut Dice) -> Done {
        let uavs = self.model.uav_count();
        let uav = Self::any_index(dice, uavs);
        let due = self.phase() == Phase::Moved;
        let done = self.open(dice, |model, state, _| model.ground(state, uav));
        if done.is_ok() {
            self.shadow.host.grounded.push(uav);
        }
        judge(&done, due && uav < uavs)
    }

    fn confirm_hotspot(&mut self, dice: &mut Dice) -> Done {
        let hotspots = self.model.hotspot_count();
        let hotspot = Self::any_index(dice, hotspots);
        let due = self.phase() == Phase::Moved;
        let done = self.open(dice, |model, state, _| {
            model.confirm_hotspot(state, hotspot)
        });
        if done.is_ok() {
            self.shadow.host.confirmed.push(hotspot);
        }
        judge(&done, due && hotspot < hotspots)
    }

    fn sense_over(&mut self, dice: &mut Dice) -> Done {
        let (uavs, hotspots) = (self.model.uav_count(), self.model.hotspot_count());
        let mut detections: Vec<u8> = (0..uavs * hotspots)
            .map(|_| u8::from(dice.one_in(3)))
            .collect();
        let legal = !dice.one_in(10);
        if !legal {
            detections.push(1);
        }
        let due = self.phase() == Phase::Moved;
        let done = self.open(dice, |model, state, scratch| {
            model.step_sense_over(state, scratch, &detections)
        });
        if done.is_ok() {
            let rows = detections.chunks(hotspots);
            let rows = rows.map(|row| row.iter().map(|&byte| byte != 0).collect());
            self.shadow.host.detections = Some(rows.collect());
        }
        judge(&done, due && legal)
    }

    fn communicate_over(&mut self, dice: &mut Dice) -> Done {
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
        let done = self.open(dice, |model, state, scratch| {
            model.step_communicate_over(state, scratch, &links, measured.as_deref())
        });
        if done.is_ok() {
            let rows = links.chunks(uavs);
            let rows = rows.map(|row| row.iter().map(|&byte| byte != 0).collect());
            self.shadow.host.links = Some(rows.collect());
            self.shadow.host.throughput = measured;
        }
        judge(&done, due && legal && !lopsided)
    }

    fn set_starts(&mut self, dice: &mut Dice) -> Done {
        let uavs = self.model.uav_count();
        let cells: Vec<Cell> = (0..uavs).map(|_| self.any_cell(dice)).collect();
        let legal = cells.iter().all(|&cell| self.on_grid(cell));
        let due = self.at_the_start();
        let done = self.open(dice, |model, state, scratch| {
            model.set_starts(state, scratch, &cells)
        });
        if let (Ok(()), Some(world)) = (&done, &mut self.shadow.world) {
            let starts: Vec<Position> = cells.iter().copied().map(position).collect();
            self.spec.set_starts(world, &starts);
        }
        judge(&done, due && legal)
    }

    fn set_hotspots(&mut self, dice: &mut Dice) -> Done {
        let count = self.model.hotspot_count();
        let mut cells: Vec<Cell> = Vec::new();
        // Often legal: a cell that would not be is drawn again a few times.
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
        let done = self.open(dice, |model, state, scratch| {
            model.set_hotspots(state, scratch, &cells)
        });
        if let (Ok(()), Some(world)) = (&done, &mut self.shadow.world) {
            world.hotspot = cells.iter().map(|&cell| position(cell)).collect();
        }
        judge(&done, due && legal)
    }

    fn set_batteries(&mut self, dice: &mut Dice) -> Done {
        let capacity = self.model.energy().capacity_uj;
        let mut charges: Vec<u64> = (0..self.model.uav_count())
            .map(|_| any_charge(dice, capacity))
            .collect();
        let legal = !dice.one_in(5);
        if !legal {
            charges[0] = capacity + 1;
        }
        let due = self.at_the_start();
        let done = self.open(dice, |model, state, scratch| {
            model.set_batteries(state, scratch, &charges)
        });
        if let (Ok(()), Some(world)) = (&done, &mut self.shadow.world) {
            self.spec.set_batteries(world, &charges);
        }
        judge(&done, due && legal)
    }

    fn set_battery(&mut self, dice: &mut Dice) -> Done {
        let (uavs, capacity) = (self.model.uav_count(), self.model.energy().capacity_uj);
        let uav = Self::any_index(dice, uavs);
        let charge = if dice.one_in(10) {
            capacity + 1
        } else {
            any_charge(dice, capacity)
        };
        let due = self.phase() == Phase::Ready;
        let done = self.open(dice, |model, state, scratch| {
            model.set_battery(state, scratch, uav, charge)
        });
        if let (Ok(()), Some(world)) = (&done, &mut self.shadow.world) {
            self.spec.set_battery(world, uav, charge);
        }
        judge(&done, due && uav < uavs && charge <= capacity)
    }

    fn move_hotspot(&mut self, dice: &mut Dice) -> Done {
        let hotspots = self.model.hotspot_count();
        let hotspot = Self::any_index(dice, hotspots);
        let cell = self.any_cell(dice);
        let state = self.model.state(&self.words).expect("a state of the model");
        let taken =
            (0..hotspots).any(|other| other != hotspot && state.hotspot_cell(other) == cell);
        let free = self.on_grid(cell) && !taken && !self.model.depots().contains(&cell);
        let due = self.phase() == Phase::Ready;
        let done = self.open(dice, |model, state, scratch| {
            model.move_hotspot(state, scratch, hotspot, cell)
        });
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

/// How a call ended, where not accepted.
enum Refusal {
    /// It was refused, as it should be.
    Refused,
    /// It did what it should not.
    Wrong(String),
}

type Done = Result<(), Refusal>;

fn accepted_if(right: bool) -> Done {
    if right {
        Ok(())
    } else {
        Err(Refusal::Wrong("not accepted as it should be".to_owned()))
    }
}

fn refused_if(right: bool) -> Done {
    if right {
        Err(Refusal::Refused)
    } else {
        Err(Refusal::Wrong("not refused as it should be".to_owned()))
    }
}

fn judge(done: &Result<(), Error>, legal: bool) -> Done {
    match done {
        Ok(()) => accepted_if(legal),
        Err(_) => refused_if(!legal),
    }
}

/// A charge of a battery, often none or all of it.
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
