//! What several fuzz targets share.

use jcas_core::{Config, Model};

/// FNV-1a, 64 bits: the checksum of snapshots and traces.
#[must_use]
pub fn fnv(bytes: &[u8]) -> u64 {
    let mix = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, mix)
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
