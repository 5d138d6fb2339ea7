//! Parts of a long computation for several machines.

use core::fmt;
use core::str::FromStr;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

/// The i-th of n parts, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// i.
    pub number: usize,
    /// n.
    pub count: usize,
}

/// must be i/n with 1 <= i <= n, such as 2/8
#[derive(Clone, Copy, Debug, PartialEq, Eq, displaydoc::Display, thiserror::Error)]
pub struct NotAShard;

impl FromStr for Shard {
    type Err = NotAShard;

    fn from_str(text: &str) -> Result<Self, NotAShard> {
        text.split_once('/')
            .and_then(|(number, count)| {
                Some(Self {
                    number: number.parse().ok()?,
                    count: count.parse().ok()?,
                })
            })
            .filter(Shard::is_valid)
            .ok_or(NotAShard)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}/{}", self.number, self.count)
    }
}

impl Shard {
    /// The only part.
    pub const WHOLE: Self = Self {
        number: 1,
        count: 1,
    };

    /// Whether 1 ≤ i ≤ n.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        (1..=self.count).contains(&self.number)
    }

    /// The indices of its cells: every n-th, since neighbours in the grid cost alike.
    pub fn cells(&self, cells_in_all: usize) -> impl Iterator<Item = usize> + use<> {
        (self.number - 1..cells_in_all).step_by(self.count)
    }

    /// The number of its cells.
    #[must_use]
    pub const fn cell_count(&self, cells_in_all: usize) -> usize {
        cells_in_all
            .saturating_sub(self.number - 1)
            .div_ceil(self.count)
    }

    /// The name of its files, without what follows.
    #[must_use]
    pub fn stem(&self) -> String {
        format!("shard-{}-of-{}", self.number, self.count)
    }

    /// The path of its manifest.
    #[must_use]
    pub fn manifest_path(&self, folder: &Path) -> PathBuf {
        folder.join(self.stem() + ".json")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_hold_every_cell_once() {
        for count in 1..=8 {
            let parts = (1..=count).map(|number| Shard { number, count });
            let mut cells: Vec<usize> = parts
                .flat_map(|part| {
                    assert_eq!(part.cells(5).count(), part.cell_count(5), "{part}");
                    part.cells(5)
                })
                .collect();
            cells.sort_unstable();
            assert_eq!(cells, [0, 1, 2, 3, 4], "{count}");
        }
        let second: Vec<usize> = Shard {
            number: 2,
            count: 3,
        }
        .cells(8)
        .collect();
        assert_eq!(second, [1, 4, 7]);
    }

    #[test]
    fn a_part_counts_from_one_to_the_number_of_parts() {
        assert_eq!(
            "3/3".parse(),
            Ok(Shard {
                number: 3,
                count: 3
            })
        );
        for text in ["0/3", "4/3", "0/0", "1", "1/", "/2", "-1/2", "1/2/3", "a/b"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
