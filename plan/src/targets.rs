//! The prior of the hotspots over the cells.

use alloc::vec;
use alloc::vec::Vec;

use jcas_core::{Cell, Model};

use crate::error::PlanError;

/// A group of hotspots that share one prior.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Number of hotspots; for [`Placement::EachCell`] the number of cells that may hold one.
    pub count: u32,
    /// Probability of each cell, row by row. The sum is 1, except for [`Placement::EachCell`].
    pub weights: Vec<f64>,
    /// How the hotspots of the group lie.
    pub placement: Placement,
}

/// How the hotspots of a group lie on the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placement {
    /// The hotspots lie in distinct cells that are equally likely, as the kernel places them.
    Distinct,
    /// Each hotspot is drawn independently, from the weights.
    Drawn,
    /// Each cell holds a hotspot with the probability of its weight, independently of the others.
    EachCell,
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
                placement: Placement::Distinct,
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
                placement: Placement::Drawn,
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
        check_length(model, weights)?;
        let sum: f64 = weights.iter().sum();
        let legal = weights.iter().all(|&weight| weight >= 0.0) && sum > 0.0 && sum.is_finite();
        if !legal {
            return Err(PlanError::Weights);
        }
        Ok(Self {
            groups: vec![Group {
                count,
                weights: weights.iter().map(|weight| weight / sum).collect(),
                placement: Placement::Drawn,
            }],
        })
    }

    /// Returns hotspots that each cell holds with a probability of its own, row by row.
    ///
    /// # Errors
    /// [`PlanError::Length`] if there is not one probability for each cell. [`PlanError::Weights`]
    /// if one is not in [0, 1].
    pub fn each_cell(model: &Model<'_>, chances: &[f64]) -> Result<Self, PlanError> {
        check_length(model, chances)?;
        if !chances.iter().all(|chance| (0.0..=1.0).contains(chance)) {
            return Err(PlanError::Weights);
        }
        Ok(Self {
            groups: vec![Group {
                count: chances.iter().filter(|&&chance| chance > 0.0).count() as u32,
                weights: chances.to_vec(),
                placement: Placement::EachCell,
            }],
        })
    }

    /// Returns the groups.
    #[must_use]
    pub fn groups(&self) -> &[Group] {
        &self.groups
    }
}

/// Checks that each cell of the grid has a weight.
fn check_length(model: &Model<'_>, weights: &[f64]) -> Result<(), PlanError> {
    let expected = model.config().cell_count();
    if weights.len() == expected {
        return Ok(());
    }
    Err(PlanError::Length {
        what: "weights",
        expected,
        got: weights.len(),
    })
}

/// Returns the row-major index of a cell of the grid.
pub(crate) fn index_of(model: &Model<'_>, cell: Cell) -> usize {
    (cell.y * model.config().grid_width + cell.x) as usize
}
