//! Study of the search for hidden hotspots.

use crate::campaign::{ADAPTIVE, CampaignSpec, Who};
use crate::chapter::{Block, Chapter};
use crate::scope::Scope;
use crate::table::{Quantity, Query, Row, Table, mean};
use crate::text::list;
use jcas_core::Preset;
use jcas_figures::{Axis, Figure, Point, Series};
use jcas_policy::{BaselineKind, PilotMode};

/// Name in the table of results.
const EXPERIMENT: &str = "grid";

/// Scripts that search for hidden hotspots.
fn searchers() -> impl Iterator<Item = BaselineKind> {
    let all = BaselineKind::ALL.into_iter();
    all.filter(|kind| !kind.reads_positions())
}

/// All of them in every cell.
pub(crate) fn flights(scope: &Scope) -> Vec<CampaignSpec> {
    let mut flights = Vec::new();
    for cell in scope.cells() {
        let config = scope.mission(Preset::Search, cell);
        let scripts = searchers().map(|kind| Who::Script(kind, PilotMode::Adaptive));
        flights.extend(scripts.map(|who| CampaignSpec {
            experiment: (EXPERIMENT.to_owned(), 0.0),
            preset: Preset::Search,
            config,
            who,
        }));
    }
    flights
}

fn query(policy: &str) -> Query<'_> {
    Query::new(EXPERIMENT, Preset::Search.name(), (policy, ADAPTIVE))
}

/// One cell of the grid: the result of each searcher, in the order of the heads.
struct Place {
    cell: (u32, u32),
    rows: Vec<Vec<Row>>,
}

impl Place {
    fn mean(&self, policy: usize, quantity: Quantity) -> Option<f64> {
        let rows: Vec<&Row> = self.rows[policy].iter().collect();
        Some(mean(&rows, quantity)?.value)
    }

    fn text(&self, policy: usize) -> String {
        let both = [Quantity::Success, Quantity::Steps].map(|quantity| self.mean(policy, quantity));
        match both {
            [Some(success), Some(steps)] if success >= 0.9995 => format!("{steps:.1}"),
            [Some(success), Some(steps)] => format!("{steps:.1} ({success:.3})"),
            _ => String::new(),
        }
    }
}

/// The chapter as far as the table has it; none without a row.
pub fn chapter(scope: &Scope, table: &Table) -> Option<Chapter> {
    let flown: Vec<&str> = searchers()
        .map(BaselineKind::name)
        .filter(|name| !query(name).rows(table).is_empty())
        .collect();
    let places: Vec<Place> = scope
        .cells()
        .into_iter()
        .map(|cell| Place {
            cell,
            rows: flown
                .iter()
                .map(|name| {
                    let query = query(name).uavs(cell.0).hotspots(cell.1);
                    query.rows(table).into_iter().cloned().collect()
                })
                .collect(),
        })
        .filter(|place| place.rows.iter().any(|rows| !rows.is_empty()))
        .collect();
    if places.is_empty() {
        return None;
    }
    let text = format!(
        "The preset `search` hides the hotspots. The table has mean steps to the end of {} missions a \
            cell, pilot density `adaptive`. The share of missions that succeeded stands in brackets \
            where it is not 1. A mission that did not succeed counts with its horizon.",
        scope.episodes
    );
    let mut head = vec!["N".to_owned(), "n".to_owned()];
    head.extend(flown.iter().map(|&name| name.to_owned()));
    let rows = places
        .iter()
        .map(|place| {
            let (uavs, hotspots) = place.cell;
            let mut row = vec![uavs.to_string(), hotspots.to_string()];
            row.extend((0..flown.len()).map(|policy| place.text(policy)));
            row
        })
        .collect();
    Some(Chapter {
        heading: "Search".to_owned(),
        blocks: vec![
            Block::Text(text),
            Block::Table {
                caption: "Steps of all searchers".to_owned(),
                head,
                rows,
            },
            Block::figure(
                "search_mission_time_over_uavs",
                "Mission time over fleet size, preset search",
                figure(scope, table, &flown),
            ),
        ],
    })
}

fn figure(scope: &Scope, table: &Table, flown: &[&str]) -> Figure {
    let mut figure = Figure::new(
        "Mission time over fleet size, preset search",
        Axis::new("UAVs", ""),
        Axis::new(Quantity::Steps.title(), Quantity::Steps.unit()),
    )
    .note(format!(
        "{} missions a cell, mean over n = {}; a mission without success counts with its horizon.",
        scope.episodes,
        list(&scope.hotspots)
    ));
    for &name in flown {
        let points = scope.fleets.iter().filter_map(|&uavs| {
            let e = query(name).uavs(uavs).mean(table, Quantity::Steps)?;
            Some(Point::interval(f64::from(uavs), e.value, e.low, e.high))
        });
        figure = figure.with(Series::line(name, points.collect()));
    }
    figure
}
