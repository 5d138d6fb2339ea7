//! The layout of an observation: a row of five own fields, hotspots, neighbour slots, and further
//! own fields.

use jcas_core::{Model, MotionMap};

/// The number of own fields before the hotspots.
pub const OWN_FIRST: usize = 5;
/// The number of fields of a hotspot.
pub const HOTSPOT_FIELDS: usize = 4;
/// The number of fields of a neighbour slot.
pub const SLOT_FIELDS: usize = 3;

/// The layout of an observation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RowLayout {
    /// The length of an observation.
    pub observation_len: usize,
    /// The number of hotspots.
    pub hotspots: usize,
    /// The number of neighbour slots.
    pub slots: usize,
    /// Cells that a position difference of 1 stands for, along x and y.
    pub cells: [u32; 2],
    /// The order of the motions over the bins of u_dir.
    pub motion_map: MotionMap,
}

impl RowLayout {
    /// The layout of the observations of a model.
    #[must_use]
    pub fn of(model: &Model<'_>) -> Self {
        let config = model.config();
        Self {
            observation_len: model.observation_len(),
            hotspots: model.hotspot_count(),
            slots: model.neighbour_slots(),
            cells: [config.grid_width, config.grid_height].map(|cells| cells.saturating_sub(1)),
            motion_map: config.motion_map,
        }
    }
}
