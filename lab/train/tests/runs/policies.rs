//! What a run leaves flies as it was trained: from its files, over any fleet that it fits.

use crate::{config, fleets, plan, settings};
use burn_tensor::Device;
use jcas_core::{Config, Model, MotionMap};
use jcas_episode::card;
use jcas_policy::Policy;
use jcas_policy::head::Mode;
use jcas_policy::network::choices::read_choices;
use jcas_policy::network::row::RowLayout;
use jcas_train::draw::draw;
use jcas_train::network::{Architecture, values};
use jcas_train::policy::files::{self, Precision};
use jcas_train::policy::{Actor, shape_of};
use jcas_train::run::{NoObserver, Start};
use jcas_train::settings::NetworkKind;
use std::path::Path;

fn observations(model: &Model<'static>) -> Vec<f32> {
    let mut sim = jcas_core::Sim::new(model);
    sim.reset(3);
    let mut observations = vec![0.0; model.uav_count() * model.observation_len()];
    for step in 0..6 {
        let actions: Vec<f32> = (0..model.action_len())
            .map(|k| ((k * 7 + step * 3) % 11) as f32 / 5.5 - 1.0)
            .collect();
        sim.step(&actions).unwrap();
    }
    sim.observe(&mut observations).unwrap();
    observations
}

/// A policy read back acts as the trained one; in half precision nearly so.
#[test]
fn policies_read_back_as_written() {
    let plan = plan("store", settings(NetworkKind::Mlp));
    plan.train(&Start::Fresh, &mut NoObserver).unwrap();
    let model = Model::new(config()).unwrap();
    card::load(&plan.out).unwrap().check(&model).unwrap();
    let (card, stored) = files::load(&plan.out).unwrap();
    let mut trainer = plan.trainer().unwrap();
    while !trainer.finished() {
        trainer.iterate();
    }
    let trained = plan.actor(&trainer);
    assert_eq!(stored, trained);

    files::save(&plan.out, &trained, &card, Precision::Half).unwrap();
    let (_, half) = files::load(&plan.out).unwrap();
    let outputs = |actor: &Actor| {
        actor
            .fly("p", Mode::Deterministic)
            .outputs(&model, &observations(&model))
            .unwrap()
    };
    for (a, b) in outputs(&trained).iter().zip(outputs(&half)) {
        assert!((a - b).abs() < 0.02, "{a} {b}");
    }
    std::fs::remove_dir_all(&plan.out).unwrap();
}

/// Flights use the inference that every host uses, learning uses tensors: the same function.
fn same_outputs(actor: &Actor, model: &Model<'static>) {
    let weights = actor.network.tensors(&actor.parameters, &Device::flex());
    let mut inputs = observations(model);
    let mut policy = actor.fly("p", Mode::Deterministic);
    let flown = policy.outputs(model, &inputs).unwrap();
    actor.inputs.apply(&mut inputs);
    let shape = shape_of(model);
    let features = actor.network.features(&inputs, &shape);
    let learnt = values(actor.network.forward(&weights, features, &shape));
    assert_eq!(flown.len(), learnt.len());
    for (flown, learnt) in flown.iter().zip(learnt) {
        let error = (flown - learnt).abs() / learnt.abs().max(1.0);
        assert!(error < 1e-5, "{flown} {learnt}");
    }
}

/// A policy that the repository ships.
fn shipped() -> (Actor, Model<'static>) {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../policies/mission");
    let (card, actor) = files::load(Path::new(folder)).unwrap();
    (actor, Model::new(card.config).unwrap())
}

#[test]
fn what_flies_is_what_was_trained() {
    let (actor, model) = shipped();
    same_outputs(&actor, &model);
    let model = Model::new(config()).unwrap();
    for network in [NetworkKind::Mlp, NetworkKind::Set] {
        let plan = plan(&format!("flies-{network:?}"), settings(network));
        plan.train(&Start::Fresh, &mut NoObserver).unwrap();
        same_outputs(&files::load(&plan.out).unwrap().1, &model);
        std::fs::remove_dir_all(&plan.out).unwrap();
    }
}

/// A mission of another size is refused with both sizes named.
#[test]
fn a_policy_that_does_not_fit_is_refused() {
    let plan = plan("fit", settings(NetworkKind::Mlp));
    plan.train(&Start::Fresh, &mut NoObserver).unwrap();
    let stored = card::load(&plan.out).unwrap();
    let other = Model::new(Config {
        uav_count: 6,
        ..config()
    })
    .unwrap();
    let refusal = stored.check(&other).unwrap_err().to_string();
    for part in ["32", "38", "uav_count = 4", "uav_count = 6"] {
        assert!(refusal.contains(part), "{part} is missing in: {refusal}");
    }
    std::fs::remove_dir_all(&plan.out).unwrap();
}

/// A set network that reads tags acts alike with and without tags in the configuration. It refuses
/// maps other than those of its training.
#[test]
fn the_set_network_numbers_the_uavs_where_the_mission_does_not() {
    let tagged = Config {
        uav_tag: jcas_core::UavTag::Index,
        ..config()
    };
    let mut plan = plan("tags", settings(NetworkKind::Set));
    plan.configs = vec![tagged];
    plan.train(&Start::Fresh, &mut NoObserver).unwrap();
    let stored = card::load(&plan.out).unwrap();
    // At the start all UAVs see the same but for their tags.
    let outputs = |config: Config| {
        let model = Model::new(config).unwrap();
        stored.check(&model).unwrap();
        let mut sim = jcas_core::Sim::new(&model);
        sim.reset(5);
        let mut observations = vec![0.0; model.uav_count() * model.observation_len()];
        sim.observe(&mut observations).unwrap();
        let mut policy = stored.policy(None);
        policy.outputs(&model, &observations).unwrap()
    };
    let shown = outputs(tagged);
    assert_eq!(shown, outputs(config()));
    let rows: Vec<_> = shown.chunks_exact(shown.len() / 4).collect();
    assert!(rows.windows(2).all(|pair| pair[0] != pair[1]));

    let mapped = Config {
        map_directions: jcas_core::MapDirections::Shown,
        search_maps: jcas_core::SearchMaps::Shared,
        ..tagged
    };
    let refusal = stored.check(&Model::new(mapped).unwrap()).unwrap_err();
    assert!(refusal.to_string().contains("map_directions"), "{refusal}");
    std::fs::remove_dir_all(&plan.out).unwrap();
}

/// The set network learns over search maps, and what flies is what it learned.
#[test]
fn the_set_network_reads_search_maps() {
    let searched = Config {
        uav_count: 4,
        hotspot_count: 3,
        horizon_steps: 20,
        ..Config::preset(jcas_core::Preset::Search)
    };
    let mut plan = plan("maps", settings(NetworkKind::Set));
    plan.configs = vec![searched];
    plan.train(&Start::Fresh, &mut NoObserver).unwrap();
    let stored = card::load(&plan.out).unwrap();
    let model = Model::new(searched).unwrap();
    stored.check(&model).unwrap();
    let (_, actor) = files::load(&plan.out).unwrap();
    same_outputs(&actor, &model);
    std::fs::remove_dir_all(&plan.out).unwrap();
}

/// Trained for several fleets, the set network reads how many UAVs there are, in flight as in
/// learning.
#[test]
fn the_set_network_reads_the_size_of_the_fleet() {
    let mut plan = plan("fleets", settings(NetworkKind::Set));
    plan.configs = fleets();
    // Trained on twice as often, listed and evaluated once.
    plan.configs.push(plan.configs[1]);
    plan.train(&Start::Fresh, &mut NoObserver).unwrap();
    let stored = card::load(&plan.out).unwrap();
    assert_eq!(stored.card.trained_on, [(4, 3), (7, 3)]);
    assert_eq!(stored.card.evaluations.len(), 2 * Mode::ALL.len());
    let reads = |actor: &Actor| match actor.network.architecture {
        Architecture::SetActor { fleet_size, .. } => fleet_size,
        _ => false,
    };
    let (_, actor) = files::load(&plan.out).unwrap();
    assert!(reads(&actor));
    for config in plan.configs {
        let model = Model::new(config).unwrap();
        stored.check(&model).unwrap();
        same_outputs(&actor, &model);
    }
    std::fs::remove_dir_all(&plan.out).unwrap();
}

/// Drawn configurations have grids of their own. The card shows the one that they were drawn
/// around, in the drawn sizes.
#[test]
fn a_policy_for_drawn_configurations_has_the_card_of_the_middle() {
    let mut plan = plan("drawn", settings(NetworkKind::Turns));
    plan.configs = draw(&config(), 4, 1).unwrap();
    plan.drawn_around = Some(config());
    plan.train(&Start::Fresh, &mut NoObserver).unwrap();
    let card = card::load(&plan.out).unwrap().card;
    let drawn = plan.configs.iter();
    let sizes: Vec<(u32, u32)> = drawn.map(|c| (c.uav_count, c.hotspot_count)).collect();
    assert_eq!(card.trained_on, sizes);
    assert_eq!(card.config.grid_width, config().grid_width);
    assert_eq!(card.config.uav_count, sizes[0].0);
    assert_eq!(card.evaluations.len(), sizes.len() * Mode::ALL.len());
    std::fs::remove_dir_all(&plan.out).unwrap();
}

/// In turns, each UAV acts on its observation with the choices of the UAVs before it, in flight as
/// in learning.
#[test]
fn a_policy_in_turns_reads_the_choices_of_its_neighbours() {
    let mut plan = plan("turns", settings(NetworkKind::Turns));
    plan.configs = fleets();
    plan.train(&Start::Fresh, &mut NoObserver).unwrap();
    let (_, actor) = files::load(&plan.out).unwrap();
    assert!(actor.network.reads_choices());
    let weights = actor.network.tensors(&actor.parameters, &Device::flex());
    for config in plan.configs {
        let model = Model::new(config).unwrap();
        let shape = shape_of(&model);
        let rows = observations(&model);
        let mut policy = actor.fly("p", Mode::Deterministic);
        let mut flown = vec![0.0; model.action_len()];
        policy.see(&rows);
        let sim = jcas_core::Sim::new(&model);
        policy.act(&model, &sim.state(), &mut flown);
        let mut learnt = vec![0.0; model.action_len()];
        let mut row = vec![0.0; shape.observation_len];
        let mut changed = 0;
        for uav in 0..shape.agents {
            read_choices(RowLayout::of(&model), &rows, &learnt, uav, &mut row);
            changed += usize::from(row != rows[uav * row.len()..][..row.len()]);
            let features = actor.network.features(&row, &shape);
            let outputs = values(actor.network.forward(&weights, features, &shape));
            learnt[2 * uav..][..2]
                .copy_from_slice(&actor.head.deterministic(&outputs, MotionMap::Udlrs));
        }
        assert!(changed > 1, "{changed} UAVs read a choice");
        for (flown, learnt) in flown.iter().zip(learnt) {
            assert!((flown - learnt).abs() < 1e-5, "{flown} {learnt}");
        }
    }
    std::fs::remove_dir_all(&plan.out).unwrap();
}
