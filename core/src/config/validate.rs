//! The rules of a legal configuration.

use super::{Config, DetectionCurve, DetectionPoint, MapDirections, SearchMaps};
use crate::error::{Allowed, ConfigError, Value};

/// Largest number of bits of the maps of a fleet: 32 MiB.
const MAP_BITS_MAX: u64 = 1 << 28;

/// Longest range of a detection table.
const RANGE_MAX_M: f64 = 1e6;

/// Largest P_d at the end of a detection table. Beyond its last range the table keeps this value,
/// so a table that ends high would be a radar without an end.
const LAST_PROBABILITY_MAX: f64 = 0.1;

impl Config {
    /// Checks every field and the rules between fields.
    ///
    /// # Errors
    /// The first violation, with field, value and what is allowed.
    pub fn validate(&self) -> Result<(), ConfigError> {
        self.each_field_is_in_range()?;
        ordered(
            "initial_soc_min",
            self.initial_soc_min,
            self.initial_soc_max,
            "initial_soc_max",
        )?;
        ordered(
            "pilot_density_min",
            self.pilot_density_min,
            self.pilot_density_max,
            "pilot_density_max",
        )?;
        ordered(
            "carbon_intensity_min_kg_per_kwh",
            self.carbon_intensity_min_kg_per_kwh,
            self.carbon_intensity_max_kg_per_kwh,
            "carbon_intensity_max_kg_per_kwh",
        )?;
        ordered(
            "rtb_threshold_kwh",
            self.rtb_threshold_kwh,
            self.battery_capacity_kwh,
            "battery_capacity_kwh",
        )?;
        self.radar_fits_its_curve()?;
        self.footprint_has_a_use()?;
        self.detection_table_is_one()?;
        self.depots_are_cells()?;
        self.hotspots_have_room()?;
        self.maps_have_room()?;
        self.reports_have_a_use()?;
        self.ledgers_have_room()
    }

    /// Checks that observations show maps only if maps exist, and that the maps of a fleet fit the
    /// limit.
    fn maps_have_room(&self) -> Result<(), ConfigError> {
        if self.search_maps == SearchMaps::Off {
            let (field, value, rule) = if self.map_window_radius > 0 && self.report_levels == 0 {
                (
                    "map_window_radius",
                    self.map_window_radius,
                    "0 (off) while search_maps is off and report_levels is 0",
                )
            } else if self.map_directions != MapDirections::Off {
                (
                    "map_directions",
                    self.map_directions as u32,
                    "0 (off) while search_maps is off",
                )
            } else {
                return Ok(());
            };
            return Err(ConfigError {
                field,
                value: Value::Integer(value.into()),
                allowed: Allowed::Rule(rule),
            });
        }
        let most = MAP_BITS_MAX / self.cell_count() as u64;
        if u64::from(self.uav_count) > most {
            return Err(ConfigError {
                field: "uav_count",
                value: Value::Integer(self.uav_count.into()),
                allowed: Allowed::AtMost(
                    most as f64,
                    "with search_maps = shared, 2^28 over the cells of the grid",
                ),
            });
        }
        Ok(())
    }

    /// Checks that reports have a footprint, are shown only if they exist, and fit the limit.
    fn reports_have_a_use(&self) -> Result<(), ConfigError> {
        let refused = |field, value: u32, allowed| {
            Err(ConfigError {
                field,
                value: Value::Integer(value.into()),
                allowed,
            })
        };
        if self.report_levels == 0 {
            if self.report_slots > 0 {
                let rule = Allowed::Rule("0 while report_levels is 0");
                return refused("report_slots", self.report_slots, rule);
            }
            return Ok(());
        }
        if self.false_alarm_per_cell == 0.0 {
            let rule = "0 while false_alarm_per_cell is 0, which leaves no footprint";
            return refused("report_levels", self.report_levels, Allowed::Rule(rule));
        }
        let most = MAP_BITS_MAX / u64::from(self.report_levels) / self.cell_count() as u64;
        if u64::from(self.uav_count) > most {
            let limit = "2^28 over report_levels times the cells of the grid";
            return refused(
                "uav_count",
                self.uav_count,
                Allowed::AtMost(most as f64, limit),
            );
        }
        Ok(())
    }

    /// Checks that no field is given that the detection curve does not use. P_fa must be in the
    /// range of Albersheim's equation where that equation gives the threshold.
    fn radar_fits_its_curve(&self) -> Result<(), ConfigError> {
        let p_fa = self.false_alarm_probability;
        match self.detection_curve {
            DetectionCurve::Logistic if !(1e-7..=1e-3).contains(&p_fa) => refused(
                "false_alarm_probability",
                Value::Real(p_fa),
                "from 1e-7 to 1e-3 while detection_curve is logistic (Albersheim's equation)",
            ),
            DetectionCurve::Logistic => Ok(()),
            DetectionCurve::Table => self
                .has_no_threshold("absent while detection_curve is table, which has no threshold"),
            DetectionCurve::Swerling1 => {
                self.has_no_threshold(
                    "absent while detection_curve is swerling1, which has no threshold",
                )?;
                let slope_per_db = self.logistic_slope_per_db;
                if slope_per_db != Self::MISSION.logistic_slope_per_db {
                    return refused(
                        "logistic_slope_per_db",
                        Value::Real(slope_per_db),
                        "0.25, its default, while detection_curve is swerling1, which has no slope",
                    );
                }
                Ok(())
            }
        }
    }

    /// Checks that a footprint is given only if there are false alarms.
    fn footprint_has_a_use(&self) -> Result<(), ConfigError> {
        match self.sensing_footprint_m {
            Some(radius_m) if self.false_alarm_per_cell == 0.0 => Err(ConfigError {
                field: "sensing_footprint_m",
                value: Value::Real(radius_m),
                allowed: Allowed::Rule("absent while false_alarm_per_cell is 0"),
            }),
            _ => Ok(()),
        }
    }

    fn has_no_threshold(&self, rule: &'static str) -> Result<(), ConfigError> {
        if let Some(threshold_db) = self.detection_threshold_db {
            return refused("detection_threshold_db", Value::Real(threshold_db), rule);
        }
        if let Some(range_m) = self.sensing_range_m {
            return refused("sensing_range_m", Value::Real(range_m), rule);
        }
        Ok(())
    }

    /// Checks that the detection table is present exactly where the curve is one, and that it does
    /// not rise with the range.
    fn detection_table_is_one(&self) -> Result<(), ConfigError> {
        let points = self.detection_table.as_slice();
        if self.detection_curve == DetectionCurve::Table && points.is_empty() {
            let rule = "a list of 1 to 64 pairs [m, P_d] while detection_curve is table";
            return refused("detection_table", Value::Name("[]"), rule);
        }
        let mut before: Option<&DetectionPoint> = None;
        for point in points {
            let (range_m, probability) = (point.range_m, point.probability);
            let rule = if self.detection_curve != DetectionCurve::Table {
                "absent unless detection_curve is table"
            } else if !(0.0..=RANGE_MAX_M).contains(&range_m) {
                "pairs [m, P_d] with a range from 0 to 1e6"
            } else if !(probability > 0.0 && probability < 1.0) {
                "pairs [m, P_d] with a P_d above 0 and below 1"
            } else if before.is_some_and(|before| before.range_m >= range_m) {
                "pairs [m, P_d] of which each has a longer range than the one before"
            } else if before.is_some_and(|before| before.probability < probability) {
                "pairs [m, P_d] whose P_d does not rise with the range"
            } else {
                before = Some(point);
                continue;
            };
            return refused("detection_table", Value::Pair(range_m, probability), rule);
        }
        match before {
            Some(last) if last.probability > LAST_PROBABILITY_MAX => refused(
                "detection_table",
                Value::Pair(last.range_m, last.probability),
                "pairs [m, P_d] that end with a P_d of at most 0.1, which holds at longer ranges",
            ),
            _ => Ok(()),
        }
    }

    fn each_field_is_in_range(&self) -> Result<(), ConfigError> {
        for (info, value) in Self::FIELDS.iter().zip(self.values()) {
            if let Some(value) = value.outside(info.low, info.high) {
                return Err(ConfigError {
                    field: info.name,
                    value,
                    allowed: Allowed::Range(info.low, info.high),
                });
            }
        }
        Ok(())
    }

    fn depots_are_cells(&self) -> Result<(), ConfigError> {
        let cells = self.depots.as_slice();
        for (index, cell) in cells.iter().enumerate() {
            let rule = if cell.x >= self.grid_width || cell.y >= self.grid_height {
                "cells of the grid: x below grid_width, y below grid_height"
            } else if cells[..index].contains(cell) {
                "distinct cells"
            } else {
                continue;
            };
            return Err(ConfigError {
                field: "depots",
                value: Value::Cell(cell.x, cell.y),
                allowed: Allowed::Rule(rule),
            });
        }
        Ok(())
    }

    fn hotspots_have_room(&self) -> Result<(), ConfigError> {
        let room = self.cell_count() - self.effective_depots().len();
        if self.hotspot_count as usize > room {
            return Err(ConfigError {
                field: "hotspot_count",
                value: Value::Integer(self.hotspot_count.into()),
                allowed: Allowed::AtMost(room as f64, "the cells of the grid without a depot"),
            });
        }
        Ok(())
    }
}

fn refused(field: &'static str, value: Value, rule: &'static str) -> Result<(), ConfigError> {
    Err(ConfigError {
        field,
        value,
        allowed: Allowed::Rule(rule),
    })
}

fn ordered(
    field: &'static str,
    low: f64,
    high: f64,
    bound: &'static str,
) -> Result<(), ConfigError> {
    if low <= high {
        return Ok(());
    }
    Err(ConfigError {
        field,
        value: Value::Real(low),
        allowed: Allowed::AtMost(high, bound),
    })
}
