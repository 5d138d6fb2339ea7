//! Input features of the set networks, laid out for their matrix products.
//!
//! The features have no gradient, so plain loops compute them once, outside the tensor library. As
//! tensor operations, they took many small passes over memory.

use super::{Actor, COMMON, CROWD, Critic, HOTSPOT_FIELDS, OWN_FIRST, SLOT_FIELDS, UAV_FIELDS};
use crate::environment::Shape;
use jcas_policy::network::features::{describe_hotspots, describe_neighbour, distance, nearness};
use jcas_policy::network::reach::chance;

/// 1 for a slot with a neighbour, whether it has chosen or not, and 0 for an empty one.
fn present(slot: &[f32]) -> f32 {
    f32::from(slot[0] != 0.0)
}

/// The actor's features of observations (rows × 11 + 4n + 3k + added), laid out as in
/// [`Actor::widths`].
pub(in crate::network) fn observed(rows: &[f32], shape: &Shape, actor: Actor) -> Vec<f32> {
    let (n, k) = (shape.hotspots, shape.neighbour_slots);
    let length = shape.observation_len;
    let count = rows.len() / length;
    let cells = shape.position_cells();
    let mut out = Vec::with_capacity(count * actor.widths(shape).iter().sum::<usize>());
    for row in rows.chunks_exact(length) {
        let (head, rest) = row.split_at(OWN_FIRST);
        let (hotspots, rest) = rest.split_at(HOTSPOT_FIELDS * n);
        let (slots, tail) = rest.split_at(SLOT_FIELDS * k);
        out.extend_from_slice(head);
        out.extend_from_slice(tail);
        if actor.fleet_size {
            out.push(shape.agents as f32 / CROWD);
        }
        let mut taken = 0.0;
        for slot in slots.chunks_exact(SLOT_FIELDS) {
            let present = present(slot);
            let first = out.len();
            out.resize(first + actor.neighbour_features(), 0.0);
            // An empty slot is all zeros.
            if present > 0.0 {
                describe_neighbour(slot, cells, &mut out[first..]);
            }
            out.push(present);
            taken += present;
        }
        out.push(k as f32 - taken);
        let first = out.len();
        out.resize(first + n * actor.hotspot_features(), 0.0);
        let reach = actor.choices.then_some(shape.reach);
        describe_hotspots(hotspots, slots, cells, reach, &mut out[first..]);
    }
    out
}

/// The critic's features of global states (rows × 6N + 4n + 4), laid out as in
/// [`Critic::widths`].
pub(in crate::network) fn overseen(rows: &[f32], shape: &Shape, critic: Critic) -> Vec<f32> {
    let (agents, n) = (shape.agents, shape.hotspots);
    let length = UAV_FIELDS * agents + HOTSPOT_FIELDS * n + COMMON;
    let count = rows.len() / length;
    let cells = shape.position_cells();
    let mut out = Vec::with_capacity(count * critic.widths(shape).iter().sum::<usize>());
    for row in rows.chunks_exact(length) {
        let (uavs, rest) = row.split_at(UAV_FIELDS * agents);
        let (hotspots, common) = rest.split_at(HOTSPOT_FIELDS * n);
        out.extend_from_slice(common);
        for uav in uavs.chunks_exact(UAV_FIELDS) {
            out.extend_from_slice(uav);
            out.push(1.0);
        }
        for hotspot in hotspots.chunks_exact(HOTSPOT_FIELDS) {
            let (mut near, mut covered) = ([0.0; 3], 0.0);
            for uav in uavs.chunks_exact(UAV_FIELDS) {
                let apart = distance(hotspot[0] - uav[0], hotspot[1] - uav[1], cells);
                for (sum, reach) in near.iter_mut().zip([1.0, 4.0, 12.0]) {
                    *sum += nearness(apart, reach);
                }
                let [dx, dy] = [hotspot[0] - uav[0], hotspot[1] - uav[1]];
                covered += chance(dx * cells[0], dy * cells[1], shape.reach);
            }
            out.extend_from_slice(hotspot);
            out.extend(near.map(|sum| sum / CROWD));
            if critic.cover {
                out.push(covered / CROWD);
            }
        }
    }
    out
}
