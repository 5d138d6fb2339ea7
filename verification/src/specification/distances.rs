//! Values of two cells that depend only on their distance.

use super::Position;
use jcas_core::Config;

/// A function of the range R, evaluated for every distance that two cells of a grid can have.
#[derive(Clone, Debug)]
pub struct ByDistance {
    /// The values by squared distance in cells. An entry is NaN where no two cells have that
    /// distance.
    values: Vec<f64>,
}

impl ByDistance {
    /// Evaluates `value(config, range_m)` for every distance.
    pub fn new(config: &Config, value: fn(&Config, f64) -> f64) -> Self {
        let mut values = Vec::new();
        for dy in 0..i64::from(config.grid_height) {
            for dx in 0..i64::from(config.grid_width) {
                let squared = (dx * dx + dy * dy) as usize;
                if values.len() <= squared {
                    values.resize(squared + 1, f64::NAN);
                }
                if values[squared].is_nan() {
                    values[squared] = value(config, range_m(config, squared));
                }
            }
        }
        ByDistance { values }
    }

    /// Returns the value for two cells of the grid.
    pub fn between(&self, a: Position, b: Position) -> f64 {
        self.values[a.squared(b) as usize]
    }
}

/// R = max(R_min, d·√(Δx² + Δy²)), R_min half a cell unless given.
fn range_m(config: &Config, squared: usize) -> f64 {
    let least = config.range_min_m.unwrap_or(config.cell_size_m / 2.0);
    let range = config.cell_size_m * libm::sqrt(squared as f64);
    if range < least { least } else { range }
}
