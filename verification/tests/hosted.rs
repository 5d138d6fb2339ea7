//! The kernel against the specification where a host owns positions, detections, links, batteries
//! and hotspots.
//!
//! Catches a host's value that the kernel uses in another way than `docs/model.md` says. Catches an
//! invalid state after it, a ledger that does not balance, and a snapshot that loses it.

use jcas_core::{Cell, Config, Error, Model, Sim};
use jcas_verification::comparison::{self, Outcome};
use jcas_verification::sampling::{self, Dice};
use jcas_verification::specification::{Host, Position, Specification, World};

#[test]
fn hosted_missions_agree_with_the_specification() {
    let (mut given, mut confirmed, mut detected) = (0, 0, 0);
    for mission in 0..300 {
        let mut dice = Dice::new(mission);
        let config = sampling::configuration(&mut dice);
        let world = fly(config, &mut dice).unwrap_or_else(|why| panic!("mission {mission}: {why}"));
        given += world.given_uj.iter().filter(|&&uj| uj != 0).count();
        confirmed += world.confirmed_at.iter().flatten().count();
        detected += world.detected.iter().flatten().filter(|&&yes| yes).count();
    }
    assert!(given > 300 && confirmed > 300 && detected > 300);
}

fn any_cell(dice: &mut Dice, config: &Config) -> Cell {
    Cell {
        x: dice.integer(0, config.grid_width - 1),
        y: dice.integer(0, config.grid_height - 1),
    }
}

fn position(cell: Cell) -> Position {
    Position {
        x: i64::from(cell.x),
        y: i64::from(cell.y),
    }
}

fn fly(config: Config, dice: &mut Dice) -> Result<World, String> {
    let model = Model::new(config).map_err(|error| error.to_string())?;
    let spec = Specification::new(&config);
    let mut sim = Sim::new(&model);
    let seed = dice.bits();
    sim.reset(seed);
    let mut world = spec.reset(seed);
    if dice.one_in(2) {
        let starts: Vec<Cell> = (0..config.uav_count)
            .map(|_| any_cell(dice, &config))
            .collect();
        let plain: Vec<Position> = starts.iter().copied().map(position).collect();
        spec.set_starts(&mut world, &plain);
        sim.set_starts(&starts).map_err(|error| error.to_string())?;
        compare(&spec, &world, &sim)?;
    }
    while !world.terminated && !world.truncated {
        between_steps(&spec, &mut world, &mut sim, dice)?;
        compare(&spec, &world, &sim).map_err(|why| format!("before step {}: {why}", world.t))?;
        let (actions, host) = step(&spec, &mut world, &mut sim, dice)?;
        compare(&spec, &world, &sim)
            .map_err(|why| format!("t = {}: {why}\n{actions:?}\n{host:?}", world.t))?;
        let saved = sim.save();
        let mut twin = Sim::new(&model);
        twin.load(&saved).map_err(|error| error.to_string())?;
        comparison::equal("snapshot", sim.state_hash(), twin.state_hash())?;
    }
    Ok(world)
}

/// Sets batteries and moves hotspots in both.
fn between_steps(
    spec: &Specification,
    world: &mut World,
    sim: &mut Sim<'_>,
    dice: &mut Dice,
) -> Outcome {
    let config = spec.config;
    if dice.one_in(4) {
        let i = dice.integer(0, config.uav_count - 1) as usize;
        let charge = match dice.integer(0, 2) {
            0 => 0,
            1 => spec.energy.capacity_uj,
            _ => dice.bits() % (spec.energy.capacity_uj + 1),
        };
        spec.set_battery(world, i, charge);
        sim.set_battery(i, charge)
            .map_err(|error| error.to_string())?;
    }
    if dice.one_in(4) {
        let j = dice.integer(0, config.hotspot_count - 1) as usize;
        let cell = any_cell(dice, &config);
        let there = position(cell);
        let taken = (0..world.hotspot.len()).any(|k| k != j && world.hotspot[k] == there);
        let legal = !taken && !spec.depots.contains(&there);
        let moved = sim.move_hotspot(j, cell);
        if legal {
            world.hotspot[j] = there;
            moved.map_err(|error| error.to_string())?;
        } else if !matches!(moved, Err(Error::Argument(_))) {
            return Err(format!("a hotspot moved to {cell:?}"));
        }
    }
    Ok(())
}

type Step = (Vec<(f32, f32)>, Host);

/// Makes one step by parts, with the values that the host supplies.
fn step(
    spec: &Specification,
    world: &mut World,
    sim: &mut Sim<'_>,
    dice: &mut Dice,
) -> Result<Step, String> {
    let said = |error: Error| error.to_string();
    let config = spec.config;
    let (n, m) = (config.uav_count as usize, config.hotspot_count as usize);
    let pilot = sampling::pilot(dice);
    let actions = sampling::actions(dice, pilot, spec, world);
    let flat: Vec<f32> = actions.iter().flat_map(|&(dir, u)| [dir, u]).collect();
    let mut host = Host::default();
    sim.step_begin(&flat).map_err(said)?;
    if dice.one_in(3) {
        let cells: Vec<Cell> = (0..n).map(|_| any_cell(dice, &config)).collect();
        host.positions = Some(cells.iter().copied().map(position).collect());
        sim.set_positions(&cells).map_err(said)?;
    }
    if dice.one_in(3) {
        host.grounded
            .push(dice.integer(0, config.uav_count - 1) as usize);
        sim.ground(host.grounded[0]).map_err(said)?;
    }
    if dice.one_in(6) {
        host.confirmed
            .push(dice.integer(0, config.hotspot_count - 1) as usize);
        sim.confirm_hotspot(host.confirmed[0]).map_err(said)?;
    }
    if dice.one_in(2) {
        let rows: Vec<Vec<bool>> = (0..n)
            .map(|_| (0..m).map(|_| dice.one_in(3)).collect())
            .collect();
        let bytes: Vec<u8> = rows.iter().flatten().map(|&yes| u8::from(yes)).collect();
        sim.step_sense_with(&bytes).map_err(said)?;
        host.detections = Some(rows);
    } else {
        sim.step_sense().map_err(said)?;
    }
    if dice.one_in(2) {
        let mut rows = vec![vec![false; n]; n];
        for pair in 0..n * n {
            let (i, k) = (pair / n, pair % n);
            if k <= i && dice.one_in(4) {
                (rows[i][k], rows[k][i]) = (true, true);
            }
        }
        let bytes: Vec<u8> = rows.iter().flatten().map(|&yes| u8::from(yes)).collect();
        host.throughput = dice
            .one_in(2)
            .then(|| (0..n).map(|_| dice.real(0.0, 5.0)).collect());
        sim.step_communicate_with(&bytes, host.throughput.as_deref())
            .map_err(said)?;
        host.links = Some(rows);
    } else {
        sim.step_communicate().map_err(said)?;
    }
    sim.step_end().map_err(said)?;
    spec.step_with(world, &actions, &host);
    Ok((actions, host))
}

fn compare(spec: &Specification, world: &World, sim: &Sim<'_>) -> Outcome {
    comparison::states(spec, world, &sim.state())?;
    for i in 0..world.position.len() {
        let entered = i128::from(world.initial_uj[i])
            + i128::from(world.accepted_uj[i])
            + i128::from(world.given_uj[i]);
        let left = i128::from(world.battery_uj[i]) + i128::from(world.spent_uj[i]);
        comparison::equal("ledger", entered, left)?;
        for k in 0..world.position.len() {
            let expected = if world.linked[i][k] {
                spec.link_throughput(world.position[i], world.position[k], world.pilot[i])
            } else {
                0.0
            };
            let pair = sim.model().pair_throughput(&sim.state(), i, k);
            comparison::real("pair throughput", expected, pair)?;
        }
    }
    comparison::equal("is_valid", true, sim.state().is_valid(sim.model()))
}

#[test]
fn a_host_is_refused_out_of_order_and_out_of_range() {
    let model = Model::new(Config::default()).unwrap();
    let mut sim = Sim::new(&model);
    let before = sim.state_hash();
    let full = model.energy().capacity_uj;
    assert!(sim.ground(0).is_err());
    assert!(sim.confirm_hotspot(0).is_err());
    assert!(sim.step_sense_with(&[0; 50]).is_err());
    assert!(sim.set_battery(10, 0).is_err());
    assert!(sim.set_battery(0, full + 1).is_err());
    assert!(sim.move_hotspot(5, Cell { x: 0, y: 0 }).is_err());
    assert!(sim.move_hotspot(0, Cell { x: 12, y: 0 }).is_err());
    assert!(sim.move_hotspot(0, Cell { x: 6, y: 6 }).is_err());
    assert!(sim.set_starts(&[Cell { x: 0, y: 0 }; 9]).is_err());
    assert!(sim.set_starts(&[Cell { x: 0, y: 12 }; 10]).is_err());
    assert_eq!(before, sim.state_hash());
    sim.step_begin(&[0.0; 20]).unwrap();
    let before = sim.state_hash();
    assert!(sim.ground(10).is_err());
    assert!(sim.confirm_hotspot(5).is_err());
    assert!(sim.step_sense_with(&[0; 49]).is_err());
    assert!(sim.set_battery(0, 0).is_err());
    assert!(sim.move_hotspot(0, Cell { x: 0, y: 0 }).is_err());
    assert!(sim.set_starts(&[Cell { x: 0, y: 0 }; 10]).is_err());
    assert_eq!(before, sim.state_hash());
}
