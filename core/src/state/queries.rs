//! What may be read from a state: the methods of [`StateRef`] that [`super::StateMut`] lacks.

use super::StateRef;
use crate::constants::reward::{self, OWN, OWN_KEPT, Rewards};
use crate::state::header::Phase;
use crate::words::bits;

impl<'a> StateRef<'a> {
    /// Number of steps begun since the reset (t).
    #[must_use]
    pub fn t(&self) -> u32 {
        self.header.t()
    }

    /// Seed of the episode.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.header.seed()
    }

    /// Whether the episode terminated: all UAVs know all hotspots, and each is confirmed.
    #[must_use]
    pub fn terminated(&self) -> bool {
        self.header.phase() == Some(Phase::Terminated)
    }

    /// Whether the episode was truncated at the horizon.
    #[must_use]
    pub fn truncated(&self) -> bool {
        self.header.phase() == Some(Phase::Truncated)
    }

    /// Number of UAVs (N).
    #[must_use]
    pub const fn uav_count(&self) -> usize {
        self.layout.uavs
    }

    /// Number of hotspots (n).
    #[must_use]
    pub const fn hotspot_count(&self) -> usize {
        self.layout.hotspots
    }

    /// Whether UAV `i` changed its cell in the last step.
    #[inline]
    #[must_use]
    pub fn moved(&self, i: usize) -> bool {
        self.cells[i] != self.previous[i]
    }

    /// Charge of UAV `i`, in microjoules.
    #[must_use]
    pub fn battery_uj(&self, i: usize) -> u64 {
        self.battery[i]
    }

    /// Charge of UAV `i` at the start of the episode, in microjoules.
    #[must_use]
    pub fn initial_uj(&self, i: usize) -> u64 {
        self.initial[i]
    }

    /// Energy that UAV `i` accepted from chargers in the episode, in microjoules.
    #[must_use]
    pub fn accepted_uj(&self, i: usize) -> u64 {
        self.accepted[i]
    }

    /// Energy that UAV `i` spent in the episode, in microjoules.
    #[must_use]
    pub fn spent_uj(&self, i: usize) -> u64 {
        self.spent[i]
    }

    /// Energy that a host added to the battery of UAV `i` less what it removed, in microjoules.
    #[must_use]
    pub fn given_uj(&self, i: usize) -> i64 {
        self.given[i] as i64
    }

    /// Energy that UAV `i` requested and its battery lacked, in microjoules.
    #[must_use]
    pub fn shortfall_uj(&self, i: usize) -> u64 {
        self.shortfall[i]
    }

    /// Mean normalised throughput η̄_i of UAV `i` toward its neighbours; 0 without neighbours.
    #[inline]
    #[must_use]
    pub fn throughput(&self, i: usize) -> f64 {
        f64::from_bits(self.throughput[i])
    }

    /// Mean of η̄_i over the fleet, η̄(t), for the present radio graph.
    #[must_use]
    pub fn mean_throughput(&self) -> f64 {
        self.header.mean_throughput()
    }

    /// Whether UAV `i` was grounded in the last step, by an empty battery or by the host.
    #[must_use]
    pub fn grounded(&self, i: usize) -> bool {
        bits::get(self.grounded, i)
    }

    /// Whether a low battery sent UAV `i` toward a depot in the last step.
    #[must_use]
    pub fn returning(&self, i: usize) -> bool {
        bits::get(self.returning, i)
    }

    /// Whether UAVs `i` and `k` are neighbours in the radio graph.
    #[must_use]
    pub fn linked(&self, i: usize, k: usize) -> bool {
        bits::get(self.links_of(i), k)
    }

    /// Indices of the neighbours of UAV `i`, in ascending order.
    pub fn neighbours(&self, i: usize) -> impl Iterator<Item = usize> + 'a {
        bits::iter(self.links_of(i))
    }

    /// Neighbours of UAV `i` as a set: bit k of the row stands for UAV k.
    #[inline]
    #[must_use]
    pub fn links_of(&self, i: usize) -> &'a [u64] {
        let row = bits::words_for(self.layout.uavs);
        &self.links[i * row..(i + 1) * row]
    }

    /// Hotspots that UAV `i` knows as a set: bit j of the row stands for hotspot j.
    #[inline]
    #[must_use]
    pub fn knowledge_of(&self, i: usize) -> &'a [u64] {
        let row = bits::words_for(self.layout.hotspots);
        &self.knowledge[i * row..(i + 1) * row]
    }

    /// Whether UAV `i` knows hotspot `j` (k_ij).
    #[inline]
    #[must_use]
    pub fn knows(&self, i: usize, j: usize) -> bool {
        bits::get(self.knowledge_of(i), j)
    }

    /// Whether UAV `i` has detected hotspot `j` in the episode; `false` unless the quorum counts
    /// the episode.
    #[must_use]
    pub fn remembered(&self, i: usize, j: usize) -> bool {
        let row = self.layout.remembered;
        row > 0 && bits::get(&self.remembered[i * row..(i + 1) * row], j)
    }

    /// Whether UAV `i` detected hotspot `j` when it last sensed.
    #[inline]
    #[must_use]
    pub fn detected(&self, i: usize, j: usize) -> bool {
        let row = bits::words_for(self.layout.hotspots);
        bits::get(&self.detected[i * row..(i + 1) * row], j)
    }

    /// Row-major indices of the cells in which UAV `i` raised a false alarm when it last sensed.
    pub fn false_alarms_of(&self, i: usize) -> impl Iterator<Item = usize> + 'a {
        let row = self.layout.alarms;
        let alarms = &self.false_alarms[i * row..(i + 1) * row];
        let raised = alarms.iter().take_while(|&&alarm| alarm > 0);
        raised.map(|&alarm| alarm as usize - 1)
    }

    /// Whether a quorum of false alarms has confirmed the cell with this row-major index.
    #[must_use]
    pub fn falsely_confirmed(&self, cell_index: usize) -> bool {
        self.layout.false_cells > 0 && bits::get(self.falsely_confirmed, cell_index)
    }

    /// Row-major indices of the falsely confirmed cells, in ascending order.
    pub fn falsely_confirmed_cells(&self) -> impl Iterator<Item = usize> + 'a {
        bits::iter(self.falsely_confirmed)
    }

    /// Number of falsely confirmed cells.
    #[must_use]
    pub fn false_confirmation_count(&self) -> usize {
        bits::count(self.falsely_confirmed)
    }

    /// The reports that UAV `i` knows: for each level from 1, a set of row-major indices. There are
    /// no words without reports.
    #[must_use]
    pub fn reports_of(&self, i: usize) -> &'a [u64] {
        let row = self.layout.reports;
        &self.reports[i * row..(i + 1) * row]
    }

    /// The level at which UAV `i` knows a report of the cell with this row-major index, or 0.
    #[must_use]
    pub fn report_level(&self, i: usize, cell_index: usize) -> u32 {
        bits::level(self.reports_of(i), self.layout.false_cells, cell_index)
    }

    /// Number of steps, at most the number of levels, in which UAV `i` saw a hotspot in the cell
    /// with this row-major index. It is 0 without reports.
    #[must_use]
    pub fn sighting_level(&self, i: usize, cell_index: usize) -> u32 {
        let row = self.layout.reports;
        let own = &self.sightings[i * row..(i + 1) * row];
        bits::level(own, self.layout.false_cells, cell_index)
    }

    /// Number of cells that were falsely confirmed when the fleet last sensed.
    #[must_use]
    pub fn new_false_confirmations(&self) -> u32 {
        self.newly_false.first().map_or(0, |&count| count as u32)
    }

    /// Whether hotspot `j` is confirmed.
    #[inline]
    #[must_use]
    pub fn confirmed(&self, j: usize) -> bool {
        bits::get(self.confirmed, j)
    }

    /// Whether all UAVs know hotspot `j`.
    #[inline]
    #[must_use]
    pub fn informed(&self, j: usize) -> bool {
        bits::get(self.informed, j)
    }

    /// Number of confirmed hotspots.
    #[must_use]
    pub fn confirmed_count(&self) -> usize {
        bits::count(self.confirmed)
    }

    /// Number of hotspots that all UAVs know.
    #[must_use]
    pub fn informed_count(&self) -> usize {
        bits::count(self.informed)
    }

    /// Step, from 1, at which hotspot `j` was confirmed; `None` before.
    #[must_use]
    pub fn confirmed_at(&self, j: usize) -> Option<u32> {
        (self.confirmed_at[j] != 0).then_some(self.confirmed_at[j] as u32)
    }

    /// Step, from 1, at which all UAVs knew hotspot `j`; `None` before.
    #[must_use]
    pub fn informed_at(&self, j: usize) -> Option<u32> {
        (self.informed_at[j] != 0).then_some(self.informed_at[j] as u32)
    }

    /// Whether any UAV has visited the cell with this row-major index, y · W + x.
    #[must_use]
    pub fn visited(&self, cell_index: usize) -> bool {
        bits::get(self.visited, cell_index)
    }

    /// The cells that UAV `i` knows to have been searched, as a set of row-major indices. The set
    /// has no words without search maps.
    #[inline]
    #[must_use]
    pub fn searched_of(&self, i: usize) -> &'a [u64] {
        let row = self.layout.map;
        &self.searched[i * row..(i + 1) * row]
    }

    /// Whether UAV `i` knows that the cell with this row-major index has been searched. It is false
    /// without search maps.
    #[must_use]
    pub fn searched(&self, i: usize, cell_index: usize) -> bool {
        self.layout.map > 0 && bits::get(self.searched_of(i), cell_index)
    }

    /// Carbon intensity with which the coming step will be billed, in mg/kWh.
    #[must_use]
    pub fn carbon_intensity_mg_per_kwh(&self) -> u64 {
        self.header.intensity_mg_per_kwh()
    }

    /// Carbon intensity with which the last step was billed, in mg/kWh; 0 before the first step.
    #[must_use]
    pub fn billed_intensity_mg_per_kwh(&self) -> u64 {
        self.header.billed_intensity_mg_per_kwh()
    }

    /// Carbon emitted in the episode by the fleet, in nanograms.
    #[must_use]
    pub fn co2_ng(&self) -> u64 {
        self.header.co2_ng()
    }

    /// Grid energy billed in the episode to the fleet, in microjoules.
    #[must_use]
    pub fn grid_uj(&self) -> u64 {
        self.header.grid_uj()
    }

    /// Components of the team's last reward, in the order of [`crate::constants::reward::NAMES`].
    #[must_use]
    pub fn rewards(&self) -> Rewards {
        self.header.rewards()
    }

    /// Components of the last reward of UAV `i`, in the order of
    /// [`crate::constants::reward::NAMES`].
    ///
    /// The components in [`crate::constants::reward::OWN`] are the UAV's own; the others are
    /// the team's.
    #[inline]
    #[must_use]
    pub fn uav_rewards(&self, i: usize) -> Rewards {
        let mut rewards = self.rewards();
        for slot in 0..OWN_KEPT {
            rewards[OWN[slot]] = f64::from_bits(self.own_rewards[i * OWN_KEPT + slot]);
        }
        rewards
    }

    /// Writes the reward R_i of every UAV.
    #[inline(always)]
    pub(crate) fn write_uav_rewards(&self, out: &mut [f32]) {
        let mut rewards = self.rewards();
        for (reward, own) in out.iter_mut().zip(self.own_rewards.chunks_exact(OWN_KEPT)) {
            for (slot, &index) in OWN.iter().enumerate().take(OWN_KEPT) {
                rewards[index] = f64::from_bits(own[slot]);
            }
            *reward = reward::total(&rewards) as f32;
        }
    }

    /// The last reward R_i of UAV `i`. The mean over the fleet is the team's reward R_t.
    #[inline]
    #[must_use]
    pub fn uav_reward(&self, i: usize) -> f64 {
        reward::total(&self.uav_rewards(i))
    }

    /// Shaping potential Φ of UAV `i` for its distance to hotspots.
    #[must_use]
    pub fn goal_potential(&self, i: usize) -> f64 {
        f64::from_bits(self.goal_potential[i])
    }

    /// Shaping potential Φ of UAV `i` for carbon-aware charging.
    #[must_use]
    pub fn charge_potential(&self, i: usize) -> f64 {
        f64::from_bits(self.charge_potential[i])
    }
}
