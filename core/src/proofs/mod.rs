//! The kernel's proofs.
//!
//! A property is a function of its inputs that asserts. Its harness asks for any
//! inputs within a bound. `cargo kani` then shows the property for all of them.
//! Without Kani, `cargo test` runs the same harness on random inputs (`standin`).
//! What each one claims, and on which assumptions, is in `verification/proofs.toml`.

/// Any model, over tables that the harness holds; or any words as the working memory of a model's
/// steps.
macro_rules! given {
    ($model:ident) => {
        given!($model = any_model);
    };
    ($model:ident = $any:ident) => {
        let mut tables = [0; $crate::model::any_model::TABLE_WORDS];
        let $model = $crate::model::any_model::$any(&mut tables);
    };
    ($scratch:ident for $model:ident) => {
        let mut words: [u64; $crate::proofs::state::SCRATCH_WORDS] = kani::any();
        let mut $scratch = $crate::state::scratch::Scratch::new(&$model, &mut words)
            .ok()
            .unwrap();
    };
}

pub(crate) mod inputs;
#[cfg(not(kani))]
pub(crate) mod standin;

mod action;
mod alarms;
mod carbon;
mod communication;
mod curves;
mod energy;
mod fleet;
mod host;
mod knowledge;
mod lanes;
mod motion;
mod refusal;
mod reports;
mod reset;
mod reward;
mod rng;
mod search;
mod snapshot;
mod state;
mod step;
#[cfg(kani)]
mod stubs;
mod tables;
