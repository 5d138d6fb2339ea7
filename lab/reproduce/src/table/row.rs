//! A row of the table: the key of a campaign and its quantities.

use jcas_episode::statistics::{Estimate, Summary};
use serde::{Deserialize, Serialize};

/// Key of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Key {
    /// `grid`, `density`, `battery`, `variation`, `range`, `endurance`, or one that begins with
    /// `pilot`.
    pub experiment: String,
    /// `mission`, `paper` or `search`.
    pub preset: String,
    /// UAVs.
    pub uavs: u32,
    /// Hotspots.
    pub hotspots: u32,
    /// Baseline's name, `learned` (our settings), a learner's name (the paper's), a variation's, or
    /// the folder of a policy that was given.
    pub policy: String,
    /// Pilot rule.
    pub pilot: String,
    /// Training seed; of policies that were given, their place among those for the mission; 0 for
    /// baselines.
    pub seed: u64,
    /// What the experiment varies besides: a density, a share; 0 where nothing.
    pub x: f64,
    /// Fingerprint of the configuration that is flown.
    pub config_hash: String,
}

/// Declares a row: the columns of its key, and each quantity with the ends of its interval.
macro_rules! row {
    ($( $quantity:ident: $value:ident, $low:ident, $high:ident; )+) => {
        /// A row: a campaign and its results.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[allow(missing_docs)] // the names are those of the summary's quantities and their ends
        pub struct Row {
            pub experiment: String,
            pub preset: String,
            pub uavs: u32,
            pub hotspots: u32,
            pub policy: String,
            pub pilot: String,
            pub seed: u64,
            pub x: f64,
            pub config_hash: String,
            pub episodes: u64,
            $( pub $value: f64, pub $low: f64, pub $high: f64, )+
            pub pilot_density: f64,
        }

        impl Row {
            pub(super) fn new(key: &Key, summary: &Summary) -> Row {
                let Key { experiment, preset, uavs, hotspots, policy, pilot, .. } = key.clone();
                Row {
                    experiment,
                    preset,
                    uavs,
                    hotspots,
                    policy,
                    pilot,
                    seed: key.seed,
                    x: key.x,
                    config_hash: key.config_hash.clone(),
                    episodes: summary.episodes,
                    $(
                        $value: summary.$value.value,
                        $low: summary.$value.low,
                        $high: summary.$value.high,
                    )+
                    pilot_density: summary.pilot_density.value,
                }
            }

            /// A quantity with its interval.
            pub fn estimate(&self, quantity: Quantity) -> Estimate {
                let (value, low, high) = match quantity {
                    $( Quantity::$quantity => (self.$value, self.$low, self.$high), )+
                };
                Estimate { value, low, high }
            }
        }
    };
}

row! {
    Success: success_rate, success_rate_low, success_rate_high;
    Steps: mission_steps, mission_steps_low, mission_steps_high;
    Energy: energy_kwh, energy_kwh_low, energy_kwh_high;
    Throughput: throughput, throughput_low, throughput_high;
    Co2: co2_kg, co2_kg_low, co2_kg_high;
}

impl Row {
    /// Whether another row is of the same campaign.
    pub(crate) fn is_again(&self, other: &Row) -> bool {
        self.campaign() == other.campaign()
    }

    pub(super) fn is_of(&self, key: &Key) -> bool {
        let names = [&key.experiment, &key.preset, &key.policy, &key.pilot];
        self.campaign() == (names, [key.uavs, key.hotspots], key.seed, key.x.to_bits())
    }

    /// The columns that identify a row.
    pub(super) fn campaign(&self) -> ([&String; 4], [u32; 2], u64, u64) {
        let names = [&self.experiment, &self.preset, &self.policy, &self.pilot];
        (
            names,
            [self.uavs, self.hotspots],
            self.seed,
            self.x.to_bits(),
        )
    }
}

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Success rate.
    Success,
    /// Mission time.
    Steps,
    /// Energy of the fleet.
    Energy,
    /// Normalised throughput.
    Throughput,
    /// Carbon.
    Co2,
}

impl Quantity {
    /// Its name, for people.
    pub const fn title(self) -> &'static str {
        match self {
            Quantity::Success => "success rate",
            Quantity::Steps => "mission time",
            Quantity::Energy => "energy spent",
            Quantity::Throughput => "normalised throughput",
            Quantity::Co2 => "carbon emitted",
        }
    }

    /// Its unit; empty for a pure number.
    pub const fn unit(self) -> &'static str {
        match self {
            Quantity::Success | Quantity::Throughput => "",
            Quantity::Steps => "steps",
            Quantity::Energy => "kWh",
            Quantity::Co2 => "kg",
        }
    }

    /// Decimals in reports.
    pub const fn digits(self) -> usize {
        match self {
            Quantity::Steps => 1,
            _ => 3,
        }
    }
}
