//! One step, in its order. Whole by [`Model::step`], or in parts between which a host simulator may
//! set what it owns: positions before sensing, links in place of communication's own graph.

use crate::bits;
use crate::config::{Cell, ChargeBilling};
use crate::energy::{Activities, Activity, settle};
use crate::error::Error;
use crate::header::Phase;
use crate::lanes::{self, Block, Cells, Lanes, WIDTH};
use crate::model::Model;
use crate::reward::{self, BlockDeeds, Deeds, Happenings, OWN_KEPT};
use crate::scratch::{Scratch, Tally};
use crate::state::StateMut;
use crate::word::stored;
use crate::{action, carbon, graph, knowledge, motion, potential, sensing};

/// What a step came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepOutcome {
    /// R_t, the same for every UAV.
    pub reward: f64,
    /// Every hotspot is informed.
    pub terminated: bool,
    /// The horizon ended the episode before that.
    pub truncated: bool,
}

impl Model<'_> {
    /// One whole step with an action pair (u_dir, u_pilot) per UAV.
    ///
    /// # Errors
    /// [`Error::EpisodeOver`], [`Error::OutOfOrder`], [`Error::Length`] or [`Error::ActionNan`]; the state
    /// is then as it was.
    pub fn step(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
        actions: &[f32],
    ) -> Result<StepOutcome, Error> {
        whole(self, state, scratch, actions)
    }

    /// Part 1: actions, return to base, move.
    ///
    /// # Errors
    /// As [`Model::step`].
    pub fn step_begin(&self, state: &mut StateMut<'_>, actions: &[f32]) -> Result<(), Error> {
        begin(self, state, actions)
    }

    /// Part 2: look around, sense and learn.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`] unless part 1 was the last.
    pub fn step_sense(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
    ) -> Result<(), Error> {
        sense(self, state, scratch)
    }

    /// Part 3: communicate over the graph that the link budget gives.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`] unless part 2 was the last.
    pub fn step_communicate(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
    ) -> Result<(), Error> {
        communicate(self, state, scratch)
    }

    /// Part 4: energy, charge, carbon, reward, termination.
    ///
    /// # Errors
    /// [`Error::OutOfOrder`] unless part 3 was the last.
    pub fn step_end(
        &self,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
    ) -> Result<StepOutcome, Error> {
        end(self, state, scratch)
    }
}

// The parts are compiled into their callers, for whatever instruction set those are compiled for.

#[inline(always)]
pub(crate) fn whole(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
    actions: &[f32],
) -> Result<StepOutcome, Error> {
    begin(model, state, actions)?;
    sense(model, state, scratch)?;
    communicate(model, state, scratch)?;
    end(model, state, scratch)
}

#[inline(always)]
fn begin(model: &Model<'_>, state: &mut StateMut<'_>, actions: &[f32]) -> Result<(), Error> {
    expect(state, Phase::Ready, "step_begin", "reset or step_end")?;
    check_actions(model, actions)?;
    let t = state.header.t() + 1;
    state.header.set_t(t);
    let (in_lanes, one_by_one) = lanes::split(model.uav_count());
    for block in in_lanes {
        act_in_lanes(model, state, block, actions);
    }
    for i in one_by_one {
        act(model, state, i, actions[2 * i], actions[2 * i + 1]);
    }
    state.header.set_phase(Phase::Moved);
    Ok(())
}

#[inline(always)]
fn sense(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
) -> Result<(), Error> {
    expect(state, Phase::Moved, "step_sense", "step_begin")?;
    sensing::look_around(model, state);
    sensing::sense_and_learn(model, state, scratch);
    state.header.set_phase(Phase::Sensed);
    Ok(())
}

#[inline(always)]
fn communicate(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
) -> Result<(), Error> {
    expect(state, Phase::Sensed, "step_communicate", "step_sense")?;
    graph::build_graph(model, state, scratch);
    knowledge::communicate(model, state, scratch);
    state.header.set_phase(Phase::Communicated);
    Ok(())
}

#[inline(always)]
fn end(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
) -> Result<StepOutcome, Error> {
    expect(state, Phase::Communicated, "step_end", "step_communicate")?;
    let mut happened = Happenings {
        goal_potential_before: state.header.goal_potential(),
        charge_potential_before: state.header.charge_potential(),
        mean_throughput: state.header.mean_throughput(),
        ..Happenings::default()
    };
    let (mut tally, mut rest) = scratch.tally(model.uav_count());
    let emitted = settle_energy(model, state, &mut tally, &mut happened);
    cover(model, state, &mut tally, &mut happened);
    count_knowledge(model, state, &mut happened);
    keep_potentials(model, state, &mut tally);
    finish(model, state, &mut rest, &mut happened);

    let rewards = model.reward().components(&happened);
    let reward = reward::total(&rewards);
    state.header.set_rewards(&rewards);
    credit(model, state, &tally, emitted, &happened);
    let return_sum = state.header.return_sum() + reward;
    state.header.set_return_sum(return_sum);
    let phase = state.header.phase();
    Ok(StepOutcome {
        reward,
        terminated: phase == Some(Phase::Terminated),
        truncated: phase == Some(Phase::Truncated),
    })
}

/// Refuses what comes out of order.
#[inline(always)]
pub(crate) fn expect(
    state: &StateMut<'_>,
    phase: Phase,
    called: &'static str,
    after: &'static str,
) -> Result<(), Error> {
    match state.header.phase() {
        Some(now) if now == phase => Ok(()),
        Some(now) if now.is_over() => Err(Error::EpisodeOver),
        Some(_) => Err(Error::OutOfOrder { called, after }),
        None => Err(Error::ModelMismatch),
    }
}

#[inline(always)]
fn check_actions(model: &Model<'_>, actions: &[f32]) -> Result<(), Error> {
    if actions.len() != model.action_len() {
        return Err(Error::Length {
            what: "actions",
            expected: model.action_len(),
            got: actions.len(),
        });
    }
    action::refuse_nan(actions)
}

/// A UAV's action: pilot density, then its motion, unless its battery grounds it or sends it home.
#[inline(always)]
fn act(model: &Model<'_>, state: &mut StateMut<'_>, i: usize, u_dir: f32, u_pilot: f32) {
    let config = model.config();
    let density =
        action::pilot_density(u_pilot, config.pilot_density_min, config.pilot_density_max);
    state.set_pilot_density(i, density);

    let grounded = state.battery[i] == 0;
    let returning = !grounded && state.battery[i] < model.energy().rtb_uj;
    bits::assign(state.grounded, i, grounded);
    bits::assign(state.returning, i, returning);

    let from = state.cell(i);
    let motion = if grounded {
        action::Motion::Stay
    } else if returning {
        motion::toward(from, model.nearest_depot(from).0)
    } else {
        action::motion(u_dir)
    };
    let to = motion::destination(from, motion, config.grid_width, config.grid_height);
    state.previous[i] = from.to_word();
    state.cells[i] = to.to_word();
}

/// [`act`] for the UAVs of a block.
#[inline(always)]
fn act_in_lanes(model: &Model<'_>, state: &mut StateMut<'_>, block: Block, actions: &[f32]) {
    let config = model.config();
    let (low, high) = (config.pilot_density_min, config.pilot_density_max);
    let (width, height) = (config.grid_width as i32, config.grid_height as i32);
    let (mut u_dir, mut u_pilot) = ([0.0; WIDTH], [0.0; WIDTH]);
    let pairs = actions[2 * block.first..].chunks_exact(2);
    for (lane, pair) in block.lanes().zip(pairs) {
        (u_dir[lane], u_pilot[lane]) = (pair[0], pair[1]);
    }
    lanes::in_memory(&mut u_dir);
    lanes::in_memory(&mut u_pilot);
    let battery = block.load(state.battery);
    let (mut pilot, mut grounded, mut returning) = ([0; WIDTH], [0; WIDTH], [0; WIDTH]);
    for lane in 0..WIDTH {
        pilot[lane] = stored(action::pilot_density(u_pilot[lane], low, high));
        grounded[lane] = ones(battery[lane] == 0);
        returning[lane] = ones(battery[lane] < model.energy().rtb_uj) & !grounded[lane];
    }
    block.store(&pilot, state.pilot);
    block.put_bits(lanes::gather_bits(&grounded), state.grounded);
    let mut home = lanes::gather_bits(&returning) & block.mask();
    block.put_bits(home, state.returning);
    home = block.uavs_in(home);

    let cells = Cells::load(block, state.cells);
    let mut to = [0; WIDTH];
    for lane in 0..WIDTH {
        // The bins of `action::motion`: up, down, left, right, stay.
        let bin = (f64::from(action::clip(u_dir[lane])) + 1.0) * 2.5;
        let up = i32::from(bin < 1.0) - i32::from(bin >= 1.0 && bin < 2.0);
        let right = i32::from(bin >= 3.0 && bin < 4.0) - i32::from(bin >= 2.0 && bin < 3.0);
        let flies = !(grounded[lane] as i32);
        let (x, y) = (cells.x[lane], cells.y[lane]);
        let (there_x, there_y) = (x + (right & flies), y + (up & flies));
        let inside = there_x >= 0 && there_x < width && there_y >= 0 && there_y < height;
        let x = if inside { there_x } else { x };
        let y = if inside { there_y } else { y };
        to[lane] = x as u64 | (y as u64) << 32;
    }
    let from = block.load(state.cells);
    block.store(&from, state.previous);
    block.store(&to, state.cells);
    while home != 0 {
        let i = block.first + home.trailing_zeros() as usize;
        home &= home - 1;
        let from = Cell::from_word(state.previous[i]);
        let motion = motion::toward(from, model.nearest_depot(from).0);
        let to = motion::destination(from, motion, config.grid_width, config.grid_height);
        state.cells[i] = to.to_word();
    }
}

/// Charging billed to the fleet in a step, and its carbon.
#[derive(Clone, Copy)]
struct Emitted {
    billed_uj: u64,
    co2_ng: u64,
}

/// Every battery, then the fleet's grid energy and carbon, each rounded once a step.
#[inline(always)]
fn settle_energy(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    tally: &mut Tally<'_>,
    happened: &mut Happenings,
) -> Emitted {
    let (plan, words) = (model.energy(), model.uav_words());
    let (mut billed_uj, mut moves, mut pilot) = (0, 0, 0.0);
    let (in_lanes, one_by_one) = lanes::split(model.uav_count());
    for block in in_lanes {
        let density = block.load(state.pilot).map(f64::from_bits);
        let settled = settle_block(model, state, tally, block, &density);
        happened.spent_uj += settled.spent_uj;
        billed_uj += settled.billed_uj;
        moves += settled.moves;
        for &density in &state.pilot[block.first..][..block.count] {
            pilot += f64::from_bits(density);
        }
    }
    for i in one_by_one {
        let density = state.pilot_density(i);
        let activity = Activity {
            grounded: bits::get(state.grounded, i),
            moved: state.cells[i] != state.previous[i],
            sensing: bits::get(state.sensing, i),
            linked: !bits::is_empty(&state.links[i * words..(i + 1) * words]),
        };
        let on_depot = model.depot_distance(state.cell(i)) == 0;
        let offered_uj = if on_depot { plan.charge_uj } else { 0 };
        let settled = settle(
            state.battery[i],
            plan.asked_uj(activity, density),
            offered_uj,
            plan.capacity_uj,
        );
        state.battery[i] = settled.battery_uj;
        state.spent[i] += settled.spent_uj;
        state.accepted[i] += settled.accepted_uj;
        state.shortfall[i] += settled.shortfall_uj;
        tally.spent_uj[i] = settled.spent_uj;
        tally.billed_uj[i] = match model.carbon().billing {
            ChargeBilling::Accepted => settled.accepted_uj,
            ChargeBilling::Nameplate => offered_uj,
        };
        happened.spent_uj += settled.spent_uj;
        billed_uj += tally.billed_uj[i];
        moves += u64::from(activity.moved);
        pilot += density;
    }

    let intensity = state.header.intensity_mg_per_kwh();
    let grid_uj = model.carbon().grid_uj(billed_uj);
    let co2_ng = carbon::emitted_ng(grid_uj, intensity);
    happened.co2_ng = co2_ng as f64;
    let header = &mut state.header;
    header.set_grid(header.grid_uj() + grid_uj);
    header.set_co2(header.co2_ng() + co2_ng);
    header.set_moves(header.moves() + moves);
    header.set_pilot_sum(header.pilot_sum() + pilot / model.uav_count() as f64);
    header.set_throughput_sum(header.throughput_sum() + header.mean_throughput());
    header.set_billed_intensity(intensity);
    let next = model
        .carbon()
        .intensity_mg_per_kwh(header.seed(), header.t());
    header.set_intensity(next);
    Emitted { billed_uj, co2_ng }
}

/// Sums over a block's UAVs.
struct Settled {
    spent_uj: u64,
    billed_uj: u64,
    moves: u64,
}

/// The batteries of a block.
#[inline(always)]
fn settle_block(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    tally: &mut Tally<'_>,
    block: Block,
    density: &Lanes<f64>,
) -> Settled {
    let (plan, row) = (model.energy(), model.uav_words());
    let (cells, previous) = (block.load(state.cells), block.load(state.previous));
    let mut any_link = [0; WIDTH];
    if row == 1 {
        any_link = block.load(state.links);
    } else {
        let links = state.links[block.first * row..].chunks_exact(row);
        for (lane, links) in block.lanes().zip(links) {
            any_link[lane] = u64::from(!bits::is_empty(links));
        }
    }
    let (mut moved, mut linked) = ([0; WIDTH], [0; WIDTH]);
    for lane in 0..WIDTH {
        moved[lane] = ones(cells[lane] != previous[lane]);
        linked[lane] = ones(any_link[lane] != 0);
    }
    let did = Activities {
        flies: lanes::spread(!block.bits(state.grounded) & block.mask()),
        moved,
        sensing: lanes::spread(block.bits(state.sensing)),
        linked,
    };
    let asked = plan.asked_in_lanes(&did, density);
    let depots = model.depot_distances(&Cells::load(block, state.cells));
    let there = lanes::spread(block.mask());
    let battery = block.load(state.battery);
    let (mut charge, mut spent, mut billed) = ([0; WIDTH], [0; WIDTH], [0; WIDTH]);
    let (mut total_spent, mut total_accepted, mut total_shortfall) = (
        block.load(state.spent),
        block.load(state.accepted),
        block.load(state.shortfall),
    );
    let nameplate = ones(model.carbon().billing == ChargeBilling::Nameplate);
    for lane in 0..WIDTH {
        let offered = ones(depots[lane] == 0) & there[lane] & plan.charge_uj;
        let settled = settle(battery[lane], asked[lane], offered, plan.capacity_uj);
        charge[lane] = settled.battery_uj;
        spent[lane] = settled.spent_uj;
        billed[lane] = offered & nameplate | settled.accepted_uj & !nameplate;
        total_spent[lane] += settled.spent_uj;
        total_accepted[lane] += settled.accepted_uj;
        total_shortfall[lane] += settled.shortfall_uj;
    }
    block.store(&charge, state.battery);
    block.store(&total_spent, state.spent);
    block.store(&total_accepted, state.accepted);
    block.store(&total_shortfall, state.shortfall);
    block.store(&spent, tally.spent_uj);
    block.store(&billed, tally.billed_uj);
    Settled {
        spent_uj: lanes::sum(&spent),
        billed_uj: lanes::sum(&billed),
        moves: u64::from((lanes::gather_bits(&moved) & block.mask()).count_ones()),
    }
}

/// All ones for yes.
#[inline(always)]
fn ones(yes: bool) -> u64 {
    0u64.wrapping_sub(u64::from(yes))
}

/// Cells visited for the first time, and moves into cells visited before this step.
#[inline(always)]
fn cover(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    tally: &mut Tally<'_>,
    happened: &mut Happenings,
) {
    let (in_lanes, one_by_one) = lanes::split(model.uav_count());
    for block in in_lanes {
        let (cells, previous) = (block.load(state.cells), block.load(state.previous));
        let index = Cells::of(&cells).index(model.config().grid_width);
        let mut moved = [0; WIDTH];
        for lane in 0..WIDTH {
            moved[lane] = ones(cells[lane] != previous[lane]);
        }
        // Until the cells are counted as visited, their indices wait here.
        block.store(&index.map(u64::from), tally.new_cells);
        lanes::in_memory(&mut moved);
        let revisits = &mut tally.revisits[block.first..][..block.count];
        for (lane, revisit) in block.lanes().zip(revisits) {
            let visited = &*state.visited;
            *revisit = u64::from(bits::get(visited, index[lane] as usize)) & moved[lane];
            happened.revisits += *revisit;
        }
    }
    for i in one_by_one {
        let moved = state.cells[i] != state.previous[i];
        let index = model.cell_index(Cell::from_word(state.cells[i]));
        let revisit = u64::from(moved & bits::get(state.visited, index));
        tally.revisits[i] = revisit;
        happened.revisits += revisit;
        tally.new_cells[i] = index as u64;
    }
    for place in &mut *tally.new_cells {
        let (word, bit) = (&mut state.visited[*place as usize / 64], *place % 64);
        *place = !*word >> bit & 1;
        *word |= 1 << bit;
        happened.new_cells += *place;
    }
}

/// The potentials of each UAV before the step.
#[inline(always)]
fn keep_potentials(model: &Model<'_>, state: &StateMut<'_>, tally: &mut Tally<'_>) {
    let (in_lanes, one_by_one) = lanes::split(model.uav_count());
    for block in in_lanes {
        block.store(&block.load(state.goal_potential), tally.goal_before);
        block.store(&block.load(state.charge_potential), tally.charge_before);
    }
    for i in one_by_one {
        tally.goal_before[i] = state.goal_potential[i];
        tally.charge_before[i] = state.charge_potential[i];
    }
}

/// Confirmations, informed hotspots and the spread of knowledge.
#[inline(always)]
fn count_knowledge(model: &Model<'_>, state: &StateMut<'_>, happened: &mut Happenings) {
    let t = u64::from(state.header.t());
    for j in 0..model.hotspot_count() {
        happened.newly_confirmed += u64::from(state.confirmed_at[j] == t);
        happened.newly_informed += u64::from(state.informed_at[j] == t);
    }
    happened.informed = bits::count(state.informed) as u64;
    // Only confirmed hotspots are ever known, so that the bits known, over N times the hotspots
    // confirmed, are the mean over these of the fraction that knows them.
    let confirmed = bits::count(state.confirmed);
    if confirmed > 0 {
        let known = bits::count(state.knowledge);
        happened.knowledge_spread = known as f64 / (confirmed * model.uav_count()) as f64;
    }
}

/// Whether the episode ends here, and the potentials of the state it has come to.
#[inline(always)]
fn finish(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    scratch: &mut Scratch<'_>,
    happened: &mut Happenings,
) {
    happened.complete = happened.informed == model.hotspot_count() as u64;
    happened.at_horizon = state.header.t() >= model.config().horizon_steps;
    potential::update(model, state, scratch, happened.complete);
    happened.goal_potential_after = state.header.goal_potential();
    happened.charge_potential_after = state.header.charge_potential();
    state.header.set_phase(if happened.complete {
        Phase::Terminated
    } else if happened.at_horizon {
        Phase::Truncated
    } else {
        Phase::Ready
    });
}

/// The reward of each UAV: the team's terms, and of its own what it is credited with.
#[inline(always)]
fn credit(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    tally: &Tally<'_>,
    emitted: Emitted,
    happened: &Happenings,
) {
    let uavs = model.uav_count() as u64;
    let (in_lanes, one_by_one) = lanes::split(model.uav_count());
    for block in in_lanes {
        let deeds = BlockDeeds {
            new_cell: block.load(tally.new_cells),
            revisit: block.load(tally.revisits),
            spent_uj: block.load(tally.spent_uj),
            billed_uj: block.load(tally.billed_uj),
            throughput: block.load(state.throughput),
            goal_potential_before: block.load(tally.goal_before),
            goal_potential_after: block.load(state.goal_potential),
            charge_potential_before: block.load(tally.charge_before),
            charge_potential_after: block.load(state.charge_potential),
        };
        let own = model
            .reward()
            .own_in_lanes(uavs, (emitted.co2_ng, emitted.billed_uj), &deeds);
        let rows = state.own_rewards[block.first * OWN_KEPT..].chunks_exact_mut(OWN_KEPT);
        for (lane, row) in block.lanes().zip(rows) {
            for (value, lanes) in row.iter_mut().zip(&own) {
                *value = lanes[lane];
            }
        }
    }
    for i in one_by_one {
        let own = Deeds {
            new_cell: tally.new_cells[i] != 0,
            revisit: tally.revisits[i] != 0,
            spent_uj: tally.spent_uj[i],
            co2_ng: carbon::share_ng(emitted.co2_ng, tally.billed_uj[i], emitted.billed_uj),
            throughput: f64::from_bits(state.throughput[i]),
            goal_potential_before: f64::from_bits(tally.goal_before[i]),
            goal_potential_after: f64::from_bits(state.goal_potential[i]),
            charge_potential_before: f64::from_bits(tally.charge_before[i]),
            charge_potential_after: f64::from_bits(state.charge_potential[i]),
        };
        let rewards = model.reward().components(&happened.credited(uavs, &own));
        state.set_own_rewards(i, &rewards);
    }
}
