//! Batches: many environments of one model in one slab of memory, stepped together.
//!
//! A call steps the environments one after the other. To use several threads, give each thread a
//! part of the environments.
//!
//! ```
//! # #[cfg(feature = "alloc")] {
//! use jcas_core::batch::BatchOut;
//! use jcas_core::{Config, Model, Scratch};
//!
//! let model = Model::new(Config::default())?;
//! let seeds = [1, 2, 3, 4];
//! let mut states = vec![0; seeds.len() * model.state_words()];
//! let mut memory = vec![0; Scratch::words_for(&model)];
//! let mut scratch = Scratch::new(&model, &mut memory)?;
//! let rows = seeds.len() * model.uav_count();
//! let mut observations = vec![0.0; rows * model.observation_len()];
//! model.batch_reset(&mut states, &mut scratch, &seeds, &mut observations, &mut [])?;
//!
//! let actions = vec![0.0; seeds.len() * model.action_len()];
//! let (mut rewards, mut terminated, mut truncated) = ([0.0; 4], [0; 4], [0; 4]);
//! let mut out = BatchOut {
//!     observations: &mut observations,
//!     rewards: &mut rewards,
//!     terminated: &mut terminated,
//!     truncated: &mut truncated,
//!     ..BatchOut::default()
//! };
//! model.batch_step(&mut states, &mut scratch, &actions, true, &mut out)?;
//! assert!(rewards.iter().all(|reward| reward.is_finite()));
//! # }
//! # Ok::<(), jcas_core::Error>(())
//! ```

use crate::error::Error;
use crate::model::Model;
use crate::observation::{observe, observe_global, observe_inline};
use crate::rules::action;
use crate::rules::metrics::Metrics;
use crate::rules::reward::COMPONENTS;
use crate::state::header::{self, HeaderRef, Phase};
use crate::state::scratch::Scratch;
use crate::state::{StateMut, StateRef};
use crate::step::{self, StepOutcome};
use crate::words::rng::derive_seed;

/// Declares the outputs of a batch step once. Each has a name, a type, and a number of elements for
/// one environment; an optional one may be omitted.
macro_rules! batch_outputs {
    ($d:tt |$model:ident| $(
        $(#[doc = $doc:literal])+
        $rule:ident $name:ident: [$type:ty; $len:expr];
    )+) => {
        /// Output buffers of a batch step for M environments.
        ///
        /// Shapes are row-major with the environment first; an empty slice omits an optional
        /// output.
        #[derive(Debug, Default)]
        pub struct BatchOut<'a> {
            $( $(#[doc = $doc])+ pub $name: &'a mut [$type], )+
        }

        /// The number of elements of each output of a batch step for one environment.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct BatchLens {
            $(
                #[doc = concat!("Elements of [`BatchOut::", stringify!($name), "`].")]
                pub $name: usize,
            )+
        }

        impl BatchLens {
            /// The numbers for environments of a model.
            #[inline]
            #[must_use]
            pub const fn of($model: &Model<'_>) -> Self {
                Self { $( $name: $len, )+ }
            }
        }

        /// Passes the name and the type of each output of a batch step to another macro.
        #[macro_export]
        macro_rules! for_each_batch_output {
            ($d each:ident) => {
                $d each! { $( $name: $type; )+ }
            };
        }

        impl BatchOut<'_> {
            /// Checks the length of each buffer, for `count` environments.
            fn check(&self, lens: &BatchLens, count: usize) -> Result<(), Error> {
                $(
                    let omitted = is_optional!($rule) && self.$name.is_empty();
                    if !omitted && self.$name.len() != count * lens.$name {
                        return Err(Error::Length {
                            what: stringify!($name),
                            expected: count * lens.$name,
                            got: self.$name.len(),
                        });
                    }
                )+
                Ok(())
            }

            /// The buffers of environment `m`.
            #[inline(always)]
            fn environment(&mut self, m: usize, lens: &BatchLens) -> BatchOut<'_> {
                BatchOut { $( $name: part(self.$name, m, lens.$name), )+ }
            }
        }
    };
}

macro_rules! is_optional {
    (required) => {
        false
    };
    (optional) => {
        true
    };
}

batch_outputs! { $ |model|
    /// Observations, `[M][N][observation_len]`; see [`crate::observation::observe`].
    required observations: [f32; model.uav_count() * model.observation_len()];
    /// The team's reward of the step, `[M]`.
    required rewards: [f32; 1];
    /// 1 where the step terminated the episode, else 0; `[M]`.
    required terminated: [u8; 1];
    /// 1 where the step truncated the episode at the horizon, else 0; `[M]`.
    required truncated: [u8; 1];
    /// Global states, `[M][global_len]`; optional.
    optional global: [f32; model.global_len()];
    /// Components of the team's reward, `[M][12]`, in the order of [`crate::rules::reward::NAMES`];
    /// optional.
    optional components: [f64; COMPONENTS];
    /// Last observations of the episodes that were reset, `[M][N][observation_len]`; optional.
    /// Other rows do not change.
    optional final_observations: [f32; model.uav_count() * model.observation_len()];
    /// Last global states of the episodes that were reset, `[M][global_len]`; optional. Other rows
    /// do not change.
    optional final_global: [f32; model.global_len()];
    /// Summaries of the episodes that ended, `[M]`; optional. Other entries do not change.
    optional final_metrics: [Metrics; 1];
    /// Each UAV's own reward, `[M][N]`; optional. The mean over the fleet is the team's reward.
    optional uav_rewards: [f32; model.uav_count()];
    /// Components of each UAV's own reward, `[M][N][12]`; optional.
    optional uav_components: [f64; model.uav_count() * COMPONENTS];
}

/// The part of a buffer that belongs to environment `m`; empty if the buffer is empty.
#[inline(always)]
fn part<T>(buffer: &mut [T], m: usize, len: usize) -> &mut [T] {
    if buffer.is_empty() {
        buffer
    } else {
        &mut buffer[m * len..(m + 1) * len]
    }
}

impl Model<'_> {
    /// Number of environments M in a slab of words.
    ///
    /// # Errors
    /// [`Error::Length`] unless the length of `states` is a multiple of [`Model::state_words`].
    pub fn batch_len(&self, states: &[u64]) -> Result<usize, Error> {
        let count = states.len() / self.state_words();
        if count * self.state_words() == states.len() {
            Ok(count)
        } else {
            Err(Error::Length {
                what: "batch memory",
                expected: (count + 1) * self.state_words(),
                got: states.len(),
            })
        }
    }

    /// Begins an episode in each environment and writes the observations.
    ///
    /// `seeds` is `[M]`, `observations` is `[M][N][observation_len]`, and `global` is
    /// `[M][global_len]` or empty.
    ///
    /// # Errors
    /// [`Error::Length`] for a buffer of the wrong length; nothing changes then.
    pub fn batch_reset(
        &self,
        states: &mut [u64],
        scratch: &mut Scratch<'_>,
        seeds: &[u64],
        observations: &mut [f32],
        global: &mut [f32],
    ) -> Result<(), Error> {
        let count = self.batch_len(states)?;
        let observation_len = self.uav_count() * self.observation_len();
        let lengths = [
            ("seeds", seeds.len(), count),
            ("observations", observations.len(), count * observation_len),
            (
                "global",
                global.len(),
                if global.is_empty() {
                    0
                } else {
                    count * self.global_len()
                },
            ),
        ];
        for (what, got, expected) in lengths {
            if got != expected {
                return Err(Error::Length {
                    what,
                    expected,
                    got,
                });
            }
        }
        for (m, words) in states.chunks_exact_mut(self.state_words()).enumerate() {
            self.reset(words, scratch, seeds[m])?;
            let state = self.state(words)?;
            observe(
                self,
                &state,
                scratch,
                part(observations, m, observation_len),
            )?;
            if !global.is_empty() {
                observe_global(self, &state, part(global, m, self.global_len()))?;
            }
        }
        Ok(())
    }

    /// Steps every environment once and writes the observations.
    ///
    /// `actions` is `[M][N][2]`; [`Model::step`] describes the two components, which are clipped to
    /// [−1, 1].
    ///
    /// With `auto_reset`, an environment whose episode ends starts the next episode at once, with a
    /// seed derived from the last one. `observations` then holds the first observation of the new
    /// episode, and `final_observations` the last of the old one. Without `auto_reset`, an
    /// environment whose episode has ended refuses the next step.
    ///
    /// # Errors
    /// - [`Error::Length`] for a buffer of the wrong length.
    /// - [`Error::ActionNan`], whose UAV is counted over the whole batch.
    /// - [`Error::EpisodeOver`], [`Error::OutOfOrder`] or [`Error::ModelMismatch`] of the first
    ///   environment that refuses.
    ///
    /// All environments are checked before the first one steps, so that nothing changes then.
    pub fn batch_step(
        &self,
        states: &mut [u64],
        scratch: &mut Scratch<'_>,
        actions: &[f32],
        auto_reset: bool,
        out: &mut BatchOut<'_>,
    ) -> Result<(), Error> {
        self.batch_step_inline(states, scratch, actions, auto_reset, out)
    }

    /// Does the same as [`Model::batch_step`], compiled into its caller and so for the caller's
    /// instruction set.
    ///
    /// # Errors
    /// The errors of [`Model::batch_step`].
    #[inline(always)]
    pub fn batch_step_inline(
        &self,
        states: &mut [u64],
        scratch: &mut Scratch<'_>,
        actions: &[f32],
        auto_reset: bool,
        out: &mut BatchOut<'_>,
    ) -> Result<(), Error> {
        let (count, lens) = (self.batch_len(states)?, BatchLens::of(self));
        out.check(&lens, count)?;
        self.check_batch(states, actions, count)?;
        let actions = actions.chunks_exact(self.action_len());
        let environments = states.chunks_exact_mut(self.state_words()).zip(actions);
        for (m, (words, actions)) in environments.enumerate() {
            let out = out.environment(m, &lens);
            self.step_one(words, scratch, actions, auto_reset, out)?;
        }
        Ok(())
    }

    /// Does the same as [`Model::step`], compiled into its caller and so for the caller's
    /// instruction set.
    ///
    /// # Errors
    /// The errors of [`Model::step`].
    #[inline(always)]
    pub fn step_inline(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
        actions: &[f32],
    ) -> Result<StepOutcome, Error> {
        step::step_inline(self, state, scratch, actions)
    }

    /// Gives a state another seed, from which all further draws follow. What was drawn before
    /// stays, such as the hotspots and the carbon intensity of the coming step.
    ///
    /// # Errors
    /// The errors of [`Model::state`].
    pub fn reseed(&self, words: &mut [u64], seed: u64) -> Result<(), Error> {
        self.state_mut(words)?.header.set_seed(seed);
        Ok(())
    }

    #[inline(always)]
    pub(crate) fn check_batch(
        &self,
        states: &[u64],
        actions: &[f32],
        count: usize,
    ) -> Result<(), Error> {
        if actions.len() != count * self.action_len() {
            return Err(Error::Length {
                what: "actions",
                expected: count * self.action_len(),
                got: actions.len(),
            });
        }
        action::refuse_nan(actions)?;
        for words in states.chunks_exact(self.state_words()) {
            let header = HeaderRef(&words[..header::WORDS]);
            if header.config_hash() != self.config_hash() {
                return Err(Error::ModelMismatch);
            }
            match header.phase() {
                None => return Err(Error::ModelMismatch),
                Some(Phase::Ready) => {}
                Some(phase) if phase.is_over() => return Err(Error::EpisodeOver),
                _ => {
                    return Err(Error::OutOfOrder {
                        called: "batch_step",
                        after: "step_end",
                    });
                }
            }
        }
        Ok(())
    }

    /// Steps one environment, whose outputs are `out`.
    #[inline(always)]
    fn step_one(
        &self,
        words: &mut [u64],
        scratch: &mut Scratch<'_>,
        actions: &[f32],
        auto_reset: bool,
        out: BatchOut<'_>,
    ) -> Result<(), Error> {
        let mut state = StateMut::split(*self.layout(), words);
        let outcome = step::step_inline(self, &mut state, scratch, actions)?;
        out.rewards[0] = outcome.reward as f32;
        out.terminated[0] = u8::from(outcome.terminated);
        out.truncated[0] = u8::from(outcome.truncated);
        let mut state = state.as_ref();
        if !out.components.is_empty() {
            out.components.copy_from_slice(&state.rewards());
        }
        if !out.uav_rewards.is_empty() {
            state.write_uav_rewards(out.uav_rewards);
        }
        for (i, row) in out.uav_components.chunks_exact_mut(COMPONENTS).enumerate() {
            row.copy_from_slice(&state.uav_rewards(i));
        }
        if outcome.terminated || outcome.truncated {
            if !out.final_metrics.is_empty() {
                out.final_metrics[0] = state.metrics();
            }
            if auto_reset {
                if !out.final_observations.is_empty() {
                    observe(self, &state, scratch, out.final_observations)?;
                }
                if !out.final_global.is_empty() {
                    observe_global(self, &state, out.final_global)?;
                }
                let next = derive_seed(state.seed(), 0);
                self.reset(words, scratch, next)?;
                state = StateRef::split(*self.layout(), words);
            }
        }
        observe_inline(self, &state, scratch, out.observations)?;
        if !out.global.is_empty() {
            observe_global(self, &state, out.global)?;
        }
        Ok(())
    }
}
