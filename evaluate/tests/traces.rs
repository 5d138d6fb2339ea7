//! Traces under attack: whatever happens to a file, reading it ends in a trace or a typed error.

use jcas_core::rng::{self, Purpose};
use jcas_core::{Config, Model};
use jcas_evaluate::policy::{BaselineKind, PilotMode};
use jcas_evaluate::trace::{self, Trace, TraceError};

fn recorded(seed: u64) -> Vec<u8> {
    let model = Model::new(Config {
        uav_count: 4,
        hotspot_count: 2,
        horizon_steps: 12,
        ..Config::default()
    })
    .unwrap();
    let mut policy = BaselineKind::Random.build(&model, PilotMode::Mid).unwrap();
    let mut text = Vec::new();
    trace::record(&model, &mut policy, seed, &mut text).unwrap();
    text
}

fn read(bytes: &[u8]) -> Result<Trace, TraceError> {
    trace::read(bytes)
}

#[test]
fn no_changed_byte_goes_unnoticed() {
    let text = recorded(1);
    let honest = read(&text).unwrap();
    for trial in 0..2000 {
        let bits = rng::bits64(1, trial, 0, 0, Purpose::Policy);
        let mut changed = text.clone();
        let place = rng::below(bits, changed.len() as u64) as usize;
        changed[place] ^= 1 << (trial % 8);
        // Letters of the checksum itself may change their case without changing its value.
        if let Ok(same) = read(&changed) {
            assert_eq!(same, honest, "byte {place}");
            let digit = changed[place] as char;
            assert!(
                digit.is_ascii_hexdigit() && place > text.len() - 20,
                "byte {place}"
            );
        }
    }
}

#[test]
fn a_trace_cut_anywhere_is_truncated_or_no_trace() {
    let text = recorded(2);
    let header = text.iter().position(|&byte| byte == b'\n').unwrap();
    for length in (0..text.len()).step_by(7) {
        let error = read(&text[..length]).expect_err("a whole trace has every byte");
        match error {
            TraceError::Empty => assert!(length <= header),
            TraceError::Truncated { steps } => {
                let lines = text[..length].iter().filter(|&&byte| byte == b'\n').count();
                assert_eq!(steps, lines - 1);
            }
            other => panic!("cut at {length}: {other}"),
        }
    }
}

#[test]
fn bytes_that_are_no_text_are_refused_by_line() {
    let mut text = recorded(3);
    let second = text.iter().position(|&byte| byte == b'\n').unwrap() + 1;
    text[second + 3] = 0xff;
    assert_eq!(
        read(&text).unwrap_err().to_string(),
        "line 2: is not UTF-8 text"
    );
}

#[test]
fn the_first_difference_is_the_earliest_step_and_its_earliest_field() {
    let left = read(&recorded(4)).unwrap();
    let mut right = left.clone();
    right.steps[7].positions[2].x ^= 1;
    right.steps[5].co2_ng += 1;
    right.steps[5].knowledge[3] = vec![0, 1];
    let found = trace::diff(&left, &right).unwrap();
    assert_eq!((found.step, found.field.as_str()), (6, "knowledge[3]"));
    assert_eq!((found.left.as_str(), found.right.as_str()), ("[]", "[0,1]"));
    assert_eq!(found.to_string(), "step 6, knowledge[3]: [] against [0,1]");
}

#[test]
fn a_missing_step_is_a_difference_and_another_version_alone_is_none() {
    let left = read(&recorded(5)).unwrap();
    let mut right = left.clone();
    right.header.core_version = "9.9.9".to_owned();
    assert_eq!(trace::diff(&left, &right), None);
    assert_eq!(trace::verify(&right).unwrap(), None);
    right.steps.pop();
    let found = trace::diff(&left, &right).unwrap();
    assert_eq!((found.step, found.field.as_str()), (12, "t"));
    assert_eq!(
        (found.left.as_str(), found.right.as_str()),
        ("present", "absent")
    );
    // Flown again, such a trace has not come to its end.
    assert_eq!(trace::verify(&right).unwrap().unwrap().field, "steps");
}

#[test]
fn a_trace_of_an_impossible_configuration_is_refused_by_field() {
    let mut trace = read(&recorded(6)).unwrap();
    trace.header.config.quorum = 0;
    let told = trace::verify(&trace).unwrap_err().to_string();
    assert!(told.starts_with("quorum = 0: must be "), "{told}");
}
