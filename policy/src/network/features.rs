//! Features of hotspots that set networks read: distances, and the UAVs at and around them.
//!
//! They are computed because learning them would take one layer or several.

use super::reach::chance;
use super::row::{HOTSPOT_FIELDS, SLOT_FIELDS};

/// The divisor of sums over a set, which keeps them near 1 for the paper's sizes.
pub const CROWD: f32 = 8.0;

/// Features besides the fields of an observation: the distance, two nearnesses, and the UAVs at and
/// around the hotspot.
const ALWAYS: usize = 5;
/// Features with a reach: the chances of detection of the UAV and of its neighbours.
const WITH_REACH: usize = 2;

/// Returns the number of features of a hotspot, for a network that reads the radar's reach or not.
#[must_use]
pub const fn hotspot_features(reads_reach: bool) -> usize {
    HOTSPOT_FIELDS + ALWAYS + if reads_reach { WITH_REACH } else { 0 }
}

/// Returns 1 at distance 0, falling linearly to 0 at `reach` cells.
#[must_use]
pub fn nearness(distance: f32, reach: f32) -> f32 {
    let near = 1.0 - distance / reach;
    if near > 0.0 { near } else { 0.0 }
}

/// Returns the Manhattan distance in cells. A position difference of 1 stands for `cells`.
#[must_use]
pub fn distance(dx: f32, dy: f32, cells: [f32; 2]) -> f32 {
    dx.abs() * cells[0] + dy.abs() * cells[1]
}

/// Writes the features of each hotspot of an observation.
///
/// `hotspots` and `slots` are the blocks of an observation, and a position difference of 1 stands
/// for `cells`. `features` has [`hotspot_features`] numbers for each hotspot. Hotspots beyond its
/// end are left out.
pub fn describe_hotspots(
    hotspots: &[f32],
    slots: &[f32],
    cells: [f32; 2],
    reach: Option<f32>,
    features: &mut [f32],
) {
    // A grid of one column has no distance along x, and a divisor of 1 avoids a division by zero.
    let far_scale = if cells[0] > 0.0 { 2.0 * cells[0] } else { 1.0 };
    let detection = |dx: f32, dy: f32, reach: f32| chance(dx * cells[0], dy * cells[1], reach);
    let outs = features.chunks_exact_mut(hotspot_features(reach.is_some()));
    for (hotspot, out) in hotspots.chunks_exact(HOTSPOT_FIELDS).zip(outs) {
        let far = distance(hotspot[0], hotspot[1], cells);
        let (mut at, mut around, mut covered) = (0.0, 0.0, 0.0);
        for slot in slots.chunks_exact(SLOT_FIELDS) {
            if slot[0] == 0.0 {
                continue;
            }
            let (dx, dy) = (hotspot[0] - slot[1], hotspot[1] - slot[2]);
            let apart = distance(dx, dy, cells);
            at += nearness(apart, 1.0);
            around += nearness(apart, 4.0);
            if let Some(reach) = reach {
                covered += detection(dx, dy, reach);
            }
        }
        let (fields, derived) = out.split_at_mut(HOTSPOT_FIELDS);
        let (always, with_reach) = derived.split_at_mut(ALWAYS);
        fields.copy_from_slice(hotspot);
        always.copy_from_slice(&[
            far / far_scale,
            nearness(far, 1.0),
            nearness(far, 4.0),
            at / CROWD,
            around / CROWD,
        ]);
        if let Some(reach) = reach {
            let own = detection(hotspot[0], hotspot[1], reach);
            with_reach.copy_from_slice(&[own, covered / CROWD]);
        }
    }
}
