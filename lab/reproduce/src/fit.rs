//! Maximum-likelihood estimate of one unknown of the model from published success rates.
//!
//! A published rate is a number of successes among a number of missions, so it is binomial. Its
//! probability as a function of the unknown comes from simulation at a few values and is
//! interpolated between them. The estimate has the greatest likelihood. The interval holds every
//! value that a likelihood-ratio test at 5 % does not reject. By Wilks' theorem, twice the loss of
//! log likelihood is χ² with one degree of freedom.
//!
//! A policy that is trained has the noise of its training as well. It shifts each simulated rate by
//! a normal variable of a given standard deviation. The shift that makes the published rate and
//! itself the most likely is taken (a profile likelihood).
//!
//! The deviance compares the fit with a model that fits each published rate exactly. Its degrees of
//! freedom are the number of rates less one.

use statrs::distribution::{ChiSquared, ContinuousCDF};

/// A success rate that was published.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Published {
    /// Fleet size.
    pub uavs: u32,
    /// Successes over missions.
    pub rate: f64,
    /// Missions.
    pub missions: f64,
}

/// The paper's two numbers, each an average of 100 missions. Its text gives the rates, and its
/// table of settings the number of episodes.
pub const PAPER: [Published; 2] = [
    Published {
        uavs: 10,
        rate: 0.73,
        missions: 100.0,
    },
    Published {
        uavs: 15,
        rate: 0.97,
        missions: 100.0,
    },
];

/// Share of the interval.
const CONFIDENCE: f64 = 0.95;
/// Steps of the search between two neighbouring values.
const STEPS: usize = 200;
/// Halvings that find the most likely shift.
const BISECTIONS: usize = 50;

/// Simulated success at rising values of the unknown.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Simulated {
    /// Value, successes over missions, missions.
    pub points: Vec<(f64, f64, f64)>,
}

impl Simulated {
    /// The rate at a value, or None outside of the simulated range. The logit is linear between
    /// neighbours. Half a success and half a failure are added to each, so that it is finite.
    pub fn rate(&self, x: f64) -> Option<f64> {
        let after = self.points.iter().position(|point| point.0 >= x)?;
        let logit = |(_, rate, missions): (f64, f64, f64)| {
            let successes = rate * missions;
            ((successes + 0.5) / (missions - successes + 0.5)).ln()
        };
        let (right, left) = (
            self.points[after],
            self.points[after.checked_sub(1).unwrap_or(after)],
        );
        if right.0 > x && after == 0 {
            return None;
        }
        let share = if right.0 > left.0 {
            (x - left.0) / (right.0 - left.0)
        } else {
            0.0
        };
        let value = logit(left) + (logit(right) - logit(left)) * share;
        Some(1.0 / (1.0 + (-value).exp()))
    }
}

/// What fits best.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The most likely value.
    pub value: f64,
    /// Lower end of the interval; none where the simulated values end before the likelihood falls.
    pub low: Option<f64>,
    /// Upper end, likewise.
    pub high: Option<f64>,
    /// The rates at the most likely value, in the order of the published ones.
    pub rates: Vec<f64>,
    /// Deviance of the published rates from these.
    pub deviance: f64,
    /// Probability of at least that deviance if the model were true; none where nothing is left to
    /// test.
    pub p_value: Option<f64>,
}

impl Fit {
    /// Whether the published rates together speak against the model at 5 %.
    pub fn refused(&self) -> bool {
        self.p_value.is_some_and(|p| p < 1.0 - CONFIDENCE)
    }
}

/// Successes and failures weighted by the logarithms of their probabilities; 0 ln 0 is 0.
fn log_likelihood(published: Published, rate: f64) -> f64 {
    let term = |count: f64, p: f64| if count == 0.0 { 0.0 } else { count * p.ln() };
    let successes = published.rate * published.missions;
    term(successes, rate) + term(published.missions - successes, 1.0 - rate)
}

/// The greatest log likelihood over the shifts that trainings of this standard deviation may make.
/// The likelihood is concave in the shifted rate, so that its slope changes sign once.
fn shifted_log_likelihood(published: Published, rate: f64, deviation: f64) -> f64 {
    if deviation == 0.0 {
        return log_likelihood(published, rate);
    }
    let precision = deviation.powi(-2);
    let slope = |p: f64| {
        let successes = published.rate * published.missions;
        successes / p - (published.missions - successes) / (1.0 - p) - (p - rate) * precision
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..BISECTIONS {
        let middle = f64::midpoint(low, high);
        if slope(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let p = f64::midpoint(low, high);
    log_likelihood(published, p) - (p - rate).powi(2) * precision / 2.0
}

/// Fits one value to several rates, each with its simulated curve. None where the curves have no
/// common value. `deviation` is the standard deviation of a rate between trainings, 0 for scripts.
pub fn fit(data: &[(Published, Simulated)], deviation: f64) -> Option<Fit> {
    let mut values: Vec<f64> = data
        .iter()
        .flat_map(|(_, curve)| curve.points.iter().map(|point| point.0))
        .collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let between = values.windows(2).flat_map(|ends| {
        let step = (ends[1] - ends[0]) / STEPS as f64;
        (0..STEPS).map(move |k| ends[0] + step * k as f64)
    });
    let likelihoods: Vec<(f64, f64)> = between
        .chain(values.last().copied())
        .filter_map(|x| {
            let terms = data.iter().map(|(published, curve)| {
                let rate = curve.rate(x)?;
                Some(shifted_log_likelihood(*published, rate, deviation))
            });
            Some((x, terms.sum::<Option<f64>>()?))
        })
        .collect();
    let best = (0..likelihoods.len()).max_by(|&a, &b| {
        likelihoods[a]
            .1
            .total_cmp(&likelihoods[b].1)
            .then(b.cmp(&a))
    })?;
    let (value, greatest) = likelihoods[best];
    let one = ChiSquared::new(1.0).ok()?;
    let lost = one.inverse_cdf(CONFIDENCE) / 2.0;
    let refused = |k: &usize| greatest - likelihoods[*k].1 > lost;
    // The ends of the run of values around the best that are not refused.
    let low = (0..best).rev().find(refused).map(|k| likelihoods[k + 1].0);
    let high = (best..likelihoods.len())
        .find(refused)
        .map(|k| likelihoods[k - 1].0);
    let rates: Option<Vec<f64>> = data.iter().map(|(_, curve)| curve.rate(value)).collect();
    let perfect: f64 = data
        .iter()
        .map(|(published, _)| log_likelihood(*published, published.rate))
        .sum();
    let deviance = 2.0 * (perfect - greatest);
    let p_value = (data.len() > 1)
        .then(|| ChiSquared::new(data.len() as f64 - 1.0).ok())
        .flatten()
        .map(|rest| 1.0 - rest.cdf(deviance));
    Some(Fit {
        value,
        low,
        high,
        rates: rates?,
        deviance,
        p_value,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn published(rate: f64, missions: f64) -> Published {
        Published {
            uavs: 10,
            rate,
            missions,
        }
    }

    /// The rate at x in [0, 1] is nearly 1/(1 + e^(-(a + b x))): with 10⁹ missions the added half
    /// success is negligible.
    fn logistic(a: f64, b: f64) -> Simulated {
        let rate = |x: f64| 1.0 / (1.0 + (-(a + b * x)).exp());
        Simulated {
            points: vec![(0.0, rate(0.0), 1e9), (1.0, rate(1.0), 1e9)],
        }
    }

    #[test]
    fn rates_are_interpolated_on_the_logit() {
        // logit 1/4 of the way from ln(1/3) to ln(3): -ln(3)/2, so 1/(1 + √3).
        let curve = Simulated {
            points: vec![(2.0, 0.25, 1e12), (6.0, 0.75, 1e12)],
        };
        let rate = curve.rate(3.0).unwrap();
        assert!((rate - 1.0 / (1.0 + 3f64.sqrt())).abs() < 1e-9, "{rate}");
        assert_eq!(curve.rate(1.9), None);
        assert_eq!(curve.rate(6.1), None);
        // None of ten: (0 + 1/2)/(10 + 1).
        let none = Simulated {
            points: vec![(1.0, 0.0, 10.0)],
        };
        assert!((none.rate(1.0).unwrap() - 0.5 / 11.0).abs() < 1e-12);
    }

    #[test]
    fn a_single_rate_is_met_exactly() {
        // 50 of 100 at logit -2 + 4 x: x = 1/2. With θ the logit, 2(l(0) - l(θ)) =
        // 200 ln cosh(θ/2), which is 3.8415 at |θ| = 0.3932: x = 1/2 ± 0.0983.
        let fit = fit(&[(published(0.5, 100.0), logistic(-2.0, 4.0))], 0.0).unwrap();
        assert!((fit.value - 0.5).abs() < 1e-9, "{fit:?}");
        assert!(
            fit.deviance.abs() < 1e-9 && fit.p_value.is_none(),
            "{fit:?}"
        );
        let theta = 2.0 * (3.841_458_8f64 / 200.0).exp().acosh();
        for (end, sign) in [(fit.low, -1.0), (fit.high, 1.0)] {
            let exact = 0.5 + sign * theta / 4.0;
            assert!((end.unwrap() - exact).abs() <= 0.0051, "{fit:?} {exact}");
        }
    }

    #[test]
    fn two_rates_that_no_value_meets_leave_a_deviance() {
        // The same curve serves 40 and 60 of 100, so the best rate is 1/2. The deviance is 2 · 2 ·
        // (40 ln(40/50) + 60 ln(60/50)) = 8.0542. With one degree of freedom, p = 0.00454.
        let curve = logistic(-2.0, 4.0);
        let data = [
            (published(0.4, 100.0), curve.clone()),
            (published(0.6, 100.0), curve),
        ];
        let fit = fit(&data, 0.0).unwrap();
        assert!((fit.value - 0.5).abs() < 1e-9);
        assert!((fit.deviance - 8.0542).abs() < 1e-3, "{}", fit.deviance);
        assert!((fit.p_value.unwrap() - 0.00454).abs() < 1e-4, "{fit:?}");
        assert!(fit.refused());
        assert!((fit.rates[0] - 0.5).abs() < 1e-6 && (fit.rates[1] - 0.5).abs() < 1e-6);
    }

    // With 10⁹ missions the published rate is exact. So only the shifts are left, which the
    // best value makes alike: 0.1 each, whose deviance is 2 · (0.1 / 0.05)² = 8.
    #[test]
    fn trainings_shift_the_rates_by_their_deviation() {
        let curve = logistic(-2.0, 4.0);
        let data = [
            (published(0.4, 1e9), curve.clone()),
            (published(0.6, 1e9), curve),
        ];
        let fit = fit(&data, 0.05).unwrap();
        assert!((fit.value - 0.5).abs() < 1e-9, "{fit:?}");
        assert!((fit.deviance - 8.0).abs() < 1e-5, "{}", fit.deviance);
    }

    // 0.79 beside 0.97 of 100 with a deviation of 0.0747. scipy 1.17.1 gives 5.4541 as the least
    // minimize_scalar(lambda p: 2*(97*log(.97/p) + 3*log(.03/(1-p))) + ((p - .79)/.0747)**2).
    #[test]
    fn a_shift_counts_in_points_near_one_as_well() {
        let most = shifted_log_likelihood(published(0.97, 100.0), 0.79, 0.0747);
        let deviance = 2.0 * (log_likelihood(published(0.97, 100.0), 0.97) - most);
        assert!((deviance - 5.4541).abs() < 1e-4, "{deviance}");
        let alone = shifted_log_likelihood(published(0.97, 100.0), 0.79, 0.0);
        assert_eq!(alone, log_likelihood(published(0.97, 100.0), 0.79));
    }

    #[test]
    fn an_interval_that_the_simulated_values_do_not_end_is_open() {
        let fit = fit(&[(published(0.5, 4.0), logistic(-0.1, 0.2))], 0.0).unwrap();
        assert_eq!((fit.low, fit.high), (None, None));
        assert_eq!(
            super::fit(&[(published(0.5, 4.0), Simulated::default())], 0.0),
            None
        );
    }
}
