//! Study of the radar that the paper's two success rates imply. The paper "derives" the detection
//! threshold and does not give it. The sensing range that corresponds to the threshold decides the
//! difficulty of a mission.

use crate::campaign::{CampaignSpec, Who};
use crate::cell_means::between_seeds;
use crate::chapter::{Block, Chapter};
use crate::fit::{self, Fit, PAPER, Published, Simulated};
use crate::scope::{Learner, Scope};
use crate::statistics::Spread;
use crate::table::{Quantity, Query, Table, mean, numbers_of_hotspots};
use crate::text::{capital, list};
use jcas_core::Preset;
use jcas_episode::statistics::wilson;
use jcas_figures::{Axis, Figure, Panels, Point, Series};
use jcas_policy::{BaselineKind, PilotMode};

/// Name of the study in the table of results.
pub const EXPERIMENT: &str = "range";
/// Name of its figure's files.
const FIGURE: &str = "success_over_range";

/// Scripts of the study: a fleet that ignores its observations, and one that flies to each hotspot
/// together.
pub const SCRIPTED: [(&str, BaselineKind, PilotMode); 2] = [
    ("a random walk", BaselineKind::Random, PilotMode::Mid),
    ("`swarm`", BaselineKind::Swarm, PilotMode::Max),
];

/// Pilot rule of learners that choose the density.
const PILOT: &str = "adaptive";

/// What the scripts fly.
pub(crate) fn flights(scope: &Scope) -> Vec<CampaignSpec> {
    let mut flights = Vec::new();
    for &cells in &scope.ranges {
        for cell in scope.cells() {
            for (_, kind, pilot) in SCRIPTED {
                flights.push(CampaignSpec {
                    experiment: (EXPERIMENT.to_owned(), cells),
                    preset: Preset::Paper,
                    config: scope.ranged(cells, cell),
                    who: Who::Script(kind, pilot),
                });
            }
        }
    }
    flights
}

/// One policy of the study.
#[derive(Clone, Debug)]
pub struct Studied {
    /// For people.
    pub title: String,
    policy: String,
    pilot: String,
    /// The numbers of hotspots that its means run over.
    hotspots: Vec<u32>,
    /// The first and the last range that it has flown, in cells.
    ranges: (f64, f64),
    /// What fits the paper best; none where the study has not come so far.
    pub fit: Option<Fit>,
}

impl Studied {
    /// A policy that was trained once a cell has the noise of its trainings as well.
    fn new(
        scope: &Scope,
        table: &Table,
        (title, policy, pilot): (String, &str, &str),
        spread: Option<Spread>,
    ) -> Studied {
        let mut studied = Studied {
            title,
            policy: policy.to_owned(),
            pilot: pilot.to_owned(),
            hotspots: Vec::new(),
            ranges: (f64::INFINITY, f64::NEG_INFINITY),
            fit: None,
        };
        let rows = studied.query().rows(table);
        studied.hotspots = numbers_of_hotspots(&rows);
        for row in &rows {
            let (first, last) = studied.ranges;
            studied.ranges = (first.min(row.x), last.max(row.x));
        }
        let data: Vec<(Published, Simulated)> = PAPER
            .iter()
            .map(|&published| {
                let simulated = studied.simulated(scope, table, published.uavs);
                (published, simulated)
            })
            .collect();
        // The paper's training and ours each have the spread.
        let deviation = spread.map_or(0.0, |spread| spread.deviation * f64::sqrt(2.0));
        studied.fit = fit::fit(&data, deviation);
        studied
    }

    fn query(&self) -> Query<'_> {
        let flown = (self.policy.as_str(), self.pilot.as_str());
        Query::new(EXPERIMENT, Preset::Paper.name(), flown)
    }

    /// Success over the range at a fleet size, mean over the numbers of hotspots; only where all of
    /// these are there.
    fn simulated(&self, scope: &Scope, table: &Table, uavs: u32) -> Simulated {
        let at = |&x: &f64| {
            let rows = self.query().uavs(uavs).x(x).rows(table);
            let whole = self
                .hotspots
                .iter()
                .all(|&n| rows.iter().any(|row| row.hotspots == n));
            if !whole {
                return None;
            }
            let missions = rows.iter().map(|row| row.episodes as f64).sum();
            let rate = mean(&rows, Quantity::Success)?.value;
            Some((x, rate, missions))
        };
        Simulated {
            points: scope.ranges.iter().filter_map(at).collect(),
        }
    }

    fn panel(&self, scope: &Scope, table: &Table) -> Figure {
        let mut figure = Figure::new(
            self.title.replace('`', ""),
            Axis::new("sensing range", "cells"),
            Axis::new(Quantity::Success.title(), "").span(0.0, 1.0),
        );
        for &uavs in &scope.fleets {
            let points = self.simulated(scope, table, uavs).points;
            let points = points.iter().map(|&(x, rate, missions)| {
                let interval = wilson((rate * missions).round() as u64, missions as u64);
                Point::interval(x, rate, interval.low, interval.high)
            });
            figure = figure.with(Series::line(format!("N = {uavs}"), points.collect()));
        }
        if let Some(fit) = self.fit.as_ref().filter(|fit| !fit.refused()) {
            for published in PAPER {
                let successes = (published.rate * published.missions).round() as u64;
                let interval = wilson(successes, published.missions as u64);
                let point = Point::interval(fit.value, published.rate, interval.low, interval.high)
                    .x_interval(fit.low.unwrap_or(f64::NAN), fit.high.unwrap_or(f64::NAN));
                let name = format!("the paper, N = {}", published.uavs);
                figure = figure.with(Series::points(name, vec![point]));
            }
        }
        figure
    }

    /// Whether the best range is the first or the last that was flown.
    fn is_at_edge(&self) -> bool {
        let best = self.fit.as_ref().map(|fit| fit.value);
        best.is_some_and(|best| best == self.ranges.0 || best == self.ranges.1)
    }

    fn sentence(&self, cell_size_m: f64) -> String {
        let Some(fit) = &self.fit else {
            return format!(
                "{} has not been flown far enough to say. ",
                capital(&self.title)
            );
        };
        let rates: Vec<String> = PAPER
            .iter()
            .zip(&fit.rates)
            .map(|(published, rate)| format!("{rate:.2} at N = {}", published.uavs))
            .collect();
        let rates = rates.join(" and ");
        let (value, metres) = (fit.value, fit.value * cell_size_m);
        let edge = if self.is_at_edge() {
            "That is the edge of the scan, beyond which a better one may lie. "
        } else {
            ""
        };
        if fit.refused() {
            let (first, last) = self.ranges;
            return format!(
                "- {} fits the two numbers at no range from {first} to {last} cells. At the best \
                    of them, {value:.2} cells, it succeeds in {rates} (deviance {:.0}). {edge}\n",
                capital(&self.title),
                fit.deviance
            );
        }
        format!(
            "- {} is compatible with both, best at {value:.2} cells ({metres:.0} m). There it \
                succeeds in {rates} (deviance {:.2}). {edge}\n",
            capital(&self.title),
            fit.deviance,
        )
    }

    fn row(&self, cell_size_m: f64) -> [String; 7] {
        let n = list(&self.hotspots);
        let Some(fit) = &self.fit else {
            let told = [self.title.clone(), n, "not measured".to_owned()];
            let mut row: [String; 7] = Default::default();
            row[..3].clone_from_slice(&told);
            return row;
        };
        let end = |end: Option<f64>| end.map_or("beyond".to_owned(), |end| format!("{end:.2}"));
        let p = match fit.p_value {
            Some(p) if p < 0.001 => "< 0.001".to_owned(),
            Some(p) => format!("{p:.3}"),
            None => String::new(),
        };
        let interval = format!("{:.2} [{}, {}]", fit.value, end(fit.low), end(fit.high));
        [
            self.title.clone(),
            n,
            match (fit.refused(), self.is_at_edge()) {
                (true, true) => format!("none (nearest {:.2}, the scan's edge)", fit.value),
                (true, false) => format!("none (nearest {:.2})", fit.value),
                (false, true) => format!("{interval}, the scan's edge"),
                (false, false) => interval,
            },
            format!("{:.0}", fit.value * cell_size_m),
            fit.rates
                .iter()
                .map(|rate| format!("{rate:.2}"))
                .collect::<Vec<_>>()
                .join(", "),
            format!("{:.2}", fit.deviance),
            p,
        ]
    }
}

/// The study as far as the table has it.
#[derive(Clone, Debug)]
pub struct Study {
    /// Scripted policies, then learners.
    pub policies: Vec<Studied>,
    missions: u64,
    ranges: (f64, f64),
    cell_size_m: f64,
}

/// Heads of [`Study::rows`].
pub const HEAD: [&str; 7] = [
    "policy",
    "n",
    "best range (cells), 95 %",
    "metres",
    "success there at N = 10, 15",
    "deviance",
    "p",
];

impl Study {
    /// Of the rows that are there; none without any.
    pub fn of(scope: &Scope, table: &Table) -> Option<Study> {
        let scripted = SCRIPTED.map(|(title, kind, pilot)| (title, kind.name(), pilot.name()));
        let learners = scope.learners();
        let learners = learners
            .iter()
            .map(|Learner { name, title, .. }| (*title, *name, PILOT.to_owned()));
        let spread = between_seeds(table, Preset::Paper.name(), "ppo", Quantity::Success);
        let studied = |(title, policy, pilot): (&str, &str, String), spread| {
            Studied::new(scope, table, (title.to_owned(), policy, &pilot), spread)
        };
        let scripted = scripted.into_iter().map(|script| studied(script, None));
        let policies: Vec<Studied> = scripted
            .chain(learners.map(|learner| studied(learner, spread)))
            .filter(|studied| !studied.hotspots.is_empty())
            .collect();
        (!policies.is_empty()).then(|| Study {
            policies,
            missions: scope.episodes,
            ranges: (scope.ranges[0], scope.ranges[scope.ranges.len() - 1]),
            cell_size_m: scope.ranged(1.0, (10, 5)).cell_size_m,
        })
    }

    /// As a chapter.
    pub fn chapter(&self, scope: &Scope, table: &Table) -> Chapter {
        Chapter {
            heading: "What the paper's two numbers imply".to_owned(),
            blocks: vec![
                Block::Text(self.text()),
                Block::table("Best ranges", HEAD, self.rows()),
                Block::figure(
                    FIGURE,
                    "Success over the sensing range",
                    self.figure(scope, table),
                ),
            ],
        }
    }

    /// The figure: a panel for each policy, the paper's numbers at the range that fits them best.
    pub fn figure(&self, scope: &Scope, table: &Table) -> Panels {
        Panels {
            title: "Success over the sensing range, and the paper's two numbers".to_owned(),
            note: format!(
                "{} missions a cell, mean over hotspots. The paper's numbers stand at the range \
                    that fits both best, \
                 with their 95 % intervals for 100 missions and that of the range.",
                self.missions
            ),
            columns: self.policies.len().min(2),
            figures: self
                .policies
                .iter()
                .map(|studied| studied.panel(scope, table))
                .collect(),
        }
    }

    /// The table, under [`HEAD`].
    pub fn rows(&self) -> Vec<[String; 7]> {
        self.policies
            .iter()
            .map(|studied| studied.row(self.cell_size_m))
            .collect()
    }

    /// What was asked, how it was answered, and what the answer is worth.
    pub fn text(&self) -> String {
        let mut text = format!(
            "The paper gives two success rates, {} at N = {} and {} at N = {}, each an average of \
                {} missions. It does not give the threshold of its radar, which it calls derived. \
                We take the threshold to be the sensing SNR at a **sensing range**. Each policy \
                flies at ranges from {} to {} cells, with everything else as the paper has it. \
                Each rate is a mean over n, with {} missions for each N, n and range. A policy \
                that learns is trained anew at each range. Which one range makes both rates the \
                most likely? The likelihood is binomial, with straight lines between the logits \
                of neighbouring ranges. The interval is that of the likelihood ratio. The \
                deviance, on one degree of freedom, says what one range leaves unexplained.\n",
            PAPER[0].rate,
            PAPER[0].uavs,
            PAPER[1].rate,
            PAPER[1].uavs,
            PAPER[0].missions,
            self.ranges.0,
            self.ranges.1,
            self.missions,
        );
        text += "\n";
        for studied in &self.policies {
            text += &studied.sentence(self.cell_size_m);
        }
        text += "\nThis cannot tell whether the paper's averages run over other missions than its \
            table of settings says. Its two numbers are rounded, and a policy and a range can \
            make up for each other. So a fit shows that a policy in such a world is compatible \
            with the numbers, not that it made them. The simulated rates of scripts are taken as \
            known.\n\n A policy that is trained has the noise of two trainings as well, the \
            paper's and ours. It may shift each rate by a normal variable with the standard \
            deviation of both.\n";
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// A range at the end of those that were flown is no optimum.
    #[test]
    fn a_best_range_at_the_edge_of_the_scan_says_so() {
        let published = Path::new(env!("CARGO_MANIFEST_DIR")).join("../results/results.csv");
        let table = Table::open(&published).unwrap();
        let study = Study::of(&Scope::full(1), &table).unwrap();
        let text = study.text();
        let told = "`swarm` fits the two numbers at no range from 0.5 to 5 cells. At the best of \
            them, 0.50 cells";
        assert!(text.contains(told), "{text}");
        assert!(text.contains("That is the edge of the scan"), "{text}");
        assert_eq!(study.rows()[1][2], "none (nearest 0.50, the scan's edge)");
    }
}
