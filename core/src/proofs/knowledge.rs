//! P7: consensus is the paper's N iterations. P8: knowledge and confirmations only grow, and the
//! quorum decides.
//!
//! Every operation on a row of knowledge is bitwise, so hotspots do not interact: what holds for
//! one bit holds for any number of hotspots.

use super::inputs::between;
#[cfg(not(kani))]
use super::standin as kani;
use crate::rules::knowledge::{consensus, consensus_of_words, receive};
use crate::rules::sensing::{confirms, count_rows, learn, remember};

/// UAVs in the harness. All graphs of up to six are tried one by one in `exhaustive`.
const UAVS: usize = 4;

/// Any symmetric graph without loops, as one row of bits for each UAV.
fn any_graph<const N: usize>() -> [u64; N] {
    let mut links = [0u64; N];
    for i in 0..N {
        for k in 0..i {
            if kani::any() {
                links[i] |= 1 << k;
                links[k] |= 1 << i;
            }
        }
    }
    links
}

/// Any knowledge of one hotspot.
fn any_knowledge<const N: usize>() -> [u64; N] {
    let mut knowledge = [0u64; N];
    for row in &mut knowledge {
        *row = between(0, 1);
    }
    knowledge
}

/// Any two words' map of which one cell, in the second word, may have been looked at.
fn any_maps<const N: usize>() -> [[u64; 2]; N] {
    let mut maps = [[0u64; 2]; N];
    for map in &mut maps {
        map[1] = between(0, 1) << 5;
    }
    maps
}

/// Maps go through the same consensus as knowledge, with rows of their own length: each cell on its
/// own.
fn maps_spread_like_knowledge<const N: usize>(links: &[u64; N], maps: &[[u64; 2]; N]) {
    let mut after = *maps;
    let (mut order, mut unreached, mut union) = ([0; N], [0; 1], [0; 2]);
    consensus(
        N,
        links,
        after.as_flattened_mut(),
        &mut order,
        &mut unreached,
        &mut union,
    );
    for word in 0..2 {
        let mut column = [0; N];
        for i in 0..N {
            column[i] = maps[i][word];
        }
        let literal = literal_rounds(links, &column);
        for i in 0..N {
            assert!(after[i][word] == literal[i]);
            assert!(after[i][word] & maps[i][word] == maps[i][word]);
        }
    }
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(5))]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn maps_spread_by_the_papers_iterations() {
    let links = any_graph::<UAVS>();
    let maps = any_maps::<UAVS>();
    kani::cover!(
        links[0] == 0b10 && links[1] == 0b101 && links[2] == 0b1010,
        "a chain of four"
    );
    kani::cover!(maps[0][1] != 0 && maps[3][1] == 0, "unequal maps");
    maps_spread_like_knowledge(&links, &maps);
}

fn spread<const N: usize>(links: &[u64; N], knowledge: &[u64; N]) -> [u64; N] {
    let mut after = *knowledge;
    let (mut order, mut unreached, mut union) = ([0; N], [0; 1], [0; 1]);
    consensus(N, links, &mut after, &mut order, &mut unreached, &mut union);
    after
}

/// k_i ← k_i ∨ ⋁ k_neighbours, N times, each round from the one before.
fn literal_rounds<const N: usize>(links: &[u64; N], knowledge: &[u64; N]) -> [u64; N] {
    let mut now = *knowledge;
    for _ in 0..N {
        let before = now;
        for i in 0..N {
            for k in 0..N {
                if links[i] >> k & 1 == 1 {
                    now[i] |= before[k];
                }
            }
        }
    }
    now
}

fn equals_the_papers_iterations<const N: usize>(links: &[u64; N], knowledge: &[u64; N]) {
    let after = spread(links, knowledge);
    let literal = literal_rounds(links, knowledge);
    for i in 0..N {
        assert!(after[i] == literal[i]);
    }
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(5))]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn consensus_equals_the_papers_iterations() {
    let links = any_graph::<UAVS>();
    let knowledge = any_knowledge::<UAVS>();
    kani::cover!(
        links[0] == 0b10 && links[2] == 0b1000,
        "two components of two"
    );
    kani::cover!(
        links[0] == 0b10 && links[1] == 0b101 && links[2] == 0b1010,
        "a chain of four"
    );
    kani::cover!(knowledge[0] == 1 && knowledge[3] == 0, "unequal knowledge");
    equals_the_papers_iterations(&links, &knowledge);
}

/// Where a word holds the fleet and another a row, consensus goes by sets.
fn words_equal_the_papers_iterations<const N: usize>(links: &[u64; N], knowledge: &[u64; N]) {
    let mut after = *knowledge;
    consensus_of_words(links, &mut after);
    let literal = literal_rounds(links, knowledge);
    for i in 0..N {
        assert!(after[i] == literal[i]);
    }
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(5))]
pub fn fast_consensus_equals_the_papers_iterations() {
    let links = any_graph::<UAVS>();
    let knowledge = any_knowledge::<UAVS>();
    kani::cover!(
        links[0] == 0b10 && links[2] == 0b1000,
        "two components of two"
    );
    kani::cover!(
        links[0] == 0b1000 && links[3] == 0b101 && links[2] == 0b1010,
        "a chain of four, out of order"
    );
    kani::cover!(knowledge[3] == 1 && knowledge[0] == 0, "unequal knowledge");
    words_equal_the_papers_iterations(&links, &knowledge);
}

/// Nobody forgets, nobody learns what no neighbour knew, and a second consensus changes nothing.
fn grows_and_settles<const N: usize>(links: &[u64; N], knowledge: &[u64; N]) {
    let once = spread(links, knowledge);
    let twice = spread(links, &once);
    for i in 0..N {
        assert!(once[i] & knowledge[i] == knowledge[i]);
        assert!(twice[i] == once[i]);
        if links[i] == 0 {
            assert!(once[i] == knowledge[i]);
        }
        for k in 0..N {
            if links[i] >> k & 1 == 1 {
                assert!(once[i] == once[k]);
            }
        }
    }
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(5))]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn consensus_grows_and_settles() {
    let links = any_graph::<UAVS>();
    let knowledge = any_knowledge::<UAVS>();
    kani::cover!(links[0] == 0, "a UAV alone");
    kani::cover!(links[0] != 0 && knowledge[0] == 0, "a UAV that can learn");
    grows_and_settles(&links, &knowledge);
}

/// A hotspot is confirmed by a step exactly if it was not yet and the quorum is reached.
fn needs_the_quorum(confirmed: bool, uavs: usize, subset: u64, quorum: u64) {
    let mut positives = 0u64;
    for i in 0..uavs {
        positives += subset >> i & 1;
    }
    let now = confirms(confirmed, positives, quorum);
    assert!(now == (!confirmed && positives >= quorum));
    if positives + 1 == quorum {
        assert!(!now);
    }
    if positives == quorum && !confirmed {
        assert!(now);
    }
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(13))]
pub fn confirmation_needs_the_quorum() {
    let confirmed: bool = kani::any();
    let subset = between(0, 0xFFF);
    let quorum = between(1, 12);
    let positives = u64::from(subset.count_ones());
    kani::cover!(!confirmed && positives == quorum, "exactly at the quorum");
    kani::cover!(!confirmed && positives + 1 == quorum, "one short of it");
    kani::cover!(confirmed && positives > quorum, "confirmed before");
    needs_the_quorum(confirmed, 12, subset, quorum);
}

/// A UAV keeps what it knew and adds exactly what it detected and is confirmed.
fn learns_what_is_confirmed(before: u64, detected: u64, confirmed: u64) {
    let mut after = [before];
    learn(&mut after, &[detected], &[confirmed]);
    assert!(after[0] & before == before);
    assert!(after[0] & !before == detected & confirmed & !before);
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(2))]
pub fn knowledge_never_falls() {
    let before: u64 = kani::any();
    let detected: u64 = kani::any();
    let confirmed: u64 = kani::any();
    kani::cover!(detected & confirmed & !before != 0, "something is learnt");
    kani::cover!(
        detected & !confirmed != 0,
        "something detected is not confirmed"
    );
    learns_what_is_confirmed(before, detected, confirmed);
}

/// A detection that a UAV remembers is never taken back, and counts once however often it comes.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(4))]
pub fn a_remembered_detection_counts_once() {
    let before: [u64; 3] = any_knowledge();
    let detected: [u64; 3] = any_knowledge();
    let mut kept = before;
    remember(&mut kept, &detected);
    let mut counts = [kani::any()];
    count_rows(&kept, 1, &mut counts);
    kani::cover!(before[0] & detected[0] == 1, "a UAV detects it again");
    kani::cover!(counts[0] == 3, "all have detected it");
    let mut expected = 0;
    for i in 0..3 {
        assert!(kept[i] == before[i] | detected[i]);
        expected += kept[i];
    }
    assert!(counts[0] == expected);
}

/// Consensus of any fleet changes rows by `receive` alone, which takes nothing away.
#[cfg_attr(kani, kani::proof)]
pub fn what_is_received_is_added() {
    let (before, union): (u64, u64) = (kani::any(), kani::any());
    let mut row = before;
    receive(&mut row, union);
    kani::cover!(row != before, "something new");
    assert!(row & before == before && row == before | union);
}

#[cfg(not(kani))]
super::standin::twins! {
    what_is_received_is_added: 4000 cases, 1 covers;
    a_remembered_detection_counts_once: 500 cases, 2 covers;
    consensus_equals_the_papers_iterations: 4000 cases, 3 covers;
    fast_consensus_equals_the_papers_iterations: 4000 cases, 3 covers;
    consensus_grows_and_settles: 2000 cases, 2 covers;
    maps_spread_by_the_papers_iterations: 4000 cases, 2 covers;
    confirmation_needs_the_quorum: 4000 cases, 3 covers;
    knowledge_never_falls: 2000 cases, 2 covers;
}

/// What is finite is tried wholly.
#[cfg(test)]
mod exhaustive {
    use super::*;

    /// The graph whose edges are the bits of `edges`.
    fn graph<const N: usize>(edges: u32) -> [u64; N] {
        let mut links = [0u64; N];
        let mut bit = 0;
        for i in 0..N {
            for k in 0..i {
                if edges >> bit & 1 == 1 {
                    links[i] |= 1 << k;
                    links[k] |= 1 << i;
                }
                bit += 1;
            }
        }
        links
    }

    /// All graphs with N UAVs. UAV i starts with bit i of its own, so that all
    /// knowledge of one hotspot is a union of columns of one run.
    fn all_graphs<const N: usize>() {
        let own: [u64; N] = core::array::from_fn(|i| 1 << i);
        for edges in 0..1u32 << (N * (N - 1) / 2) {
            let links = graph::<N>(edges);
            equals_the_papers_iterations(&links, &own);
            words_equal_the_papers_iterations(&links, &own);
            grows_and_settles(&links, &own);
        }
    }

    #[test]
    fn every_graph_of_up_to_six_uavs() {
        all_graphs::<1>();
        all_graphs::<2>();
        all_graphs::<3>();
        all_graphs::<4>();
        all_graphs::<5>();
        all_graphs::<6>();
    }

    /// All subsets of up to twelve UAVs against all quorums.
    #[test]
    fn every_subset_of_up_to_twelve_uavs() {
        for uavs in 0..=12usize {
            for subset in 0..1u64 << uavs {
                for quorum in 1..=13 {
                    needs_the_quorum(false, uavs, subset, quorum);
                    needs_the_quorum(true, uavs, subset, quorum);
                }
            }
        }
    }
}

/// The same beyond the harness's bound.
#[cfg(test)]
mod wide {
    use super::*;
    use crate::words::bits;
    use proptest::prelude::*;

    /// Fleets of 70 take two words a row; 64-bit knowledge.
    const FLEET: usize = 70;

    proptest! {
        #[test]
        fn components_of_a_large_fleet_hold_their_union(
            edges in proptest::collection::vec((0..FLEET, 0..FLEET), 0..80),
            knowledge: [[u64; 2]; 35],
        ) {
            let before: [u64; FLEET] = core::array::from_fn(|i| knowledge[i / 2][i % 2]);
            let mut links = [0u64; 2 * FLEET];
            for &(a, b) in edges.iter().filter(|(a, b)| a != b) {
                bits::set(&mut links[2 * a..2 * a + 2], b);
                bits::set(&mut links[2 * b..2 * b + 2], a);
            }
            let mut after = before;
            let (mut order, mut unreached, mut union) = ([0; FLEET], [0; 2], [0; 1]);
            consensus(FLEET, &links, &mut after, &mut order, &mut unreached, &mut union);

            let mut literal = before;
            for _ in 0..FLEET {
                let round = literal;
                for &(a, b) in &edges {
                    literal[a] |= round[b];
                    literal[b] |= round[a];
                }
            }
            prop_assert_eq!(after, literal);
        }
    }
}
