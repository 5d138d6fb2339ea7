//! Tests that every instruction set gives the bits of the plain formula for the outputs of
//! networks.

#[path = "../../policy/tests/episode/mod.rs"]
mod episode;

use episode::{EPISODES, fly};
use jcas_core::rng::{derive_seed, unit};
use jcas_core::{Config, Model};
use jcas_policy::network::Network;
use jcas_simd::InstructionSet;

/// Returns a number between −1 and 1, which is sometimes zero.
fn number(seed: u64, index: usize) -> f32 {
    let drawn = unit(derive_seed(seed, index as u64)) as f32 * 2.4 - 1.2;
    if drawn.abs() > 1.0 { 0.0 } else { drawn }
}

/// Returns layers of these widths, each with a matrix and a bias.
fn layers(widths: &[usize]) -> Vec<(Vec<f32>, Vec<f32>)> {
    widths
        .windows(2)
        .enumerate()
        .map(|(layer, width)| {
            let numbers = |seed, count| (0..count).map(|k| number(seed, k)).collect();
            let seed = 2 * layer as u64;
            (
                numbers(seed, width[0] * width[1]),
                numbers(seed + 1, width[1]),
            )
        })
        .collect()
}

/// Returns the layers as a safetensors file.
fn file(widths: &[usize], layers: &[(Vec<f32>, Vec<f32>)]) -> Vec<u8> {
    let (mut header, mut data) = (Vec::new(), Vec::new());
    for (index, (matrix, bias)) in layers.iter().enumerate() {
        let (inputs, outputs) = (widths[index], widths[index + 1]);
        for (part, shape, values) in [
            ("weight", vec![inputs, outputs], matrix),
            ("bias", vec![outputs], bias),
        ] {
            let start = data.len();
            data.extend(values.iter().flat_map(|x| x.to_le_bytes()));
            let end = data.len();
            let offsets = format!(r#""data_offsets":[{start},{end}]"#);
            header.push(format!(
                r#""{index}.{part}":{{"dtype":"F32","shape":{shape:?},{offsets}}}"#
            ));
        }
    }
    let header = format!("{{{}}}", header.join(","));
    let mut bytes = (header.len() as u64).to_le_bytes().to_vec();
    bytes.extend(header.bytes());
    bytes.extend(data);
    bytes
}

/// Computes the sums one by one, over all inputs in their order.
fn plain(layers: &[(Vec<f32>, Vec<f32>)], row: &[f32]) -> Vec<f32> {
    let mut inputs = row.to_vec();
    for (layer, (matrix, bias)) in layers.iter().enumerate() {
        if layer > 0 {
            for input in &mut inputs {
                *input = if *input > 0.0 { *input } else { 0.0 };
            }
        }
        let mut outputs = bias.clone();
        for (input, weights) in inputs.iter().zip(matrix.chunks_exact(bias.len())) {
            for (sum, weight) in outputs.iter_mut().zip(weights) {
                *sum += input * weight;
            }
        }
        inputs = outputs;
    }
    inputs
}

#[test]
fn every_instruction_set_multiplies_as_the_plain_formula() {
    // There are more rows than one block, and an odd number of fields.
    for (uavs, hotspots) in [(1, 1), (15, 7), (37, 3)] {
        let model = Model::new(Config {
            uav_count: uavs,
            hotspot_count: hotspots,
            ..Config::default()
        })
        .expect("a legal configuration");
        let fields = model.observation_len();
        // The widths are below, at and above a vector, a panel and a block of inputs.
        for hidden in [
            &[1][..],
            &[16, 64],
            &[17, 65, 127],
            &[128, 80, 129],
            &[300, 256],
        ] {
            let widths = [&[fields], hidden, &[7]].concat();
            let layers = layers(&widths);
            let bytes = file(&widths, &layers);
            let network = Network::read(&bytes).expect("a network");
            let mut weights = vec![0.0; network.weights_len()];
            let network = Network::load(&bytes, &mut weights).expect("a network");
            let mut rows: Vec<f32> = (0..model.uav_count() * fields)
                .map(|k| number(99, k))
                .collect();
            rows[fields / 2] = -0.0;
            if uavs > 1 {
                rows[fields] = f32::INFINITY;
                rows[2 * fields + 1] = f32::NAN;
            }
            let expected: Vec<u32> = rows
                .chunks_exact(fields)
                .flat_map(|row| plain(&layers, row))
                .map(bits)
                .collect();
            for set in InstructionSet::all() {
                let network = network.with_matmul(set.matmul());
                let mut scratch = vec![f32::NAN; network.scratch_len(&model)];
                let mut outputs = vec![f32::NAN; expected.len()];
                network
                    .outputs(&weights, &model, &rows, &mut scratch, &mut outputs)
                    .expect("a episode that fits");
                let outputs: Vec<u32> = outputs.into_iter().map(bits).collect();
                assert_eq!(outputs, expected, "{}, {widths:?}", set.name());
            }
        }
    }
}

/// The bits of a NaN are not specified.
fn bits(x: f32) -> u32 {
    if x.is_nan() {
        f32::NAN.to_bits()
    } else {
        x.to_bits()
    }
}

#[test]
fn the_shipped_policy_flies_the_same_missions_with_every_instruction_set() {
    for set in InstructionSet::all() {
        let flown = EPISODES.map(|episode| fly(episode, set.matmul()));
        assert_eq!(flown, EPISODES, "{}", set.name());
    }
}
