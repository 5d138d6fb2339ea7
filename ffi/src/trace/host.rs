//! What a host supplied, as lines of a trace: one for each of its calls.

use std::fmt::{self, Write};

use jcas_core::Cell;

use super::line::{cells, list, numbers, pairs};
use super::number::Real;

/// A call of the host, with its arguments as the kernel took them.
pub(crate) enum Host<'a> {
    Starts(&'a [Cell]),
    Hotspots(&'a [Cell]),
    Batteries(&'a [u64]),
    Battery(usize, u64),
    Hotspot(usize, Cell),
    Positions(&'a [Cell]),
    Ground(usize),
    Confirm(usize),
    /// N rows of n.
    Detections(&'a [u8]),
    /// N rows of N, and what was measured.
    Links(&'a [u8], Option<&'a [f64]>),
}

impl Host<'_> {
    /// Writes the line; `uavs` is N.
    pub(crate) fn write(&self, out: &mut impl Write, uavs: usize) -> fmt::Result {
        write!(out, "{{\"kind\":\"{}\",", self.kind())?;
        match *self {
            Self::Starts(list) | Self::Hotspots(list) | Self::Positions(list) => {
                out.write_str("\"cells\":")?;
                cells(out, list.iter().copied())
            }
            Self::Batteries(charges) => {
                out.write_str("\"charges_uj\":")?;
                numbers(out, charges.iter())
            }
            Self::Battery(uav, charge) => write!(out, "\"uav\":{uav},\"charge_uj\":{charge}"),
            Self::Hotspot(hotspot, cell) => {
                write!(
                    out,
                    "\"hotspot\":{hotspot},\"cell\":[{},{}]",
                    cell.x, cell.y
                )
            }
            Self::Ground(uav) => write!(out, "\"uav\":{uav}"),
            Self::Confirm(hotspot) => write!(out, "\"hotspot\":{hotspot}"),
            Self::Detections(matrix) => {
                out.write_str("\"detections\":")?;
                pairs(out, set(matrix, matrix.len() / uavs))
            }
            Self::Links(matrix, throughput) => {
                out.write_str("\"links\":")?;
                pairs(out, set(matrix, uavs).filter(|(i, k)| i < k))?;
                out.write_str(",\"throughput\":")?;
                match throughput {
                    None => out.write_str("null"),
                    Some(each) => list(out, each.iter(), |out, &value| {
                        write!(out, "{}", Real(value))
                    }),
                }
            }
        }?;
        out.write_str("}\n")
    }

    const fn kind(&self) -> &'static str {
        match self {
            Self::Starts(_) => "set_starts",
            Self::Hotspots(_) => "set_hotspots",
            Self::Batteries(_) => "set_batteries",
            Self::Battery(..) => "set_battery",
            Self::Hotspot(..) => "move_hotspot",
            Self::Positions(_) => "set_positions",
            Self::Ground(_) => "ground",
            Self::Confirm(_) => "confirm_hotspot",
            Self::Detections(_) => "step_sense_with",
            Self::Links(..) => "step_communicate_with",
        }
    }
}

/// Places of a matrix that are not 0: (row, column).
fn set(matrix: &[u8], columns: usize) -> impl Iterator<Item = (usize, usize)> {
    let places = matrix.iter().enumerate().filter(|(_, value)| **value != 0);
    places.map(move |(place, _)| (place / columns, place % columns))
}
