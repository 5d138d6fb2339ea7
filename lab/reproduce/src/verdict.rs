//! Verdicts by intervals.

use crate::fit::{PAPER, Published};
use crate::statistics::{CONFIDENCE, Measured, Spread, t_factor};
use jcas_episode::statistics::{Estimate, wilson};

/// How a claim came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Every interval lies within the claim's region.
    Holds,
    /// Some interval lies outside the region.
    Fails,
    /// Neither: more trainings or missions may turn it.
    Undecided,
    /// What it takes was not trained or flown, or only in part.
    NotJudged,
}

impl Verdict {
    /// In words.
    pub const fn text(self) -> &'static str {
        match self {
            Verdict::Holds => "holds",
            Verdict::Fails => "does not hold",
            Verdict::Undecided => "undecided",
            Verdict::NotJudged => "not judged",
        }
    }

    /// Whether it says something that noise could have made.
    pub const fn is_decided(self) -> bool {
        matches!(self, Verdict::Holds | Verdict::Fails)
    }
}

/// Where a claim says that a value lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Region {
    /// Above this.
    Above(f64),
    /// Below this.
    Below(f64),
    /// Between these.
    Between(f64, f64),
    /// Where another training and its missions may have given this success rate of the paper.
    AnotherTraining(f64),
}

impl Region {
    /// The ends of the region, given the spread between trainings.
    pub fn ends(self, spread: Option<Spread>) -> (f64, f64) {
        match self {
            Region::Above(low) => (low, f64::INFINITY),
            Region::Below(high) => (f64::NEG_INFINITY, high),
            Region::Between(low, high) => (low, high),
            Region::AnotherTraining(rate) => {
                let interval = one_training(Published { rate, ..PAPER[0] }, spread);
                // No rate is above 1 or below 0, so that such an end is none.
                let low = Some(interval.low).filter(|&low| low > 0.0);
                let high = Some(interval.high).filter(|&high| high < 1.0);
                (
                    low.unwrap_or(f64::NEG_INFINITY),
                    high.unwrap_or(f64::INFINITY),
                )
            }
        }
    }
}

/// The interval of a published success rate: that of its missions, and that of its one training.
pub fn one_training(published: Published, spread: Option<Spread>) -> Estimate {
    let successes = (published.rate * published.missions).round() as u64;
    let missions = wilson(successes, published.missions as u64);
    let training = spread.map_or(0.0, |spread| {
        t_factor(spread.freedom, CONFIDENCE) * spread.deviation
    });
    let rate = published.rate;
    Estimate {
        value: rate,
        low: (rate - (rate - missions.low).hypot(training)).max(0.0),
        high: (rate + (missions.high - rate).hypot(training)).min(1.0),
    }
}

/// A measured value on the scale on which its noise is normal.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// As it is.
    Plain(Measured),
    /// The logarithm of a ratio.
    LogRatio(Measured),
    /// The greatest of several.
    Greatest(Vec<Measured>),
}

impl Effect {
    /// The value with its interval, a ratio where it is one. The interval of the greatest of K
    /// values reaches from the highest lower end to the highest upper end. They are the ends of
    /// intervals at 1 − (1 − confidence)/K, which hold together (Bonferroni).
    pub fn interval(&self, confidence: f64) -> Estimate {
        match self {
            Effect::Plain(measured) => measured.interval(confidence),
            Effect::LogRatio(measured) => {
                let e = measured.interval(confidence);
                Estimate {
                    value: e.value.exp(),
                    low: e.low.exp(),
                    high: e.high.exp(),
                }
            }
            Effect::Greatest(values) => {
                let each = together(confidence, values.len());
                let intervals = values.iter().map(|value| value.interval(each));
                let highest = |end: fn(&Estimate) -> f64| {
                    let ends = intervals.clone().map(|e| end(&e));
                    ends.fold(f64::NEG_INFINITY, f64::max)
                };
                Estimate {
                    value: highest(|e| e.value),
                    low: highest(|e| e.low),
                    high: highest(|e| e.high),
                }
            }
        }
    }
}

/// The confidence of each of several intervals that hold together with a given one.
fn together(confidence: f64, count: usize) -> f64 {
    1.0 - (1.0 - confidence) / count as f64
}

/// The verdict on a claim that says all of these effects lie in a region.
///
/// It holds where each 95 % interval lies within the region. It does not hold where one lies
/// outside. For that, the intervals of K effects are widened to 1 − 0.05/K (Bonferroni), since any
/// of them can refute.
pub fn verdict(effects: &[Effect], (low, high): (f64, f64)) -> Verdict {
    if effects.is_empty() {
        return Verdict::NotJudged;
    }
    let inside = |effect: &Effect| {
        let e = effect.interval(CONFIDENCE);
        e.low >= low && e.high <= high
    };
    let wide = together(CONFIDENCE, effects.len());
    let outside = |effect: &Effect| {
        let e = effect.interval(wide);
        e.high < low || e.low > high
    };
    if effects.iter().any(outside) {
        Verdict::Fails
    } else if effects.iter().all(inside) {
        Verdict::Holds
    } else {
        Verdict::Undecided
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(value: f64, error: f64) -> Effect {
        Effect::Plain(Measured {
            value,
            error,
            freedom: f64::INFINITY,
        })
    }

    #[test]
    fn an_interval_decides_only_where_it_is_on_one_side() {
        use Verdict::{Fails, Holds, NotJudged, Undecided};
        let zero = Region::Above(0.0).ends(None);
        for (effects, expected) in [
            // 1.96 standard errors away from 0, and a little nearer.
            (&[of(1.97, 1.0)][..], Holds),
            (&[of(1.95, 1.0)], Undecided),
            (&[of(-1.97, 1.0)], Fails),
            // Each of two has to be at 1.96 to hold, but one at 2.2414 to refute (2.5 % of both).
            (&[of(1.97, 1.0), of(1.97, 1.0)], Holds),
            (&[of(-2.24, 1.0), of(9.0, 1.0)], Undecided),
            (&[of(-2.25, 1.0), of(9.0, 1.0)], Fails),
            (&[], NotJudged),
        ] {
            assert_eq!(verdict(effects, zero), expected, "{effects:?}");
        }
        let between = Region::Between(-5.0, 5.0).ends(None);
        // +5.3 points with a half-width of 7.5 is what it is, and neither within 5 nor outside.
        assert_eq!(verdict(&[of(5.3, 7.5 / 1.96)], between), Undecided);
    }

    // Each of two intervals at 97.5 % has 2.2414 standard errors: [-1.24, 3.24] and [1.759, 2.241].
    #[test]
    fn the_greatest_of_several_is_above_each_lower_end() {
        let [Effect::Plain(wide), Effect::Plain(narrow)] = [of(1.0, 1.0), of(2.0, 0.1075)] else {
            panic!("two plain values");
        };
        let e = Effect::Greatest(vec![wide, narrow]).interval(CONFIDENCE);
        assert_eq!(e.value, 2.0);
        assert!((e.low - (2.0 - 0.1075 * 2.2414)).abs() < 1e-4, "{e:?}");
        assert!((e.high - 3.2414).abs() < 1e-4, "{e:?}");
    }

    // Of 4000 values around the edge of the region, some 2.5 % are called inside and as many
    // outside. The quantiles of Binomial(4000, 0.025) at 2.5 and 97.5 % are 81 and 120.
    #[test]
    fn noise_decides_as_often_as_stated() {
        let zero = Region::Above(0.0).ends(None);
        let mut decided = [0, 0];
        for k in 0..4000u32 {
            let words = jcas_core::rng::block(7, k, 0, 0, jcas_core::rng::Purpose::Policy);
            let uniform = |word: u32| (f64::from(word) + 0.5) / 4_294_967_296.0;
            let radius = (-2.0 * uniform(words[0]).ln()).sqrt();
            let normal = radius * (std::f64::consts::TAU * uniform(words[1])).cos();
            match verdict(&[of(normal, 1.0)], zero) {
                Verdict::Holds => decided[0] += 1,
                Verdict::Fails => decided[1] += 1,
                _ => {}
            }
        }
        for count in decided {
            assert!((81..=120).contains(&count), "{decided:?}");
        }
    }

    // Wilson's interval of 73 of 100 is [0.6357, 0.8073]. A training of ± 2 · 0.05 in quadrature:
    // 0.0943 and 0.1 make 0.1375, 0.0773 and 0.1 make 0.1264.
    #[test]
    fn another_training_may_have_given_another_rate() {
        let alone = one_training(PAPER[0], None);
        assert!((alone.low - 0.6357).abs() < 1e-4 && (alone.high - 0.8073).abs() < 1e-4);
        let spread = Spread {
            deviation: 0.1 / 1.959_963_985,
            freedom: f64::INFINITY,
        };
        let trained = one_training(PAPER[0], Some(spread));
        assert!((trained.low - 0.5925).abs() < 1e-3, "{trained:?}");
        assert!((trained.high - 0.8564).abs() < 1e-3, "{trained:?}");
        let (low, high) = Region::AnotherTraining(0.97).ends(Some(spread));
        assert!(low < 0.87 && high == f64::INFINITY);
    }
}
