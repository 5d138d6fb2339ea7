//! An adaptive pilot density beside each constant in one mission: the campaigns, and what they come
//! to.

use crate::campaign::{ADAPTIVE, CampaignSpec, HELD, Who};
use crate::scope::CONSTANT_PILOT;
use crate::table::{Quantity, Query, Row, Table};
use jcas_core::{Config, Preset};
use jcas_policy::{BaselineKind, PilotMode};

/// A script's campaigns: adaptive, then each density.
pub(crate) fn scripted(
    experiment: &str,
    preset: Preset,
    config: Config,
    kind: BaselineKind,
    densities: &[f64],
) -> Vec<CampaignSpec> {
    let held = densities.iter().map(|&rho| (rho, PilotMode::Fixed(rho)));
    [(0.0, PilotMode::Adaptive)]
        .into_iter()
        .chain(held)
        .map(|(x, pilot)| CampaignSpec {
            experiment: (experiment.to_owned(), x),
            preset,
            config,
            who: Who::Script(kind, pilot),
        })
        .collect()
}

/// Adaptive beside each constant, in one mission.
pub(crate) struct PilotComparison {
    pub(crate) adaptive: Row,
    pub(crate) held: Vec<Row>,
}

impl PilotComparison {
    pub(crate) fn of(
        table: &Table,
        experiment: &str,
        preset: Preset,
        policy: &str,
        uavs: Option<u32>,
    ) -> Option<PilotComparison> {
        let rows = |pilot| {
            let query = Query {
                uavs,
                ..Query::new(experiment, preset.name(), (policy, pilot))
            };
            query.rows(table).into_iter().filter(|row| row.seed == 0)
        };
        let mut held: Vec<Row> = rows(HELD).cloned().collect();
        held.sort_by(|a, b| a.x.total_cmp(&b.x));
        Some(PilotComparison {
            adaptive: rows(ADAPTIVE).next()?.clone(),
            held,
        })
        .filter(|worth| !worth.held.is_empty())
    }

    /// The constant with the shortest missions; of those whose intervals reach that, the one that
    /// talks most.
    pub(crate) fn best(&self) -> &Row {
        let least = self
            .held
            .iter()
            .min_by(|a, b| a.mission_steps.total_cmp(&b.mission_steps));
        let bound = least.map_or(f64::INFINITY, |row| row.mission_steps_high);
        self.held
            .iter()
            .filter(|row| row.mission_steps <= bound)
            .max_by(|a, b| a.throughput.total_cmp(&b.throughput))
            .expect("the least is one of them")
    }

    /// The constant that the paper compares with.
    pub(crate) fn papers(&self) -> Option<&Row> {
        self.held.iter().find(|row| row.x == CONSTANT_PILOT)
    }

    /// How much a quantity of adaptive is above that of a constant, in percent.
    pub(crate) fn above(&self, constant: &Row, quantity: Quantity) -> f64 {
        let of = |row: &Row| row.estimate(quantity).value;
        100.0 * (of(&self.adaptive) / of(constant).max(1e-9) - 1.0)
    }

    /// Whether the intervals of mission time of adaptive and a constant are apart.
    pub(crate) fn tells_apart(&self, constant: &Row) -> bool {
        let (a, b) = (&self.adaptive, constant);
        a.mission_steps_high < b.mission_steps_low || a.mission_steps_low > b.mission_steps_high
    }
}
