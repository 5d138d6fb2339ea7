//! Policies on disk: a folder with weights (safetensors) and a card (JSON).

use super::Actor;
use crate::error::{FormatError, TrainError};
use crate::network::{Architecture, Network};
use crate::ppo::normalise::Affine;
use crate::store::{Array, Arrays, encode, write_whole};
use jcas_core::TargetVisibility;
use jcas_episode::card::{CARD, Card, WEIGHTS, load_card};
use jcas_episode::files::{WEIGHTS_BYTES_MAX, read};
use jcas_policy::action_of;
use serde::Deserialize;
use std::path::Path;

/// Width of the stored numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// As trained.
    Single,
    /// Half the size, for shipping.
    Half,
}

/// Writes weights and card. Equal policies give equal bytes.
pub fn save(
    folder: &Path,
    actor: &Actor,
    card: &Card,
    precision: Precision,
) -> Result<(), TrainError> {
    std::fs::create_dir_all(folder).map_err(TrainError::file(folder))?;
    let path = folder.join(WEIGHTS);
    let bytes = weights(actor, precision, &note(card, &actor.network.architecture))
        .map_err(TrainError::format(&path))?;
    write_whole(&path, &bytes)?;
    let text = serde_json::to_string_pretty(card).map_err(TrainError::format(&path))?;
    write_whole(&folder.join(CARD), (text + "\n").as_bytes())
}

/// A policy's arrays as safetensors, with what else a host without the card has to know.
pub(super) fn weights(
    actor: &Actor,
    precision: Precision,
    note: &str,
) -> Result<Vec<u8>, FormatError> {
    let array = match precision {
        Precision::Single => Array::f32,
        Precision::Half => Array::f16,
    };
    let blocks = actor.network.blocks.iter();
    let mut arrays: Vec<Array> = blocks
        .map(|block| {
            let values = &actor.parameters[block.offset..block.offset + block.len()];
            array(&block.name, &[block.rows, block.columns], values)
        })
        .collect();
    let inputs = &actor.inputs;
    if !inputs.offset.is_empty() {
        let fields = [inputs.offset.len()];
        arrays.push(Array::f32("inputs.offset", &fields, &inputs.offset));
        arrays.push(Array::f32("inputs.scale", &fields, &inputs.scale));
    }
    encode(&arrays, note)
}

/// How a policy is flown, for hosts that read its weights without the card.
fn note(card: &Card, architecture: &Architecture) -> String {
    let mode = card.mode.name();
    let visibility = match card.config.target_visibility {
        TargetVisibility::Known => "known",
        TargetVisibility::Hidden => "hidden",
    };
    let pilot = card.constant_pilot_density;
    let pilot = pilot.map_or(String::new(), |density| format!(" pilot_density={density}"));
    let read = read_besides(architecture);
    format!("mode={mode} target_visibility={visibility}{pilot}{read}")
}

/// What a network reads that no observation shows, as a part of the note.
pub(super) fn read_besides(architecture: &Architecture) -> String {
    let Architecture::SetActor {
        fleet_size,
        choices,
        ..
    } = *architecture
    else {
        return String::new();
    };
    let read = [(fleet_size, " fleet_size=read"), (choices, " choices=read")];
    let read = read.iter().filter(|(reads, _)| *reads);
    read.map(|&(_, text)| text).collect()
}

fn read_actor(bytes: &[u8], card: &Card) -> Result<Actor, FormatError> {
    let architecture =
        Architecture::deserialize(&card.architecture).map_err(FormatError::Architecture)?;
    let network = Network::new(architecture.clone());
    let arrays = Arrays::decode(bytes)?;
    let mut parameters = Vec::with_capacity(network.parameters());
    for block in &network.blocks {
        parameters.extend(arrays.f32(&block.name, block.len())?);
    }
    let inputs = match (&architecture, card.normalised_inputs) {
        (Architecture::Mlp { sizes }, true) => Affine {
            offset: arrays.f32("inputs.offset", sizes[0])?,
            scale: arrays.f32("inputs.scale", sizes[0])?,
        },
        (_, true) => return Err(FormatError::Inputs),
        (_, false) => Affine::default(),
    };
    let constant_pilot = card
        .constant_pilot_density
        .map(|density| action_of(&card.config, density));
    Ok(Actor {
        network,
        parameters,
        head: card.head,
        inputs,
        constant_pilot,
    })
}

/// Reads the actor of a policy's folder, with its card, for the trainer's own network.
pub fn load(folder: &Path) -> Result<(Card, Actor), TrainError> {
    let card = load_card(folder)?;
    let path = folder.join(WEIGHTS);
    let bytes = read(&path, WEIGHTS_BYTES_MAX).map_err(TrainError::file(&path))?;
    let actor = read_actor(&bytes, &card).map_err(TrainError::format(&path))?;
    Ok((card, actor))
}
