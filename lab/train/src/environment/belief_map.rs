//! The critic's map of a search: where hotspots may still be, and where the UAVs are.

use jcas_core::{Model, StateRef};

/// Upper bound of the cells along each axis. On larger grids, several cells share one.
const AXIS_MAX: u32 = 32;
/// Value that a UAV adds to its cell.
const UAV: f32 = 0.5;

/// Maps of several episodes: the chances of all cells, scaled to a maximum of 1, then the UAVs of
/// all cells.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchBeliefMap {
    /// Cells of the grid along each axis that are drawn as one.
    side: u32,
    /// Cells of a map along each axis.
    axes: [u32; 2],
    maps: Vec<f32>,
}

impl SearchBeliefMap {
    /// Empty maps for `missions` episodes.
    pub fn new(missions: usize, model: &Model<'_>) -> SearchBeliefMap {
        let config = model.config();
        let grid = [config.grid_width, config.grid_height];
        let side = grid[0].max(grid[1]).div_ceil(AXIS_MAX);
        let axes = grid.map(|cells| cells.div_ceil(side));
        let floats = missions * 2 * (axes[0] * axes[1]) as usize;
        SearchBeliefMap {
            side,
            axes,
            maps: vec![0.0; floats],
        }
    }

    /// Number of floats of a map.
    pub fn map_len(&self) -> usize {
        2 * (self.axes[0] * self.axes[1]) as usize
    }

    /// The maps last drawn, one for each episode.
    pub fn maps(&self) -> &[f32] {
        &self.maps
    }

    /// Draws the map of an episode. `missed` has, for each cell of the grid, the chance that a
    /// hotspot there is not confirmed yet.
    pub fn draw(
        &mut self,
        mission: usize,
        model: &Model<'_>,
        state: &StateRef<'_>,
        missed: &[f64],
    ) {
        let (len, width) = (self.map_len(), model.config().grid_width);
        let [side, across] = [self.side, self.axes[0]];
        let drawn_at = |x: u32, y: u32| (y / side * across + x / side) as usize;
        let map = &mut self.maps[mission * len..(mission + 1) * len];
        map.fill(0.0);
        let (open, uavs) = map.split_at_mut(len / 2);
        let most = missed
            .iter()
            .fold(f64::MIN_POSITIVE, |most, &x| most.max(x));
        let most = most * f64::from(side * side);
        for (index, missed) in (0..).zip(missed) {
            open[drawn_at(index % width, index / width)] += (missed / most) as f32;
        }
        for uav in 0..model.uav_count() {
            let cell = state.cell(uav);
            uavs[drawn_at(cell.x, cell.y)] += UAV;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jcas_core::{Cell, Config, Preset, Sim};

    fn drawn(width: u32, height: u32, starts: &[Cell], missed: &[f64]) -> SearchBeliefMap {
        let config = Config {
            grid_width: width,
            grid_height: height,
            uav_count: starts.len() as u32,
            ..Config::preset(Preset::Search)
        };
        let model = Model::new(config).unwrap();
        let mut sim = Sim::new(&model);
        sim.reset(1);
        sim.set_starts(starts).unwrap();
        let mut survey = SearchBeliefMap::new(2, &model);
        survey.draw(1, &model, &sim.state(), missed);
        survey
    }

    #[test]
    fn a_cell_is_drawn_where_it_is() {
        let mut missed = [0.1; 20];
        missed[7] = 0.4; // x = 2, y = 1
        let here = Cell { x: 3, y: 2 };
        let survey = drawn(5, 4, &[here, here, Cell { x: 0, y: 3 }], &missed);
        assert_eq!(survey.map_len(), 40);
        let (before, map) = survey.maps().split_at(40);
        assert!(before.iter().all(|&x| x == 0.0), "the other mission");
        for (index, &open) in map[..20].iter().enumerate() {
            assert_eq!(open, if index == 7 { 1.0 } else { 0.25 });
        }
        for (index, &uavs) in map[20..].iter().enumerate() {
            let expected = match index {
                13 => 1.0,
                15 => 0.5,
                _ => 0.0,
            };
            assert_eq!(uavs, expected, "{index}");
        }
    }

    #[test]
    fn a_large_grid_is_drawn_coarsely() {
        let starts = [
            Cell { x: 99, y: 41 },
            Cell { x: 0, y: 0 },
            Cell { x: 3, y: 3 },
        ];
        let survey = drawn(100, 42, &starts, &[0.5; 4200]);
        let cells = 25 * 11;
        assert_eq!(survey.map_len(), 2 * cells);
        let map = &survey.maps()[2 * cells..];
        assert!((map[0] - 1.0).abs() < 1e-6);
        assert!(
            (map[cells - 1] - 0.5).abs() < 1e-6,
            "half of it is off the grid"
        );
        assert_eq!([map[cells], map[2 * cells - 1]], [1.0, 0.5]);
    }
}
