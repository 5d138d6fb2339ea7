//! The memory in which a trace is recorded and verified.

use jcas_core::{Cell, Model};

/// The lengths of the slices of a [`Workspace`], in elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WorkspaceSizes {
    /// Elements for all observations, \[N\]\[observation_len\].
    pub observations: usize,
    /// Elements for the actions of a step, \[N\]\[2\].
    pub actions: usize,
    /// One element for each UAV.
    pub uavs: usize,
    /// One element for each UAV or for each hotspot, the greater number.
    pub cells: usize,
    /// One byte for each pair of UAVs or for each UAV and hotspot, the greater number.
    pub matrix: usize,
}

impl WorkspaceSizes {
    /// Returns the lengths that the traces of a model need.
    #[must_use]
    pub fn of(model: &Model<'_>) -> Self {
        let (uavs, hotspots) = (model.uav_count(), model.hotspot_count());
        Self {
            observations: uavs * model.observation_len(),
            actions: model.action_len(),
            uavs,
            cells: uavs.max(hotspots),
            matrix: uavs * uavs.max(hotspots),
        }
    }
}

/// The memory that a replay works in. Its content before a call does not matter.
#[derive(Debug)]
pub struct Workspace<'a> {
    /// [`WorkspaceSizes::observations`] elements.
    pub observations: &'a mut [f32],
    /// [`WorkspaceSizes::actions`] elements.
    pub actions: &'a mut [f32],
    /// The arguments of a host's calls.
    pub arguments: Arguments<'a>,
}

/// The memory for the arguments of a host's calls.
#[derive(Debug)]
pub struct Arguments<'a> {
    /// [`WorkspaceSizes::cells`] elements.
    pub cells: &'a mut [Cell],
    /// [`WorkspaceSizes::uavs`] elements.
    pub charges_uj: &'a mut [u64],
    /// [`WorkspaceSizes::uavs`] elements.
    pub throughput: &'a mut [f64],
    /// [`WorkspaceSizes::matrix`] elements.
    pub matrix: &'a mut [u8],
}
