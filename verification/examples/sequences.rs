//! Random sequences of every public call, until so many agent-steps are made:
//!
//! ```console
//! $ cargo run --release -p jcas-verification --example sequences -- 1e9 out/sequences.txt
//! ```
//!
//! The file holds how far it has come; the same command goes on from there. One sequence in 64 is flown
//! against the specification, the others with fleets of up to 48; all are judged call by call. A failing sequence is made shorter, printed and
//! ends the run.

use jcas_verification::machine::{Tally, play};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestRng, TestRunner};
use std::cell::RefCell;
use std::path::Path;

/// Sequences between two notes of how far it has come.
const SEQUENCES: u32 = 500;

fn main() -> Result<(), String> {
    let mut arguments = std::env::args().skip(1);
    let usage = "usage: sequences <agent-steps> <file>";
    let wanted: f64 = arguments
        .next()
        .and_then(|text| text.parse().ok())
        .ok_or(usage)?;
    let path = arguments.next().ok_or(usage)?;
    let path = Path::new(&path);
    let (mut batch, mut agent_steps, mut compared) = read(path)?;
    while (agent_steps as f64) < wanted {
        let tally = play_batch(batch)?;
        batch += 1;
        agent_steps += tally.agent_steps;
        compared += tally.compared;
        write(path, batch, agent_steps, compared)?;
    }
    println!("{agent_steps} agent-steps, {compared} of them compared with the specification");
    Ok(())
}

/// One batch of sequences; which ones follows from its number.
fn play_batch(batch: u64) -> Result<Tally, String> {
    let mut seed = [0; 32];
    seed[..8].copy_from_slice(&batch.to_le_bytes());
    let config = Config {
        cases: SEQUENCES,
        failure_persistence: None,
        ..Config::default()
    };
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &seed);
    let mut runner = TestRunner::new_with_rng(config, rng);
    let tally = RefCell::new(Tally::default());
    let sequence = (any::<u64>(), prop::collection::vec(any::<u64>(), 0..400));
    let outcome = runner.run(&sequence, |(seed, calls)| {
        let compares = seed % 64 == 0;
        let one = play(seed, &calls, compares).map_err(TestCaseError::fail)?;
        tally.borrow_mut().add(&one);
        Ok(())
    });
    outcome.map_err(|failure| format!("batch {batch}: {failure}"))?;
    Ok(tally.into_inner())
}

/// The batch that comes next, and what was done before.
fn read(path: &Path) -> Result<(u64, u64, u64), String> {
    let Ok(text) = std::fs::read_to_string(path) else {
        return Ok((0, 0, 0));
    };
    let numbers: Vec<u64> = text
        .split_whitespace()
        .filter_map(|word| word.parse().ok())
        .collect();
    match numbers[..] {
        [batch, agent_steps, compared] => Ok((batch, agent_steps, compared)),
        _ => Err(format!("{} is not of this program", path.display())),
    }
}

fn write(path: &Path, batch: u64, agent_steps: u64, compared: u64) -> Result<(), String> {
    let text = format!("batches {batch} agent-steps {agent_steps} compared {compared}\n");
    let partial = path.with_extension("partial");
    std::fs::write(&partial, text)
        .and_then(|()| std::fs::rename(&partial, path))
        .map_err(|error| format!("{}: {error}", path.display()))
}
