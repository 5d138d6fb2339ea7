//! The reach of a radar, and a curve that stands for its chance of detection.

use jcas_core::Model;

/// The limits of a reach, in cells. A cell has a radius of about 0.5.
const REACH_CELLS: [f64; 2] = [0.5, 32.0];

/// Returns the range in cells at which P_d is a half at ρ_max, along the longer side of the grid.
///
/// It is interpolated between the middles of cells, and lies in [0.5, 32]. The kernel bisects for
/// the exact range of a footprint, which would take too long before each action.
#[must_use]
pub fn reach_cells(model: &Model<'_>) -> f32 {
    let config = model.config();
    let wide = config.grid_width >= config.grid_height;
    let side = if wide {
        config.grid_width
    } else {
        config.grid_height
    };
    let [least, most] = REACH_CELLS;
    let chance = |cells: u32| {
        let (dx, dy) = if wide { (cells, 0) } else { (0, cells) };
        model.detection_probability(dx, dy, config.pilot_density_max)
    };
    let mut reach = most;
    let mut before = chance(0);
    for cells in 1..side.min(most as u32) {
        let after = chance(cells);
        if after < 0.5 {
            let past = f64::from(cells) - (0.5 - after) / (before - after);
            reach = if before < 0.5 { least } else { past };
            break;
        }
        before = after;
    }
    reach.clamp(least, most) as f32
}

/// Returns 1/(1 + (d/R)⁴) for a distance of `dx` and `dy` cells and a reach R.
///
/// An echo falls with the fourth power of the range, and at R the chance is a half. With a logistic
/// curve of slope 0.23 per dB the formula is P_d at ρ_max.
#[must_use]
pub fn chance(dx: f32, dy: f32, reach: f32) -> f32 {
    let squared = (dx * dx + dy * dy) / (reach * reach);
    1.0 / (1.0 + squared * squared)
}

#[cfg(test)]
mod tests {
    use super::*;
    use jcas_core::{Config, Preset};

    fn reach(range_m: f64, grid: [u32; 2]) -> f32 {
        let model = Model::new(Config {
            sensing_range_m: Some(range_m),
            grid_width: grid[0],
            grid_height: grid[1],
            ..Config::preset(Preset::Paper)
        })
        .unwrap();
        reach_cells(&model)
    }

    // Without a load P_d is a half at the sensing range; cells are 50 m wide. The load at ρ_max
    // costs 0.7 dB.
    #[test]
    fn the_reach_is_the_sensing_range() {
        for (range_m, cells) in [(100.0, 2.0), (150.0, 3.0), (187.5, 3.75), (350.0, 7.0)] {
            for grid in [[12, 12], [3, 12]] {
                let got = reach(range_m, grid);
                assert!((got / cells - 0.96).abs() < 0.02, "{range_m} m: {got}");
            }
        }
        assert_eq!(reach(1.0, [12, 12]), 0.5);
        assert_eq!(reach(1500.0, [12, 12]), 32.0);
    }

    #[test]
    fn the_chance_is_near_that_of_the_radar() {
        let model = Model::new(Config::preset(Preset::Paper)).unwrap();
        let reach = reach_cells(&model);
        for dx in 0..12 {
            for dy in 0..12 {
                let radar = model.detection_probability(dx, dy, model.config().pilot_density_max);
                let near = chance(dx as f32, dy as f32, reach);
                assert!(
                    (f64::from(near) - radar).abs() < 0.03,
                    "{dx} {dy}: {near} {radar}"
                );
            }
        }
    }
}
