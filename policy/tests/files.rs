//! Tests that files of policies are read whole or refused, and never panic.

use jcas_core::{Config, Model, Sim, TargetVisibility};
use jcas_policy::head::{Head, Mode};
use jcas_policy::network::{FlyError, LoadError, Network};
use jcas_policy::{BaselineKind, PilotMode, Policy, Trained};
use proptest::prelude::*;

const MISSION: &[u8] = include_bytes!("../../policies/mission/policy.safetensors");

/// Returns a safetensors file of f32 arrays.
fn file(metadata: &str, arrays: &[(&str, &[usize], Vec<f32>)]) -> Vec<u8> {
    let mut header = String::from("{");
    if !metadata.is_empty() {
        header += &format!(r#""__metadata__":{{"jcas":"{metadata}"}},"#);
    }
    let mut data = Vec::new();
    for (name, shape, values) in arrays {
        let start = data.len();
        data.extend(values.iter().flat_map(|x| x.to_le_bytes()));
        let end = data.len();
        header += &format!(
            r#""{name}": {{"dtype":"F32","shape":{shape:?},"data_offsets":[{start}, {end}]}},"#
        );
    }
    header.pop();
    header.push('}');
    let mut bytes = (header.len() as u64).to_le_bytes().to_vec();
    bytes.extend(header.bytes());
    bytes.extend(data);
    bytes
}

/// Returns an MLP of two layers, `fields` → 3 → 4.
fn small_mlp(metadata: &str, fields: usize) -> Vec<u8> {
    let weights = (0..3 * fields).map(|k| (k % 5) as f32 - 2.0).collect();
    file(
        metadata,
        &[
            ("0.bias", &[1, 3], vec![0.5, -0.5, 1.0]),
            ("0.weight", &[fields, 3], weights),
            ("1.bias", &[4], vec![0.0, 0.25, -1.0, -1.0]),
            (
                "1.weight",
                &[3, 4],
                (0..12).map(|k| 0.1 * k as f32).collect(),
            ),
        ],
    )
}

fn load(bytes: &[u8]) -> Result<(Network, Vec<f32>), LoadError> {
    let mut weights = vec![0.0; Network::read(bytes)?.weights_len()];
    let network = Network::load(bytes, &mut weights)?;
    Ok((network, weights))
}

fn model(config: Config) -> Model<'static> {
    Model::new(config).unwrap()
}

#[test]
fn the_shipped_policy_is_read() {
    let (network, weights) = load(MISSION).unwrap();
    assert_eq!(network.head(), Head::Hybrid);
    assert_eq!(network.metadata().mode, Mode::Deterministic);
    let visibility = network.metadata().target_visibility;
    assert_eq!(visibility, Some(TargetVisibility::Known));
    assert!(weights.iter().any(|&weight| weight != 0.0));
    for (uav_count, hotspot_count) in [(1, 1), (5, 3), (20, 11)] {
        let config = Config {
            uav_count,
            hotspot_count,
            ..Config::default()
        };
        network.check(&model(config)).unwrap();
    }
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    for end in (0..2000).chain((2000..MISSION.len()).step_by(997)) {
        assert!(Network::read(&MISSION[..end]).is_err(), "{end}");
    }
    let mut longer = MISSION.to_vec();
    longer.push(0);
    assert!(Network::read(&longer).is_err());
}

#[test]
fn memory_of_another_length_is_refused() {
    let expected = Network::read(MISSION).unwrap().weights_len();
    let got = expected - 1;
    assert_eq!(
        Network::load(MISSION, &mut vec![0.0; got]),
        Err(LoadError::Memory { expected, got })
    );
}

#[test]
fn what_does_not_fit_is_refused_by_name() {
    let refused =
        |arrays: &[(&str, &[usize], Vec<f32>)]| load(&file("", arrays)).unwrap_err().to_string();
    let bias = || ("0.bias", [1usize, 4], vec![0.0; 4]);
    let (name, shape, values) = bias();
    let wrong_rows = refused(&[
        (name, &shape, values.clone()),
        ("0.weight", &[2, 4], vec![0.0; 8]),
        ("1.weight", &[5, 4], vec![0.0; 20]),
        ("1.bias", &[1, 4], vec![0.0; 4]),
    ]);
    assert_eq!(wrong_rows, "array 1.weight: shape 5 × 4, must be 4 × any");
    let no_bias = refused(&[("0.weight", &[2, 4], vec![0.0; 8])]);
    assert_eq!(no_bias, "array 0.bias is missing");
    let mut with_nan = vec![0.0; 8];
    with_nan[3] = f32::NAN;
    let nan = refused(&[
        (name, &shape, values.clone()),
        ("0.weight", &[2, 4], with_nan),
    ]);
    assert!(
        nan.starts_with("array 0.weight: element 3 is not finite"),
        "{nan}"
    );
    let surplus = refused(&[
        (name, &shape, values.clone()),
        ("0.weight", &[2, 4], vec![0.0; 8]),
        ("1.wait", &[1], vec![0.0]),
    ]);
    assert_eq!(surplus, "arrays: 3, of which the network reads 2");
    let critic = refused(&[
        ("0.weight", &[2, 1], vec![0.0; 2]),
        ("0.bias", &[1, 1], vec![0.0]),
    ]);
    assert_eq!(critic, "outputs: 1, must be 4 (gaussian) or 7 (hybrid)");
    let scale = refused(&[
        (name, &shape, values),
        ("0.weight", &[2, 4], vec![0.0; 8]),
        ("inputs.offset", &[2], vec![0.0; 2]),
        ("inputs.scale", &[2], vec![1.0, 0.0]),
    ]);
    assert!(
        scale.starts_with("array inputs.scale: element 1"),
        "{scale}"
    );
    assert_eq!(
        refused(&[("x", &[1], vec![0.0])]).split(':').next(),
        Some("arrays")
    );
}

#[test]
fn only_a_set_network_reads_the_size_of_the_fleet_and_choices() {
    for metadata in ["fleet_size=read", "choices=read"] {
        let refusal = load(&small_mlp(metadata, 12)).unwrap_err().to_string();
        assert!(refusal.contains("only a set network"), "{refusal}");
    }
}

#[test]
fn a_policy_refuses_missions_that_it_cannot_read() {
    let config = Config {
        uav_count: 1,
        hotspot_count: 1,
        ..Config::default()
    };
    let fits = model(config);
    let (network, _) = load(&small_mlp(
        "target_visibility=known",
        fits.observation_len(),
    ))
    .unwrap();
    assert_eq!(network.check(&fits), Ok(()));
    let more = model(Config {
        hotspot_count: 2,
        ..config
    });
    assert!(matches!(
        network.check(&more),
        Err(FlyError::Observation { .. })
    ));
    let hidden = model(Config {
        target_visibility: TargetVisibility::Hidden,
        ..config
    });
    assert_eq!(network.check(&hidden), Err(FlyError::Visibility));
}

// Two UAVs and one hotspot give the two layers their inputs. Every sum is written out in the
// promised order, so that the outputs are the same to the last bit.
#[test]
fn an_mlp_is_the_sum_in_the_order_of_its_inputs() {
    let model = model(Config {
        uav_count: 2,
        hotspot_count: 1,
        ..Config::default()
    });
    let fields = model.observation_len();
    let (network, weights) = load(&small_mlp("", fields)).unwrap();
    let mut sim = Sim::new(&model);
    sim.reset(5);
    let mut observations = vec![0.0; 2 * fields];
    sim.observe(&mut observations).unwrap();
    let mut scratch = vec![f32::NAN; network.scratch_len(&model)];
    let mut out = vec![0.0; 8];
    network
        .outputs(&weights, &model, &observations, &mut scratch, &mut out)
        .unwrap();
    let first = |k: usize| (k % 5) as f32 - 2.0;
    for (row, out) in observations.chunks(fields).zip(out.chunks(4)) {
        let hidden: Vec<f32> = (0..3)
            .map(|j| {
                let start = [0.5f32, -0.5, 1.0][j];
                let sum = row
                    .iter()
                    .enumerate()
                    .fold(start, |sum, (i, x)| sum + x * first(3 * i + j));
                sum.max(0.0)
            })
            .collect();
        for (j, out) in out.iter().enumerate() {
            let start = [0.0f32, 0.25, -1.0, -1.0][j];
            let sum = hidden
                .iter()
                .enumerate()
                .fold(start, |sum, (i, x)| sum + x * (0.1 * (4 * i + j) as f32));
            assert_eq!(sum.to_bits(), out.to_bits());
        }
    }
}

#[test]
fn untrained_acts_as_a_network_of_zeros_does() {
    let model = model(Config {
        uav_count: 4,
        hotspot_count: 1,
        ..Config::default()
    });
    let zeros = file(
        "mode=sampled",
        &[
            ("0.bias", &[4], vec![0.0; 4]),
            (
                "0.weight",
                &[model.observation_len(), 4],
                vec![0.0; 4 * model.observation_len()],
            ),
        ],
    );
    let mut network = Trained::read("zeros", &zeros).unwrap();
    let mut untrained = BaselineKind::Untrained
        .build(&model, PilotMode::Adaptive)
        .unwrap();
    let mut sim = Sim::new(&model);
    let mut observations = vec![0.0; 4 * model.observation_len()];
    let (mut expected, mut got) = (vec![0.0; 8], vec![0.0; 8]);
    sim.reset(9);
    untrained.reset(&model, 9);
    for _ in 0..20 {
        sim.observe(&mut observations).unwrap();
        network.see(&observations);
        network.act(&model, &sim.state(), &mut expected);
        untrained.act(&model, &sim.state(), &mut got);
        assert_eq!(got, expected);
        sim.step(&got).unwrap();
    }
}

proptest! {
    /// One byte of the header, or a few bytes of the file, are changed.
    #[test]
    fn a_damaged_file_is_read_or_refused(
        edits in prop::collection::vec((0usize..2200, any::<u8>()), 1..4),
        cut in 0usize..40,
    ) {
        let mut bytes = MISSION.to_vec();
        for (at, byte) in edits {
            bytes[at] = byte;
        }
        bytes.truncate(MISSION.len() - cut);
        if let Ok((network, weights)) = load(&bytes) {
            prop_assert!(weights.iter().all(|weight| weight.is_finite()));
            let model = model(Config { uav_count: 2, hotspot_count: 1, ..Config::default() });
            let _ = network.check(&model);
        }
    }

    /// Headers are made of JSON's own pieces, which get further than random bytes.
    #[test]
    fn any_header_is_read_or_refused(
        pieces in prop::collection::vec(prop::sample::select(vec![
            "{", "}", "[", "]", ":", ",", "\"", "\"0.weight\"", "\"dtype\"", "\"shape\"",
            "\"data_offsets\"", "\"F32\"", "\"__metadata__\"", "\\", "1", "16",
            "18446744073709551615", " ", "\u{e4}",
        ]), 0..60),
        data in 0usize..64,
    ) {
        let header = pieces.concat();
        let mut bytes = (header.len() as u64).to_le_bytes().to_vec();
        bytes.extend(header.bytes());
        bytes.extend(vec![0; data]);
        prop_assert!(load(&bytes).is_err());
    }

    #[test]
    fn any_bytes_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(load(&bytes).is_err());
    }
}
