//! The calls of a host simulator. Each is a line of its own, in the order in which it was made,
//! before the line of the step that it is part of.

use jcas_core::Cell;
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
    StepSenseWith {
        /// (UAV, hotspot).
        detections: Vec<[usize; 2]>,
    },
    /// Who heard whom.
    StepCommunicateWith {
        /// (i, j), i < j.
        links: Vec<[usize; 2]>,
        /// Mean normalised throughput of each UAV as measured; `None` for the link budget's.
        throughput: Option<Vec<f64>>,
    },
}

impl Host {
    /// Whether the call stands between two parts of a step.
    pub(super) const fn within_a_step(&self) -> bool {
        matches!(
            self,
            Self::SetPositions { .. }
                | Self::Ground { .. }
                | Self::ConfirmHotspot { .. }
                | Self::StepSenseWith { .. }
                | Self::StepCommunicateWith { .. }
        )
    }

    /// The pairs of a matrix that do not exist in a model of these sizes.
    pub(super) fn stray_pair(&self, uavs: usize, hotspots: usize) -> Option<[usize; 2]> {
        let (pairs, columns) = match self {
            Self::StepSenseWith { detections } => (detections, hotspots),
            Self::StepCommunicateWith { links, .. } => (links, uavs),
            _ => return None,
        };
        let stray = |pair: &&[usize; 2]| pair[0] >= uavs || pair[1] >= columns;
        pairs.iter().find(stray).copied()
    }
}
