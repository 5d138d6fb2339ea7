//! The prior of the hotspots over the cells.

use alloc::vec;
use alloc::vec::Vec;

use jcas_core::{Cell, Model};

use crate::error::PlanError;

/// A group of hotspots that share one prior.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Number of hotspots.
    pub count: u32,
    /// Probability of each cell, row by row; the sum is 1.
    pub weights: Vec<f64>,
    /// Whether the hotspots lie in distinct cells that are equally likely, as the kernel places
    /// them. Otherwise each hotspot is drawn independently.
    pub distinct: bool,
}

/// The hotspots to confirm, as groups that are independent of each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Targets {
    groups: Vec<Group>,
}

impl Targets {
    /// Returns the model's own prior: all hotspots are hidden in distinct cells without a depot,
    /// and each set is equally likely.
    #[must_use]
    pub fn hidden(model: &Model<'_>) -> Self {
        let config = model.config();
        let mut weights = vec![1.0; config.cell_count()];
        for depot in model.depots() {
            weights[index_of(model, *depot)] = 0.0;
        }
        let share = 1.0 / (config.cell_count() - model.depots().len()) as f64;
        for weight in &mut weights {
            *weight *= share;
        }
        Self {
            groups: vec![Group {
                count: config.hotspot_count,
                weights,
                distinct: true,
            }],
        }
    }

    /// Returns hotspots in known cells.
    ///
    /// # Errors
    /// [`PlanError::OffGrid`] if a cell lies off the grid.
    pub fn known(model: &Model<'_>, cells: &[Cell]) -> Result<Self, PlanError> {
        let config = model.config();
        let groups = cells.iter().map(|&cell| {
            if cell.x >= config.grid_width || cell.y >= config.grid_height {
                return Err(PlanError::OffGrid {
                    x: cell.x,
                    y: cell.y,
                });
            }
            let mut weights = vec![0.0; config.cell_count()];
            weights[index_of(model, cell)] = 1.0;
            Ok(Group {
                count: 1,
                weights,
                distinct: false,
            })
        });
        Ok(Self {
            groups: groups.collect::<Result<_, _>>()?,
        })
    }

    /// Hotspots that are drawn independently, each from a prior with these weights, one for each
    /// cell, row by row. The weights need not sum to 1.
    ///
    /// # Errors
    /// [`PlanError::Length`] if a prior has another length than the grid. [`PlanError::Weights`] if
    /// a weight is negative or not finite, or if all are zero.
    pub fn weighted(model: &Model<'_>, count: u32, weights: &[f64]) -> Result<Self, PlanError> {
        let expected = model.config().cell_count();
        if weights.len() != expected {
            return Err(PlanError::Length {
                what: "weights",
                expected,
                got: weights.len(),
            });
        }
        let sum: f64 = weights.iter().sum();
        let legal = weights.iter().all(|&weight| weight >= 0.0) && sum > 0.0 && sum.is_finite();
        if !legal {
            return Err(PlanError::Weights);
        }
        Ok(Self {
            groups: vec![Group {
                count,
                weights: weights.iter().map(|weight| weight / sum).collect(),
                distinct: false,
            }],
        })
    }

    /// Returns the groups.
    #[must_use]
    pub fn groups(&self) -> &[Group] {
        &self.groups
    }
}

/// Returns the row-major index of a cell of the grid.
pub(crate) fn index_of(model: &Model<'_>, cell: Cell) -> usize {
    (cell.y * model.config().grid_width + cell.x) as usize
}
