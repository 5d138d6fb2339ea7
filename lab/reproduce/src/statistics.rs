//! Estimates with standard errors, and the few operations that the claims need.
//!
//! An interval is Student's t of its degrees of freedom times the standard error. A combination of
//! estimates takes the least degrees of freedom of its terms, which makes it wider, never narrower.

use jcas_episode::statistics::Estimate;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Share of values that an interval covers.
pub const CONFIDENCE: f64 = 0.95;

/// An estimate and its noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The estimate.
    pub value: f64,
    /// Its standard error; 0 where the value is exact.
    pub error: f64,
    /// Degrees of freedom of the standard error; infinite where it is known.
    pub freedom: f64,
}

impl Measured {
    /// Returns the interval that covers the true value with this probability.
    pub fn interval(&self, confidence: f64) -> Estimate {
        let half = if self.error > 0.0 {
            t_factor(self.freedom, confidence) * self.error
        } else {
            0.0
        };
        Estimate {
            value: self.value,
            low: self.value - half,
            high: self.value + half,
        }
    }

    /// Returns the natural logarithm, whose error is the relative error (delta method).
    pub fn ln(&self) -> Measured {
        Measured {
            value: self.value.ln(),
            error: self.error / self.value.abs(),
            ..*self
        }
    }
}

/// Returns the half-width of a two-sided interval in standard errors.
pub fn t_factor(freedom: f64, confidence: f64) -> f64 {
    let quantile = 0.5 + confidence / 2.0;
    match StudentsT::new(0.0, 1.0, freedom) {
        Ok(t) if freedom.is_finite() => t.inverse_cdf(quantile),
        _ => Normal::standard().inverse_cdf(quantile),
    }
}

/// Returns the standard error that a 95 % interval of many missions stands for.
pub fn error_of(interval: &Estimate) -> f64 {
    (interval.high - interval.low) / (2.0 * t_factor(f64::INFINITY, CONFIDENCE))
}

/// Returns the weighted sum of independent estimates.
pub fn combination(terms: impl IntoIterator<Item = (f64, Measured)>) -> Measured {
    let mut sum = Measured {
        value: 0.0,
        error: 0.0,
        freedom: f64::INFINITY,
    };
    let mut variance = 0.0;
    for (weight, term) in terms {
        sum.value += weight * term.value;
        variance += (weight * term.error).powi(2);
        sum.freedom = sum.freedom.min(term.freedom);
    }
    sum.error = variance.sqrt();
    sum
}

/// Returns the mean of independent values, with the noise that their spread shows; none where there
/// are fewer than two.
pub fn mean(values: &[f64]) -> Option<Measured> {
    let spread = pooled(&[values.to_vec()])?;
    let count = values.len() as f64;
    Some(Measured {
        value: values.iter().sum::<f64>() / count,
        error: spread.deviation / count.sqrt(),
        freedom: spread.freedom,
    })
}

/// A standard deviation within groups.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The standard deviation.
    pub deviation: f64,
    /// Its degrees of freedom.
    pub freedom: f64,
}

/// Returns the standard deviation within groups, pooled over them; none where no group has two
/// values.
pub fn pooled(groups: &[Vec<f64>]) -> Option<Spread> {
    let (mut squares, mut freedom) = (0.0, 0.0);
    for values in groups.iter().filter(|values| values.len() > 1) {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        squares += values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
        freedom += count - 1.0;
    }
    (freedom > 0.0).then(|| Spread {
        deviation: (squares / freedom).sqrt(),
        freedom,
    })
}

/// A straight line through equally spaced values, by least squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Change from one value to the next.
    pub slope: Measured,
    /// Standard deviation of the values about the line.
    pub scatter: f64,
}

/// Returns the line through values; none where there are fewer than three.
pub fn line(values: &[f64]) -> Option<Line> {
    if values.len() < 3 {
        return None;
    }
    let count = values.len() as f64;
    let centre = (count - 1.0) / 2.0;
    let mean = values.iter().sum::<f64>() / count;
    let offsets = (0..values.len()).map(|k| k as f64 - centre);
    let width: f64 = offsets.clone().map(|x| x * x).sum();
    let slope = offsets
        .clone()
        .zip(values)
        .map(|(x, y)| x * (y - mean))
        .sum::<f64>()
        / width;
    let residuals = offsets
        .zip(values)
        .map(|(x, y)| (y - mean - slope * x).powi(2));
    let scatter = (residuals.sum::<f64>() / (count - 2.0)).sqrt();
    Some(Line {
        slope: Measured {
            value: slope,
            error: scatter / width.sqrt(),
            freedom: count - 2.0,
        },
        scatter,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(value: f64, expected: f64) {
        assert!(
            (value - expected).abs() < 1e-6 * expected.abs().max(1.0),
            "{value} is not {expected}"
        );
    }

    // Values of scipy 1.17.1, by the calls that stand beside them.

    #[test]
    fn factors_are_quantiles_of_student_and_normal() {
        close(t_factor(16.0, 0.95), 2.119_905_299_221_254_6); // stats.t.ppf(0.975, 16)
        close(t_factor(2.0, 0.95), 4.302_652_729_749_462); // stats.t.ppf(0.975, 2)
        close(t_factor(80.0, 0.99), 2.638_690_596_344_183); // stats.t.ppf(0.995, 80)
        close(t_factor(f64::INFINITY, 0.95), 1.959_963_984_540_054); // stats.norm.ppf(0.975)
    }

    #[test]
    fn a_mean_has_the_interval_of_its_values() {
        let values = [0.267, 0.372, 0.457, 0.715];
        let mean = mean(&values).unwrap();
        close(mean.value, 0.452_75);
        close(mean.error, 0.095_662_928_208_022_84); // stats.sem(values)
        // stats.ttest_1samp(values, 0).confidence_interval(0.95)
        let interval = mean.interval(0.95);
        close(interval.low, 0.148_307_867_571_757_12);
        close(interval.high, 0.757_192_132_428_243_9);
        assert!(super::mean(&[0.5]).is_none());
    }

    #[test]
    fn a_difference_with_pooled_noise_has_the_interval_of_the_t_test() {
        let groups = [vec![0.334, 0.286, 0.298], vec![0.401, 0.443, 0.508]];
        let spread = pooled(&groups).unwrap();
        close(spread.freedom, 4.0);
        let means = groups.map(|values| Measured {
            value: values.iter().sum::<f64>() / 3.0,
            error: spread.deviation / 3f64.sqrt(),
            freedom: spread.freedom,
        });
        let difference = combination([(1.0, means[0]), (-1.0, means[1])]);
        // stats.ttest_ind(*groups).confidence_interval(0.95)
        let interval = difference.interval(0.95);
        close(interval.low, -0.239_910_380_281_485_37);
        close(interval.high, -0.049_422_953_051_848_06);
        assert!(pooled(&[vec![1.0], vec![2.0]]).is_none());
    }

    #[test]
    fn a_line_has_the_slope_and_the_error_of_least_squares() {
        let line = line(&[1.0, 3.0, 2.0, 5.0, 4.0, 6.5, 5.5]).unwrap();
        // stats.linregress(range(7), values): slope, stderr; residuals over 7 - 2
        close(line.slope.value, 0.803_571_428_571_428_4);
        close(line.slope.error, 0.194_142_541_784_669_8);
        close(line.scatter, 1.027_305_768_920_404_1);
        assert!(super::line(&[1.0, 2.0]).is_none());
    }

    #[test]
    fn a_ratio_has_the_relative_errors_of_both() {
        let of = |value, error| Measured {
            value,
            error,
            freedom: 9.0,
        };
        // 3 % and 4 % make 5 %.
        let ratio = combination([(1.0, of(4.0, 0.12).ln()), (-1.0, of(2.0, 0.08).ln())]);
        close(ratio.value, 2f64.ln());
        close(ratio.error, 0.05);
        let exact = of(1.0, 0.0).interval(0.95);
        assert_eq!((exact.low, exact.high), (1.0, 1.0));
    }

    // An interval of 1.96 standard errors to either side.
    #[test]
    fn an_interval_of_missions_gives_its_standard_error() {
        let interval = Estimate {
            value: 0.5,
            low: 0.402_001_800_772_997_3,
            high: 0.597_998_199_227_002_7,
        };
        close(error_of(&interval), 0.05);
    }
}
