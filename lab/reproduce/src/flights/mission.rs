//! What our policy flies in the preset `mission` alone.

use super::{Flights, key};
use crate::campaign::{HELD, OURS};
use jcas_core::Preset;
use jcas_episode::card::StoredPolicy;
use jcas_policy::head::Mode;
use jcas_policy::{BaselineKind, PilotMode};
use jcas_train::error::TrainError;

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
        let config = self.scope.mission(Preset::Mission, self.scope.hard_cell());
        self.approach(OURS, config, policy.policy(Some(Mode::Deterministic)), seed)
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
            let pilot = PilotMode::Fixed(density);
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
}
