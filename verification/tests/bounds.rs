//! The ranges that proofs assume of a legal configuration, on random legal ones.

use jcas_core::Model;
use jcas_core::carbon::CarbonConstants;
use jcas_core::energy::EnergyConstants;
use jcas_verification::sampling::{self, Dice};
use jcas_verification::specification::Specification;

const CONFIGURATIONS: u64 = 500;

/// Catches a ledger that a legal configuration could overflow.
#[test]
fn the_worst_episode_stays_below_two_to_the_62() {
    for seed in 0..CONFIGURATIONS {
        let mut dice = Dice::new(seed);
        let mut config = sampling::configuration(&mut dice);
        // As long and as hungry as is legal: the longest horizon that is accepted.
        config.charge_power_kw = dice.real(0.0, 10_000.0);
        config.step_duration_s = dice.real(1.0, 86_400.0);
        config.horizon_steps = 1_000_000;
        config.uav_count = dice.integer(1, 4096);
        while config.validate().is_err() {
            if config.horizon_steps > 1 {
                config.horizon_steps /= 2;
            } else {
                config.step_duration_s /= 2.0;
            }
        }
        let plan = EnergyConstants::new(&config);
        let carbon = CarbonConstants::new(&config);
        let steps = u128::from(config.horizon_steps);
        let uavs = u128::from(config.uav_count);
        let charged = steps * uavs * u128::from(plan.charge_uj);
        let asked = steps * uavs * u128::from(plan.most_asked_uj());
        let stored = uavs * u128::from(plan.capacity_uj);
        // Half a nanogram more a step, for the rounding of each.
        let emitted = charged * u128::from(carbon.intensity_max_mg_per_kwh) / 3_600_000 + steps;
        assert!(stored + charged + asked <= 1 << 62, "{config:?}");
        assert!(emitted <= (1 << 62) + steps, "{config:?}");
    }
}

/// Catches a table entry outside of what proofs of whole steps assume.
#[test]
fn every_table_entry_is_in_range() {
    for seed in 0..CONFIGURATIONS {
        let config = sampling::configuration(&mut Dice::new(seed));
        let model = Model::new(config).unwrap();
        let spec = Specification::new(&config);
        for dx in 0..config.grid_width {
            for dy in 0..config.grid_height {
                let throughput = model.link_throughput(dx, dy, 0.0);
                assert!((0.0..=1e6).contains(&throughput), "{throughput} {config:?}");
                // Without load the probability shows the tabulated odds.
                let p = model.detection_probability(dx, dy, 1.0);
                assert!((0.0..=1.0).contains(&p), "{p} {config:?}");
                let from = position(0, 0);
                let to = position(dx, dy);
                let expected = spec.detection_probability(from, to, 1.0);
                assert!((p - expected).abs() <= 1e-12, "{p} {expected} {config:?}");
            }
        }
    }
}

fn position(x: u32, y: u32) -> jcas_verification::specification::Position {
    jcas_verification::specification::Position {
        x: i64::from(x),
        y: i64::from(y),
    }
}
