//! Exports a plan as a picture, GeoJSON, or QGroundControl plans.

use std::fmt::Write;

use jcas_core::{Cell, Config};
use jcas_plan::PlanFile;
use serde_json::{Value, json};

/// Mean radius of the earth, in metres.
const EARTH_RADIUS_M: f64 = 6_371_008.8;
/// Side of a cell in the picture, in pixels.
const CELL_PX: f64 = 44.0;
/// Colours of the UAVs, in order of their indices.
const COLOURS: [&str; 10] = [
    "#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#bbbbbb", "#cc3311",
    "#009988", "#000000",
];

/// The position of the first depot on earth, and the altitude of the UAVs above it.
#[derive(Clone, Copy, Debug)]
pub struct GeoPosition {
    /// Latitude, in degrees north.
    pub latitude: f64,
    /// Longitude, in degrees east.
    pub longitude: f64,
    /// Altitude above the depot, in metres.
    pub altitude_m: f64,
}

impl GeoPosition {
    /// Latitude and longitude of a cell: x points east, y north.
    fn of(self, cell: Cell, depot: Cell, cell_size_m: f64) -> (f64, f64) {
        let east_m = (f64::from(cell.x) - f64::from(depot.x)) * cell_size_m;
        let north_m = (f64::from(cell.y) - f64::from(depot.y)) * cell_size_m;
        let parallel_m = EARTH_RADIUS_M * self.latitude.to_radians().cos();
        let latitude = self.latitude + (north_m / EARTH_RADIUS_M).to_degrees();
        let longitude = self.longitude + (east_m / parallel_m).to_degrees();
        (latitude, longitude)
    }
}

/// The trajectories as GeoJSON lines: one feature for each UAV, one position for each step.
#[must_use]
pub fn geojson(file: &PlanFile, depot: Cell, place: GeoPosition) -> Value {
    let size_m = file.config.cell_size_m;
    let features = file.uavs.iter().enumerate().map(|(uav, trajectory)| {
        let coordinates: Vec<Value> = trajectory
            .cells
            .iter()
            .map(|&cell| {
                let (latitude, longitude) = place.of(cell, depot, size_m);
                json!([longitude, latitude, place.altitude_m])
            })
            .collect();
        json!({
            "type": "Feature",
            "properties": {
                "uav": uav + 1,
                "step_duration_s": file.config.step_duration_s,
                "pilot_density": trajectory.pilot_density,
            },
            "geometry": { "type": "LineString", "coordinates": coordinates },
        })
    });
    json!({
        "type": "FeatureCollection",
        "features": features.collect::<Vec<_>>(),
    })
}

/// The episode of one UAV as a QGroundControl plan. It has a take-off, a waypoint for each cell and
/// the return. The UAV holds each waypoint for as long as it stays in the cell.
#[must_use]
pub fn mission_of(file: &PlanFile, uav: usize, depot: Cell, place: GeoPosition) -> Value {
    const TAKE_OFF: u32 = 22;
    const WAYPOINT: u32 = 16;
    const RETURN: u32 = 20;
    let config = &file.config;
    let mut items = Vec::new();
    let mut add = |command: u32, hold_s: f64, cell: Option<Cell>| {
        let id = items.len() + 1;
        let (latitude, longitude, altitude_m) = match cell {
            Some(cell) => {
                let (latitude, longitude) = place.of(cell, depot, config.cell_size_m);
                (latitude, longitude, place.altitude_m)
            }
            None => (0.0, 0.0, 0.0),
        };
        // Frame 3 counts altitudes from home; frame 2 belongs to commands without a position.
        items.push(json!({
            "type": "SimpleItem",
            "command": command,
            "frame": if cell.is_some() { 3 } else { 2 },
            "params": [hold_s, 0, 0, null, latitude, longitude, altitude_m],
            "Altitude": altitude_m,
            "AltitudeMode": 1,
            "AMSLAltAboveTerrain": null,
            "autoContinue": true,
            "doJumpId": id,
        }));
    };
    let cells = &file.uavs[uav].cells;
    add(TAKE_OFF, 0.0, Some(cells[0]));
    let mut step = 1;
    while step < cells.len() {
        let here = cells[step];
        let stays = cells[step..]
            .iter()
            .take_while(|&&cell| cell == here)
            .count();
        // The first step in a cell is the travel to it, unless the UAV was already there.
        let moved = cells[step - 1] != here;
        let hold = stays - usize::from(moved);
        add(WAYPOINT, hold as f64 * config.step_duration_s, Some(here));
        step += stays;
    }
    add(RETURN, 0.0, None);
    let speed = config.cell_size_m / config.step_duration_s;
    json!({
        "fileType": "Plan",
        "version": 1,
        "groundStation": "QGroundControl",
        "geoFence": { "circles": [], "polygons": [], "version": 2 },
        "rallyPoints": { "points": [], "version": 2 },
        "mission": {
            "version": 2,
            "firmwareType": 12,
            "vehicleType": 2,
            "globalPlanAltitudeMode": 1,
            "cruiseSpeed": speed,
            "hoverSpeed": speed,
            "plannedHomePosition": [place.latitude, place.longitude, 0],
            "items": items,
        },
    })
}

/// Draws the trajectories over the grid as SVG, up to twice the expected time.
#[must_use]
pub fn picture(file: &PlanFile) -> String {
    let config = &file.config;
    let (width, height) = (
        f64::from(config.grid_width) * CELL_PX,
        f64::from(config.grid_height) * CELL_PX,
    );
    let margin = 40.0;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0} {:.0}\" \
         font-family=\"sans-serif\" font-size=\"14\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         <text x=\"{margin}\" y=\"26\">{} UAVs, {} hotspots: expected {:.2} steps; no fixed plan \
         below {:.2}</text>\n<g transform=\"translate({margin} {margin})\">\n",
        width + 2.0 * margin,
        height + 2.0 * margin,
        file.uavs.len(),
        config.hotspot_count,
        file.expected_steps,
        file.bound_steps,
    );
    let middle = |cell: Cell| {
        (
            (f64::from(cell.x) + 0.5) * CELL_PX,
            height - (f64::from(cell.y) + 0.5) * CELL_PX,
        )
    };
    draw_grid(&mut svg, config);
    for depot in config.effective_depots().as_slice() {
        let (x, y) = middle(*depot);
        let _ = writeln!(
            svg,
            "<rect x=\"{}\" y=\"{}\" width=\"16\" height=\"16\" fill=\"#444444\"/>",
            x - 8.0,
            y - 8.0
        );
    }
    for cell in file.hotspots.iter().flatten() {
        let (x, y) = middle(*cell);
        let _ = writeln!(
            svg,
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"10\" fill=\"none\" stroke=\"#cc3311\" \
             stroke-width=\"3\"/>"
        );
    }
    let shown = 1 + (2.0 * file.expected_steps).ceil() as usize;
    for (uav, trajectory) in file.uavs.iter().enumerate() {
        // Each UAV has its own lane, so that lines in one cell do not hide each other.
        let lane = (uav as f64 + 0.5) / file.uavs.len() as f64 - 0.5;
        let shift = lane * 0.6 * CELL_PX;
        let points: Vec<String> = trajectory
            .cells
            .iter()
            .take(shown)
            .map(|&cell| {
                let (x, y) = middle(cell);
                format!("{:.1},{:.1}", x + shift, y + shift)
            })
            .collect();
        draw_trajectory(&mut svg, &points, COLOURS[uav % COLOURS.len()]);
    }
    svg + "</g>\n</svg>\n"
}

/// Draws the borders of the cells.
fn draw_grid(svg: &mut String, config: &Config) {
    let (width, height) = (
        f64::from(config.grid_width) * CELL_PX,
        f64::from(config.grid_height) * CELL_PX,
    );
    for column in 0..=config.grid_width {
        let x = f64::from(column) * CELL_PX;
        let _ = writeln!(svg, "<path d=\"M{x} 0V{height}\" stroke=\"#dddddd\"/>");
    }
    for row in 0..=config.grid_height {
        let y = f64::from(row) * CELL_PX;
        let _ = writeln!(svg, "<path d=\"M0 {y}H{width}\" stroke=\"#dddddd\"/>");
    }
}

/// Draws a line through points "x,y", with a disc at the last one.
fn draw_trajectory(svg: &mut String, points: &[String], colour: &str) {
    let _ = writeln!(
        svg,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2.5\" \
         stroke-linejoin=\"round\"/>",
        points.join(" ")
    );
    if let Some((x, y)) = points.last().and_then(|end| end.split_once(',')) {
        let _ = writeln!(
            svg,
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"4\" fill=\"{colour}\"/>"
        );
    }
}
