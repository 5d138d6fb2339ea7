//! A detection curve as a table over the range.

use super::list::{Element, List};

/// Largest number of points of a detection table.
pub const MAX_DETECTION_POINTS: usize = 64;

/// A point of a detection table. In files it is a pair `[range in m, P_d]`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "(f64, f64)", into = "(f64, f64)"))]
pub struct DetectionPoint {
    /// Distance between UAV and hotspot in metres, from 0 to 1e6.
    pub range_m: f64,
    /// Probability of detection (P_d) at the highest pilot density, between 0 and 1.
    pub probability: f64,
}

impl From<(f64, f64)> for DetectionPoint {
    fn from((range_m, probability): (f64, f64)) -> Self {
        Self {
            range_m,
            probability,
        }
    }
}

impl From<DetectionPoint> for (f64, f64) {
    fn from(point: DetectionPoint) -> Self {
        (point.range_m, point.probability)
    }
}

impl Element for DetectionPoint {
    const BLANK: Self = Self {
        range_m: 0.0,
        probability: 0.0,
    };
    const NAMES: &'static str = "pairs [m, P_d]";
}

/// A list of up to [`MAX_DETECTION_POINTS`] points.
pub type DetectionTable = List<DetectionPoint, MAX_DETECTION_POINTS>;
