//! Maps values to places on the page: limits, ticks and their labels.

/// A scale maps the values of an axis to places between two ends on the page.
#[derive(Clone, Debug)]
pub(super) struct Scale {
    low: f64,
    high: f64,
    logarithmic: bool,
    /// Places on the page of `low` and `high`.
    ends: (f64, f64),
    /// Values and texts, from low to high.
    pub ticks: Vec<(f64, String)>,
}

/// The range of values that an axis has to show.
pub(super) struct Extent {
    pub low: f64,
    pub high: f64,
}

impl Extent {
    /// The extent of all finite values; 0 to 1 where there are none.
    pub(super) fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut extent = Self {
            low: f64::INFINITY,
            high: f64::NEG_INFINITY,
        };
        for value in values.filter(|value| value.is_finite()) {
            extent.low = extent.low.min(value);
            extent.high = extent.high.max(value);
        }
        if extent.low > extent.high {
            extent = Self {
                low: 0.0,
                high: 1.0,
            };
        }
        extent
    }
}

impl Scale {
    /// A linear scale whose limits are moved out to the nearest tick.
    pub(super) fn linear(extent: &Extent, ends: (f64, f64), wanted_ticks: usize) -> Self {
        let (mut low, mut high) = (extent.low, extent.high);
        if low == high {
            let margin = if low == 0.0 { 1.0 } else { low.abs() * 0.5 };
            (low, high) = (low - margin, high + margin);
        }
        let step = nice_step((high - low) / wanted_ticks as f64);
        let first = (low / step + 1e-9).floor();
        let last = (high / step - 1e-9).ceil();
        let decimals = decimals(step);
        let ticks: Vec<_> = (0..=(last - first) as usize)
            .map(|k| {
                let value = (first + k as f64) * step;
                (value, number(value, decimals))
            })
            .collect();
        Self {
            low: first * step,
            high: last * step,
            logarithmic: false,
            ends,
            ticks,
        }
    }

    /// A linear scale that ends where the data end.
    pub(super) fn trimmed(mut self, extent: &Extent) -> Self {
        if extent.low < extent.high {
            (self.low, self.high) = (extent.low, extent.high);
            let slack = (self.high - self.low) * 1e-9;
            self.ticks
                .retain(|(value, _)| (extent.low - slack..=extent.high + slack).contains(value));
        }
        self
    }

    /// A scale with ticks at given values, and a margin outside the first and the last.
    pub(super) fn at_values(
        values: &[f64],
        texts: Vec<String>,
        ends: (f64, f64),
        margin: f64,
    ) -> Self {
        let extent = Extent::of(values.iter().copied());
        let gap = if extent.high > extent.low {
            (extent.high - extent.low) * margin
        } else {
            0.5
        };
        Self {
            low: extent.low - gap,
            high: extent.high + gap,
            logarithmic: false,
            ends,
            ticks: values.iter().copied().zip(texts).collect(),
        }
    }

    /// A logarithmic scale, with ticks at 1, 2 and 5 where it spans few decades.
    pub(super) fn logarithmic(extent: &Extent, ends: (f64, f64)) -> Self {
        let low = extent.low.max(f64::MIN_POSITIVE);
        let high = extent.high.max(low * 1.0001);
        let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
        let digits: &[f64] = if last - first <= 3 {
            &[1.0, 2.0, 5.0]
        } else {
            &[1.0]
        };
        let mut ticks = Vec::new();
        for exponent in first..=last {
            for digit in digits {
                let value = digit * 10_f64.powi(exponent);
                if value >= low * 0.999 && value <= high * 1.001 {
                    let decimals = if exponent < 0 {
                        exponent.unsigned_abs() as usize
                    } else {
                        0
                    };
                    ticks.push((value, number(value, decimals)));
                }
            }
        }
        Self {
            low,
            high,
            logarithmic: true,
            ends,
            ticks,
        }
    }

    pub(super) fn place(&self, value: f64) -> f64 {
        let share = if self.logarithmic {
            (value.max(f64::MIN_POSITIVE) / self.low).log10() / (self.high / self.low).log10()
        } else {
            (value - self.low) / (self.high - self.low)
        };
        self.ends.0 + share * (self.ends.1 - self.ends.0)
    }

    /// The foot of the bars: zero if it is on the axis, otherwise the end nearest to zero.
    pub(super) fn base(&self) -> f64 {
        if self.logarithmic {
            self.low
        } else {
            0.0_f64.clamp(self.low, self.high)
        }
    }
}

/// The step of 1, 2, 2.5 or 5 times a power of ten whose ratio to the raw step is the smallest.
fn nice_step(raw: f64) -> f64 {
    let decade = 10_f64.powf(raw.log10().floor());
    [1.0, 2.0, 2.5, 5.0, 10.0]
        .into_iter()
        .map(|digit| digit * decade)
        .min_by(|a, b| (a / raw).ln().abs().total_cmp(&(b / raw).ln().abs()))
        .unwrap_or(decade)
}

fn decimals(step: f64) -> usize {
    (0..9)
        .find(|digits| {
            let scaled = step * 10_f64.powi(*digits);
            (scaled - scaled.round()).abs() < 1e-6 * scaled.abs()
        })
        .unwrap_or(9) as usize
}

/// Formats a number with a minus sign and grouped thousands from 10 000 on, without negative zero.
pub(super) fn number(value: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.abs());
    let (whole, fraction) = text.split_at(text.find('.').unwrap_or(text.len()));
    let mut grouped = String::new();
    for (k, digit) in whole.chars().enumerate() {
        if whole.len() > 4 && k > 0 && (whole.len() - k) % 3 == 0 {
            grouped.push('\u{a0}');
        }
        grouped.push(digit);
    }
    let negative = value < 0.0 && text.chars().any(|c| c.is_ascii_digit() && c != '0');
    format!("{}{grouped}{fraction}", if negative { "−" } else { "" })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(scale: &Scale) -> Vec<&str> {
        scale.ticks.iter().map(|(_, text)| text.as_str()).collect()
    }

    #[test]
    fn ticks_are_round_and_hold_the_data() {
        let scale = Scale::linear(
            &Extent {
                low: 3.0,
                high: 97.0,
            },
            (0.0, 100.0),
            5,
        );
        assert_eq!(texts(&scale), ["0", "20", "40", "60", "80", "100"]);
        assert_eq!((scale.place(0.0), scale.place(100.0)), (0.0, 100.0));
        let scale = Scale::linear(
            &Extent {
                low: -0.11,
                high: 0.4,
            },
            (0.0, 1.0),
            5,
        );
        assert_eq!(
            texts(&scale),
            ["−0.2", "−0.1", "0.0", "0.1", "0.2", "0.3", "0.4"]
        );
        let scale = Scale::linear(
            &Extent {
                low: 0.0,
                high: 1.0,
            },
            (0.0, 1.0),
            4,
        );
        assert_eq!(texts(&scale), ["0.00", "0.25", "0.50", "0.75", "1.00"]);
    }

    #[test]
    fn a_single_value_still_has_an_axis() {
        for value in [0.0, -3.0, 1e-9, 7e12] {
            let scale = Scale::linear(
                &Extent {
                    low: value,
                    high: value,
                },
                (0.0, 100.0),
                5,
            );
            assert!(scale.ticks.len() >= 2);
            assert!((0.0..=100.0).contains(&scale.place(value)), "{value}");
        }
    }

    #[test]
    fn decades_are_equally_far_apart() {
        let scale = Scale::logarithmic(
            &Extent {
                low: 1.0,
                high: 10_000.0,
            },
            (0.0, 400.0),
        );
        assert_eq!(texts(&scale), ["1", "10", "100", "1000", "10\u{a0}000"]);
        assert!((scale.place(100.0) - 200.0).abs() < 1e-9);
    }

    #[test]
    fn numbers_read_well() {
        assert_eq!(number(-1234.5, 1), "−1234.5");
        assert_eq!(number(1_234_567.0, 0), "1\u{a0}234\u{a0}567");
        assert_eq!(number(-0.0001, 2), "0.00");
    }
}
