//! A machine that makes random sequences of every public call, and judges each call.
//!
//! The model checker covers fleets of two UAVs; this machine samples fleets of every size. An
//! accepted call must leave a valid state, and a whole step the state of the specification. A
//! refused call must leave every word unchanged. Random words fill working memory before each call,
//! so a call that reads them is noticed.
//!
//! A sequence is a list of words, and each word stands for one call. So a failing sequence can be
//! shortened word by word.

use crate::comparison;
use crate::sampling::{self, Dice};
use crate::specification::{Host, Specification, World};
use jcas_core::header::Phase;
use jcas_core::{Error, Model, Scratch, StateMut};

mod host;

/// The kinds of calls that a sequence may make.
const CALLS: [CallKind; 32] = [
    CallKind::Step,
    CallKind::Step,
    CallKind::Step,
    CallKind::Step,
    CallKind::Fly,
    CallKind::Fly,
    CallKind::NextPart,
    CallKind::NextPart,
    CallKind::NextPart,
    CallKind::NextPart,
    CallKind::NextPart,
    CallKind::NextPart,
    CallKind::AnyPart,
    CallKind::Reset,
    CallKind::Save,
    CallKind::Load,
    CallKind::LoadDamaged,
    CallKind::NotANumber,
    CallKind::WrongLength,
    CallKind::SetPositions,
    CallKind::Ground,
    CallKind::ConfirmHotspot,
    CallKind::SenseWith,
    CallKind::SenseWith,
    CallKind::CommunicateWith,
    CallKind::CommunicateWith,
    CallKind::SetStarts,
    CallKind::SetHotspots,
    CallKind::SetBatteries,
    CallKind::SetBattery,
    CallKind::MoveHotspot,
    CallKind::MoveHotspot,
];

/// Kinds of calls.
pub const KINDS: usize = CallKind::CommunicateWith as usize + 1;

/// A kind of call, legal or not. The host's calls among them draw their arguments and make a
/// [`jcas_core::host::Call`]. The other kinds are no calls of a host.
#[derive(Clone, Copy, Debug, PartialEq)]
enum CallKind {
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
    SenseWith,
    SetStarts,
    SetHotspots,
    SetBatteries,
    SetBattery,
    MoveHotspot,
    /// Whole steps, and a reset where an episode is over.
    Fly,
    CommunicateWith,
}

/// Counts of a sequence.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Counts {
    /// Agent-steps: whole steps times UAVs.
    pub agent_steps: u64,
    /// Agent-steps that were compared with the specification.
    pub compared: u64,
    /// Compared agent-steps of fleets of eight UAVs and more.
    pub compared_from_eight: u64,
    /// Calls that were accepted, by kind.
    pub accepted: [u64; KINDS],
    /// Calls that were refused, by kind.
    pub refused: [u64; KINDS],
}

impl Counts {
    /// Counts a step that was compared with the specification.
    pub fn count_compared(&mut self, uavs: u64) {
        self.agent_steps += uavs;
        self.compared += uavs;
        if uavs >= 8 {
            self.compared_from_eight += uavs;
        }
    }

    /// Adds another sequence's.
    pub fn add(&mut self, other: &Counts) {
        self.agent_steps += other.agent_steps;
        self.compared += other.compared;
        self.compared_from_eight += other.compared_from_eight;
        for kind in 0..KINDS {
            self.accepted[kind] += other.accepted[kind];
            self.refused[kind] += other.refused[kind];
        }
    }
}

/// The specification's side of a state.
#[derive(Clone)]
struct Shadow {
    /// The state before the step under way. None once a host has moved UAVs after keeping some on
    /// the ground, until the next reset.
    world: Option<World>,
    /// The actions of that step.
    actions: Vec<(f32, f32)>,
    /// The host's values of that step so far.
    host: Host,
}

struct Machine<'m> {
    model: &'m Model<'m>,
    spec: Specification,
    words: Vec<u64>,
    scratch: Vec<u64>,
    /// A world for choosing actions while the specification does not know the present one.
    start: World,
    shadow: Shadow,
    saved: Option<(Vec<u8>, Shadow)>,
    counts: Counts,
}

/// Plays the calls that `calls` stand for on the model that `seed` stands for.
///
/// # Errors
/// Returns a description of the first call with a wrong result.
pub fn play(seed: u64, calls: &[u64]) -> Result<Counts, String> {
    let mut dice = Dice::new(seed);
    let config = if dice.one_in(500) {
        sampling::large_configuration(&mut dice)
    } else {
        sampling::configuration(&mut dice)
    };
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
        counts: Counts::default(),
        model: &model,
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
    Ok(machine.counts)
}

impl Machine<'_> {
    fn phase(&self) -> Phase {
        let state = self.model.state(&self.words).expect("a state of the model");
        state.header.phase().expect("reset before")
    }

    /// Makes a call and judges it.
    fn make(&mut self, call: CallKind, dice: &mut Dice) -> Result<(), String> {
        let before = self.words.clone();
        let done = match call {
            CallKind::Step => self.step(dice),
            CallKind::NextPart => {
                let phase = self.phase();
                self.part(phase, dice)
            }
            CallKind::AnyPart => {
                let parts = [
                    Phase::Ready,
                    Phase::Moved,
                    Phase::Sensed,
                    Phase::Communicated,
                ];
                self.part(parts[dice.integer(0, 3) as usize], dice)
            }
            CallKind::Reset => {
                self.reset(dice.bits());
                Ok(())
            }
            CallKind::Save => self.save(),
            CallKind::Load => self.load(),
            CallKind::LoadDamaged => self.load_damaged(dice),
            CallKind::NotANumber => self.begin_with_a_nan(dice),
            CallKind::WrongLength => self.begin_with_another_length(dice),
            CallKind::SetPositions => self.set_positions(dice),
            CallKind::Ground => self.ground(dice),
            CallKind::ConfirmHotspot => self.confirm_hotspot(dice),
            CallKind::SenseWith => self.sense_with(dice),
            CallKind::CommunicateWith => self.communicate_with(dice),
            CallKind::SetStarts => self.set_starts(dice),
            CallKind::SetHotspots => self.set_hotspots(dice),
            CallKind::SetBatteries => self.set_batteries(dice),
            CallKind::SetBattery => self.set_battery(dice),
            CallKind::MoveHotspot => self.move_hotspot(dice),
            CallKind::Fly => self.fly(dice),
        };
        match done {
            Ok(()) => self.counts.accepted[call as usize] += 1,
            Err(Refusal::Refused) => {
                self.counts.refused[call as usize] += 1;
                if self.words != before {
                    return Err("refused, and the state is another".to_owned());
                }
            }
            Err(Refusal::Wrong(why)) => return Err(why),
        }
        self.check()
    }

    /// Checks that the state is valid, and between steps equal to the specification's.
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

    /// Makes a call on the state, with working memory full of random words.
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
        self.shadow.world = Some(self.spec.reset(seed));
        self.shadow.host = Host::default();
    }

    /// Makes up to 60 whole steps or parts of steps, from any phase.
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

    /// Draws actions for the coming step, and returns them also in the kernel's form.
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

    /// Makes the part of a step that belongs to a phase.
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

    /// Makes a completed step in the specification too.
    fn ended(&mut self, reward: f64) -> Done {
        let uavs = self.model.uav_count() as u64;
        let host = std::mem::take(&mut self.shadow.host);
        let Some(world) = &mut self.shadow.world else {
            self.counts.agent_steps += uavs;
            return Ok(());
        };
        self.counts.count_compared(uavs);
        self.spec.step_with(world, &self.shadow.actions, &host);
        comparison::real("reward", world.rewards.sum(), reward).map_err(Refusal::Wrong)
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

    /// Loads a snapshot with one bit changed, or a shorter or longer one.
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
}

/// The outcome of a call that was not accepted.
enum Refusal {
    /// The call was refused, as it should be.
    Refused,
    /// The call had a wrong result.
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
