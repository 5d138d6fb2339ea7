//! The calls of a host simulator. Each call is a separate line before the line of its step. The
//! lines have the order of the calls.

use jcas_core::Cell;
use serde::{Deserialize, Serialize};

/// A call of the host. The kernel decides which calls come between steps and which within one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Host {
    /// Sets the cells in which the UAVs start.
    SetStarts {
        /// One cell for each UAV.
        cells: Vec<Cell>,
    },
    /// Sets the cells of the hotspots.
    SetHotspots {
        /// One cell for each hotspot.
        cells: Vec<Cell>,
    },
    /// Sets the charge of all batteries at the start.
    SetBatteries {
        /// Charge in microjoules, one for each UAV.
        charges_uj: Vec<u64>,
    },
    /// Sets the charge of one battery.
    SetBattery {
        /// Index of the UAV.
        uav: usize,
        /// Charge in microjoules.
        charge_uj: u64,
    },
    /// Moves a hotspot.
    MoveHotspot {
        /// Index of the hotspot.
        hotspot: usize,
        /// Its new cell.
        cell: Cell,
    },
    /// Sets the cells of the UAVs after the move.
    SetPositions {
        /// One cell for each UAV.
        cells: Vec<Cell>,
    },
    /// Grounds a UAV, which neither flies nor senses nor communicates in this step.
    Ground {
        /// Index of the UAV.
        uav: usize,
    },
    /// Confirms a hotspot independently of detections.
    ConfirmHotspot {
        /// Index of the hotspot.
        hotspot: usize,
    },
    /// Sets the detections of this step.
    StepSenseWith {
        /// Pairs (UAV, hotspot).
        detections: Vec<[usize; 2]>,
    },
    /// Sets the links of this step.
    StepCommunicateWith {
        /// Pairs (i, j), i < j.
        links: Vec<[usize; 2]>,
        /// Measured mean normalised throughput of each UAV; `None` for that of the link budget.
        throughput: Option<Vec<f64>>,
    },
}

impl Host {
    /// Whether the call comes between two parts of a step.
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

    /// A pair that is outside the matrix of a model of these sizes.
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
