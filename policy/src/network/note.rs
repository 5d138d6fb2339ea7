//! What a policy's file says about how it is flown: the entry `jcas` of its metadata.
//!
//! `key=value` pairs, one space between them, such as `mode=sampled target_visibility=hidden
//! pilot_density=0.15 starts=5:3,10:1 fleet_size=read`. Files of other trainers, and older ones (`{}`), say nothing.

use jcas_core::TargetVisibility;

use super::error::LoadError;
use crate::head::Mode;
use crate::strata::Starts;

/// How a policy is flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Note {
    /// How actions follow from the distribution.
    pub mode: Mode,
    /// What it was trained with; none where the file does not say.
    pub target_visibility: Option<TargetVisibility>,
    /// Pilot density held, whatever the network says; none: it chooses.
    pub pilot_density: Option<f64>,
    /// From which start fleets divide that are flown stratified.
    pub starts: Starts,
    /// A set network's last own field is the number of UAVs, which no observation shows.
    pub fleet_size: bool,
}

impl Default for Note {
    fn default() -> Self {
        Self {
            mode: Mode::Deterministic,
            target_visibility: None,
            pilot_density: None,
            starts: Starts::default(),
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
                Some(("mode", "deterministic")) => note.mode = Mode::Deterministic,
                Some(("mode", "sampled")) => note.mode = Mode::Sampled,
                Some(("mode", "stratified")) => note.mode = Mode::Stratified,
                Some(("mode", _)) => {
                    return Err(LoadError::Note(
                        "mode: must be deterministic, sampled or stratified",
                    ));
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
                        "starts: must be UAVs:start,UAVs:start and so on, at most 16, the smallest fleet first",
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

fn read_starts(text: &str) -> Option<Starts> {
    let mut whole = true;
    let pairs = text.split(',').map_while(|pair| {
        let read = || {
            let (uavs, start) = pair.split_once(':')?;
            Some((uavs.parse().ok()?, start.parse().ok()?))
        };
        let pair = read();
        whole &= pair.is_some();
        pair
    });
    Starts::new(pairs).filter(|_| whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_is_read_whole_or_refused() {
        assert_eq!(Note::read(""), Ok(Note::default()));
        assert_eq!(Note::read("{}"), Ok(Note::default()));
        let note =
            Note::read("mode=sampled target_visibility=hidden pilot_density=0.15 starts=5:3,10:1 fleet_size=read")
                .unwrap();
        assert_eq!(note.mode, Mode::Sampled);
        assert_eq!(note.target_visibility, Some(TargetVisibility::Hidden));
        assert_eq!(note.pilot_density, Some(0.15));
        assert_eq!(note.starts.of_fleets(), [(5, 3), (10, 1)]);
        assert!(note.fleet_size);
        for wrong in [
            "mode=x",
            "target_visibility=",
            "pilot_density=NaN",
            "pilot_density=2",
            "fleet_size=20",
            "starts=",
            "starts=5",
            "starts=5:3,x:1",
            "starts=10:1,5:3",
            "x",
            "mode=sampled ",
        ] {
            assert!(Note::read(wrong).is_err(), "{wrong}");
        }
    }
}
