//! Features that set networks read: distances of hotspots, the UAVs at and around them, and
//! neighbours in the own cell or the next.
//!
//! They are computed because learning them would take one layer or several.

use super::choices::CHOSEN;
use super::reach::chance;
use super::row::{HOTSPOT_FIELDS, SLOT_FIELDS};

/// The divisor of sums over a set, which keeps them near 1 for the paper's sizes.
pub const CROWD: f32 = 8.0;

/// Features besides the fields of an observation: the distance, two nearnesses, and the UAVs at and
/// around the hotspot.
const ALWAYS: usize = 5;
/// Neighbours near a hotspot whose distances are features.
const NEAREST: usize = 3;
/// Features with a reach: chances of detection, own and summed over neighbours, the UAV's rank, the
/// hotspots around, and the distances of the nearest neighbours.
const WITH_REACH: usize = 4 + NEAREST;

/// Returns the number of features of a hotspot, for a network that reads the radar's reach or not.
#[must_use]
pub const fn hotspot_features(reads_reach: bool) -> usize {
    HOTSPOT_FIELDS + ALWAYS + if reads_reach { WITH_REACH } else { 0 }
}

/// Features of a neighbour besides the fields of its slot: the offset along both axes, cut off at
/// one cell, and two nearnesses.
const LOCAL: usize = 4;

/// Returns the number of features of a neighbour, for a network that reads choices or not.
#[must_use]
pub const fn neighbour_features(reads_choices: bool) -> usize {
    SLOT_FIELDS + if reads_choices { LOCAL } else { 0 }
}

/// Writes the features of the neighbour in a slot: its fields, then those of its offset in cells if
/// `features` has room for them.
///
/// A UAV can then distinguish its own cell from the next one, and count what those before it have
/// chosen. A position difference of 1 stands for `cells`.
pub fn describe_neighbour(slot: &[f32], cells: [f32; 2], features: &mut [f32]) {
    let (fields, local) = features.split_at_mut(SLOT_FIELDS);
    fields.copy_from_slice(slot);
    if let [right, up, here, beside] = local {
        let apart = distance(slot[1], slot[2], cells);
        *right = (slot[1] * cells[0]).clamp(-1.0, 1.0);
        *up = (slot[2] * cells[1]).clamp(-1.0, 1.0);
        *here = nearness(apart, 1.0);
        *beside = nearness(apart, 2.0);
    }
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

/// Puts a value at its place in an ascending list, whose greatest value drops out.
fn insert(ascending: &mut [f32], mut value: f32) {
    for place in ascending {
        if value < *place {
            core::mem::swap(place, &mut value);
        }
    }
}

/// Writes the features of each hotspot of an observation.
///
/// The rank of a UAV at a hotspot is the number of neighbours that come before it. They are nearer,
/// or as near and have chosen.
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
        let (mut rank, mut nearest) = (0.0, [far_scale; NEAREST]);
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
                // Distances are whole cells. Of neighbours as near, those that have chosen come
                // first.
                let margin = if slot[0] == CHOSEN { 0.5 } else { -0.5 };
                rank += f32::from(u8::from(apart < far + margin));
                insert(&mut nearest, apart);
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
            let open = hotspots.chunks_exact(HOTSPOT_FIELDS);
            let open = open.filter(|other| other[2] == 0.0);
            let clustered: f32 = open
                .map(|other| distance(hotspot[0] - other[0], hotspot[1] - other[1], cells))
                .map(|apart| nearness(apart, 4.0))
                .sum();
            let (team, distances) = with_reach.split_at_mut(WITH_REACH - NEAREST);
            team.copy_from_slice(&[own, covered / CROWD, rank / CROWD, clustered / CROWD]);
            for (out, apart) in distances.iter_mut().zip(nearest) {
                *out = apart / far_scale;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // A grid of 9 × 5 with a neighbour in the UAV's own cell, one in the next, and one far away.
    #[test]
    fn neighbours_by_hand() {
        let described = |slot: [f32; SLOT_FIELDS]| {
            let mut features = [9.0; neighbour_features(true)];
            describe_neighbour(&slot, [8.0, 4.0], &mut features);
            features
        };
        let here = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0];
        assert_eq!(described([1.0, 0.0, 0.0]), here);
        let below = [CHOSEN, 0.0, -0.25, 0.0, -1.0, 0.0, 0.5];
        assert_eq!(described([CHOSEN, 0.0, -0.25]), below);
        let far = [1.0, 0.5, 0.25, 1.0, 1.0, 0.0, 0.0];
        assert_eq!(described([1.0, 0.5, 0.25]), far);
        let mut plain = [9.0; neighbour_features(false)];
        describe_neighbour(&[1.0, 0.5, 0.25], [8.0, 4.0], &mut plain);
        assert_eq!(plain, [1.0, 0.5, 0.25]);
    }

    // A UAV in the corner of a grid of 9 × 9, two hotspots and three of four slots taken. Its
    // distances to the hotspots are 4 and 8 cells, and the hotspots lie 4 cells apart.
    #[test]
    fn features_by_hand() {
        let hotspots = [0.5, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0];
        #[rustfmt::skip]
        let slots = [
            // This one has chosen and lies as far from the first hotspot as the UAV itself.
            CHOSEN, 0.5, 0.5,
            1.0, 0.5, 0.0,
            // This one has not chosen, and lies as far from both.
            1.0, 0.0, 0.0,
            0.0, 0.0, 0.0,
        ];
        let mut features = [0.0; 2 * hotspot_features(true)];
        describe_hotspots(&hotspots, &slots, [8.0, 8.0], Some(4.0), &mut features);
        // Chances of detection at 4 and 8 cells, and at 4 cells along both axes, for a reach of 4.
        let (near, far) = (0.5, 1.0 / 17.0);
        let diagonal = 1.0 / (1.0 + 2.0f32.powi(2));
        #[rustfmt::skip]
        let expected = [
            0.5, 0.0, 0.0, 0.0,
            0.25, 0.0, 0.0, 1.0 / CROWD, 1.0 / CROWD,
            near, (near + 1.0 + near) / CROWD,
            // Two are before the UAV, and only the first hotspot is open.
            2.0 / CROWD, 1.0 / CROWD,
            0.0, 0.25, 0.25,
            1.0, 0.0, 1.0, 1.0,
            0.5, 0.0, 0.0, 0.0, 0.0,
            far, (diagonal + near + far) / CROWD,
            2.0 / CROWD, 0.0,
            0.25, 0.5, 0.5,
        ];
        for (index, (got, expected)) in features.iter().zip(expected).enumerate() {
            assert!((got - expected).abs() < 1e-6, "{index}: {got} {expected}");
        }
    }
}
