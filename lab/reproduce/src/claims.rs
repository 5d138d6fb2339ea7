//! The paper's claims, judged by intervals. A claim is data: its text, its measure, and the region
//! in which the paper says that the measure lies. To add one, add a row to [`CLAIMS`].

use crate::evidence::Evidence;
use crate::results::Results;
use crate::scope::{CONSTANT_PILOT, Scope};
use crate::table::Quantity;
use crate::verdict::{Region, Verdict, verdict};
use jcas_core::Preset;

/// One claim of the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Claim {
    /// What the paper says.
    pub text: &'static str,
    /// When it holds, in words.
    pub holds_if: &'static str,
    /// Measure of the claim.
    pub measure: Measure,
    /// Where the measure lies if it holds.
    pub region: Region,
}

/// A measure: one or several numbers of the results, each with its noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// A quantity at one fleet size, mean over the numbers of hotspots.
    At(Quantity, u32),
    /// A quantity at one fleet size for each number of hotspots.
    OfEachHotspots(Quantity, u32),
    /// A quantity of the largest fleet over that of the smallest.
    LastOverFirst(Quantity),
    /// The same over the ratio of the fleets' sizes.
    Growth(Quantity),
    /// How far a quantity falls from the first fleet to the second, and the mean of its second
    /// differences over the fleets.
    Saturation(Quantity),
    /// Success with adaptive less that with constant pilot density, in points of 100, at one fleet
    /// size.
    PilotGap(u32),
    /// The greatest of that over the numbers of hotspots.
    GreatestPilotGap(u32),
    /// The slope of that over the number of hotspots, mean of N = 10 and 15.
    PilotGapSlope,
    /// A quantity with constant over that with adaptive pilot density, at one fleet size.
    PilotRatio(Quantity, u32),
    /// The same for each number of hotspots at N = 10 and 15.
    PilotRatioOfEachHotspots(Quantity),
    /// Pilot density within a cell of an unconfirmed hotspot less that farther away.
    Approach,
    /// Change of the return over the last third of a training, in the scatter of one iteration.
    LateChange,
    /// Time of an iteration of the largest fleet over that of the smallest.
    TimeGrowth,
    /// Steps of moving, sensing and talking that a full battery lasts.
    Endurance,
}

const fn claim(
    text: &'static str,
    holds_if: &'static str,
    measure: Measure,
    region: Region,
) -> Claim {
    Claim {
        text,
        holds_if,
        measure,
        region,
    }
}

const ANOTHER: &str = "within what one training and 100 missions of that rate may give";

/// The paper's claims.
#[rustfmt::skip]
pub const CLAIMS: [Claim; 17] = {
    use Measure::*;
    use Quantity::{Energy, Steps, Success, Throughput};
    use Region::{Above, AnotherTraining, Below, Between};
    [
        claim("success 0.73 at N = 10", ANOTHER, At(Success, 10), AnotherTraining(0.73)),
        claim("success 0.97 at N = 15", ANOTHER, At(Success, 15), AnotherTraining(0.97)),
        claim("success 0.97 at N = 15 for all target densities", "the same for each n",
              OfEachHotspots(Success, 15), AnotherTraining(0.97)),
        claim("mission time falls with N and saturates",
              "the first step down and the mean second difference are above 0",
              Saturation(Steps), Above(0.0)),
        claim("energy grows less than in proportion to N", "the growth is below that of N",
              Growth(Energy), Below(1.0)),
        claim("normalised throughput can exceed 1", "above 1 at N = 20",
              At(Throughput, 20), Above(1.0)),
        claim("enough throughput even for larger teams",
              "no lower at the largest N than at the smallest",
              LastOverFirst(Throughput), Above(1.0)),
        claim("adaptive and constant pilot within about 5 points at N = 10",
              "between -5 and +5 points", PilotGap(10), Between(-5.0, 5.0)),
        claim("adaptive pilot up to around 10 points better at N = 15",
              "the greatest over n is between +5 and +15 points",
              GreatestPilotGap(15), Between(5.0, 15.0)),
        claim("adaptivity is worth less with more targets", "its worth falls with n",
              PilotGapSlope, Below(0.0)),
        claim("constant pilot lowers throughput, N = 10", "the ratio is below 1",
              PilotRatio(Throughput, 10), Below(1.0)),
        claim("constant pilot lowers throughput, N = 15", "the ratio is below 1",
              PilotRatio(Throughput, 15), Below(1.0)),
        claim("constant pilot lowers throughput for each n, N = 10 and 15", "each ratio is below 1",
              PilotRatioOfEachHotspots(Throughput), Below(1.0)),
        claim("pilot density is high on approach and low afterwards",
              "denser within a cell of an unconfirmed hotspot than farther away",
              Approach, Above(0.0)),
        claim("the return is flat after about 40 iterations",
              "it changes over the last third by less than one iteration scatters",
              LateChange, Between(-1.0, 1.0)),
        claim("training takes 4.4 times as long at N = 20 as at N = 5",
              "within a fifth of 4.4 times", TimeGrowth, Between(3.5, 5.2)),
        claim("the horizon of 100 steps is the endurance of 0.20 kWh",
              "within a tenth of 100 steps", Endurance, Between(90.0, 110.0)),
    ]
};

/// What is held against the claims.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Subject {
    /// A variant of the paper's training, trained once a cell.
    Trained,
    /// Our own policy.
    Ours,
    /// The paper's own numbers.
    Numbers,
}

/// A reading of the paper that is held against the claims.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// For people.
    pub title: String,
    /// Preset in which it is flown.
    pub preset: Preset,
    /// Its policy in the table.
    pub policy: &'static str,
    subject: Subject,
}

impl Reading {
    /// Whether a reproduction of this size trains and flies what a measure takes. The two success
    /// rates are asked of the paper's training alone.
    fn answers(&self, scope: &Scope, measure: Measure) -> bool {
        if measure == Measure::Endurance || self.subject == Subject::Numbers {
            return measure == Measure::Endurance && self.subject == Subject::Numbers;
        }
        let trained = self.subject == Subject::Trained;
        let flies = |uavs: u32| {
            if trained {
                scope.paper_cells.iter().any(|cell| cell.0 == uavs)
            } else {
                scope.fleets.contains(&uavs)
            }
        };
        let fleets = || scope.fleets.iter().all(|&uavs| flies(uavs));
        let holds_pilots = !trained || scope.paper_pilots.contains(&Some(CONSTANT_PILOT));
        match measure {
            Measure::At(Quantity::Success, uavs)
            | Measure::OfEachHotspots(Quantity::Success, uavs) => trained && flies(uavs),
            Measure::At(_, uavs) | Measure::OfEachHotspots(_, uavs) => flies(uavs),
            Measure::LastOverFirst(_) | Measure::Growth(_) | Measure::Saturation(_) => fleets(),
            Measure::PilotGap(uavs)
            | Measure::GreatestPilotGap(uavs)
            | Measure::PilotRatio(_, uavs) => flies(uavs) && holds_pilots,
            Measure::PilotGapSlope | Measure::PilotRatioOfEachHotspots(_) => {
                flies(10) && flies(15) && holds_pilots
            }
            Measure::Approach => trained || self.preset == Preset::Mission,
            Measure::LateChange => trained,
            Measure::TimeGrowth => trained && fleets(),
            Measure::Endurance => false,
        }
    }
}

/// The readings that a reproduction has.
pub fn readings(scope: &Scope) -> Vec<Reading> {
    let learners = scope.learners().into_iter().map(|learner| Reading {
        title: learner.as_trained(),
        preset: Preset::Paper,
        policy: learner.name,
        subject: Subject::Trained,
    });
    let ours = scope.presets.iter().map(|&preset| Reading {
        title: format!("our policy, preset `{}`", preset.name()),
        preset,
        policy: crate::campaign::OURS,
        subject: Subject::Ours,
    });
    let numbers = Reading {
        title: "the paper's own table".to_owned(),
        preset: Preset::Paper,
        policy: "",
        subject: Subject::Numbers,
    };
    learners.chain(ours).chain([numbers]).collect()
}

/// The verdict on a claim for one reading.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// What the paper says.
    pub claim: Claim,
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
    let others = readings
        .iter()
        .filter(|reading| reading.subject != Subject::Ours);
    let unasked = |claim: &Claim| !others.clone().any(|r| r.answers(scope, claim.measure));
    let claims = CLAIMS.iter().filter(|&claim| unasked(claim));
    claims.map(|claim| claim.text).collect()
}

/// Every claim with every reading that answers it.
pub fn judge(results: &Results) -> Vec<Judged> {
    let scope = results.scope;
    let readings = readings(scope);
    let mut judged = Vec::new();
    for claim in CLAIMS {
        for reading in readings.iter().filter(|r| r.answers(scope, claim.measure)) {
            let evidence = Evidence::new(results, reading);
            let shortened = reading.subject == Subject::Trained && scope.shortened().is_some();
            let (measured, verdict) = match evidence.measure(claim.measure) {
                None => ("not run".to_owned(), Verdict::NotJudged),
                Some(measured) if shortened => (measured.words, Verdict::NotJudged),
                Some(measured) => {
                    let ends = claim.region.ends(evidence.spread(Quantity::Success));
                    (measured.words, verdict(&measured.effects, ends))
                }
            };
            judged.push(Judged {
                claim,
                reading: reading.title.clone(),
                measured,
                verdict,
            });
        }
    }
    judged
}

/// How many of the verdicts chance would make wrong.
pub fn by_chance(judged: &[Judged]) -> String {
    let decided = judged.iter().filter(|j| j.verdict.is_decided()).count();
    format!(
        "Each verdict \"holds\" or \"does not hold\" is made at 95 %. Of the {decided} here, at \
            most {:.1} would be wrong by chance.",
        0.05 * decided as f64
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A full reproduction asks everything of the paper's training; a quick one what its few
    /// trainings answer.
    #[test]
    fn claims_are_asked_of_what_is_trained() {
        let told = |scope: &Scope| -> Vec<usize> {
            let readings = readings(scope);
            let of = |claim: &Claim| {
                let answering = readings.iter().filter(|r| r.answers(scope, claim.measure));
                answering.count()
            };
            CLAIMS.iter().map(of).collect()
        };
        let full = Scope::full(1);
        assert_eq!(unasked(&full), Vec::<&str>::new());
        // Two readings of the paper's training; ours in two presets, but not about the two rates or
        // training; the horizon is arithmetic.
        assert_eq!(
            told(&full),
            [2, 2, 2, 4, 4, 4, 4, 4, 4, 4, 4, 4, 4, 3, 2, 2, 1]
        );

        let quick = Scope::quick(1);
        assert_eq!(
            told(&quick),
            [2, 2, 2, 3, 3, 3, 3, 1, 1, 1, 1, 1, 1, 2, 2, 2, 1]
        );
        assert_eq!(unasked(&quick).len(), 6);
    }

    #[test]
    fn the_decided_verdicts_are_counted() {
        let of = |verdict| Judged {
            claim: CLAIMS[0],
            reading: String::new(),
            measured: String::new(),
            verdict,
        };
        let judged = [
            Verdict::Holds,
            Verdict::Fails,
            Verdict::Undecided,
            Verdict::NotJudged,
        ]
        .map(of);
        let told = by_chance(&judged);
        assert!(told.contains("Of the 2 here, at most 0.1 "), "{told}");
    }
}
