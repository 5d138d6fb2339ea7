//! P10, the part that communicates, in two: what the graph is, and the consensus over any such
//! graph. X1: consensus does not read what working memory held.

use super::inputs::{between, real_between};
#[cfg(not(kani))]
use super::standin as kani;
use super::state::{
    REMEMBERING_WORDS, SCRATCH_WORDS, STATE_WORDS, any_fleet, any_fleet_in, carries_scalars,
    differ, links_join_two, nothing_is_forgotten, open, radios_are_valid, view,
};
use crate::config::Cell;
use crate::model::Model;
use crate::state::header::{self, Phase};
use crate::state::scratch::Scratch;
use crate::state::{StateMut, StateRef};
use crate::words::bits;

/// Any words whose radios are valid.
#[cfg(kani)]
fn any_radios(model: &Model<'_>) -> [u64; STATE_WORDS] {
    let words: [u64; STATE_WORDS] = kani::any();
    kani::assume(radios_are_valid(model, &view(model, &words)));
    words
}

/// A state before its graph is built.
#[cfg(not(kani))]
fn any_radios(model: &Model<'_>) -> [u64; STATE_WORDS] {
    let words = any_fleet(model, Phase::Sensed);
    assert!(radios_are_valid(model, &view(model, &words)));
    words
}

/// The mean throughput of a UAV of the smallest model.
#[cfg_attr(kani, kani::proof)]
pub fn a_mean_throughput_is_bounded() {
    let load = real_between(0.0, 1.0);
    let sum = real_between(0.0, 1e6);
    let degree = between(0, 1) as u32;
    let mean = crate::rules::graph::mean_throughput(load, sum, degree);
    kani::cover!(mean > 1.0, "a throughput");
    kani::cover!(degree == 0, "no neighbour");
    assert!(mean >= 0.0 && mean <= 1e6);
}

/// Links join two UAVs of which none is grounded, both ways, and throughputs are in their range.
fn is_a_graph(model: &Model<'_>, state: &StateRef<'_>) {
    assert!(links_join_two(model, state));
    for i in 0..model.uav_count() {
        assert!(is_a_throughput(state.throughput(i)));
        assert!(!state.grounded(i) || bits::is_empty(state.links_of(i)));
        for k in 0..i {
            assert!(state.linked(i, k) == state.linked(k, i));
        }
    }
    assert!(is_a_throughput(state.mean_throughput()));
}

/// In the range of what the radio of the default configuration reaches, and no negative zero.
fn is_a_throughput(value: f64) -> bool {
    value >= 0.0 && value <= 1e6 && value.to_bits() != (-0.0f64).to_bits()
}

/// For any other words of the state, the result is a valid graph and only the graph is written.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(3))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(
    kani,
    kani::stub(
        crate::rules::graph::mean_throughput,
        crate::proofs::stubs::any_mean_throughput
    )
)]
#[cfg_attr(
    kani,
    kani::stub(
        crate::rules::graph::hear_each_other,
        crate::proofs::stubs::any_hearing
    )
)]
pub fn building_the_graph_keeps_its_contract() {
    given!(model);
    let before = any_radios(&model);
    let mut after = before;
    given!(scratch for model);
    crate::rules::graph::build_graph(&model, &mut open(&model, &mut after), &mut scratch);
    let new = view(&model, &after);
    kani::cover!(model.uav_count() > 1 && new.linked(0, 1), "a link");
    kani::cover!(new.grounded(0), "a grounded UAV");
    is_a_graph(&model, &new);
    let mut expected = before;
    expected[header::MEAN_THROUGHPUT] = after[header::MEAN_THROUGHPUT];
    let only_the_graph = open(&model, &mut expected);
    for i in 0..model.uav_count() {
        only_the_graph.throughput[i] = new.throughput[i];
    }
    for word in 0..new.links.len() {
        only_the_graph.links[word] = new.links[word];
    }
    assert!(!differ(&expected, &after));
}

/// Over any links, throughputs are in their range and only they are written.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(3))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(
    kani,
    kani::stub(
        crate::rules::graph::mean_throughput,
        crate::proofs::stubs::any_mean_throughput
    )
)]
pub fn measuring_the_throughput_keeps_its_contract() {
    given!(model);
    let before = any_radios(&model);
    kani::assume(links_join_two(&model, &view(&model, &before)));
    let mut after = before;
    crate::rules::graph::measure_throughput(&model, &mut open(&model, &mut after));
    let new = view(&model, &after);
    kani::cover!(new.throughput(0) > 0.0, "a throughput");
    kani::cover!(new.mean_throughput() == 0.0, "none");
    assert!(is_a_throughput(new.mean_throughput()));
    let mut expected = before;
    expected[header::MEAN_THROUGHPUT] = after[header::MEAN_THROUGHPUT];
    for i in 0..model.uav_count() {
        assert!(is_a_throughput(new.throughput(i)));
        open(&model, &mut expected).throughput[i] = new.throughput[i];
    }
    assert!(!differ(&expected, &after));
}

/// In a fleet of any size that is linked pair by pair, both ways of building the graph link the
/// same pairs. A test alone: places decide the bounds of its loops, which Kani's symbolic execution
/// does not finish.
#[cfg(not(kani))]
pub fn buckets_link_the_pairs_that_pairs_link() {
    given!(model = any_bucketed_model);
    kani::assume(crate::state::scratch::by_pairs(model.uav_count()));
    let mut words: [u64; STATE_WORDS] = kani::any();
    place_radios(&model, &mut words);
    let (mut pairs, mut buckets) = (words, words);
    given!(scratch for model);
    let layout = *model.layout();
    let mut pairs = StateMut::split(layout, &mut pairs[..model.state_words()]);
    let mut buckets = StateMut::split(layout, &mut buckets[..model.state_words()]);
    link_pairs(&model, &mut pairs, &mut scratch);
    crate::rules::graph::link_by_buckets(&model, &mut buckets, &mut scratch);
    let linked = pairs.links[0] != 0;
    kani::cover!(
        linked && pairs.cells[0] != pairs.cells[1],
        "a link between buckets"
    );
    kani::cover!(pairs.grounded[0] & 1 == 1, "a grounded UAV");
    for word in 0..pairs.links.len() {
        assert!(pairs.links[word] == buckets.links[word]);
    }
    crate::rules::graph::measure_throughput(&model, &mut buckets);
    assert!(pairs.throughput == buckets.throughput);
}

/// Puts every UAV on the grid, with a pilot density in its range.
#[cfg(not(kani))]
fn place_radios(model: &Model<'_>, words: &mut [u64; STATE_WORDS]) {
    let config = model.config();
    let mut state = StateMut::split(*model.layout(), &mut words[..model.state_words()]);
    for i in 0..model.uav_count() {
        let x = between(0, u64::from(config.grid_width) - 1) as u32;
        let y = between(0, u64::from(config.grid_height) - 1) as u32;
        state.cells[i] = Cell { x, y }.to_word();
        let density = real_between(config.pilot_density_min, config.pilot_density_max);
        state.set_pilot_density(i, density);
    }
    for word in 0..state.grounded.len() {
        state.grounded[word] &= bits::valid_mask(word, model.uav_count());
    }
}

#[cfg(not(kani))]
fn link_pairs(model: &Model<'_>, state: &mut StateMut<'_>, scratch: &mut Scratch<'_>) {
    use crate::rules::graph::link_by_pairs;
    crate::lanes::at_width!(model, link_by_pairs(model, state, scratch));
}

/// Consensus over any graph, and what all know is informed.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(3))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(
    kani,
    kani::stub(crate::rules::graph::build_graph, crate::proofs::stubs::any_graph)
)]
pub fn spreading_keeps_the_state_valid() {
    given!(model);
    let before = any_fleet(&model, Phase::Sensed);
    let after = spread(&model, &before);
    let (old, new) = (view(&model, &before), view(&model, &after));
    kani::cover!(model.uav_count() > 1 && new.linked(0, 1), "a link");
    kani::cover!(
        !old.informed(0) && new.informed(0),
        "a hotspot becomes informed"
    );
    kani::cover!(new.grounded(0), "a grounded UAV");
}

/// Communicates, and checks all that holds afterwards.
fn spread<const W: usize>(model: &Model<'_>, before: &[u64; W]) -> [u64; W] {
    let mut after = *before;
    given!(scratch for model);
    let done = model.step_communicate(&mut open(model, &mut after), &mut scratch);
    assert!(done.is_ok());
    let (old, new) = (view(model, before), view(model, &after));
    nothing_is_forgotten(model, &old, &new);
    carries_scalars(&old, &new);
    assert!(new.header.phase() == Some(Phase::Communicated));
    assert!(new.fleet_is_valid(model, Phase::Communicated));
    after
}

/// The same where all UAVs may know a hotspot that is not confirmed.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(3))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(
    kani,
    kani::stub(crate::rules::graph::build_graph, crate::proofs::stubs::any_graph)
)]
pub fn spreading_with_memory_keeps_the_state_valid() {
    given!(model = any_remembering_model);
    let before: [u64; REMEMBERING_WORDS] = any_fleet_in(&model, Phase::Sensed);
    let after = spread(&model, &before);
    let new = view(&model, &after);
    kani::cover!(
        new.informed(0) && !new.confirmed(0),
        "a hotspot is informed before it is confirmed"
    );
}

/// What working memory held before does not matter to consensus over the same graph.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(3))]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn working_memory_does_not_matter_to_consensus() {
    given!(model);
    let mut one = any_fleet(&model, Phase::Sensed);
    let mut other = one;
    let mut scratch: [u64; SCRATCH_WORDS] = kani::any();
    let mut zeros = [0; SCRATCH_WORDS];
    let mut scratch = Scratch::new(&model, &mut scratch).ok().unwrap();
    let mut zeros = Scratch::new(&model, &mut zeros).ok().unwrap();
    crate::rules::knowledge::communicate(&model, &mut open(&model, &mut one), &mut scratch);
    crate::rules::knowledge::communicate(&model, &mut open(&model, &mut other), &mut zeros);
    kani::cover!(view(&model, &one).informed(0), "an informed hotspot");
    assert!(!differ(&one, &other));
}

#[cfg(not(kani))]
super::standin::twins! {
    a_mean_throughput_is_bounded: 1000 cases, 2 covers;
    building_the_graph_keeps_its_contract: 2000 cases, 2 covers;
    buckets_link_the_pairs_that_pairs_link: 2000 cases, 2 covers;
    measuring_the_throughput_keeps_its_contract: 2000 cases, 2 covers;
    spreading_keeps_the_state_valid: 2000 cases, 3 covers;
    spreading_with_memory_keeps_the_state_valid: 2000 cases, 1 covers;
    working_memory_does_not_matter_to_consensus: 500 cases, 1 covers;
}
