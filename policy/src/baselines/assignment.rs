//! The assignment of rows to columns with the least total cost (H. W. Kuhn, 1955; J. Munkres,
//! 1957).

use super::memory::{OutOfMemory, collect, filled};

/// A marker for no row and no column.
const NONE: usize = usize::MAX;

/// Returns the column of each row of a square matrix of costs, given row by row, with the least
/// sum. Among several solutions it returns the one built row by row along the first column of least
/// slack.
///
/// The time grows with the cube of the number of rows.
pub(super) fn cheapest(costs: &[i64], size: usize) -> Result<Vec<usize>, OutOfMemory> {
    let cost = |row: usize, column: usize| costs[row * size + column];
    let mut column_of = filled(NONE, size)?;
    let mut row_of = filled(NONE, size)?;
    // The price of a row plus the price of a column is at most the cost. They equal it where the
    // two are matched.
    let least = (0..size).map(|row| (0..size).map(|column| cost(row, column)).min().unwrap_or(0));
    let mut row_price = collect(least)?;
    let mut column_price = filled(0, size)?;
    let mut rows = Vec::new();
    rows.try_reserve_exact(size)?;
    // Each column has the row that it is reached from, or its least slack so far and the row of
    // that slack.
    let mut reached_from = filled(NONE, size)?;
    let mut slack = filled(0, size)?;
    let mut slack_from = filled(NONE, size)?;
    for root in 0..size {
        rows.clear();
        rows.push(root);
        reached_from.fill(NONE);
        slack_from.fill(root);
        for column in 0..size {
            slack[column] = cost(root, column) - row_price[root] - column_price[column];
        }
        let mut column = loop {
            let (mut delta, mut next) = (i64::MAX, 0);
            for column in 0..size {
                if reached_from[column] == NONE && slack[column] < delta {
                    (delta, next) = (slack[column], column);
                }
            }
            if delta > 0 {
                for &row in &rows {
                    row_price[row] += delta;
                }
                for column in 0..size {
                    if reached_from[column] == NONE {
                        slack[column] -= delta;
                    } else {
                        column_price[column] -= delta;
                    }
                }
            }
            reached_from[next] = slack_from[next];
            let row = row_of[next];
            if row == NONE {
                break next;
            }
            rows.push(row);
            for column in 0..size {
                if reached_from[column] == NONE {
                    let other = cost(row, column) - row_price[row] - column_price[column];
                    if other < slack[column] {
                        (slack[column], slack_from[column]) = (other, row);
                    }
                }
            }
        };
        // Every row along the way moves up by one column.
        while column != NONE {
            let row = reached_from[column];
            let before = column_of[row];
            row_of[column] = row;
            column_of[row] = column;
            column = before;
        }
    }
    Ok(column_of)
}

#[cfg(test)]
mod tests {
    use pathfinding::matrix::Matrix;
    use pathfinding::prelude::kuhn_munkres_min;
    use proptest::prelude::*;

    use super::cheapest;

    proptest! {
        /// The test draws from few different costs, so that several assignments share the least
        /// cost.
        #[test]
        fn of_the_cheapest_it_is_that_of_the_textbook(
            size in 1usize..12,
            most in 1i64..20,
            draws in prop::collection::vec(any::<u32>(), 144),
        ) {
            let draws = draws[..size * size].iter();
            let costs: Vec<i64> = draws.map(|&x| i64::from(x) % most).collect();
            let matrix = Matrix::from_vec(size, size, costs.clone()).unwrap();
            prop_assert_eq!(cheapest(&costs, size).unwrap(), kuhn_munkres_min(&matrix).1);
        }
    }
}
