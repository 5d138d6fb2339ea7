//! The footprint of a UAV's radar: the cells in which it may raise a false alarm.

use crate::config::{Cell, Config};
use crate::radio::radar::curve::{self, AnyCurve};
use crate::words::geometry::Disc;

/// Halvings of the longest distance on a grid: more than the bits of a real's fraction.
const HALVINGS: u32 = 64;

/// The offsets of a footprint; the UAV's own cell alone without false alarms.
pub(crate) fn of(config: &Config) -> Disc {
    if config.false_alarm_per_cell > 0.0 {
        Disc::from_radius(radius_m(config), config.cell_size_m)
    } else {
        Disc::from_squared(0)
    }
}

/// The radius of a footprint: the configured one, or the sensing range if it gives the threshold.
/// Otherwise it is the range at which P_d is 0.5.
#[must_use]
pub fn radius_m(config: &Config) -> f64 {
    match (config.sensing_footprint_m, config.detection_threshold_db) {
        (Some(radius_m), _) => radius_m,
        (None, None) => config
            .sensing_range_m
            .unwrap_or_else(|| even_odds_range_m(config)),
        _ => even_odds_range_m(config),
    }
}

/// The longest range on the grid at which P_d is at least 0.5 at ρ_max, by bisection; 0 if there is
/// none.
fn even_odds_range_m(config: &Config) -> f64 {
    let curve = AnyCurve::of(config);
    let even = |range_m| {
        let tabulated = curve::tabulated(config, range_m);
        curve.probability(tabulated, config.pilot_density_max) >= 0.5
    };
    let (columns, rows) = (config.grid_width - 1, config.grid_height - 1);
    let squared = f64::from(columns) * f64::from(columns) + f64::from(rows) * f64::from(rows);
    let (mut near_m, mut far_m) = (0.0, config.cell_size_m * libm::sqrt(squared));
    if even(far_m) {
        return far_m;
    }
    for _ in 0..HALVINGS {
        let middle_m = near_m + (far_m - near_m) / 2.0;
        if even(middle_m) {
            near_m = middle_m;
        } else {
            far_m = middle_m;
        }
    }
    near_m
}

/// A row of a disc on a grid: the cells `begin..end` of row `y`.
struct Stripe {
    y: u32,
    begin: u32,
    end: u32,
}

impl Disc {
    /// The rows of the disc around a cell that lie on the grid, from below.
    fn rows(self, cell: Cell, width: u32, height: u32) -> impl Iterator<Item = Stripe> {
        let first = cell.y.saturating_sub(self.reach);
        let end = if cell.y + self.reach < height {
            cell.y + self.reach + 1
        } else {
            height
        };
        let mut half = 0;
        (first..end).map(move |y| {
            let dy = y.abs_diff(cell.y);
            while half < self.reach && (half + 1) * (half + 1) + dy * dy <= self.squared {
                half += 1;
            }
            while half > 0 && half * half + dy * dy > self.squared {
                half -= 1;
            }
            Stripe {
                y,
                begin: cell.x.saturating_sub(half),
                end: if cell.x + half < width {
                    cell.x + half + 1
                } else {
                    width
                },
            }
        })
    }

    /// Number of cells of the disc around a cell that lie on the grid.
    #[must_use]
    pub fn size(self, cell: Cell, width: u32, height: u32) -> u32 {
        let mut size = 0;
        for row in self.rows(cell, width, height) {
            size += row.end - row.begin;
        }
        size
    }

    /// The cell with a rank among those that [`Disc::size`] counts, row by row from below. The cell
    /// is the middle of the disc if there are fewer.
    // Proof: proofs/alarms.rs, a_rank_names_a_cell_of_the_footprint
    #[must_use]
    pub fn ranked(self, rank: u32, cell: Cell, width: u32, height: u32) -> Cell {
        let mut rest = rank;
        for row in self.rows(cell, width, height) {
            let length = row.end - row.begin;
            if rest < length {
                return Cell {
                    x: row.begin + rest,
                    y: row.y,
                };
            }
            rest -= length;
        }
        cell
    }

    /// Upper bound of [`Disc::size`] over the cells of a grid.
    #[must_use]
    pub fn size_max(self, width: u32, height: u32) -> u32 {
        let mut size = 0;
        let middle = Cell {
            x: self.reach,
            y: self.reach,
        };
        let side = 2 * self.reach + 1;
        for row in self.rows(middle, side, side) {
            size += row.end - row.begin;
        }
        let cells = width * height;
        if size < cells { size } else { cells }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{DetectionCurve, Preset};

    fn near(a: f64, b: f64, tolerance: f64) {
        assert!((a - b).abs() < tolerance, "{a} is not {b}");
    }

    fn noisy(preset: Preset) -> Config {
        Config {
            false_alarm_per_cell: 0.01,
            ..Config::preset(preset)
        }
    }

    #[test]
    fn the_radius_is_the_given_one_or_the_sensing_range() {
        let search = noisy(Preset::Search);
        assert_eq!(radius_m(&search), 150.0);
        let given = Config {
            sensing_footprint_m: Some(70.0),
            ..search
        };
        assert_eq!(radius_m(&given), 70.0);
        // An explicit threshold wins over the sensing range.
        let explicit = Config {
            detection_threshold_db: Some(-16.71),
            comm_load_penalty_db: 0.0,
            range_resolution_m: Some(0.0),
            ..search
        };
        near(radius_m(&explicit), 100.0, 0.05);
    }

    /// P_fa^(1/(1 + SNR)) = 0.5 at SNR = ln P_fa/ln 0.5 - 1 = 18.93 = 12.77 dB for P_fa = 1e-6. The
    /// SNR is 7.37 dB at 25 m and falls with the fourth power of the range.
    #[test]
    fn even_odds_of_a_fluctuating_echo_follow_from_its_equation() {
        let config = Config {
            detection_curve: DetectionCurve::Swerling1,
            comm_load_penalty_db: 0.0,
            range_resolution_m: Some(0.0),
            ..noisy(Preset::Mission)
        };
        let expected_m = 25.0 * libm::pow(10.0, (7.37 - 12.77) / 40.0);
        near(radius_m(&config), expected_m, 0.02);
        let deaf = Config {
            sensing_noise_dbm: 100.0,
            ..config
        };
        assert_eq!(of(&deaf), Disc::from_squared(0));
    }

    #[test]
    fn ranks_name_each_cell_of_the_disc_once() {
        let (width, height) = (6, 5);
        for squared in [0, 1, 2, 4, 9, 13, 100] {
            let disc = Disc::from_squared(squared);
            for index in 0..width * height {
                let middle = Cell {
                    x: index % width,
                    y: index / width,
                };
                let mut map = [0u64];
                disc.mark(&mut map, middle, width, height);
                let size = disc.size(middle, width, height);
                assert!(size == map[0].count_ones() && size <= disc.size_max(width, height));
                let named = (0..size).fold(0u64, |named, rank| {
                    let cell = disc.ranked(rank, middle, width, height);
                    named | 1 << (cell.y * width + cell.x)
                });
                assert_eq!(named, map[0]);
            }
        }
    }
}
