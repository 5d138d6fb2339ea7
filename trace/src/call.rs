//! The writer and reader of the lines of a host's calls.

use core::fmt::{self, Display};

use jcas_core::Model;
use jcas_core::host::Call;

use crate::error::Problem;
use crate::line::{cells, list, numbers, pairs};
use crate::number::Real;
use crate::reader::{Reader, expect};
use crate::workspace::Arguments;

/// The line of a call.
#[derive(Clone, Copy, Debug)]
pub struct CallLine<'a> {
    /// The call that the kernel accepted.
    pub call: &'a Call<'a>,
    /// Number of UAVs (N).
    pub uavs: usize,
}

impl Display for CallLine<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{{\"kind\":\"{}\",", self.call.kind())?;
        match *self.call {
            Call::SetStarts { cells: list }
            | Call::SetHotspots { cells: list }
            | Call::SetPositions { cells: list } => {
                out.write_str("\"cells\":")?;
                cells(out, list.iter().copied())
            }
            Call::SetBatteries { charges_uj } => {
                out.write_str("\"charges_uj\":")?;
                numbers(out, charges_uj.iter())
            }
            Call::SetBattery { uav, charge_uj } => {
                write!(out, "\"uav\":{uav},\"charge_uj\":{charge_uj}")
            }
            Call::MoveHotspot { hotspot, cell } => {
                write!(
                    out,
                    "\"hotspot\":{hotspot},\"cell\":[{},{}]",
                    cell.x, cell.y
                )
            }
            Call::Ground { uav } => write!(out, "\"uav\":{uav}"),
            Call::ConfirmHotspot { hotspot } => write!(out, "\"hotspot\":{hotspot}"),
            Call::StepSenseWith { detections } => {
                out.write_str("\"detections\":")?;
                pairs(out, nonzero(detections, detections.len() / self.uavs))
            }
            Call::StepCommunicateWith { links, throughput } => {
                out.write_str("\"links\":")?;
                pairs(out, nonzero(links, self.uavs).filter(|(i, k)| i < k))?;
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
}

/// Returns the (row, column) of each nonzero element of a matrix.
fn nonzero(matrix: &[u8], columns: usize) -> impl Iterator<Item = (usize, usize)> {
    let places = matrix.iter().enumerate().filter(|(_, value)| **value != 0);
    places.map(move |(place, _)| (place / columns, place % columns))
}

/// Reads a call's line after its kind. The call borrows its lists from the arguments' memory.
pub(crate) fn read<'a, 't>(
    kind: &str,
    reader: &mut Reader<'t>,
    model: &Model<'_>,
    arguments: &'a mut Arguments<'_>,
) -> Result<Call<'a>, Problem<'t>> {
    let (uavs, hotspots) = (model.uav_count(), model.hotspot_count());
    let Arguments {
        cells,
        charges_uj,
        throughput,
        matrix,
    } = arguments;
    let call = match kind {
        "set_starts" => Call::SetStarts {
            cells: read_cells(reader, &mut cells[..uavs])?,
        },
        "set_hotspots" => Call::SetHotspots {
            cells: read_cells(reader, &mut cells[..hotspots])?,
        },
        "set_positions" => Call::SetPositions {
            cells: read_cells(reader, &mut cells[..uavs])?,
        },
        "set_batteries" => {
            reader.skip("\"charges_uj\":")?;
            let charges_uj = reader.fill(charges_uj, Reader::number)?;
            Call::SetBatteries { charges_uj }
        }
        "set_battery" => Call::SetBattery {
            uav: reader.field("\"uav\":")?,
            charge_uj: reader.field(",\"charge_uj\":")?,
        },
        "move_hotspot" => {
            let hotspot = reader.field("\"hotspot\":")?;
            reader.skip(",\"cell\":")?;
            let cell = reader.cell()?;
            Call::MoveHotspot { hotspot, cell }
        }
        "ground" => Call::Ground {
            uav: reader.field("\"uav\":")?,
        },
        "confirm_hotspot" => Call::ConfirmHotspot {
            hotspot: reader.field("\"hotspot\":")?,
        },
        "step_sense_with" => {
            reader.skip("\"detections\":")?;
            let detections = &mut matrix[..uavs * hotspots];
            read_matrix(reader, detections, hotspots, false)?;
            Call::StepSenseWith { detections }
        }
        "step_communicate_with" => {
            reader.skip("\"links\":")?;
            let links = &mut matrix[..uavs * uavs];
            read_matrix(reader, links, uavs, true)?;
            reader.skip(",\"throughput\":")?;
            let throughput = if reader.rest.starts_with('[') {
                Some(reader.fill(throughput, Reader::number)?)
            } else {
                reader.skip("null")?;
                None
            };
            Call::StepCommunicateWith { links, throughput }
        }
        _ => return Err(Problem::Form),
    };
    expect(reader.rest == "}\n")?;
    Ok(call)
}

fn read_cells<'a, 't>(
    reader: &mut Reader<'t>,
    cells: &'a mut [jcas_core::Cell],
) -> Result<&'a [jcas_core::Cell], Problem<'t>> {
    reader.skip("\"cells\":")?;
    reader.fill(cells, Reader::cell)
}

/// Reads a matrix from the list of the (row, column) of its nonzero elements.
fn read_matrix<'t>(
    reader: &mut Reader<'t>,
    matrix: &mut [u8],
    columns: usize,
    symmetric: bool,
) -> Result<(), Problem<'t>> {
    let rows = matrix.len() / columns;
    matrix.fill(0);
    reader.list(|reader, _| {
        let [row, column] = reader.pair::<usize>()?;
        expect(row < rows && column < columns)?;
        matrix[row * columns + column] = 1;
        if symmetric {
            matrix[column * columns + row] = 1;
        }
        Ok(())
    })?;
    Ok(())
}
