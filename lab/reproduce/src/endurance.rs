//! Missions that outlast many batteries, where charging and the carbon of the grid decide.

use crate::campaign::{ADAPTIVE, CampaignSpec, OURS, Who};
use crate::chapter::{Block, Chapter};
use crate::scope::Scope;
use crate::table::{Quantity, Query, Table};
use crate::text::capital;
use jcas_core::config::Depots;
use jcas_core::{Cell, Config, Preset};
use jcas_figures::{Axis, Figure, Panels, Point, Series};
use jcas_policy::{BaselineKind, PilotMode};

/// Name in the table of results; what it varies is the charger's power.
const EXPERIMENT: &str = "endurance";
/// Hotspots of a mission.
const HOTSPOTS: u32 = 30;
/// The paper's charger, which takes as long as a flight, and one that fills a battery in a step, as
/// a swap does.
const CHARGERS_KW: [f64; 2] = [0.3, SWAP_KW];
const SWAP_KW: f64 = 21.6;

/// The scripts: with the autopilot's charging alone, filling up, and waiting for clean energy.
const SCRIPTS: [BaselineKind; 3] = [
    BaselineKind::Teams,
    BaselineKind::Charging,
    BaselineKind::Clean,
];

/// The tour of `mission` with thirty hotspots, a horizon of a thousand steps, batteries that last
/// sixty moves and two depots. The charge that sends a UAV home is the paper's share of the
/// battery.
pub fn mission(uavs: u32, charge_power_kw: f64) -> Config {
    let depots = Depots::from_slice(&[Cell { x: 2, y: 2 }, Cell { x: 9, y: 9 }]);
    Config {
        uav_count: uavs,
        hotspot_count: HOTSPOTS,
        horizon_steps: 1000,
        battery_capacity_kwh: 0.06,
        rtb_threshold_kwh: 0.012,
        depots: depots.expect("two are within the bound"),
        charge_power_kw,
        ..Config::preset(Preset::Mission)
    }
}

/// Every script, and ours where it is given, for each charger and fleet.
pub(crate) fn flights(scope: &Scope) -> Vec<CampaignSpec> {
    let mut flights = Vec::new();
    for power in CHARGERS_KW {
        for &uavs in &scope.endurance_fleets {
            let config = mission(uavs, power);
            let ours = Who::Ours {
                base: config,
                held: None,
            };
            let scripts = SCRIPTS.map(|kind| Who::Script(kind, PilotMode::Adaptive));
            flights.extend(scripts.into_iter().chain([ours]).map(|who| CampaignSpec {
                experiment: (EXPERIMENT.to_owned(), power),
                preset: Preset::Mission,
                config,
                who,
            }));
        }
    }
    flights
}

fn names() -> impl Iterator<Item = &'static str> {
    SCRIPTS.into_iter().map(BaselineKind::name).chain([OURS])
}

fn query(policy: &str, power: f64, uavs: u32) -> Query<'_> {
    let query = Query::new(EXPERIMENT, Preset::Mission.name(), (policy, ADAPTIVE));
    query.uavs(uavs).x(power)
}

const HEAD: [&str; 8] = [
    "charger (kW)",
    "N",
    "policy",
    "success",
    "steps",
    "energy (kWh)",
    "CO2 (kg)",
    "CO2 against `charging`",
];

/// The chapter as far as the table has it; none without a row.
pub fn chapter(scope: &Scope, table: &Table) -> Option<Chapter> {
    let mut rows = Vec::new();
    for power in CHARGERS_KW {
        for &uavs in &scope.endurance_fleets {
            for name in names() {
                let of = |quantity| query(name, power, uavs).mean(table, quantity);
                let (Some(success), Some(steps), Some(energy), Some(co2)) = (
                    of(Quantity::Success),
                    of(Quantity::Steps),
                    of(Quantity::Energy),
                    of(Quantity::Co2),
                ) else {
                    continue;
                };
                let charging = query(BaselineKind::Charging.name(), power, uavs);
                let against = charging
                    .mean(table, Quantity::Co2)
                    .map_or(String::new(), |c| {
                        format!("{:+.1} %", 100.0 * (co2.value / c.value.max(1e-12) - 1.0))
                    });
                rows.push([
                    power.to_string(),
                    uavs.to_string(),
                    name.to_owned(),
                    format!("{:.3}", success.value),
                    format!("{:.1} [{:.1}, {:.1}]", steps.value, steps.low, steps.high),
                    format!("{:.3}", energy.value),
                    format!("{:.3} [{:.3}, {:.3}]", co2.value, co2.low, co2.high),
                    against,
                ]);
            }
        }
    }
    if rows.is_empty() {
        return None;
    }
    let figures = [
        (Quantity::Steps, "endurance_mission_time"),
        (Quantity::Co2, "endurance_co2"),
    ];
    let figures = figures.map(|(quantity, name)| {
        let figure = panels(scope, table, quantity);
        Block::figure(name, &figure.title.clone(), figure)
    });
    let learned = rows.iter().any(|row| row[2] == OURS);
    let mut blocks = vec![
        Block::Text(text(scope, learned)),
        Block::table("Missions that outlast many batteries", HEAD, rows),
    ];
    blocks.extend(figures);
    Some(Chapter {
        heading: "Endurance".to_owned(),
        blocks,
    })
}

fn text(scope: &Scope, learned: bool) -> String {
    let config = mission(10, SWAP_KW);
    let ours = if learned {
        " `learned` is ours, trained on this mission and flown with the charger that it was \
            trained with. It may fly home by itself, and the autopilot sends it where it does not."
    } else {
        ""
    };
    format!(
        "This is `mission` with {HOTSPOTS} hotspots, a horizon of {} steps, and depots at (2, 2) \
            and (9, 9) (`examples/endurance.toml`; {} missions a row). Batteries of {} kWh last \
            about sixty moves. The paper's charger of 0.3 kW takes as long as a flight. One of \
            {SWAP_KW} kW fills a battery in one step, as a swap does.\n\n\
         `teams` leaves charging to the autopilot: home at a fifth of the charge, off again once \
            the grid can be crossed. `charging` fills up whenever it is home. `clean` starts for \
            home with a reserve. It waits beside the depot until the intensity is in the lowest \
            fifth of its range or the reserve is spent. Then it fills up. The intensity is drawn \
            anew in each step, so that only the step in which a UAV begins to charge can be \
            chosen. With a swap that is all of the charge, with the paper's charger one step of \
            about sixty. And a UAV that goes home early goes more often and ends the mission with \
            a fuller battery. So cleaner energy need not mean less carbon.{ours}",
        config.horizon_steps, scope.episodes, config.battery_capacity_kwh
    )
}

/// A quantity over the fleet's size, a panel for each charger.
fn panels(scope: &Scope, table: &Table, quantity: Quantity) -> Panels {
    let panel = |power: f64| {
        let mut figure = Figure::new(
            format!("charger of {power} kW"),
            Axis::new("UAVs", ""),
            Axis::new(quantity.title(), quantity.unit()),
        );
        for name in names() {
            let points: Vec<Point> = scope
                .endurance_fleets
                .iter()
                .filter_map(|&uavs| {
                    let e = query(name, power, uavs).mean(table, quantity)?;
                    Some(Point::interval(f64::from(uavs), e.value, e.low, e.high))
                })
                .collect();
            if !points.is_empty() {
                figure = figure.with(Series::line(name, points));
            }
        }
        figure
    };
    Panels {
        title: format!("{} over fleet size, endurance", capital(quantity.title())),
        note: format!(
            "{HOTSPOTS} hotspots, {} missions a point; a mission without success counts with its \
             horizon, 1000 steps.",
            scope.episodes
        ),
        columns: 2,
        figures: CHARGERS_KW.map(panel).to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_example_is_the_mission_that_is_flown() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/endurance.toml");
        let text = std::fs::read_to_string(path).unwrap();
        assert_eq!(Config::from_toml(&text).unwrap(), mission(10, SWAP_KW));
    }

    #[test]
    fn a_battery_lasts_sixty_moves_and_reaches_a_depot_from_anywhere() {
        let config = mission(10, SWAP_KW);
        let most = config.move_energy_kwh + config.sense_energy_kwh + config.comm_energy_kwh;
        assert_eq!(
            (config.battery_capacity_kwh / (config.move_energy_kwh + config.sense_energy_kwh))
                .round(),
            60.0
        );
        let depots = config.effective_depots();
        let farthest = (0..config.grid_width)
            .flat_map(|x| (0..config.grid_height).map(move |y| Cell { x, y }))
            .filter_map(|cell| depots.as_slice().iter().map(|d| d.manhattan(cell)).min())
            .max()
            .unwrap();
        assert!(f64::from(farthest) * most <= config.rtb_threshold_kwh);
    }
}
