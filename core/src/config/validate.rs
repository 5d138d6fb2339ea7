//! The rules of a legal configuration.

use super::{Config, DetectionCurve, MapDirections, SearchMaps};
use crate::carbon::milligrams;
use crate::energy::EnergyPlan;
use crate::error::{Allowed, ConfigError, Value};

/// Largest number of bits of the maps of a fleet: 32 MiB.
const MAP_BITS_MAX: u64 = 1 << 28;

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
        let refused = |field, value, rule| {
            Err(ConfigError {
                field,
                value: Value::Real(value),
                allowed: Allowed::Rule(rule),
            })
        };
        let p_fa = self.false_alarm_probability;
        match self.detection_curve {
            DetectionCurve::Logistic if !(1e-7..=1e-3).contains(&p_fa) => refused(
                "false_alarm_probability",
                p_fa,
                "from 1e-7 to 1e-3 while detection_curve is logistic (Albersheim's equation)",
            ),
            DetectionCurve::Logistic => Ok(()),
            DetectionCurve::Swerling1 => {
                if let Some(threshold_db) = self.detection_threshold_db {
                    let rule = "absent while detection_curve is swerling1, which has no threshold";
                    return refused("detection_threshold_db", threshold_db, rule);
                }
                if let Some(range_m) = self.sensing_range_m {
                    let rule = "absent while detection_curve is swerling1, which has no threshold";
                    return refused("sensing_range_m", range_m, rule);
                }
                if self.logistic_slope_per_db != Self::DEFAULT.logistic_slope_per_db {
                    let rule =
                        "0.25, its default, while detection_curve is swerling1, which has no slope";
                    return refused("logistic_slope_per_db", self.logistic_slope_per_db, rule);
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

    /// Checks that the worst case of every ledger over an episode fits its 64-bit integer. So no
    /// step has to check for overflow.
    fn ledgers_have_room(&self) -> Result<(), ConfigError> {
        const ROOM: u128 = 1 << 62;
        let plan = EnergyPlan::new(self);
        let fleet_steps = u128::from(self.uav_count) * u128::from(self.horizon_steps);
        let energy_uj = u128::from(self.uav_count) * u128::from(plan.capacity_uj)
            + fleet_steps * u128::from(plan.charge_uj.saturating_add(plan.most_asked_uj()));
        let intensity_mg_per_kwh = milligrams(self.carbon_intensity_max_kg_per_kwh);
        let carbon_ng =
            fleet_steps * u128::from(plan.charge_uj) * u128::from(intensity_mg_per_kwh) / 3_600_000;
        if energy_uj > ROOM || carbon_ng > ROOM {
            return Err(ConfigError {
                field: "horizon_steps",
                value: Value::Integer(self.horizon_steps.into()),
                allowed: Allowed::Rule(
                    "so small that the fleet's energy over an episode stays under 2^62 uJ \
                     and its carbon under 2^62 ng",
                ),
            });
        }
        Ok(())
    }
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
