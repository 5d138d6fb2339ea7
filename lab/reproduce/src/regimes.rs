//! Where adapting the pilot density pays: maps over two fields of the configuration.

use crate::campaign::CampaignSpec;
use crate::chapter::Block;
use crate::pilot_comparison::{PilotComparison, scripted};
use crate::scope::Scope;
use crate::table::{Quantity, Table};
use jcas_core::{Config, Preset};
use jcas_figures::{Axis, HeatTable};
use jcas_policy::BaselineKind;

/// A field of the configuration and its values.
struct Varied {
    label: &'static str,
    unit: &'static str,
    values: &'static [f64],
    set: fn(&mut Config, f64),
}

impl Varied {
    fn ends_at(&self, value: f64) -> bool {
        [self.values.first(), self.values.last()].contains(&Some(&value))
    }

    /// Those of the values that are among others.
    fn among(&self, others: impl Iterator<Item = f64>) -> Vec<f64> {
        let others: Vec<f64> = others.collect();
        let values = self.values.iter().copied();
        values.filter(|value| others.contains(value)).collect()
    }

    fn axis(&self, values: &[f64]) -> Axis {
        Axis::new(self.label, self.unit).categories(values.iter().map(f64::to_string))
    }
}

const LOAD: Varied = Varied {
    label: "loss of sensing per load (α_JCAS)",
    unit: "dB",
    values: &[0.0, 1.0, 3.0, 5.0, 10.0, 20.0],
    set: |config, value| config.comm_load_penalty_db = value,
};
const LINK: Varied = Varied {
    label: "throughput that a link needs (η_link)",
    unit: "",
    values: &[0.6, 0.8, 1.0, 1.2, 1.4],
    set: |config, value| config.link_throughput_min = value,
};
const FLEET: Varied = Varied {
    label: "UAVs",
    unit: "",
    values: &[5.0, 10.0, 15.0, 20.0],
    set: |config, value| config.uav_count = value as u32,
};
const RANGE: Varied = Varied {
    label: "sensing range",
    unit: "m",
    values: &[75.0, 100.0, 150.0, 200.0, 250.0],
    set: |config, value| config.sensing_range_m = Some(value),
};

/// Two fields varied together around the mission of `line` in `search` at N = 10, n = 7.
struct Map {
    name: &'static str,
    rows: Varied,
    columns: Varied,
    /// α_JCAS where it is not varied, dB.
    load_db: f64,
}

const MAPS: [Map; 3] = [
    Map {
        name: "pilot_load_link",
        rows: LOAD,
        columns: LINK,
        load_db: 1.0,
    },
    Map {
        name: "pilot_load_fleet",
        rows: LOAD,
        columns: FLEET,
        load_db: 1.0,
    },
    Map {
        name: "pilot_range_fleet",
        rows: RANGE,
        columns: FLEET,
        load_db: 10.0,
    },
];

impl Map {
    fn config(&self, scope: &Scope, row: f64, column: f64) -> Config {
        let mut config = Config {
            comm_load_penalty_db: self.load_db,
            ..scope.mission(Preset::Search, (10, 7))
        };
        (self.rows.set)(&mut config, row);
        (self.columns.set)(&mut config, column);
        config
    }

    fn experiment(&self, row: f64, column: f64) -> String {
        format!("{}:{row}:{column}", self.name)
    }

    fn places(&self) -> impl Iterator<Item = (f64, f64)> {
        let (rows, columns) = (self.rows.values, self.columns.values);
        rows.iter()
            .flat_map(move |&row| columns.iter().map(move |&column| (row, column)))
    }

    fn worth(&self, table: &Table, row: f64, column: f64) -> Option<PilotComparison> {
        let experiment = self.experiment(row, column);
        PilotComparison::of(
            table,
            &experiment,
            Preset::Search,
            BaselineKind::Line.name(),
            None,
        )
    }
}

/// The maps with coarse densities.
pub(crate) fn flights(scope: &Scope) -> Vec<CampaignSpec> {
    let (_, coarse) = &scope.pilot_densities;
    let mut flights = Vec::new();
    for map in &MAPS {
        let flown = |&(row, column): &(f64, f64)| {
            !coarse.is_empty()
                && (scope.whole_maps || map.rows.ends_at(row) && map.columns.ends_at(column))
        };
        for (row, column) in map.places().filter(flown) {
            let experiment = map.experiment(row, column);
            let config = map.config(scope, row, column);
            flights.extend(scripted(
                &experiment,
                Preset::Search,
                config,
                BaselineKind::Line,
                coarse,
            ));
        }
    }
    flights
}

/// A sentence and a map for each, as far as the table has them.
pub(crate) fn blocks(scope: &Scope, table: &Table) -> Vec<Block> {
    let maps = MAPS.iter().filter_map(|map| {
        let (text, figure) = regimes(scope, table, map)?;
        let title = figure.title.clone();
        Some([Block::Text(text), Block::figure(map.name, &title, figure)])
    });
    maps.flatten().collect()
}

/// Where adapting pays, over two fields: mission time saved against the best constant of each
/// regime.
fn regimes(scope: &Scope, table: &Table, map: &Map) -> Option<(String, HeatTable)> {
    let worths: Vec<((f64, f64), PilotComparison)> = map
        .places()
        .filter_map(|(row, column)| Some(((row, column), map.worth(table, row, column)?)))
        .collect();
    let saved = |worth: &PilotComparison| -worth.above(worth.best(), Quantity::Steps);
    let most = worths
        .iter()
        .max_by(|a, b| saved(&a.1).total_cmp(&saved(&b.1)))?;
    let least = worths
        .iter()
        .min_by(|a, b| saved(&a.1).total_cmp(&saved(&b.1)))?;
    let clear = worths
        .iter()
        .filter(|(_, worth)| worth.tells_apart(worth.best()) && saved(worth) > 0.0)
        .count();
    let (rows, columns) = (&map.rows, &map.columns);
    let place = |((row, column), worth): &((f64, f64), PilotComparison)| {
        format!(
            "{} {row}{}, {} {column}: {:+.1} % of the best constant's time. That constant is ρ = \
             {:.2} and takes {:.1} steps",
            rows.label,
            unit(rows.unit),
            columns.label,
            -saved(worth),
            worth.best().x,
            worth.best().mission_steps
        )
    };
    let text = format!(
        "`line` in `search` around N = 10, n = 7{}: adapting shortens the mission beyond the \
            intervals in {clear} of {} regimes.\n\n- Most: {}.\n- Least: {}.",
        if map.load_db == 1.0 {
            String::new()
        } else {
            format!(", α_JCAS = {} dB", map.load_db)
        },
        worths.len(),
        place(most),
        place(least),
    );
    let cell = |row: f64, column: f64| {
        let at = worths.iter().find(|(place, _)| *place == (row, column))?;
        Some(saved(&at.1))
    };
    let places = || worths.iter().map(|(place, _)| *place);
    let rows_flown = rows.among(places().map(|(row, _)| row));
    let columns_flown = columns.among(places().map(|(_, column)| column));
    let figure = HeatTable {
        title: "Mission time saved by adapting".to_owned(),
        note: format!(
            "Against the best constant; line in search, {} missions a campaign, n = 7; where not \
             varied N = 10, α = {} dB.",
            scope.episodes, map.load_db
        ),
        value: Axis::new("mission time saved", "%"),
        columns: columns.axis(&columns_flown),
        rows: rows.axis(&rows_flown),
        cells: rows_flown
            .iter()
            .map(|&row| {
                let columns = columns_flown.iter();
                columns.map(|&column| cell(row, column)).collect()
            })
            .collect(),
        decimals: Some(1),
    };
    Some((text, figure))
}

fn unit(unit: &str) -> String {
    if unit.is_empty() {
        String::new()
    } else {
        format!(" {unit}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::{ADAPTIVE, HELD};
    use crate::table::Key;
    use jcas_core::Metrics;
    use jcas_episode::statistics::Summary;

    /// One regime in which a constant of 0.1 takes 20 steps and adaptive 15.
    #[test]
    fn a_map_says_what_adapting_saves() {
        let scope = Scope::full(1);
        let mut table = Table::open(&std::env::temp_dir().join("jcas-no-such-table")).unwrap();
        let map = &MAPS[0];
        for (pilot, x, steps) in [(ADAPTIVE, 0.0, 15), (HELD, 0.1, 20), (HELD, 0.3, 25)] {
            let key = Key {
                experiment: map.experiment(5.0, 1.0),
                preset: Preset::Search.name().to_owned(),
                uavs: 10,
                hotspots: 7,
                policy: BaselineKind::Line.name().to_owned(),
                pilot: pilot.to_owned(),
                seed: 0,
                x,
                config_hash: String::new(),
            };
            let mission = Metrics {
                steps,
                terminated: true,
                ..Metrics::default()
            };
            table
                .add(0, &key, &Summary::of(&[mission; 10], 100))
                .unwrap();
        }
        let (text, figure) = regimes(&scope, &table, map).unwrap();
        let [row] = &figure.cells[..] else {
            panic!("rows that were not flown: {:?}", figure.cells);
        };
        let [Some(saved)] = row[..] else {
            panic!("columns that were not flown: {row:?}");
        };
        assert!((saved - 25.0).abs() < 1e-9);
        assert!(text.contains("in 1 of 1 regimes"), "{text}");
        let told = "-25.0 % of the best constant's time. That constant is ρ = 0.10 and takes 20.0";
        assert!(text.contains(told), "{text}");
    }

    #[test]
    fn regimes_have_names_and_missions_of_their_own() {
        let scope = Scope::full(1);
        let mut seen = Vec::new();
        for map in &MAPS {
            for (row, column) in map.places() {
                let config = map.config(&scope, row, column);
                jcas_core::Model::new(config).unwrap();
                let experiment = map.experiment(row, column);
                assert!(!seen.contains(&experiment), "{experiment}");
                seen.push(experiment);
            }
        }
        let base = MAPS[0].config(&scope, 1.0, 1.0);
        assert_eq!(base, scope.mission(Preset::Search, (10, 7)));
    }
}
