//! The metadata of a policy's file about how the policy acts: its entry `jcas`.
//!
//! The entry holds pairs `key=value` with one space between them. An example is `mode=stratified
//! target_visibility=hidden pilot_density=0.15 starts=5:3:0:1:2:8,10:1:7:0:0:4 fleet_size=read`.
//! Files of other trainers, and older ones (`{}`), state nothing.

use jcas_core::TargetVisibility;

use super::error::LoadError;
use crate::head::Mode;
use crate::strata::{FleetStarts, Starts};

/// The metadata of a policy: how it acts, and what it reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Note {
    /// The acting mode.
    pub mode: Mode,
    /// The visibility that the policy was trained with; `None` if the file does not state it.
    pub target_visibility: Option<TargetVisibility>,
    /// The pilot density that overrides that of the network, in (0, 1]. `None` keeps that of the
    /// network.
    pub pilot_density: Option<f64>,
    /// The phase seeds of the stratified mode.
    pub starts: FleetStarts,
    /// Whether the last own field of a set network is the number of UAVs, which no observation
    /// holds.
    pub fleet_size: bool,
}

impl Default for Note {
    fn default() -> Self {
        Self {
            mode: Mode::Deterministic,
            target_visibility: None,
            pilot_density: None,
            starts: FleetStarts::default(),
            fleet_size: false,
        }
    }
}

impl Note {
    pub(crate) fn read(text: &str) -> Result<Self, LoadError> {
        let mut note = Self::default();
        if text.is_empty() || text == "{}" {
            return Ok(note);
        }
        for pair in text.split(' ') {
            match pair.split_once('=') {
                Some(("mode", name)) => {
                    note.mode = Mode::named(name).ok_or(LoadError::Note(
                        "mode: must be deterministic, sampled or stratified",
                    ))?;
                }
                Some(("target_visibility", "known")) => {
                    note.target_visibility = Some(TargetVisibility::Known);
                }
                Some(("target_visibility", "hidden")) => {
                    note.target_visibility = Some(TargetVisibility::Hidden);
                }
                Some(("target_visibility", _)) => {
                    return Err(LoadError::Note(
                        "target_visibility: must be known or hidden",
                    ));
                }
                Some(("pilot_density", density)) => {
                    let density = density
                        .parse()
                        .ok()
                        .filter(|density: &f64| *density > 0.0 && *density <= 1.0);
                    note.pilot_density = Some(density.ok_or(LoadError::Note(
                        "pilot_density: must be above 0 and at most 1",
                    ))?);
                }
                Some(("starts", starts)) => {
                    note.starts = read_starts(starts).ok_or(LoadError::Note(
                        "starts: must be UAVs and five numbers, with colons, of at most eight fleets, with commas, the smallest first",
                    ))?;
                }
                Some(("fleet_size", "read")) => note.fleet_size = true,
                Some(("fleet_size", _)) => {
                    return Err(LoadError::Note("fleet_size: must be read"));
                }
                _ => {
                    return Err(LoadError::Note(
                        "must be of mode=, target_visibility=, pilot_density=, starts= and fleet_size=",
                    ));
                }
            }
        }
        Ok(note)
    }
}

fn read_starts(text: &str) -> Option<FleetStarts> {
    let mut whole = true;
    let fleets = text.split(',').map_while(|fleet| {
        let fleet = read_fleet(fleet);
        whole &= fleet.is_some();
        fleet
    });
    FleetStarts::new(fleets).filter(|_| whole)
}

fn read_fleet(text: &str) -> Option<(u32, Starts)> {
    let mut numbers = text.split(':');
    let uavs = numbers.next()?.parse().ok()?;
    let mut starts = Starts::default();
    for start in &mut starts {
        *start = numbers.next()?.parse().ok()?;
    }
    numbers.next().is_none().then_some((uavs, starts))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_is_read_whole_or_refused() {
        assert_eq!(Note::read(""), Ok(Note::default()));
        assert_eq!(Note::read("{}"), Ok(Note::default()));
        let note =
            Note::read("mode=sampled target_visibility=hidden pilot_density=0.15 starts=5:3:0:1:2:8,10:1:7:0:0:4 fleet_size=read")
                .unwrap();
        assert_eq!(note.mode, Mode::Sampled);
        assert_eq!(note.target_visibility, Some(TargetVisibility::Hidden));
        assert_eq!(note.pilot_density, Some(0.15));
        let starts = [(5, [3, 0, 1, 2, 8]), (10, [1, 7, 0, 0, 4])];
        assert_eq!(note.starts.fleets(), starts);
        assert!(note.fleet_size);
        for wrong in [
            "mode=x",
            "target_visibility=",
            "pilot_density=NaN",
            "pilot_density=2",
            "fleet_size=20",
            "starts=",
            "starts=5:1:2:3:4",
            "starts=5:1:2:3:4:5:6",
            "starts=5:1:2:3:4:65536",
            "starts=5:1:2:3:4:5,x:1:2:3:4:5",
            "starts=10:1:2:3:4:5,5:1:2:3:4:5",
            "x",
            "mode=sampled ",
        ] {
            assert!(Note::read(wrong).is_err(), "{wrong}");
        }
    }
}
