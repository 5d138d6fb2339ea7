//! Routes of teams over known hotspots, and the changes that may shorten them.

use alloc::vec;
use alloc::vec::Vec;

use jcas_core::Cell;

/// The hotspots of each team, in the order of its visits.
pub(crate) type Routes = Vec<Vec<usize>>;

/// Returns the routes in which the team that is free first takes the open hotspot nearest to it.
///
/// A team is free after the way to its last hotspot and a wait there, both in steps. `starts` and
/// `waits` have one element for each team.
pub(crate) fn nearest_first(
    starts: &[Cell],
    waits: &[f64],
    hotspots: &[Cell],
    mut open: Vec<usize>,
) -> Routes {
    let mut routes = vec![Vec::new(); starts.len()];
    let mut free: Vec<(f64, Cell)> = starts.iter().map(|&cell| (0.0, cell)).collect();
    while !open.is_empty() {
        let next = (0..free.len()).min_by(|&a, &b| free[a].0.total_cmp(&free[b].0));
        let Some(team) = next else { break };
        let (at, here) = free[team];
        let nearest = (0..open.len()).min_by_key(|&index| here.manhattan(hotspots[open[index]]));
        let Some(nearest) = nearest else { break };
        let hotspot = open.swap_remove(nearest);
        let way = f64::from(here.manhattan(hotspots[hotspot]));
        free[team] = (at + way + waits[team], hotspots[hotspot]);
        routes[team].push(hotspot);
    }
    routes
}

/// A change of routes.
pub(crate) enum Change {
    /// Moves a hotspot to a place in a route.
    Shift {
        from: (usize, usize),
        to: (usize, usize),
    },
    /// Reverses a part of a route.
    Reverse {
        team: usize,
        first: usize,
        last: usize,
    },
}

impl Change {
    /// Applies the change.
    pub(crate) fn apply(&self, routes: &mut Routes) {
        match *self {
            Self::Shift { from, to } => {
                let hotspot = routes[from.0].remove(from.1);
                routes[to.0].insert(to.1, hotspot);
            }
            Self::Reverse { team, first, last } => routes[team][first..=last].reverse(),
        }
    }
}

/// Returns every change of one hotspot or of one part of a route.
pub(crate) fn changes(routes: &Routes) -> Vec<Change> {
    let mut changes = Vec::new();
    for (team, route) in routes.iter().enumerate() {
        for first in 0..route.len() {
            for last in first + 1..route.len() {
                changes.push(Change::Reverse { team, first, last });
            }
            for (other, there) in routes.iter().enumerate() {
                // In its own route the hotspot leaves one place fewer.
                for place in 0..there.len() + usize::from(other != team) {
                    if (other, place) != (team, first) {
                        let (from, to) = ((team, first), (other, place));
                        changes.push(Change::Shift { from, to });
                    }
                }
            }
        }
    }
    changes
}
