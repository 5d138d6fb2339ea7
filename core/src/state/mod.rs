//! The state: one slab of `u64` words in the caller's memory, viewed as named quantities.
//!
//! A state holds no pointer, so that a copy of its words is a copy of the state.
//!
//! The slab, in words, for N UAVs and n hotspots; the list below is its order:
//!
//! ```text
//! | header | N words each: cells .. potentials | own rewards | UAV sets | n words each |
//! | scalars| one row a quantity               | 7 N         | N bits   | cells, times |
//!
//! | hotspot sets | knowledge  | links      | visited  | searched       | given | detected   |
//! | n bits       | N × n bits | N × N bits | W H bits | N rows or none | N     | N × n bits |
//!
//! | false alarms  | falsely confirmed | newly so | sightings      | reports        |
//! | 8 N or none   | W H bits or none  | 1 or none| N rows or none | N rows or none |
//!
//! | remembered detections | remembered false alarms |
//! | N × n bits or none    | N × W H bits or none    |
//! ```

pub mod header;
mod queries;
pub(crate) mod scratch;
pub(crate) mod validity;

use self::header::{HeaderMut, HeaderRef};
use crate::config::Cell;
use crate::constants::layout::Layout;
use crate::constants::reward::OWN_KEPT;
use crate::error::Error;
use crate::model::Model;
use crate::radio::false_alarms::ALARMS_MAX;
use crate::words::bits;
use crate::words::word::canonical_bits;

/// Declares both views of a state from one list, so that they cannot disagree on the layout.
macro_rules! state {
    ($( $(#[$meta:meta])* $name:ident: $length:expr; )+) => {
        /// A read-only view of a state.
        ///
        /// Indices `i` and `k` of UAVs are below N, and indices `j` of hotspots are below n.
        #[derive(Clone, Copy, Debug)]
        pub struct StateRef<'a> {
            /// Scalars.
            pub header: HeaderRef<'a>,
            $( $(#[$meta])* pub(crate) $name: &'a [u64], )+
            pub(crate) layout: Layout,
        }

        /// A writable view of a state, which the steps of a [`Model`] change.
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
                $(
                    let (one, _rest) = _rest.split_at(length(&layout, $length));
                    let $name = one;
                )+
                Self { header: HeaderRef(header), $( $name, )+ layout }
            }
        }

        impl<'a> StateMut<'a> {
            pub(crate) fn split(layout: Layout, words: &'a mut [u64]) -> Self {
                let (header, _rest) = words.split_at_mut(header::WORDS);
                $(
                    let (one, _rest) = _rest.split_at_mut(length(&layout, $length));
                    let $name = one;
                )+
                Self { header: HeaderMut(header), $( $name, )+ layout }
            }

            /// A read-only view of the same state.
            #[must_use]
            pub fn as_ref(&self) -> StateRef<'_> {
                StateRef {
                    header: self.header.as_ref(),
                    $( $name: &*self.$name, )+
                    layout: self.layout,
                }
            }
        }
    };
}

/// The length of a quantity in words.
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
    Alarms,
    FalseCells,
    FalseCount,
    Reports,
    Remembered,
    RememberedFalse,
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
        Length::Alarms => uavs * layout.alarms,
        Length::FalseCells => layout.false_cells,
        Length::FalseCount => layout.alarms / ALARMS_MAX,
        Length::Reports => uavs * layout.reports,
        Length::Remembered => uavs * layout.remembered,
        Length::RememberedFalse => uavs * layout.remembered_false,
    }
}

state! {
    /// Cell of each UAV.
    cells: Length::PerUav;
    /// Cell of each UAV before the present step, or between steps before the last one.
    previous: Length::PerUav;
    /// Charge of each UAV, in microjoules.
    battery: Length::PerUav;
    /// Charge of each UAV at the start of the episode, in microjoules.
    initial: Length::PerUav;
    /// Energy that each UAV accepted from chargers, in microjoules.
    accepted: Length::PerUav;
    /// Energy that each UAV spent, in microjoules.
    spent: Length::PerUav;
    /// Energy that each UAV requested and its battery lacked, in microjoules.
    shortfall: Length::PerUav;
    /// Pilot density of each UAV, as bits of f64.
    pilot: Length::PerUav;
    /// Mean normalised throughput η̄_i of each UAV, as bits of f64.
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
    /// UAVs for which some hotspot was unknown or not confirmed when they sensed.
    sensing: Length::UavSet;
    /// Cell of each hotspot.
    hotspots: Length::PerHotspot;
    /// Step at which each hotspot was confirmed; 0 before.
    confirmed_at: Length::PerHotspot;
    /// Step at which all UAVs know the hotspot; 0 before.
    informed_at: Length::PerHotspot;
    /// Confirmed hotspots.
    confirmed: Length::HotspotSet;
    /// Hotspots that all UAVs know.
    informed: Length::HotspotSet;
    /// The hotspots that each UAV knows.
    knowledge: Length::Knowledge;
    /// The neighbours of each UAV in the radio graph.
    links: Length::Links;
    /// Cells that any UAV has visited.
    visited: Length::Visited;
    /// The cells that each UAV knows to have been searched; no words without maps.
    searched: Length::Maps;
    /// Energy that a host added to each battery less what it removed, in microjoules as bits of
    /// i64.
    given: Length::PerUav;
    /// The hotspots that each UAV detected when it last sensed.
    detected: Length::Knowledge;
    /// Cells in which each UAV raised a false alarm when it last sensed; no words without false
    /// alarms. They are row-major indices plus 1, and 0 after the last of them.
    false_alarms: Length::Alarms;
    /// Cells without a hotspot that a quorum has confirmed; no words without false alarms.
    falsely_confirmed: Length::FalseCells;
    /// Number of cells that joined them when the fleet last sensed; no word without false alarms.
    newly_false: Length::FalseCount;
    /// For each UAV and level ℓ, the cells in which it saw a hotspot in at least ℓ steps. There are
    /// no words without reports.
    sightings: Length::Reports;
    /// The cells in which some UAV did so, as far as each UAV knows; no words without reports.
    reports: Length::Reports;
    /// The hotspots that each UAV has detected in the episode; no words unless the quorum counts
    /// them.
    remembered: Length::Remembered;
    /// The cells in which each UAV has raised a false alarm in the episode; no words unless the
    /// quorum counts them.
    remembered_false: Length::RememberedFalse;
}

impl Model<'_> {
    /// Opens a state of this model for reading.
    ///
    /// # Errors
    /// [`Error::Length`] unless `words` has [`Model::state_words`] elements;
    /// [`Error::ModelMismatch`] unless the state was reset with this configuration.
    pub fn state<'a>(&self, words: &'a [u64]) -> Result<StateRef<'a>, Error> {
        self.check_len(words.len())?;
        let state = StateRef::split(*self.layout(), words);
        if state.header.config_hash() == self.config_hash() && state.header.phase().is_some() {
            Ok(state)
        } else {
            Err(Error::ModelMismatch)
        }
    }

    /// Opens a state of this model for writing.
    ///
    /// # Errors
    /// The errors of [`Model::state`].
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

/// Declares the queries that both views of a state have.
macro_rules! queries_of {
    ($view:ident) => {
        impl $view<'_> {
            /// Cell of UAV `i`.
            #[inline]
            #[must_use]
            pub fn cell(&self, i: usize) -> Cell {
                Cell::from_word(self.cells[i])
            }

            /// Cell of UAV `i` before the last step.
            #[inline]
            #[must_use]
            pub fn previous_cell(&self, i: usize) -> Cell {
                Cell::from_word(self.previous[i])
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
        }
    };
}

queries_of!(StateRef);
queries_of!(StateMut);

impl StateMut<'_> {
    #[inline]
    pub(crate) fn set_pilot_density(&mut self, i: usize, density: f64) {
        self.pilot[i] = canonical_bits(density);
    }

    #[inline]
    pub(crate) fn set_throughput(&mut self, i: usize, throughput: f64) {
        self.throughput[i] = canonical_bits(throughput);
    }

    #[inline]
    pub(crate) fn set_goal_potential(&mut self, i: usize, potential: f64) {
        self.goal_potential[i] = canonical_bits(potential);
    }

    #[inline]
    pub(crate) fn set_charge_potential(&mut self, i: usize, potential: f64) {
        self.charge_potential[i] = canonical_bits(potential);
    }
}
