//! What a host simulator supplied: each of its calls is a line of its own, before the line of the step that it is
//! part of, in the order in which it was made.

use jcas_core::{Cell, Error, Sim};
use serde::{Deserialize, Serialize};

/// A call of the host. Which of them come between steps, and which within one, the kernel knows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Host {
    /// The UAVs start in these cells.
    SetStarts {
        /// One for each UAV.
        cells: Vec<Cell>,
    },
    /// The hotspots lie in these cells.
    SetHotspots {
        /// One for each hotspot.
        cells: Vec<Cell>,
    },
    /// The batteries hold this at the start.
    SetBatteries {
        /// In microjoules, one for each UAV.
        charges_uj: Vec<u64>,
    },
    /// A battery holds this from now on.
    SetBattery {
        /// Whose.
        uav: usize,
        /// In microjoules.
        charge_uj: u64,
    },
    /// A hotspot lies elsewhere from now on.
    MoveHotspot {
        /// Which.
        hotspot: usize,
        /// Where.
        cell: Cell,
    },
    /// The UAVs are in these cells after the move.
    SetPositions {
        /// One for each UAV.
        cells: Vec<Cell>,
    },
    /// A UAV neither flies nor senses nor communicates in this step.
    Ground {
        /// Which.
        uav: usize,
    },
    /// A hotspot is confirmed, whatever was detected.
    ConfirmHotspot {
        /// Which.
        hotspot: usize,
    },
    /// Who detected what.
    StepSenseOver {
        /// (UAV, hotspot).
        detections: Vec<[usize; 2]>,
    },
    /// Who heard whom.
    StepCommunicateOver {
        /// (i, j), i < j.
        links: Vec<[usize; 2]>,
        /// Mean normalised throughput of each UAV as measured; `None` for the link budget's.
        throughput: Option<Vec<f64>>,
    },
}

impl Host {
    /// The kinds of line that are calls of the host.
    pub(super) const KINDS: [&'static str; 10] = [
        "set_starts",
        "set_hotspots",
        "set_batteries",
        "set_battery",
        "move_hotspot",
        "set_positions",
        "ground",
        "confirm_hotspot",
        "step_sense_with",
        "step_communicate_with",
    ];

    /// Whether the call stands between two parts of a step.
    #[must_use]
    pub const fn within_a_step(&self) -> bool {
        matches!(
            self,
            Self::SetPositions { .. }
                | Self::Ground { .. }
                | Self::ConfirmHotspot { .. }
                | Self::StepSenseOver { .. }
                | Self::StepCommunicateOver { .. }
        )
    }

    /// The pairs of a matrix that do not exist in a model of these sizes.
    pub(super) fn stray_pair(&self, uavs: usize, hotspots: usize) -> Option<[usize; 2]> {
        let (pairs, columns) = match self {
            Self::StepSenseOver { detections } => (detections, hotspots),
            Self::StepCommunicateOver { links, .. } => (links, uavs),
            _ => return None,
        };
        let stray = |pair: &&[usize; 2]| pair[0] >= uavs || pair[1] >= columns;
        pairs.iter().find(stray).copied()
    }

    /// Makes the call.
    ///
    /// # Errors
    /// What the kernel refuses.
    pub(super) fn make(&self, sim: &mut Sim<'_>) -> Result<(), Error> {
        let model = sim.model();
        let (uavs, hotspots) = (model.uav_count(), model.hotspot_count());
        match self {
            Self::SetStarts { cells } => sim.set_starts(cells),
            Self::SetHotspots { cells } => sim.set_hotspots(cells),
            Self::SetBatteries { charges_uj } => sim.set_batteries(charges_uj),
            Self::SetBattery { uav, charge_uj } => sim.set_battery(*uav, *charge_uj),
            Self::MoveHotspot { hotspot, cell } => sim.move_hotspot(*hotspot, *cell),
            Self::SetPositions { cells } => sim.set_positions(cells),
            Self::Ground { uav } => sim.ground(*uav),
            Self::ConfirmHotspot { hotspot } => sim.confirm_hotspot(*hotspot),
            Self::StepSenseOver { detections } => {
                sim.step_sense_with(&matrix(uavs, hotspots, detections, false))
            }
            Self::StepCommunicateOver { links, throughput } => {
                sim.step_communicate_with(&matrix(uavs, uavs, links, true), throughput.as_deref())
            }
        }
    }
}

/// A matrix with 1 at each pair, and at its mirror image where it is to be symmetric.
fn matrix(rows: usize, columns: usize, pairs: &[[usize; 2]], symmetric: bool) -> Vec<u8> {
    let mut matrix = vec![0; rows * columns];
    for &[i, k] in pairs {
        matrix[i * columns + k] = 1;
        if symmetric {
            matrix[k * columns + i] = 1;
        }
    }
    matrix
}
