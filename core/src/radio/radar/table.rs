//! A detection curve that is given as a table over the range.

use libm::log;

use crate::config::DetectionTable;

/// The logit of a probability between 0 and 1, ln(p/(1 - p)).
fn logit(probability: f64) -> f64 {
    log(probability) - log(1.0 - probability)
}

/// The logit of P_d at a range: linear between two points of the table, and held beyond its ends.
#[must_use]
pub fn logit_at(table: &DetectionTable, range_m: f64) -> f64 {
    let points = table.as_slice();
    let above = points.iter().position(|point| point.range_m >= range_m);
    let (near, far) = match above {
        Some(0) => (&points[0], &points[0]),
        Some(above) => (&points[above - 1], &points[above]),
        None => match points.last() {
            Some(last) => (last, last),
            // A legal configuration has a point.
            None => return f64::NEG_INFINITY,
        },
    };
    between(
        (near.range_m, logit(near.probability)),
        (far.range_m, logit(far.probability)),
        range_m,
    )
}

/// The line through two points at a range between them; the first point where both have one range.
fn between(near: (f64, f64), far: (f64, f64), range_m: f64) -> f64 {
    let width_m = far.0 - near.0;
    if width_m > 0.0 {
        near.1 + (range_m - near.0) / width_m * (far.1 - near.1)
    } else {
        near.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Config, DetectionCurve, PilotGain};
    use crate::radio::radar::curve::{AnyCurve, tabulated};

    /// Rounding moves the logit by less than 1e-12 beyond those of the two points.
    #[test]
    fn a_line_stays_between_its_points() {
        for (near, far) in [
            ((0.0, 40.0), (1e6, -745.0)),
            ((0.1, 3.0), (0.1 + f64::EPSILON, 2.9)),
            ((7.3, 1e-300), (1e6 / 3.0, -1e-300)),
            ((1e-9, 0.3), (999_999.9, 0.3)),
        ] {
            for step in 0..=10_000 {
                let range_m = near.0 + (far.0 - near.0) * f64::from(step) / 1e4;
                let logit = between(near, far, range_m.min(far.0));
                assert!(
                    logit <= near.1 && logit >= far.1 - 1e-12,
                    "{near:?}: {logit}"
                );
            }
        }
    }

    /// Two points whose logits are ln 9 and -ln 9.
    fn table() -> Config {
        Config {
            detection_curve: DetectionCurve::Table,
            detection_table: DetectionTable::from_slice(&[(50.0, 0.9).into(), (150.0, 0.1).into()])
                .unwrap(),
            ..Config::default()
        }
    }

    fn probability(config: &Config, range_m: f64, density: f64) -> f64 {
        AnyCurve::of(config).probability(tabulated(config, range_m), density)
    }

    fn near(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-12, "{a} is not {b}");
    }

    /// Worked by hand: the logit is 0 half way and ln 3 at a quarter of the way, and it is held
    /// beyond the ends. The load's penalty at ρ_max is in the table.
    #[test]
    fn the_logit_is_linear_between_points_and_held_beyond_them() {
        for pilot_gain in [PilotGain::None, PilotGain::Coherent] {
            let config = Config {
                pilot_gain,
                ..table()
            };
            for (range_m, p_d) in [
                (0.0, 0.9),
                (50.0, 0.9),
                (75.0, 0.75),
                (100.0, 0.5),
                (125.0, 0.25),
                (150.0, 0.1),
                (1e9, 0.1),
            ] {
                near(probability(&config, range_m, 0.3), p_d);
            }
        }
    }

    /// A tenth of the pilots is 10 dB less, and a load that is 0.27 higher costs α · 0.27 dB.
    #[test]
    fn gain_and_penalty_move_the_logit_by_the_slope_per_db() {
        let config = Config {
            pilot_gain: PilotGain::Coherent,
            logistic_slope_per_db: 0.3,
            comm_load_penalty_db: 2.0,
            ..table()
        };
        let logit = -0.3 * (10.0 + 2.0 * 0.27);
        near(
            probability(&config, 100.0, 0.03),
            1.0 / (1.0 + libm::exp(-logit)),
        );
    }

    /// One point is a probability that does not depend on the range.
    #[test]
    fn a_single_point_holds_everywhere() {
        let config = Config {
            detection_table: DetectionTable::from_slice(&[(80.0, 0.4).into()]).unwrap(),
            ..table()
        };
        for range_m in [0.0, 80.0, 1e6] {
            near(probability(&config, range_m, 0.3), 0.4);
        }
    }
}
