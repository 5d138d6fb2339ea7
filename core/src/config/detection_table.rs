//! A detection curve as a table over the range, with a fixed capacity.

/// Largest number of points of a detection table.
pub const MAX_DETECTION_POINTS: usize = 64;

/// A point of a detection table. In files it is a pair `[range in m, P_d]`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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

/// A list of up to [`MAX_DETECTION_POINTS`] points.
#[derive(Clone, Copy, Debug)]
pub struct DetectionTable {
    points: [DetectionPoint; MAX_DETECTION_POINTS],
    count: usize,
}

impl PartialEq for DetectionTable {
    fn eq(&self, other: &Self) -> bool {
        self.as_slice() == other.as_slice()
    }
}

impl DetectionTable {
    /// No table.
    pub const EMPTY: Self = Self {
        points: [DetectionPoint {
            range_m: 0.0,
            probability: 0.0,
        }; MAX_DETECTION_POINTS],
        count: 0,
    };

    /// The given points; `None` if there are more than [`MAX_DETECTION_POINTS`].
    #[must_use]
    pub fn from_slice(points: &[DetectionPoint]) -> Option<Self> {
        let mut table = Self::EMPTY;
        for point in points {
            table.push(*point)?;
        }
        Some(table)
    }

    /// Adds a point; `None` if the table is full.
    pub(super) fn push(&mut self, point: DetectionPoint) -> Option<()> {
        *self.points.get_mut(self.count)? = point;
        self.count += 1;
        Some(())
    }

    /// The points.
    #[must_use]
    pub fn as_slice(&self) -> &[DetectionPoint] {
        &self.points[..self.count]
    }

    /// Number of points in the table.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.count
    }

    /// Whether there is no table.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }
}

#[cfg(feature = "serde")]
mod serde_impl {
    use super::{DetectionTable, MAX_DETECTION_POINTS};
    use core::fmt;
    use serde::de::{Error, SeqAccess, Visitor};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    impl Serialize for DetectionTable {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            let pairs = self.as_slice().iter();
            serializer.collect_seq(pairs.map(|point| (point.range_m, point.probability)))
        }
    }

    impl<'de> Deserialize<'de> for DetectionTable {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            struct Points;
            impl<'de> Visitor<'de> for Points {
                type Value = DetectionTable;
                fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                    write!(
                        out,
                        "a list of at most {MAX_DETECTION_POINTS} pairs [m, P_d]"
                    )
                }
                fn visit_seq<A: SeqAccess<'de>>(
                    self,
                    mut list: A,
                ) -> Result<Self::Value, A::Error> {
                    let mut table = DetectionTable::EMPTY;
                    while let Some(pair) = list.next_element::<(f64, f64)>()? {
                        table.push(pair.into()).ok_or_else(|| {
                            A::Error::invalid_length(MAX_DETECTION_POINTS + 1, &self)
                        })?;
                    }
                    Ok(table)
                }
            }
            deserializer.deserialize_seq(Points)
        }
    }
}
