//! Random sequences of calls through the ABI, beside the same calls of the kernel.
//!
//! This test catches a call that only one of the ABI and the kernel accepts, and a refused call
//! that changes a state. It also catches an invalid snapshot that is accepted, and a panic. It runs
//! a bounded number of sequences. A longer run is `PROPTEST_CASES=100000 cargo test --release -p
//! jcas-tests --test abi_sequences`.

use std::ptr::{null, null_mut};

use jcas::*;
use jcas_core::{Cell, Config, Model, Sim, hash};
use jcas_verification::sampling::{SEAMS, UAVS_MAX};
use proptest::prelude::*;

/// A call with arguments that may be wrong. It owns them, since proptest shortens them, and C has
/// no counterpart of the kernel's `host::Call`.
#[derive(Clone, Debug)]
enum Call {
    Reset(u64),
    Step(Vec<f32>),
    Begin(Vec<f32>),
    Positions(Vec<(u32, u32)>),
    Sense,
    Communicate,
    CommunicateWith(Vec<u8>, Option<Vec<f64>>),
    End,
    Hotspots(Vec<(u32, u32)>),
    Batteries(Vec<u64>),
    Save,
    LoadSaved,
    /// Loads the saved bytes with some of them changed, with or without the matching checksum.
    LoadChanged(Vec<(u16, u8)>, bool),
    LoadCut(u16),
    LoadBytes(Vec<u8>),
    /// A fork replaces the simulation.
    Fork,
}

const HOTSPOTS: usize = 2;

const WIDTH: u32 = 5;
const HEIGHT: u32 = 4;

fn config(uavs: usize) -> Config {
    Config {
        grid_width: WIDTH,
        grid_height: HEIGHT,
        uav_count: uavs as u32,
        hotspot_count: HOTSPOTS as u32,
        horizon_steps: 6,
        quorum: 2,
        radar_cross_section_dbsm: 20.0,
        battery_capacity_kwh: 0.003,
        link_throughput_min: 1.2,
        rtb_threshold_kwh: 0.001,
        ..Config::default()
    }
}

/// A number of elements, which is correct in most cases.
fn about(count: usize) -> impl Strategy<Value = usize> {
    prop_oneof![12 => Just(count), 1 => Just(count - 1), 1 => Just(count + 1), 1 => Just(0)]
}

/// Valid values; in one list of ten, an invalid value replaces one of them.
fn several<T: std::fmt::Debug + Clone>(
    good: impl Strategy<Value = T> + Clone,
    bad: impl Strategy<Value = T>,
    count: usize,
) -> impl Strategy<Value = Vec<T>> {
    let values =
        about(count).prop_flat_map(move |count| prop::collection::vec(good.clone(), count));
    let one_bad = prop::option::weighted(0.1, (any::<prop::sample::Index>(), bad));
    (values, one_bad).prop_map(|(mut values, one_bad)| {
        if let Some((place, bad)) = one_bad
            && !values.is_empty()
        {
            let place = place.index(values.len());
            values[place] = bad;
        }
        values
    })
}

fn actions(uavs: usize) -> impl Strategy<Value = Vec<f32>> {
    let bad = prop_oneof![Just(f32::NAN), Just(f32::INFINITY), any::<f32>()];
    several(-1.2f32..1.2, bad, 2 * uavs)
}

fn cells(count: usize) -> impl Strategy<Value = Vec<(u32, u32)>> {
    several((0..WIDTH, 0..HEIGHT), any::<(u32, u32)>(), count)
}

fn charges(uavs: usize) -> impl Strategy<Value = Vec<u64>> {
    several(0u64..=10_800_000_000, any::<u64>(), uavs)
}

fn links(uavs: usize) -> impl Strategy<Value = Vec<u8>> {
    let pairs = uavs * (uavs - 1) / 2;
    let symmetric = prop::collection::vec(any::<bool>(), pairs).prop_map(move |pair| {
        let mut links = vec![0; uavs * uavs];
        let places = (0..uavs).flat_map(|i| (0..i).map(move |k| (i, k)));
        for ((i, k), linked) in places.zip(pair) {
            links[i * uavs + k] = u8::from(linked);
            links[k * uavs + i] = 7 * u8::from(linked);
        }
        links
    });
    prop_oneof![8 => symmetric, 1 => several(0u8..2, any::<u8>(), uavs * uavs)]
}

fn call(uavs: usize) -> impl Strategy<Value = Call> {
    prop_oneof![
        1 => any::<u64>().prop_map(Call::Reset),
        8 => actions(uavs).prop_map(Call::Step),
        8 => actions(uavs).prop_map(Call::Begin),
        3 => cells(uavs).prop_map(Call::Positions),
        8 => Just(Call::Sense),
        4 => Just(Call::Communicate),
        6 => (links(uavs), prop::option::of(several(0.0f64..3.0, any::<f64>(), uavs)))
            .prop_map(|(links, throughput)| Call::CommunicateWith(links, throughput)),
        8 => Just(Call::End),
        1 => cells(HOTSPOTS).prop_map(Call::Hotspots),
        1 => charges(uavs).prop_map(Call::Batteries),
        2 => Just(Call::Save),
        1 => Just(Call::LoadSaved),
        3 => (prop::collection::vec(any::<(u16, u8)>(), 1..4), any::<bool>())
            .prop_map(|(changes, mended)| Call::LoadChanged(changes, mended)),
        1 => any::<u16>().prop_map(Call::LoadCut),
        1 => prop::collection::vec(any::<u8>(), 0..64).prop_map(Call::LoadBytes),
        1 => Just(Call::Fork),
    ]
}

/// A fleet with calls that fit it; two sizes in three are at a boundary of an implementation.
fn sequence() -> impl Strategy<Value = (usize, Vec<Call>)> {
    let size = prop_oneof![2 => prop::sample::select(&SEAMS[..]), 1 => 1..=UAVS_MAX];
    size.prop_flat_map(|uavs| {
        let uavs = uavs as usize;
        // A call to a large fleet takes as long as many calls to a small one.
        let most = 60.min(20 + 400 / uavs);
        (Just(uavs), prop::collection::vec(call(uavs), 1..most))
    })
}

/// Two copies of a simulation: one through the ABI, one in the kernel.
struct Pair<'m> {
    model: *mut jcas_model,
    sim: *mut jcas_sim,
    kernel: Sim<'m>,
    saved: Vec<u8>,
}

impl<'m> Pair<'m> {
    fn new(model: &'m Model<'m>) -> Self {
        let text = serde_json::to_string(model.config()).expect("a configuration is a record");
        let mut config = std::mem::MaybeUninit::<jcas_config>::uninit();
        let (mut c_model, mut sim) = (null_mut(), null_mut());
        // SAFETY: the text and the places have these sizes; no message is requested.
        unsafe {
            let size = size_of::<jcas_config>();
            let text = (text.as_ptr().cast(), text.len());
            ok(jcas_config_from_json(
                text.0,
                text.1,
                config.as_mut_ptr(),
                size,
                null_mut(),
                0,
            ));
            ok(jcas_model_new(
                config.as_ptr(),
                &raw mut c_model,
                null_mut(),
                0,
            ));
            ok(jcas_sim_new(c_model, &raw mut sim));
        }
        let kernel = Sim::new(model);
        let saved = kernel.save();
        Self {
            model: c_model,
            sim,
            kernel,
            saved,
        }
    }

    fn state_hash(&self) -> u64 {
        let mut hash = 0;
        // SAFETY: the simulation is valid.
        ok(unsafe { jcas_sim_hash(self.sim, &raw mut hash) });
        hash
    }

    /// The bytes that a call loads.
    fn snapshot(&self, call: &Call) -> Vec<u8> {
        let mut bytes = self.saved.clone();
        match call {
            Call::LoadChanged(changes, mended) => {
                for (at, bits) in changes {
                    let at = *at as usize % bytes.len();
                    bytes[at] ^= bits;
                }
                if *mended {
                    let content = bytes.len() - 8;
                    let mut checksum = hash::Fnv1a::new();
                    checksum.write(&bytes[..content]);
                    bytes[content..].copy_from_slice(&checksum.finish().to_le_bytes());
                }
            }
            Call::LoadCut(length) => bytes.truncate(*length as usize % bytes.len()),
            Call::LoadBytes(other) => bytes.clone_from(other),
            _ => {}
        }
        bytes
    }

    /// Makes a call both ways and returns whether each side accepted it.
    fn make(&mut self, call: &Call) -> (i32, bool) {
        let sim = self.sim;
        // SAFETY (of this function): the simulation and the buffers' lengths are valid.
        match call {
            Call::Reset(seed) => {
                self.kernel.reset(*seed);
                (unsafe { jcas_sim_reset(sim, *seed) }, true)
            }
            Call::Step(actions) => self.step(actions),
            Call::Begin(actions) => {
                let (data, count) = (actions.as_ptr(), actions.len());
                let begun = self.kernel.step_begin(actions).is_ok();
                (unsafe { jcas_sim_step_begin(sim, data, count) }, begun)
            }
            Call::Positions(cells) => {
                let (cells, kernel) = both(cells);
                let set = self.kernel.set_positions(&kernel).is_ok();
                (
                    unsafe { jcas_sim_set_positions(sim, cells.as_ptr(), cells.len()) },
                    set,
                )
            }
            Call::Sense => {
                let sensed = self.kernel.step_sense().is_ok();
                (unsafe { jcas_sim_step_sense(sim) }, sensed)
            }
            Call::Communicate => {
                let done = self.kernel.step_communicate().is_ok();
                (unsafe { jcas_sim_step_communicate(sim) }, done)
            }
            Call::CommunicateWith(links, throughput) => {
                self.communicate_with(links, throughput.as_deref())
            }
            Call::End => {
                let mut outcome = empty_outcome();
                let ended = self.kernel.step_end().is_ok();
                (unsafe { jcas_sim_step_end(sim, &raw mut outcome) }, ended)
            }
            Call::Hotspots(cells) => {
                let (cells, kernel) = both(cells);
                let set = self.kernel.set_hotspots(&kernel).is_ok();
                (
                    unsafe { jcas_sim_set_hotspots(sim, cells.as_ptr(), cells.len()) },
                    set,
                )
            }
            Call::Batteries(charges) => {
                let set = self.kernel.set_batteries(charges).is_ok();
                (
                    unsafe { jcas_sim_set_batteries(sim, charges.as_ptr(), charges.len()) },
                    set,
                )
            }
            Call::Save => self.save(),
            Call::LoadSaved | Call::LoadChanged(..) | Call::LoadCut(_) | Call::LoadBytes(_) => {
                let bytes = self.snapshot(call);
                let loaded = self.kernel.load(&bytes).is_ok();
                (
                    unsafe { jcas_sim_load(sim, bytes.as_ptr().cast(), bytes.len()) },
                    loaded,
                )
            }
            Call::Fork => self.fork(),
        }
    }

    fn step(&mut self, actions: &[f32]) -> (i32, bool) {
        let stepped = self.kernel.step(actions);
        let mut outcome = empty_outcome();
        // SAFETY: the simulation and the buffer's length are valid.
        let status =
            unsafe { jcas_sim_step(self.sim, actions.as_ptr(), actions.len(), &raw mut outcome) };
        if let Ok(stepped) = stepped {
            assert_eq!(stepped.reward.to_bits(), outcome.reward.to_bits());
            assert_eq!(u32::from(stepped.terminated), outcome.terminated);
            assert_eq!(u32::from(stepped.truncated), outcome.truncated);
        }
        (status, stepped.is_ok())
    }

    fn communicate_with(&mut self, links: &[u8], throughput: Option<&[f64]>) -> (i32, bool) {
        let done = self.kernel.step_communicate_with(links, throughput).is_ok();
        let (data, count) =
            throughput.map_or((null(), 0), |values| (values.as_ptr(), values.len()));
        // SAFETY: the simulation and the buffers' lengths are valid.
        let status = unsafe {
            jcas_sim_step_communicate_with(self.sim, links.as_ptr(), links.len(), data, count)
        };
        (status, done)
    }

    fn save(&mut self) -> (i32, bool) {
        self.saved = self.kernel.save();
        let mut bytes = vec![0u8; self.saved.len()];
        // SAFETY: the simulation and the buffer's length are valid.
        let status = unsafe { jcas_sim_save(self.sim, bytes.as_mut_ptr().cast(), bytes.len()) };
        assert_eq!(bytes, self.saved);
        (status, true)
    }

    /// Goes on with a copy in place of the C simulation.
    fn fork(&mut self) -> (i32, bool) {
        let mut twin = null_mut();
        // SAFETY: the model and the simulation are valid.
        let statuses = unsafe {
            [
                jcas_sim_new(self.model, &raw mut twin),
                jcas_sim_fork(self.sim, twin),
                jcas_sim_free(self.sim),
            ]
        };
        self.sim = twin;
        (statuses.into_iter().min().unwrap_or(JCAS_OK), true)
    }
}

fn empty_outcome() -> jcas_outcome {
    jcas_outcome {
        struct_size: size_of::<jcas_outcome>() as u32,
        terminated: 0,
        truncated: 0,
        false_confirmations: 0,
        reward: 0.0,
    }
}

impl Drop for Pair<'_> {
    fn drop(&mut self) {
        // SAFETY: the handles are valid and not used afterwards.
        unsafe {
            ok(jcas_sim_free(self.sim));
            ok(jcas_model_free(self.model));
        }
    }
}

fn both(cells: &[(u32, u32)]) -> (Vec<jcas_cell>, Vec<Cell>) {
    let c = cells.iter().map(|&(x, y)| jcas_cell { x, y }).collect();
    (c, cells.iter().map(|&(x, y)| Cell { x, y }).collect())
}

fn ok(status: i32) {
    assert_eq!(status, JCAS_OK);
}

proptest! {
    #[test]
    fn any_sequence_of_calls_is_what_the_kernel_does((uavs, calls) in sequence()) {
        let model = Model::new(config(uavs)).expect("a legal configuration");
        let mut pair = Pair::new(&model);
        for call in &calls {
            let before = pair.state_hash();
            let (status, accepted) = pair.make(call);
            prop_assert_eq!(status == JCAS_OK, accepted, "{:?} gave {}", call, status);
            prop_assert_ne!(status, JCAS_ERROR_INTERNAL);
            let after = pair.state_hash();
            prop_assert_eq!(after, pair.kernel.state_hash());
            if status != JCAS_OK {
                prop_assert_eq!(after, before, "{:?} was refused, yet changed the state", call);
            }
            prop_assert!(pair.kernel.state().is_valid(&model));
        }
    }
}
