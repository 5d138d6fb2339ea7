//! What several fuzz targets share.

use jcas_core::hash::Fnv1a;
use jcas_core::{Config, Model};

/// The checksum of snapshots and traces.
#[must_use]
pub fn checksum(bytes: &[u8]) -> u64 {
    let mut hash = Fnv1a::new();
    hash.write(bytes);
    hash.finish()
}

/// UAVs of [`small_model`].
pub const UAVS: usize = 4;
/// Hotspots of [`small_model`].
pub const HOTSPOTS: usize = 3;

/// A model so small that a run of a target takes microseconds.
///
/// # Panics
/// Never: the configuration is valid.
#[must_use]
pub fn small_model() -> Model<'static> {
    let config = Config {
        grid_width: 5,
        grid_height: 4,
        uav_count: UAVS as u32,
        hotspot_count: HOTSPOTS as u32,
        horizon_steps: 20,
        ..Config::default()
    };
    Model::new(config).unwrap()
}
