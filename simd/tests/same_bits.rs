//! Tests that every instruction set of the machine gives the bits of the baseline.

use jcas_core::batch::BatchOut;
use jcas_core::{Config, Model, Preset, Scratch, hash, rng};
use jcas_simd::InstructionSet;

const ENVIRONMENTS: usize = 3;

/// Hashes everything that a batch writes in its first steps. The seed determines the actions.
fn flown(set: InstructionSet, model: &Model<'_>, steps: u64) -> u64 {
    let uavs = model.uav_count();
    let mut states = vec![0; ENVIRONMENTS * model.state_words()];
    let mut words = vec![0; Scratch::words_for(model)];
    let mut scratch = Scratch::new(model, &mut words).expect("sized for the model");
    let mut observations = vec![0.0; ENVIRONMENTS * uavs * model.observation_len()];
    let mut global = vec![0.0; ENVIRONMENTS * model.global_len()];
    let (mut rewards, mut own) = (vec![0.0; ENVIRONMENTS], vec![0.0; ENVIRONMENTS * uavs]);
    let (mut terminated, mut truncated) = (vec![0; ENVIRONMENTS], vec![0; ENVIRONMENTS]);
    model
        .batch_reset(
            &mut states,
            &mut scratch,
            &[1, 2, 3],
            &mut observations,
            &mut global,
        )
        .expect("buffers of the right lengths");
    let mut seen = hash::Fnv1a::new();
    for step in 0..steps {
        let actions: Vec<f32> = (0..ENVIRONMENTS as u64 * 2 * uavs as u64)
            .map(|index| rng::unit(rng::derive_seed(step, index)) as f32 * 2.2 - 1.1)
            .collect();
        let mut out = BatchOut {
            observations: &mut observations,
            global: &mut global,
            rewards: &mut rewards,
            terminated: &mut terminated,
            truncated: &mut truncated,
            uav_rewards: &mut own,
            ..BatchOut::default()
        };
        set.batch_step(model, &mut states, &mut scratch, &actions, true, &mut out)
            .expect("a legal step");
        for &word in &states {
            seen.write_u64(word);
        }
        for value in observations
            .iter()
            .chain(&global)
            .chain(&rewards)
            .chain(&own)
        {
            seen.write_u64(u64::from(value.to_bits()));
        }
    }
    seen.finish()
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    let sets: Vec<InstructionSet> = InstructionSet::all().collect();
    assert_eq!(sets.first(), Some(&InstructionSet::BASELINE));
    assert_eq!(sets.last(), Some(&InstructionSet::best()));
    for set in sets {
        println!("{}", set.name());
        for preset in [Preset::Mission, Preset::Paper, Preset::Search] {
            // The sizes are below, at and above a block of lanes, a word and the limit for pairwise
            // links.
            for (uavs, hotspots, side) in [
                (1, 1, 2),
                (5, 3, 12),
                (8, 8, 12),
                (15, 7, 12),
                (16, 9, 40),
                (17, 65, 12),
                (49, 5, 20),
                (70, 11, 20),
            ] {
                let model = Model::new(Config {
                    uav_count: uavs,
                    hotspot_count: hotspots,
                    grid_width: side,
                    grid_height: side + 1,
                    initial_soc_min: 0.0,
                    horizon_steps: 40,
                    ..Config::preset(preset)
                })
                .expect("a legal configuration");
                assert_eq!(
                    flown(set, &model, 50),
                    flown(InstructionSet::BASELINE, &model, 50),
                    "{} at N = {uavs}, n = {hotspots}, {preset:?}",
                    set.name()
                );
            }
        }
    }
}
