//! Geometry of fleets on the grid, for baselines and planners: meeting points, and lines abreast
//! that sweep the grid.

use jcas_core::{Cell, Config};

/// The maximum number of lines, and of strips that a line sweeps one after the other.
pub const LINES_MAX: u32 = 4;
/// The maximum spread of a line, in thirds of the width of its strip. A spread of 0 is a flock.
pub const THIRDS_MAX: u32 = 3;

/// Returns the cell where a fleet meets soonest. It is the centre in Manhattan distance, with the
/// least distance to the farthest UAV.
///
/// With u = x + y and v = x - y, Manhattan distance is the larger of the two differences. The
/// centre is then that of the bounding box. Where it is no cell, the best cell around it is taken.
/// Among equals that is the one with the least total distance, then the first.
#[must_use]
pub fn meeting_cell(cells: impl Iterator<Item = Cell> + Clone, width: u32, height: u32) -> Cell {
    let middle = |of: fn(i64, i64) -> i64| {
        let (mut low, mut high) = (i64::MAX, i64::MIN);
        for cell in cells.clone() {
            let value = of(i64::from(cell.x), i64::from(cell.y));
            low = low.min(value);
            high = high.max(value);
        }
        if low > high {
            0
        } else {
            (low + high).div_euclid(2)
        }
    };
    let (u, v) = (middle(|x, y| x + y), middle(|x, y| x - y));
    let (x, y) = ((u + v).div_euclid(2), (u - v).div_euclid(2));
    let (mut best, mut least) = (Cell::default(), (u32::MAX, u64::MAX));
    for dx in -1..=1 {
        for dy in -1..=1 {
            let centre = Cell {
                x: (x + dx).max(0).min(i64::from(width) - 1) as u32,
                y: (y + dy).max(0).min(i64::from(height) - 1) as u32,
            };
            let (mut most, mut sum) = (0, 0);
            for cell in cells.clone() {
                let distance = cell.manhattan(centre);
                most = most.max(distance);
                sum += u64::from(distance);
            }
            if (most, sum) < least {
                (best, least) = (centre, (most, sum));
            }
        }
    }
    best
}

/// Adds an event of probability p to the chances that exactly k events happen, for each k of the
/// slice.
pub fn one_more(exactly: &mut [f64], p: f64) {
    for k in (1..exactly.len()).rev() {
        exactly[k] = exactly[k] * (1.0 - p) + exactly[k - 1] * p;
    }
    if let Some(none) = exactly.first_mut() {
        *none *= 1.0 - p;
    }
}

/// A formation: lines of UAVs abreast, each with a band of the grid that it sweeps strip by strip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Formation {
    /// Number of lines.
    pub lines: u32,
    /// Number of strips of a band.
    pub strips: u32,
    /// Width of a line, in thirds of that of its strip.
    pub thirds: u32,
}

impl Formation {
    /// Returns all formations of a number of UAVs on a grid, the simplest first.
    pub fn all(config: &Config, uavs: usize) -> impl Iterator<Item = Self> + use<> {
        let Grid { across, along, .. } = Grid::of(config);
        let within = |extent: i64| LINES_MAX.min(extent as u32);
        let (lines_max, strips_max) = (within(along.min(uavs as i64)), within(across));
        (1..=lines_max).flat_map(move |lines| {
            (1..=strips_max).flat_map(move |strips| {
                (0..=THIRDS_MAX).map(move |thirds| Self {
                    lines,
                    strips,
                    thirds,
                })
            })
        })
    }

    /// Returns the lines of a fleet that starts in a cell. Each begins at the end of its band that
    /// is nearer to the start.
    pub fn ranks(
        self,
        config: &Config,
        start: Cell,
        uavs: usize,
    ) -> impl Iterator<Item = Rank> + use<> {
        let grid = Grid::of(config);
        let start = i64::from(if grid.transposed { start.x } else { start.y });
        let lines = i64::from(self.lines);
        (0..lines).map(move |line| {
            let share = |end: i64| end as usize * uavs / lines as usize;
            let (low, high) = (line * grid.along / lines, (line + 1) * grid.along / lines);
            Rank {
                grid,
                formation: self,
                first: share(line),
                count: share(line + 1) - share(line),
                low,
                high,
                near_first: (start - low).abs() <= (start - (high - 1)).abs(),
                next: 0,
                forward: true,
            }
        })
    }
}

/// The grid as a sweep sees it.
#[derive(Clone, Copy, Debug)]
struct Grid {
    /// The width across the sweep, and the length along it, in cells.
    across: i64,
    along: i64,
    /// Whether x runs along the sweep.
    transposed: bool,
}

impl Grid {
    fn of(config: &Config) -> Self {
        let (width, height) = (config.grid_width, config.grid_height);
        Self {
            across: i64::from(width.min(height)),
            along: i64::from(width.max(height)),
            transposed: width > height,
        }
    }
}

/// A line of UAVs abreast. It flies from station to station along the strips of its band, and turns
/// back at the last one.
#[derive(Clone, Copy, Debug)]
pub struct Rank {
    grid: Grid,
    formation: Formation,
    /// The index of its first UAV, and their number.
    first: usize,
    count: usize,
    /// The ends of its band along the sweep.
    low: i64,
    high: i64,
    near_first: bool,
    next: usize,
    forward: bool,
}

impl Rank {
    /// Returns the indices of its UAVs.
    #[must_use]
    pub fn uavs(&self) -> core::ops::Range<usize> {
        self.first..self.first + self.count
    }

    /// Returns the number of its stations.
    #[must_use]
    pub fn stations(&self) -> usize {
        self.formation.strips as usize * (self.high - self.low) as usize
    }

    /// Returns its present station and whether it flies forward.
    #[must_use]
    pub fn position(&self) -> (usize, bool) {
        (self.next, self.forward)
    }

    /// Sets the present station, one of [`Rank::stations`], and the direction.
    pub fn set_position(&mut self, station: usize, forward: bool) {
        self.next = station;
        self.forward = forward;
    }

    /// Returns the cell at the present station of the UAV with an index within the line.
    #[must_use]
    pub fn place(&self, index: usize) -> Cell {
        let Grid {
            across, transposed, ..
        } = self.grid;
        let (strips, length) = (i64::from(self.formation.strips), self.high - self.low);
        let (strip, step) = (self.next as i64 / length, self.next as i64 % length);
        let x = (across * (2 * strip + 1) / (2 * strips)).min(across - 1);
        let y = if (strip % 2 == 0) == self.near_first {
            self.low + step
        } else {
            self.high - 1 - step
        };
        let count = self.count as i64;
        let twice = (2 * index as i64 - (count - 1)) * across * i64::from(self.formation.thirds);
        let offset = twice.div_euclid(2 * i64::from(THIRDS_MAX) * strips * count.max(1));
        let x = (x + offset).max(0).min(across - 1) as u32;
        let y = y as u32;
        if transposed {
            Cell { x: y, y: x }
        } else {
            Cell { x, y }
        }
    }

    /// Advances to the next station once most of its UAVs that can fly are in place. `cell` gives
    /// the cell of each UAV of the fleet that can.
    pub fn advance(&mut self, cell: impl Fn(usize) -> Option<Cell>) {
        let last = self.stations() - 1;
        let (mut flying, mut arrived) = (0, 0);
        for (index, uav) in self.uavs().enumerate() {
            if let Some(cell) = cell(uav) {
                flying += 1;
                arrived += usize::from(cell == self.place(index));
            }
        }
        if flying == 0 || 2 * arrived <= flying || last == 0 {
            return;
        }
        if self.next == if self.forward { last } else { 0 } {
            self.forward = !self.forward;
        }
        self.next = if self.forward {
            self.next + 1
        } else {
            self.next - 1
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_of_every_formation_is_on_the_grid() {
        for (width, height, uavs) in [(12, 12, 5), (1, 7, 3), (30, 2, 20)] {
            let config = Config {
                grid_width: width,
                grid_height: height,
                ..Config::default()
            };
            let mut formations = 0;
            for formation in Formation::all(&config, uavs) {
                formations += 1;
                for mut rank in formation.ranks(&config, Cell::default(), uavs) {
                    for station in 0..rank.stations() {
                        rank.set_position(station, true);
                        for index in 0..rank.uavs().len() {
                            let cell = rank.place(index);
                            assert!(cell.x < width && cell.y < height);
                        }
                    }
                }
            }
            assert!(formations >= 4 * 3, "{formations}");
        }
    }
}
