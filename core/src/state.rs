//! The state: one slab of words in the caller's memory, seen as named quantities.
//!
//! A state holds no pointer, so that a snapshot is one copy and a thousand states lie side by side.
//!
//! The slab, in words, for N UAVs and n hotspots; the list below is its order:
//!
//! ```text
//! | header | N words each: cells .. potentials | own rewards | UAV sets | n words each | hotspot sets |
//! | scalars| one row a quantity               | 7 N         | N bits   | cells, times | n bits       |
//!
//! | knowledge     | links          | visited     | searched       | given | detected      |
//! | N rows of n b | N rows of N b  | W H bits    | N rows, or none| N     | N rows of n b |
//! ```

use crate::bits;
use crate::config::Cell;
use crate::error::Error;
use crate::header::{self, HeaderMut, HeaderRef, Phase};
use crate::layout::Layout;
use crate::model::Model;
use crate::reward::{self, OWN, OWN_KEPT, Rewards};
use crate::word::stored;

/// Declares both views of a state from one list, so that they cannot disagree on the layout.
macro_rules! state {
    ($( $(#[$meta:meta])* $name:ident: $length:expr; )+) => {
        /// A state to read.
        #[derive(Clone, Copy, Debug)]
        pub struct StateRef<'a> {
            /// Scalars.
            pub header: HeaderRef<'a>,
            $( $(#[$meta])* pub(crate) $name: &'a [u64], )+
            pub(crate) layout: Layout,
        }

        /// A state to change.
        #[derive(Debug)]
        pub struct StateMut<'a> {
            /// Scalars.
            pub header: HeaderMut<'a>,
            $( $(#[$meta])* pub(crate) $name: &'a mut [u64], )+
            pub(crate) layout: Layout,
        }

        impl<'a> StateRef<'a> {
            pub(crate) fn split(layout: Layout, words: &'a [u64]) -> Self {
                let (header, _rest) = words.split_at(header::WORDS);
                $( let (one, _rest) = _rest.split_at(length(&layout, $length)); let $name = one; )+
                Self { header: HeaderRef(header), $( $name, )+ layout }
            }
        }

        impl<'a> StateMut<'a> {
            pub(crate) fn split(layout: Layout, words: &'a mut [u64]) -> Self {
                let (header, _rest) = words.split_at_mut(header::WORDS);
                $( let (one, _rest) = _rest.split_at_mut(length(&layout, $length)); let $name = one; )+
                Self { header: HeaderMut(header), $( $name, )+ layout }
            }

            /// The same state to read.
            #[must_use]
            pub fn as_ref(&self) -> StateRef<'_> {
                StateRef { header: self.header.as_ref(), $( $name: &*self.$name, )+ layout: self.layout }
            }
        }
    };
}

/// How many words a quantity takes.
enum Length {
    PerUav,
    OwnRewards,
    PerHotspot,
    UavSet,
    HotspotSet,
    Knowledge,
    Links,
    Visited,
    Maps,
}

const fn length(layout: &Layout, length: Length) -> usize {
    let (uavs, hotspots) = (layout.uavs, layout.hotspots);
    match length {
        Length::PerUav => uavs,
        Length::OwnRewards => OWN_KEPT * uavs,
        Length::PerHotspot => hotspots,
        Length::UavSet => bits::words_for(uavs),
        Length::HotspotSet => bits::words_for(hotspots),
        Length::Knowledge => uavs * bits::words_for(hotspots),
        Length::Links => uavs * bits::words_for(uavs),
        Length::Visited => layout.visited,
        Length::Maps => uavs * layout.map,
    }
}

state! {
    /// Cell of each UAV.
    cells: Length::PerUav;
    /// Cell of each UAV before the present (or last) step.
    previous: Length::PerUav;
    /// Charge of each UAV.
    battery: Length::PerUav;
    /// Charge of each UAV at the start of the episode.
    initial: Length::PerUav;
    /// Energy accepted from chargers.
    accepted: Length::PerUav;
    /// Energy spent.
    spent: Length::PerUav;
    /// Energy asked for that was not there.
    shortfall: Length::PerUav;
    /// Pilot density, as bits of f64.
    pilot: Length::PerUav;
    /// Mean normalised throughput η̄_i, as bits of f64.
    throughput: Length::PerUav;
    /// Φ of the distance to hotspots, as bits of f64.
    goal_potential: Length::PerUav;
    /// Φ of carbon-aware charging, as bits of f64.
    charge_potential: Length::PerUav;
    /// Own components of each UAV's last reward, as bits of f64.
    own_rewards: Length::OwnRewards;
    /// UAVs whose battery was empty at the start of the step.
    grounded: Length::UavSet;
    /// UAVs sent to a depot by a low battery.
    returning: Length::UavSet;
    /// UAVs that did not know some hotspot when they sensed.
    sensing: Length::UavSet;
    /// Cell of each hotspot.
    hotspots: Length::PerHotspot;
    /// Step of each confirmation; 0 before.
    confirmed_at: Length::PerHotspot;
    /// Step at which all UAVs know the hotspot; 0 before.
    informed_at: Length::PerHotspot;
    /// Confirmed hotspots.
    confirmed: Length::HotspotSet;
    /// Hotspots that all UAVs know.
    informed: Length::HotspotSet;
    /// For each UAV the hotspots that it knows.
    knowledge: Length::Knowledge;
    /// For each UAV its neighbours in the radio graph.
    links: Length::Links;
    /// Cells that any UAV has been in.
    visited: Length::Visited;
    /// For each UAV the cells that it knows to have been looked at; nothing without maps.
    searched: Length::Maps;
    /// What a host has put into each battery, less what it has taken out, as bits of i64.
    given: Length::PerUav;
    /// For each UAV the hotspots that it detected when it last sensed.
    detected: Length::Knowledge;
}

impl Model<'_> {
    /// Looks at a state of this model.
    ///
    /// # Errors
    /// [`Error::Length`] unless `words` has [`Model::state_words`] elements; [`Error::ModelMismatch`]
    /// unless the state was reset with this configuration.
    pub fn state<'a>(&self, words: &'a [u64]) -> Result<StateRef<'a>, Error> {
        self.check_len(words.len())?;
        let state = StateRef::split(*self.layout(), words);
        if state.header.config_hash() == self.config_hash() && state.header.phase().is_some() {
            Ok(state)
        } else {
            Err(Error::ModelMismatch)
        }
    }

    /// Opens a state of this model for change.
    ///
    /// # Errors
    /// As [`Model::state`].
    pub fn state_mut<'a>(&self, words: &'a mut [u64]) -> Result<StateMut<'a>, Error> {
        self.state(words)?;
        Ok(StateMut::split(*self.layout(), words))
    }

    pub(crate) fn check_len(&self, got: usize) -> Result<(), Error> {
        let expected = self.state_words();
        if got == expected {
            Ok(())
        } else {
            Err(Error::Length {
                what: "state memory",
                expected,
                got,
            })
        }
    }
}

impl StateMut<'_> {
    /// Cell of UAV `i`.
    #[inline]
    #[must_use]
    pub fn cell(&self, i: usize) -> Cell {
        Cell::from_word(self.cells[i])
    }

    /// Cell of hotspot `j`.
    #[inline]
    #[must_use]
    pub fn hotspot_cell(&self, j: usize) -> Cell {
        Cell::from_word(self.hotspots[j])
    }

    /// Pilot density of UAV `i`.
    #[inline]
    #[must_use]
    pub fn pilot_density(&self, i: usize) -> f64 {
        f64::from_bits(self.pilot[i])
    }

    #[inline]
    pub(crate) fn set_pilot_density(&mut self, i: usize, density: f64) {
        self.pilot[i] = stored(density);
    }

    #[inline]
    pub(crate) fn set_throughput(&mut self, i: usize, throughput: f64) {
        self.throughput[i] = stored(throughput);
    }

    #[inline]
    pub(crate) fn set_goal_potential(&mut self, i: usize, potential: f64) {
        self.goal_potential[i] = stored(potential);
    }

    #[inline]
    pub(crate) fn set_charge_potential(&mut self, i: usize, potential: f64) {
        self.charge_potential[i] = stored(potential);
    }
}

impl<'a> StateRef<'a> {
    /// Steps begun since the reset.
    #[must_use]
    pub fn t(&self) -> u32 {
        self.header.t()
    }

    /// Seed of the episode.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.header.seed()
    }

    /// Whether every hotspot is informed.
    #[must_use]
    pub fn terminated(&self) -> bool {
        self.header.phase() == Some(Phase::Terminated)
    }

    /// Whether the horizon ended the episode.
    #[must_use]
    pub fn truncated(&self) -> bool {
        self.header.phase() == Some(Phase::Truncated)
    }

    /// UAVs.
    #[must_use]
    pub const fn uav_count(&self) -> usize {
        self.layout.uavs
    }

    /// Hotspots.
    #[must_use]
    pub const fn hotspot_count(&self) -> usize {
        self.layout.hotspots
    }

    /// Cell of UAV `i`.
    #[inline]
    #[must_use]
    pub fn cell(&self, i: usize) -> Cell {
        Cell::from_word(self.cells[i])
    }

    /// Whether UAV `i` changed its cell in the last step.
    #[inline]
    #[must_use]
    pub fn moved(&self, i: usize) -> bool {
        self.cells[i] != self.previous[i]
    }

    /// Charge of UAV `i`.
    #[must_use]
    pub fn battery_uj(&self, i: usize) -> u64 {
        self.battery[i]
    }

    /// Charge of UAV `i` at the start of the episode.
    #[must_use]
    pub fn initial_uj(&self, i: usize) -> u64 {
        self.initial[i]
    }

    /// Energy that UAV `i` accepted from chargers.
    #[must_use]
    pub fn accepted_uj(&self, i: usize) -> u64 {
        self.accepted[i]
    }

    /// Energy that UAV `i` spent.
    #[must_use]
    pub fn spent_uj(&self, i: usize) -> u64 {
        self.spent[i]
    }

    /// What a host has put into the battery of UAV `i`, less what it has taken out.
    #[must_use]
    pub fn given_uj(&self, i: usize) -> i64 {
        self.given[i] as i64
    }

    /// Energy that UAV `i` asked for and did not have.
    #[must_use]
    pub fn shortfall_uj(&self, i: usize) -> u64 {
        self.shortfall[i]
    }

    /// Pilot density of UAV `i`.
    #[inline]
    #[must_use]
    pub fn pilot_density(&self, i: usize) -> f64 {
        f64::from_bits(self.pilot[i])
    }

    /// η̄_i of UAV `i`.
    #[inline]
    #[must_use]
    pub fn throughput(&self, i: usize) -> f64 {
        f64::from_bits(self.throughput[i])
    }

    /// η̄(t).
    #[must_use]
    pub fn mean_throughput(&self) -> f64 {
        self.header.mean_throughput()
    }

    /// Whether UAV `i` had an empty battery at the start of the last step.
    #[must_use]
    pub fn grounded(&self, i: usize) -> bool {
        bits::get(self.grounded, i)
    }

    /// Whether a low battery sent UAV `i` toward a depot in the last step.
    #[must_use]
    pub fn returning(&self, i: usize) -> bool {
        bits::get(self.returning, i)
    }

    /// Whether UAVs `i` and `k` are neighbours.
    #[must_use]
    pub fn linked(&self, i: usize, k: usize) -> bool {
        bits::get(self.links_of(i), k)
    }

    /// Neighbours of UAV `i`, ascending.
    pub fn neighbours(&self, i: usize) -> impl Iterator<Item = usize> + 'a {
        bits::iter(self.links_of(i))
    }

    /// Neighbours of UAV `i`, as a set.
    #[inline]
    #[must_use]
    pub fn links_of(&self, i: usize) -> &'a [u64] {
        let row = bits::words_for(self.layout.uavs);
        &self.links[i * row..(i + 1) * row]
    }

    /// Hotspots that UAV `i` knows, as a set.
    #[inline]
    #[must_use]
    pub fn knowledge_of(&self, i: usize) -> &'a [u64] {
        let row = bits::words_for(self.layout.hotspots);
        &self.knowledge[i * row..(i + 1) * row]
    }

    /// k_ij: whether UAV `i` knows hotspot `j`.
    #[inline]
    #[must_use]
    pub fn knows(&self, i: usize, j: usize) -> bool {
        bits::get(self.knowledge_of(i), j)
    }

    /// Whether UAV `i` detected hotspot `j` when it last sensed.
    #[inline]
    #[must_use]
    pub fn detected(&self, i: usize, j: usize) -> bool {
        let row = bits::words_for(self.layout.hotspots);
        bits::get(&self.detected[i * row..(i + 1) * row], j)
    }

    /// Cell of hotspot `j`.
    #[inline]
    #[must_use]
    pub fn hotspot_cell(&self, j: usize) -> Cell {
        Cell::from_word(self.hotspots[j])
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

    /// Confirmed hotspots.
    #[must_use]
    pub fn confirmed_count(&self) -> usize {
        bits::count(self.confirmed)
    }

    /// Hotspots that all UAVs know.
    #[must_use]
    pub fn informed_count(&self) -> usize {
        bits::count(self.informed)
    }

    /// Step at which hotspot `j` was confirmed.
    #[must_use]
    pub fn confirmed_at(&self, j: usize) -> Option<u32> {
        (self.confirmed_at[j] != 0).then_some(self.confirmed_at[j] as u32)
    }

    /// Step at which hotspot `j` became informed.
    #[must_use]
    pub fn informed_at(&self, j: usize) -> Option<u32> {
        (self.informed_at[j] != 0).then_some(self.informed_at[j] as u32)
    }

    /// Whether any UAV has been in the cell with this row-major index.
    #[must_use]
    pub fn visited(&self, cell_index: usize) -> bool {
        bits::get(self.visited, cell_index)
    }

    /// The cells that UAV `i` knows to have been looked at, as a set of row-major indices; of no words
    /// without search maps.
    #[inline]
    #[must_use]
    pub fn searched_of(&self, i: usize) -> &'a [u64] {
        let row = self.layout.map;
        &self.searched[i * row..(i + 1) * row]
    }

    /// Whether UAV `i` knows the cell with this row-major index to have been looked at; never without
    /// search maps.
    #[must_use]
    pub fn searched(&self, i: usize, cell_index: usize) -> bool {
        self.layout.map > 0 && bits::get(self.searched_of(i), cell_index)
    }

    /// Carbon intensity that the coming step will be billed with.
    #[must_use]
    pub fn carbon_intensity_mg_per_kwh(&self) -> u64 {
        self.header.intensity_mg_per_kwh()
    }

    /// Carbon intensity that the last step was billed with; 0 before the first.
    #[must_use]
    pub fn billed_intensity_mg_per_kwh(&self) -> u64 {
        self.header.billed_intensity_mg_per_kwh()
    }

    /// Carbon emitted in the episode.
    #[must_use]
    pub fn co2_ng(&self) -> u64 {
        self.header.co2_ng()
    }

    /// Grid energy billed in the episode.
    #[must_use]
    pub fn grid_uj(&self) -> u64 {
        self.header.grid_uj()
    }

    /// Components of the last reward, in the order of [`crate::reward::NAMES`].
    #[must_use]
    pub fn rewards(&self) -> Rewards {
        self.header.rewards()
    }

    /// Components of the last reward of UAV `i`, in the order of [`crate::reward::NAMES`]: the team's where
    /// they are shared, its own in [`crate::reward::OWN`].
    #[inline]
    #[must_use]
    pub fn uav_rewards(&self, i: usize) -> Rewards {
        let mut rewards = self.rewards();
        for slot in 0..OWN_KEPT {
            rewards[OWN[slot]] = f64::from_bits(self.own_rewards[i * OWN_KEPT + slot]);
        }
        rewards
    }

    /// R_i of every UAV.
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

    /// R_i: the last reward of UAV `i`. The mean over the fleet is R_t.
    #[inline]
    #[must_use]
    pub fn uav_reward(&self, i: usize) -> f64 {
        reward::total(&self.uav_rewards(i))
    }

    /// Φ of the distance to hotspots of UAV `i`.
    #[must_use]
    pub fn goal_potential(&self, i: usize) -> f64 {
        f64::from_bits(self.goal_potential[i])
    }

    /// Φ of carbon-aware charging of UAV `i`.
    #[must_use]
    pub fn charge_potential(&self, i: usize) -> f64 {
        f64::from_bits(self.charge_potential[i])
    }
}
