//! Corrupted traces: reading any changed file ends in a trace or a typed error.

use jcas_core::hash::Fnv1a;
use jcas_core::host::Call;
use jcas_core::rng::{self, Purpose};
use jcas_core::{Cell, Config, Model};
use jcas_episode::trace::{self, CHECKSUM, EpisodeRecorder, Trace, TraceError};
use jcas_policy::{BaselineKind, PilotMode};

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

/// Reads a trace with some of its lines changed, and with the checksum that fits.
fn with_lines(text: &[u8], change: impl FnOnce(&mut Vec<String>)) -> Trace {
    let text = std::str::from_utf8(text).unwrap();
    let mut lines = text.lines().map(str::to_owned).collect();
    change(&mut lines);
    let text = lines.join("\n");
    let covered = &text[..text.rfind(CHECKSUM).unwrap()];
    let mut hash = Fnv1a::new();
    hash.write(covered.as_bytes());
    let text = format!("{covered}{CHECKSUM}{:016x}\"}}\n", hash.finish());
    read(text.as_bytes()).unwrap()
}

fn with_text(text: &[u8], from: &str, to: &str) -> Trace {
    with_lines(text, |lines| {
        let line = lines.iter_mut().find(|line| line.contains(from)).unwrap();
        *line = line.replacen(from, to, 1);
    })
}

#[test]
fn no_changed_byte_goes_unnoticed() {
    let text = recorded(1);
    read(&text).unwrap();
    for trial in 0..2000 {
        let bits = rng::bits64(1, trial, 0, 0, Purpose::Policy);
        let mut changed = text.clone();
        let place = rng::below(bits, changed.len() as u64) as usize;
        changed[place] ^= 1 << (trial % 8);
        assert!(read(&changed).is_err(), "byte {place}");
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
    let text = recorded(5);
    let left = read(&text).unwrap();
    let right = with_text(&text, jcas_core::VERSION, "9.9.9");
    assert_eq!(right.header.core_version, "9.9.9");
    assert_eq!(trace::diff(&left, &right), None);
    assert_eq!(trace::verify(&right).unwrap(), None);
    let right = with_lines(&text, |lines| drop(lines.remove(lines.len() - 2)));
    let found = trace::diff(&left, &right).unwrap();
    assert_eq!((found.step, found.field.as_str()), (12, "t"));
    assert_eq!(
        (found.left.as_str(), found.right.as_str()),
        ("present", "absent")
    );
    // When replayed, such a trace stops before the end of its episode.
    assert_eq!(trace::verify(&right).unwrap().unwrap().field, "steps");
}

#[test]
fn a_trace_of_an_impossible_configuration_is_refused_by_field() {
    let trace = with_text(&recorded(6), "\"quorum\":3", "\"quorum\":0");
    let message = trace::verify(&trace).unwrap_err().to_string();
    assert!(message.starts_with("quorum = 0: must be "), "{message}");
}

/// An episode in which a host uses every kind of call, as text.
fn hosted() -> Vec<u8> {
    let config = Config {
        uav_count: 4,
        hotspot_count: 2,
        quorum: 2,
        horizon_steps: 30,
        ..Config::default()
    };
    let model = Model::new(config).unwrap();
    let cell = |x, y| Cell { x, y };
    let mut text = Vec::new();
    let mut episode = EpisodeRecorder::begin(&model, 9, ("host", "mid"), &mut text).unwrap();
    let starts = [cell(0, 0), cell(1, 0), cell(2, 0), cell(3, 0)];
    let before = [
        Call::SetStarts { cells: &starts },
        Call::SetHotspots {
            cells: &[cell(1, 1), cell(9, 9)],
        },
        Call::SetBatteries {
            charges_uj: &[500_000_000_000, 1, 600_000_000_000, 7],
        },
    ];
    before.iter().for_each(|call| episode.call(call).unwrap());
    let actions = [0.8; 8];
    episode.step(&actions, &[]).unwrap();
    episode
        .step(&actions, &[Call::SetPositions { cells: &starts }])
        .unwrap();
    let before = [
        Call::SetBattery {
            uav: 1,
            charge_uj: 300_000_000_000,
        },
        Call::MoveHotspot {
            hotspot: 1,
            cell: cell(4, 4),
        },
    ];
    before.iter().for_each(|call| episode.call(call).unwrap());
    let within = [
        Call::SetPositions {
            cells: &[cell(5, 5); 4],
        },
        Call::Ground { uav: 2 },
        Call::ConfirmHotspot { hotspot: 0 },
        Call::StepSenseWith {
            detections: &[1, 0, 0, 0, 0, 0, 0, 1],
        },
        Call::StepCommunicateWith {
            links: &[0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0],
            throughput: None,
        },
    ];
    episode.step(&actions, &within).unwrap();
    episode.step(&actions, &[]).unwrap();
    let measured = Call::StepCommunicateWith {
        links: &[0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
        throughput: Some(&[0.1, 2.5, 0.0, 1e-7]),
    };
    episode.step(&actions, &[measured]).unwrap();
    let after = Call::SetBattery {
        uav: 0,
        charge_uj: 5,
    };
    episode.call(&after).unwrap();
    episode.end().unwrap();
    text
}

#[test]
fn what_a_host_owned_is_repeated_with_the_same_bits() {
    let text = hosted();
    let read = read(&text).unwrap();
    assert_eq!(trace::verify(&read).unwrap(), None);
    assert_eq!(read.steps[2].host.len(), 7);
    assert_eq!(trace::rerecord(&read).unwrap(), text);
}

#[test]
fn another_host_is_a_difference_and_an_impossible_one_is_refused() {
    let text = hosted();
    let honest = read(&text).unwrap();
    let ground = r#"{"kind":"ground","uav":2}"#;
    let other = with_text(&text, ground, &ground.replace('2', "0"));
    assert_eq!(trace::diff(&honest, &other).unwrap().field, "host[3].uav");
    let found = trace::verify(&other).unwrap().unwrap();
    assert_eq!((found.step, found.field.as_str()), (3, "positions[0][0]"));
    let other = with_text(&text, ground, &ground.replace('2', "4"));
    let message = trace::verify(&other).unwrap_err().to_string();
    assert!(message.starts_with("uav = 4"), "{message}");
    // The first and the last call of the third step.
    let other = with_lines(&text, |lines| lines.swap(7, 13));
    assert!(
        trace::verify(&other)
            .unwrap_err()
            .to_string()
            .contains("out of")
    );
}

#[test]
fn lines_of_a_host_are_read_strictly() {
    let refused = |from: &str, to: &str| {
        let text = String::from_utf8(hosted()).unwrap().replacen(from, to, 1);
        read(text.as_bytes()).unwrap_err().to_string()
    };
    let message = refused("[3,1]]}", "[3,2]]}");
    assert!(
        message.contains("[3, 2]: there is no such pair"),
        "{message}"
    );
    let message = refused("\"kind\":\"ground\"", "\"kind\":\"land\"");
    assert!(message.contains("must be step, end or a call"), "{message}");
    let message = refused("\"uav\":2}", "\"uav\":2,\"why\":1}");
    assert!(message.contains("unknown field"), "{message}");
    let message = refused("\"format_version\":1", "\"format_version\":3");
    assert!(
        message.contains("format_version = 3: must be 1"),
        "{message}"
    );
    let message = refused(
        "{\"kind\":\"end\"",
        "{\"kind\":\"ground\",\"uav\":1}\n{\"kind\":\"end\"",
    );
    assert!(message.contains("is missing"), "{message}");
}

#[test]
fn a_page_starts_where_the_host_starts_and_moves_hotspots() {
    let trace = read(&hosted()).unwrap();
    let data = jcas_episode::replay::data_of(&trace).unwrap();
    assert!(data.contains(r#""hotspots":[[1,1],[9,9]]"#));
    assert!(data.contains(
        r#""initial":{"positions":[[0,0],[1,0],[2,0],[3,0]],"battery_uj":[500000000000,1,"#
    ));
    assert!(data.contains(r#""moved_hotspots":[[1,[4,4]]]"#));
}
