//! Invariants of every state that a run of the kernel can reach.

use crate::config::{Cell, LearnedDetections};
use crate::constants::carbon;
use crate::constants::reward::OWN_KEPT;
use crate::model::Model;
use crate::state::StateRef;
use crate::state::header::Phase;
use crate::words::bits;

/// Whether two potentials are legal for a UAV or a fleet: each within its weights, up to rounding.
fn potentials_are_in_range(model: &Model<'_>, goal: f64, charge: f64) -> bool {
    let config = model.config();
    let slack = 1.000_001;
    let farthest = 1.0 + config.shaping_unconfirmed_weight * model.hotspot_count() as f64;
    goal >= -(config.shaping_goal_weight * farthest) * slack
        && goal <= 0.0
        && charge >= 0.0
        && charge <= config.shaping_charge_weight * slack
}

impl StateRef<'_> {
    /// Whether this state keeps every invariant of the model.
    ///
    /// It is true after each reset, each part of a step, each load and each call of a host. Proofs
    /// assume it of a state, and tests check it for every state that they reach.
    #[must_use]
    pub fn is_valid(&self, model: &Model<'_>) -> bool {
        let Some(phase) = self.header.phase() else {
            return false;
        };
        self.header.config_hash() == model.config_hash()
            && self.fleet_is_valid(model, phase)
            && self.scalars_are_valid(model)
    }

    /// Checks all invariants except those of the scalars that only the end of a step changes.
    pub(crate) fn fleet_is_valid(&self, model: &Model<'_>, phase: Phase) -> bool {
        self.time_is_bounded(model, phase)
            && self.uavs_are_valid(model)
            && self.hotspots_are_valid(model)
            && self.knowledge_is_valid(model, phase)
            && self.links_are_valid(model)
            && self.visits_are_valid(model, phase)
            && self.maps_are_valid(model, phase)
            && self.alarms_are_valid(model)
            && self.reports_are_valid(model)
            && self.memory_is_valid(model)
    }

    fn time_is_bounded(&self, model: &Model<'_>, phase: Phase) -> bool {
        let (t, horizon) = (self.t(), model.config().horizon_steps);
        // A word above 32 bits would survive a round trip through `t()` unnoticed.
        self.header.0[2] == u64::from(t)
            && match phase {
                Phase::Ready => t < horizon,
                Phase::Truncated => t == horizon,
                _ => t >= 1 && t <= horizon,
            }
    }

    /// Number of steps whose energy is settled. Within a step these are the steps before it.
    pub(crate) fn settled_steps(&self) -> u64 {
        let under_way = matches!(
            self.header.phase(),
            Some(Phase::Moved | Phase::Sensed | Phase::Communicated)
        );
        u64::from(self.t()).saturating_sub(u64::from(under_way))
    }

    fn uavs_are_valid(&self, model: &Model<'_>) -> bool {
        let (config, plan) = (model.config(), model.energy());
        let steps = self.settled_steps();
        let most_uj = steps * plan.charge_uj;
        for i in 0..model.uav_count() {
            let density = self.pilot_density(i);
            let throughput = self.throughput(i);
            if !model.contains(self.cell(i))
                || !model.contains(Cell::from_word(self.previous[i]))
                || self.battery[i] > plan.capacity_uj
                || self.initial[i] > plan.capacity_uj
                || self.accepted[i] > most_uj
                || self.spent[i] > steps * plan.most_asked_uj()
                || self.battery[i] != self.balance_uj(i)
                || self.shortfall[i] > steps * plan.most_asked_uj()
                || !(density >= config.pilot_density_min && density <= config.pilot_density_max)
                || !(throughput >= 0.0 && throughput <= THROUGHPUT_MAX)
                || is_negative_zero(throughput)
            {
                return false;
            }
        }
        bits::fits(self.grounded, model.uav_count())
            && bits::fits(self.returning, model.uav_count())
            && bits::fits(self.sensing, model.uav_count())
    }

    /// What the ledger of UAV `i` leaves in its battery. Each entry is below 2^62 and the host's is
    /// the difference of the others, so that sums modulo 2^64 are exact.
    fn balance_uj(&self, i: usize) -> u64 {
        self.initial[i]
            .wrapping_add(self.accepted[i])
            .wrapping_add(self.given[i])
            .wrapping_sub(self.spent[i])
    }

    fn hotspots_are_valid(&self, model: &Model<'_>) -> bool {
        for j in 0..model.hotspot_count() {
            let cell = self.hotspot_cell(j);
            if !model.contains(cell)
                || model.depot_distance(cell) == 0
                || self.confirmed_at[j] > u64::from(self.t())
                || self.informed_at[j] > u64::from(self.t())
                || (self.confirmed_at[j] != 0) != self.confirmed(j)
                || (self.informed_at[j] != 0) != self.informed(j)
                || (learns_confirmed(model)
                    && self.informed(j)
                    && self.informed_at[j] < self.confirmed_at[j])
            {
                return false;
            }
        }
        bits::fits(self.confirmed, model.hotspot_count())
            && bits::fits(self.informed, model.hotspot_count())
            && (!learns_confirmed(model) || bits::is_subset(self.informed, self.confirmed))
    }

    /// Checks that only confirmed hotspots are known if detections alone do not teach. A hotspot
    /// must be informed if all UAVs know it (once knowledge has spread).
    fn knowledge_is_valid(&self, model: &Model<'_>, phase: Phase) -> bool {
        let row = model.hotspot_words();
        for word in 0..row {
            let mut common = u64::MAX;
            for i in 0..model.uav_count() {
                common &= self.knowledge[i * row + word];
            }
            let behind = common & !self.informed[word];
            if self.informed[word] & !common != 0 || (behind != 0 && phase != Phase::Sensed) {
                return false;
            }
        }
        for i in 0..model.uav_count() {
            let own = i * row..(i + 1) * row;
            if !bits::fits(self.knowledge_of(i), model.hotspot_count())
                || (learns_confirmed(model)
                    && !bits::is_subset(self.knowledge_of(i), self.confirmed))
                || !bits::fits(&self.detected[own], model.hotspot_count())
            {
                return false;
            }
        }
        let hotspots = model.hotspot_count();
        let all = self.informed_count() == hotspots && self.confirmed_count() == hotspots;
        match phase {
            Phase::Terminated => all,
            Phase::Communicated => true,
            // A hotspot that all UAVs know may become confirmed within the step.
            Phase::Moved | Phase::Sensed if !learns_confirmed(model) => true,
            _ => !all,
        }
    }

    /// Checks that links are symmetric, join two different UAVs, and join no grounded UAV. Before
    /// the communication of a step, the links are those of the step before.
    fn links_are_valid(&self, model: &Model<'_>) -> bool {
        let current = !matches!(self.header.phase(), Some(Phase::Moved | Phase::Sensed));
        for i in 0..model.uav_count() {
            let row = self.links_of(i);
            if !bits::fits(row, model.uav_count())
                || bits::get(row, i)
                || (current && self.grounded(i) && !bits::is_empty(row))
            {
                return false;
            }
            for k in 0..i {
                if self.linked(i, k) != self.linked(k, i) {
                    return false;
                }
            }
        }
        true
    }

    fn visits_are_valid(&self, model: &Model<'_>, phase: Phase) -> bool {
        let between_steps = phase == Phase::Ready || phase.is_over();
        for i in 0..model.uav_count() {
            let settled = if between_steps {
                self.cell(i)
            } else {
                Cell::from_word(self.previous[i])
            };
            if !self.visited(model.cell_index(settled)) {
                return false;
            }
        }
        bits::fits(self.visited, model.config().cell_count())
    }

    /// Checks that maps hold cells of the grid, and each UAV's own cell if it has searched.
    fn maps_are_valid(&self, model: &Model<'_>, phase: Phase) -> bool {
        if model.map_words() == 0 {
            return true;
        }
        let looked = self.t() > 0 && phase != Phase::Moved;
        for i in 0..model.uav_count() {
            let map = self.searched_of(i);
            if !bits::fits(map, model.config().cell_count())
                || (looked && !self.grounded(i) && !bits::get(map, model.cell_index(self.cell(i))))
            {
                return false;
            }
        }
        true
    }

    /// Checks that the false alarms of a UAV are distinct cells of the grid, without a gap between
    /// them. False confirmations must be cells of the grid.
    fn alarms_are_valid(&self, model: &Model<'_>) -> bool {
        let cells = model.config().cell_count();
        if self.layout.alarms == 0 {
            return true;
        }
        for row in self.false_alarms.chunks_exact(self.layout.alarms) {
            for slot in 0..row.len() {
                let follows_a_gap = slot > 0 && row[slot - 1] == 0;
                if row[slot] != 0 && (follows_a_gap || row[..slot].contains(&row[slot]))
                    || row[slot] > cells as u64
                {
                    return false;
                }
            }
        }
        bits::fits(self.falsely_confirmed, cells)
            && self.newly_false[0] <= bits::count(self.falsely_confirmed) as u64
    }

    /// Checks that levels are nested sets of cells, that a UAV reports what it saw, and that a
    /// report is a sighting of some UAV.
    fn reports_are_valid(&self, model: &Model<'_>) -> bool {
        let (row, words) = (self.layout.reports, self.layout.false_cells);
        if row == 0 {
            return true;
        }
        let mut unheard = 0;
        for word in 0..row {
            let (mut seen, mut told) = (0, 0);
            for i in 0..model.uav_count() {
                seen |= self.sightings[i * row + word];
                told |= self.reports[i * row + word];
            }
            unheard |= told & !seen;
        }
        let mut nested = unheard == 0 && bits::is_subset(self.sightings, self.reports);
        for rows in [self.sightings, self.reports] {
            for levels in rows.chunks_exact(row) {
                nested &= bits::is_subset(&levels[words..], &levels[..row - words]);
                nested &= bits::fits(&levels[..words], model.config().cell_count());
            }
        }
        nested
    }

    /// Checks that a UAV remembers what it detected last, and nothing beyond the hotspots and the
    /// grid.
    fn memory_is_valid(&self, model: &Model<'_>) -> bool {
        let (row, cells) = (self.layout.remembered, self.layout.remembered_false);
        if row == 0 {
            return true;
        }
        let mut valid = bits::is_subset(self.detected, self.remembered);
        for kept in self.remembered.chunks_exact(row) {
            valid &= bits::fits(kept, model.hotspot_count());
        }
        if cells > 0 {
            let alarms = self.false_alarms.chunks_exact(self.layout.alarms);
            for (kept, alarms) in self.remembered_false.chunks_exact(cells).zip(alarms) {
                valid &= bits::fits(kept, model.config().cell_count());
                for &alarm in alarms {
                    valid &= alarm == 0 || bits::get(kept, alarm as usize - 1);
                }
            }
        }
        valid
    }

    /// Checks the scalars that only the end of a step changes.
    pub(crate) fn scalars_are_valid(&self, model: &Model<'_>) -> bool {
        let header = &self.header;
        let plan = model.carbon();
        let steps = self.settled_steps();
        let fleet_uj = model.uav_count() as u64 * model.energy().charge_uj;
        let step_ng = carbon::emitted_ng(fleet_uj, plan.intensity_max_mg_per_kwh);
        let in_range = |intensity: u64| {
            intensity >= plan.intensity_min_mg_per_kwh && intensity <= plan.intensity_max_mg_per_kwh
        };
        let reals = [
            header.mean_throughput(),
            header.throughput_sum(),
            header.pilot_sum(),
            header.goal_potential(),
            header.charge_potential(),
            header.return_sum(),
        ];
        let mut numbers = true;
        for real in reals {
            numbers &= real.is_finite() && !is_negative_zero(real);
        }
        for reward in header.rewards() {
            numbers &= reward.is_finite() && !is_negative_zero(reward);
        }
        numbers
            && in_range(header.intensity_mg_per_kwh())
            && (header.billed_intensity_mg_per_kwh() == 0
                || in_range(header.billed_intensity_mg_per_kwh()))
            && header.moves() <= steps * model.uav_count() as u64
            && header.grid_uj() <= steps * fleet_uj
            && header.co2_ng() <= steps * step_ng
            && header.mean_throughput() >= 0.0
            && header.mean_throughput() <= THROUGHPUT_MAX
            && potentials_are_in_range(model, header.goal_potential(), header.charge_potential())
            && self.uav_rewards_are_valid(model)
    }

    /// Checks that potentials are in range and rewards are finite. Only the end of a step changes
    /// them.
    fn uav_rewards_are_valid(&self, model: &Model<'_>) -> bool {
        let mut numbers = true;
        for i in 0..model.uav_count() {
            let (goal, charge) = (self.goal_potential(i), self.charge_potential(i));
            numbers &= !is_negative_zero(goal) && !is_negative_zero(charge);
            numbers &= potentials_are_in_range(model, goal, charge);
            for slot in 0..OWN_KEPT {
                let own = f64::from_bits(self.own_rewards[i * OWN_KEPT + slot]);
                numbers &= own.is_finite() && !is_negative_zero(own);
            }
        }
        numbers
    }
}

/// Whether a UAV learns a hotspot only once a quorum has confirmed it.
fn learns_confirmed(model: &Model<'_>) -> bool {
    model.config().learned_detections == LearnedDetections::Confirmed
}

/// Largest throughput that a legal configuration or a host can give.
pub(crate) const THROUGHPUT_MAX: f64 = 1e9;

fn is_negative_zero(real: f64) -> bool {
    real.to_bits() == (-0.0f64).to_bits()
}
