//! Every cell of the grid beside the best baseline on the same missions.

use crate::scope::Scope;
use crate::table::{Quantity, Query, Row, Table};
use jcas_core::Preset;
use std::cmp::Ordering;

/// A learned cell beside the best baseline on the same missions.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// UAVs, hotspots.
    pub cell: (u32, u32),
    /// The baseline with the highest success, then the shortest missions.
    pub best: Row,
    /// The learned policy, mean over seeds: success, steps, energy, throughput.
    pub learned: [f64; 4],
}

/// Heads of [`Bar::texts`].
pub const HEAD: [&str; 8] = [
    "N",
    "n",
    "best baseline",
    "success",
    "steps",
    "energy (kWh)",
    "throughput",
    "reached",
];

/// Every cell of a preset's grid that both have flown.
pub fn bars(scope: &Scope, table: &Table, preset: Preset) -> Vec<Bar> {
    let bar = |cell: (u32, u32)| {
        let of_cell = |row: &&Row| {
            row.experiment == "grid"
                && row.preset == preset.name()
                && (row.uavs, row.hotspots) == cell
                && crate::table::is_baseline(&row.policy)
        };
        let key = |row: &Row| (row.success_rate, -row.mission_steps, -row.energy_kwh);
        let better = |a: &&Row, b: &&Row| key(a).partial_cmp(&key(b)).unwrap_or(Ordering::Equal);
        let best = table.rows.iter().filter(of_cell).max_by(better)?;
        let learned = Query::new("grid", preset.name(), ("learned", "adaptive"))
            .uavs(cell.0)
            .hotspots(cell.1);
        let of = |quantity| Some(learned.mean(table, quantity)?.value);
        Some(Bar {
            cell,
            best: best.clone(),
            learned: [
                of(Quantity::Success)?,
                of(Quantity::Steps)?,
                of(Quantity::Energy)?,
                of(Quantity::Throughput)?,
            ],
        })
    };
    scope.cells().into_iter().filter_map(bar).collect()
}

impl Bar {
    /// Success at least the lower end of the baseline's interval.
    pub fn success_holds(&self) -> bool {
        self.learned[0] >= self.best.success_rate_low
    }

    /// Missions at most a tenth longer.
    pub fn time_holds(&self) -> bool {
        self.learned[1] <= 1.1 * self.best.mission_steps
    }

    /// What was reached, in words.
    pub fn verdict(&self) -> &'static str {
        match (self.success_holds(), self.time_holds()) {
            (true, true) => "success, time within 10 %",
            (true, false) => "success only",
            (false, _) => "missed",
        }
    }

    /// A row under [`HEAD`].
    pub fn texts(&self) -> [String; 8] {
        let [success, steps, energy, throughput] = self.learned;
        let best = &self.best;
        let change = |learned: f64, best: f64| {
            let percent = 100.0 * (learned / best.max(1e-9) - 1.0);
            format!("{learned:.3} ({percent:+.1} %)")
        };
        [
            format!("{}", self.cell.0),
            format!("{}", self.cell.1),
            format!("{}:{}", best.policy, best.pilot),
            format!("{success:.3} (best {:.3})", best.success_rate),
            change(steps, best.mission_steps),
            change(energy, best.energy_kwh),
            change(throughput, best.throughput),
            self.verdict().to_owned(),
        ]
    }
}
