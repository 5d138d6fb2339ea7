//! The paper's claims, judged by the table of results. A claim is data: its text, its measure, and
//! the rule that judges the measure. To add one, add a row to [`CLAIMS`].

use crate::curves::Curve;
use crate::fit;
use crate::scope::{CONSTANT_PILOT, Scope};
use crate::table::{Quantity, Query, Row, Table, in_common, numbers_of_hotspots};
use jcas_core::Preset;
use jcas_episode::statistics::wilson;

/// One claim of the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Claim {
    /// What the paper says.
    pub text: &'static str,
    /// Measure of the claim.
    pub measure: Measure,
    /// When it holds.
    pub rule: Rule,
}

/// A measure: one or several numbers of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// A quantity at one fleet size.
    At(Quantity, u32),
    /// A quantity at every fleet size.
    OverFleets(Quantity),
    /// Success with adaptive less that with constant pilot density, in points of 100, at one fleet
    /// size.
    PilotGap(u32),
    /// A quantity with adaptive and with constant pilot density, at one fleet size.
    Pilots(Quantity, u32),
    /// Share of the trainings of at least sixty iterations whose return changes by at most a tenth
    /// of its whole gain after the fortieth.
    FlatTrainings,
    /// Seconds that the paper's number of iterations takes at one fleet size, mean over trainings.
    TrainingTime(u32),
}

/// When a claim holds, given the measured values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// The value lies within the 95 % interval of this success rate in 100 missions, or above it.
    Success(f64),
    /// The value is at least this.
    AtLeast(f64),
    /// The value is at most this.
    AtMost(f64),
    /// The value is at most this far from 0.
    Within(f64),
    /// Each value is lower than the one before, and the last step down is smaller than the first.
    FallsAndSaturates,
    /// The last value over the first is less than the fleets' ratio.
    LessThanProportional,
    /// The second value is lower than the first.
    SecondIsLower,
}

const fn claim(text: &'static str, measure: Measure, rule: Rule) -> Claim {
    Claim {
        text,
        measure,
        rule,
    }
}

/// The paper's claims.
pub const CLAIMS: [Claim; 12] = [
    claim(
        "success 0.73 at N = 10",
        Measure::At(Quantity::Success, 10),
        Rule::Success(0.73),
    ),
    claim(
        "success 0.97 at N = 15",
        Measure::At(Quantity::Success, 15),
        Rule::Success(0.97),
    ),
    claim(
        "mission time falls with N and saturates",
        Measure::OverFleets(Quantity::Steps),
        Rule::FallsAndSaturates,
    ),
    claim(
        "energy grows less than in proportion to N",
        Measure::OverFleets(Quantity::Energy),
        Rule::LessThanProportional,
    ),
    claim(
        "adaptive and constant pilot within about 5 points at N = 10",
        Measure::PilotGap(10),
        Rule::Within(5.0),
    ),
    claim(
        "adaptive pilot up to about 10 points better at N = 15",
        Measure::PilotGap(15),
        Rule::AtLeast(5.0),
    ),
    claim(
        "constant pilot lowers throughput, N = 15",
        Measure::Pilots(Quantity::Throughput, 15),
        Rule::SecondIsLower,
    ),
    claim(
        "the return is flat after about 40 iterations",
        Measure::FlatTrainings,
        Rule::AtLeast(0.5),
    ),
    claim(
        "training takes 402 s at N = 5 on eight processes",
        Measure::TrainingTime(5),
        Rule::AtMost(402.0),
    ),
    claim(
        "training takes 598 s at N = 10 on eight processes",
        Measure::TrainingTime(10),
        Rule::AtMost(598.0),
    ),
    claim(
        "training takes 1253 s at N = 15 on eight processes",
        Measure::TrainingTime(15),
        Rule::AtMost(1253.0),
    ),
    claim(
        "training takes 1751 s at N = 20 on eight processes",
        Measure::TrainingTime(20),
        Rule::AtMost(1751.0),
    ),
];

/// A reading of the paper that is held against the claims: a variant of its training, or our own
/// settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// For people.
    pub title: String,
    preset: &'static str,
    policy: &'static str,
    /// Trained once a cell, so that its trainings can be compared with the paper's.
    of_a_cell: bool,
}

impl Reading {
    /// Whether a reproduction of this size trains and flies what a measure takes.
    fn answers(&self, scope: &Scope, measure: Measure) -> bool {
        let flies = |uavs| {
            if self.of_a_cell {
                scope.paper_cells.iter().any(|cell| cell.0 == uavs)
            } else {
                scope.fleets.contains(&uavs)
            }
        };
        let trains_whole = self.of_a_cell && scope.shortened().is_none();
        let holds_pilots = !self.of_a_cell || scope.paper_pilots.contains(&Some(CONSTANT_PILOT));
        match measure {
            Measure::At(_, uavs) => flies(uavs),
            Measure::OverFleets(_) => scope.fleets.iter().all(|&uavs| flies(uavs)),
            Measure::PilotGap(uavs) | Measure::Pilots(_, uavs) => flies(uavs) && holds_pilots,
            Measure::FlatTrainings => trains_whole,
            Measure::TrainingTime(uavs) => trains_whole && flies(uavs),
        }
    }
}

/// The readings that a reproduction has.
pub fn readings(scope: &Scope) -> Vec<Reading> {
    let learners = scope.learners().into_iter().map(|learner| Reading {
        title: learner.as_trained(),
        preset: Preset::Paper.name(),
        policy: learner.name,
        of_a_cell: true,
    });
    let ours = scope.presets.iter().map(|preset| Reading {
        title: format!("our policy, preset `{}`", preset.name()),
        preset: preset.name(),
        policy: "learned",
        of_a_cell: false,
    });
    learners.chain(ours).collect()
}

/// How a claim came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It holds.
    Holds,
    /// More is reached than is claimed.
    Exceeded,
    /// It does not hold.
    Fails,
    /// What it takes has not been trained or flown.
    NotMeasured,
}

impl Verdict {
    /// In words.
    pub const fn text(self) -> &'static str {
        match self {
            Verdict::Holds => "holds",
            Verdict::Exceeded => "exceeded",
            Verdict::Fails => "does not hold",
            Verdict::NotMeasured => "not run",
        }
    }
}

/// The verdict on a claim for one reading.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// What the paper says.
    pub claim: &'static str,
    /// Title of the reading.
    pub reading: String,
    /// What was measured, in words and numbers.
    pub measured: String,
    /// Whether it holds.
    pub verdict: Verdict,
}

/// The claims that a reproduction of this size does not hold the paper's training to.
pub fn unasked(scope: &Scope) -> Vec<&'static str> {
    let readings = readings(scope);
    let papers = readings.iter().filter(|reading| reading.of_a_cell);
    let unasked = |claim: &Claim| !papers.clone().any(|r| r.answers(scope, claim.measure));
    let claims = CLAIMS.iter().filter(|&claim| unasked(claim));
    claims.map(|claim| claim.text).collect()
}

/// Every claim with every reading that answers it.
pub fn judge(scope: &Scope, table: &Table, curves: &[Curve]) -> Vec<Judged> {
    let readings = readings(scope);
    let mut judged = Vec::new();
    for claim in CLAIMS {
        for reading in readings.iter().filter(|r| r.answers(scope, claim.measure)) {
            let evidence = Evidence {
                scope,
                table,
                curves,
                reading,
            };
            let values = evidence.values(claim.measure);
            judged.push(Judged {
                claim: claim.text,
                reading: reading.title.clone(),
                measured: evidence.words(claim.measure, &values),
                verdict: verdict(claim.rule, &values, &scope.fleets),
            });
        }
    }
    judged
}

fn verdict(rule: Rule, values: &[Option<f64>], fleets: &[u32]) -> Verdict {
    let values: Option<Vec<f64>> = values.iter().copied().collect();
    let (Some(values), true) = (values, !fleets.is_empty()) else {
        return Verdict::NotMeasured;
    };
    let (Some(&first), Some(&last)) = (values.first(), values.last()) else {
        return Verdict::NotMeasured;
    };
    let holds = match rule {
        Rule::Success(rate) => {
            let missions = fit::PAPER[0].missions;
            let interval = wilson((rate * missions).round() as u64, missions as u64);
            if first > interval.high {
                return Verdict::Exceeded;
            }
            first >= interval.low
        }
        Rule::AtLeast(bound) => first >= bound,
        Rule::AtMost(bound) => first <= bound,
        Rule::Within(bound) => first.abs() <= bound,
        Rule::FallsAndSaturates => {
            let falls: Vec<f64> = values.windows(2).map(|w| w[0] - w[1]).collect();
            falls.iter().all(|&fall| fall > 0.0) && falls.last() < falls.first()
        }
        Rule::LessThanProportional => {
            let fleets = f64::from(fleets[fleets.len() - 1]) / f64::from(fleets[0]);
            last / first < fleets
        }
        Rule::SecondIsLower => last < first,
    };
    if holds {
        Verdict::Holds
    } else {
        Verdict::Fails
    }
}

struct Evidence<'a> {
    scope: &'a Scope,
    table: &'a Table,
    curves: &'a [Curve],
    reading: &'a Reading,
}

impl Evidence<'_> {
    fn query(&self, pilot: &'static str) -> Query<'static> {
        Query::new("grid", self.reading.preset, (self.reading.policy, pilot))
    }

    /// The rows that a measure takes: groups whose means are its values.
    fn groups(&self, measure: Measure) -> Vec<Vec<&Row>> {
        let of = |pilot, uavs| self.query(pilot).uavs(uavs).rows(self.table);
        match measure {
            Measure::At(_, uavs) => vec![of("adaptive", uavs)],
            Measure::OverFleets(_) => {
                let fleets = self.scope.fleets.iter();
                in_common(fleets.map(|&uavs| of("adaptive", uavs)).collect())
            }
            Measure::PilotGap(uavs) | Measure::Pilots(_, uavs) => {
                in_common(vec![of("adaptive", uavs), of("constant", uavs)])
            }
            Measure::FlatTrainings | Measure::TrainingTime(_) => Vec::new(),
        }
    }

    fn values(&self, measure: Measure) -> Vec<Option<f64>> {
        let means = |quantity| -> Vec<Option<f64>> {
            self.groups(measure)
                .iter()
                .map(|rows| Some(crate::table::mean(rows, quantity)?.value))
                .collect()
        };
        match measure {
            Measure::At(quantity, _)
            | Measure::OverFleets(quantity)
            | Measure::Pilots(quantity, _) => means(quantity),
            Measure::PilotGap(_) => {
                let both: Option<Vec<f64>> = means(Quantity::Success).into_iter().collect();
                // Two policies that never succeed say nothing about pilots.
                let gap = both
                    .filter(|both| both.iter().sum::<f64>() > 0.0)
                    .map(|both| 100.0 * (both[0] - both[1]));
                vec![gap]
            }
            Measure::FlatTrainings => {
                let mut adaptive = self.trainings(None);
                adaptive.retain(|curve| curve.constant.is_none());
                vec![flat_share(&adaptive)]
            }
            Measure::TrainingTime(uavs) => {
                let times: Vec<f64> = self
                    .trainings(Some(uavs))
                    .iter()
                    .map(|curve| curve.whole_training_s())
                    .collect();
                vec![(!times.is_empty()).then(|| times.iter().sum::<f64>() / times.len() as f64)]
            }
        }
    }

    fn trainings(&self, uavs: Option<u32>) -> Vec<&Curve> {
        self.curves
            .iter()
            .filter(|curve| curve.learner == self.reading.policy)
            .filter(|curve| uavs.is_none_or(|uavs| curve.uavs == uavs))
            .collect()
    }

    /// The values, and over which numbers of hotspots they are means where that is not the whole
    /// grid.
    fn words(&self, measure: Measure, values: &[Option<f64>]) -> String {
        if values.iter().all(Option::is_none) {
            return "not run".to_owned();
        }
        let number = |value: Option<f64>, digits: usize| {
            value.map_or("not run".to_owned(), |value| format!("{value:.digits$}"))
        };
        let text = match measure {
            Measure::At(quantity, _) => number(values[0], quantity.digits()),
            Measure::OverFleets(quantity) => {
                let parts = self.scope.fleets.iter().zip(values);
                let parts: Vec<String> = parts
                    .map(|(n, value)| format!("N = {n}: {}", number(*value, quantity.digits())))
                    .collect();
                parts.join(", ")
            }
            Measure::PilotGap(_) => {
                values[0].map_or(String::new(), |gap| format!("{gap:+.1} points"))
            }
            Measure::Pilots(quantity, _) => format!(
                "adaptive {}, constant {}",
                number(values[0], quantity.digits()),
                number(values[1], quantity.digits())
            ),
            Measure::FlatTrainings => format!("in {} of the trainings", number(values[0], 2)),
            Measure::TrainingTime(_) => format!(
                "{} s for 62 iterations at the pace measured here, beside whatever else the machine did",
                number(values[0], 0)
            ),
        };
        text + &self.over(measure)
    }

    fn over(&self, measure: Measure) -> String {
        let groups = self.groups(measure);
        let numbers = numbers_of_hotspots(&groups.concat());
        if groups.is_empty() {
            return String::new();
        }
        self.scope.over(&numbers)
    }
}

fn flat_share(curves: &[&Curve]) -> Option<f64> {
    let long: Vec<&&Curve> = curves
        .iter()
        .filter(|curve| curve.returns.len() >= 60)
        .collect();
    let mean = |returns: &[f64]| {
        let finite: Vec<f64> = returns.iter().copied().filter(|r| r.is_finite()).collect();
        finite.iter().sum::<f64>() / finite.len().max(1) as f64
    };
    let flat = long.iter().filter(|curve| {
        let returns = &curve.returns;
        let (start, middle) = (mean(&returns[..5]), mean(&returns[37..42]));
        let end = mean(&returns[returns.len() - 5..]);
        (end - middle).abs() <= 0.1 * (end - start).abs()
    });
    (!long.is_empty()).then(|| flat.count() as f64 / long.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(returns: Vec<f64>) -> Curve {
        Curve {
            learner: "ppo",
            uavs: 10,
            hotspots: 5,
            constant: None,
            seed: 0,
            returns,
            iteration_s: 1.0,
        }
    }

    #[test]
    fn a_curve_that_goes_on_rising_is_not_flat() {
        let rising = curve((0..62).map(f64::from).collect());
        let flat = curve((0..62).map(|k| f64::from(k.min(35))).collect());
        assert_eq!(flat_share(&[&rising]), Some(0.0));
        assert_eq!(flat_share(&[&flat, &rising]), Some(0.5));
        assert_eq!(flat_share(&[&curve(vec![0.0; 6])]), None);
    }

    #[test]
    fn rules_judge_as_they_say() {
        use Verdict::{Exceeded, Fails, Holds, NotMeasured};
        let fleets = [5, 10, 20];
        for (rule, values, expected) in [
            // Wilson's interval of 73 of 100 is [0.636, 0.807].
            (Rule::Success(0.73), &[0.64][..], Holds),
            (Rule::Success(0.73), &[0.63], Fails),
            (Rule::Success(0.73), &[0.81], Exceeded),
            (Rule::AtLeast(0.5), &[0.5], Holds),
            (Rule::AtMost(402.0), &[402.5], Fails),
            (Rule::Within(5.0), &[-5.5], Fails),
            (Rule::FallsAndSaturates, &[90.0, 50.0, 40.0], Holds),
            (Rule::FallsAndSaturates, &[90.0, 80.0, 40.0], Fails),
            (Rule::LessThanProportional, &[1.0, 2.0, 3.9], Holds),
            (Rule::LessThanProportional, &[1.0, 2.0, 4.1], Fails),
            (Rule::SecondIsLower, &[2.0, 1.9], Holds),
        ] {
            let values: Vec<Option<f64>> = values.iter().copied().map(Some).collect();
            assert_eq!(
                verdict(rule, &values, &fleets),
                expected,
                "{rule:?} {values:?}"
            );
        }
        assert_eq!(verdict(Rule::AtLeast(0.0), &[None], &fleets), NotMeasured);
    }

    /// A full reproduction asks everything of the paper's training; a quick one what its short
    /// trainings answer.
    #[test]
    fn claims_are_asked_of_what_is_trained() {
        let told = |scope: &Scope| -> Vec<(&'static str, usize)> {
            let readings = readings(scope);
            let of = |claim: &Claim| {
                readings
                    .iter()
                    .filter(|r| r.answers(scope, claim.measure))
                    .count()
            };
            CLAIMS.iter().map(|claim| (claim.text, of(claim))).collect()
        };
        let full = Scope::full(1);
        assert_eq!(unasked(&full), Vec::<&str>::new());
        // Two readings of the paper's training; ours in two presets, but not about training.
        let counts: Vec<usize> = told(&full).iter().map(|claim| claim.1).collect();
        assert_eq!(counts, [4, 4, 4, 4, 4, 4, 4, 2, 2, 2, 2, 2]);

        let quick = Scope::quick(1);
        let counts: Vec<usize> = told(&quick).iter().map(|claim| claim.1).collect();
        assert_eq!(counts, [3, 3, 3, 3, 1, 1, 1, 0, 0, 0, 0, 0]);
        assert_eq!(unasked(&quick).len(), 8);
    }
}
