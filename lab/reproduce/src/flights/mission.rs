//! What our policy flies in the preset `mission` alone.

use super::{Flights, key};
use crate::campaign::{HELD, OURS};
use crate::pilot_by_distance;
use jcas_core::{Model, Preset};
use jcas_episode::card::StoredPolicy;
use jcas_policy::{BaselineKind, PilotMode};
use jcas_train::error::TrainError;
use jcas_train::store::write_whole;

impl Flights<'_> {
    /// What is flown in the preset `mission` alone.
    pub(super) fn experiments(
        &mut self,
        preset: Preset,
        policy: &StoredPolicy,
        seed: u64,
    ) -> Result<(), TrainError> {
        if preset != Preset::Mission {
            return Ok(());
        }
        self.trade_off(policy, seed)?;
        self.batteries(policy, seed)?;
        self.approach(policy, seed)
    }

    /// Success against throughput: the motions of the learned policy and of `teams`, the pilot
    /// density held.
    fn trade_off(&mut self, policy: &StoredPolicy, seed: u64) -> Result<(), TrainError> {
        self.narrator.chapter("sensing against communication");
        let config = self.scope.mission(Preset::Mission, self.scope.hard_cell());
        for &density in &self.scope.densities {
            let key_of = |policy, seed| {
                let campaign = ("density", density);
                key(campaign, Preset::Mission, &config, (policy, HELD), seed)
            };
            self.ours(&key_of(OURS, seed), config, policy, Some(density))?;
            let key = key_of("teams", 0);
            let pilot = PilotMode::Held(density);
            self.campaign(&key, config, &|| {
                Box::new(BaselineKind::Teams.build_privileged(pilot))
            })?;
        }
        Ok(())
    }

    fn batteries(&mut self, policy: &StoredPolicy, seed: u64) -> Result<(), TrainError> {
        self.narrator.chapter("small batteries");
        for &share in &self.scope.renewable_shares {
            let config = self.scope.small_battery(share);
            let key_of = |policy, seed| {
                let campaign = ("battery", share);
                key(
                    campaign,
                    Preset::Mission,
                    &config,
                    (policy, "adaptive"),
                    seed,
                )
            };
            self.ours(&key_of(OURS, seed), config, policy, None)?;
            let teams = key_of("teams", 0);
            self.campaign(&teams, config, &|| {
                Box::new(BaselineKind::Teams.build_privileged(PilotMode::Adaptive))
            })?;
        }
        Ok(())
    }

    /// Pilot density over distance to the nearest unconfirmed hotspot, as a table of its own.
    fn approach(&mut self, policy: &StoredPolicy, seed: u64) -> Result<(), TrainError> {
        let path = self.out.join(pilot_by_distance::table(seed));
        if path.exists() || self.stopped() {
            return Ok(());
        }
        let config = self.scope.mission(Preset::Mission, self.scope.hard_cell());
        let model = Model::new(config).map_err(|error| TrainError::Setting(error.to_string()))?;
        let bins =
            pilot_by_distance::observe(&model, policy, pilot_by_distance::missions(self.scope))
                .map_err(|error| TrainError::Setting(error.to_string()))?;
        let mut text = String::from("distance_cells,uav_steps,pilot_density_mean\n");
        for (distance, (count, sum)) in bins.iter().enumerate() {
            if *count > 0 {
                text += &format!("{distance},{count},{:.6}\n", sum / *count as f64);
            }
        }
        write_whole(&path, text.as_bytes())
    }
}
