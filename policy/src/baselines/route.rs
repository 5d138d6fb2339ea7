//! A short route through several cells.

use jcas_core::Cell;

use super::memory::{OutOfMemory, collect, filled};

/// The maximum number of cells with an optimal order: the table has 2^n rows.
const EXACT_MAX: usize = 11;

/// The maximum number of cells for which 2-opt improves the route: its cost grows faster than the
/// route shortens.
const IMPROVED_MAX: usize = 128;

/// Returns an order in which to visit `targets` from `start` on a short route, and its length in
/// steps. The order is optimal for few targets (M. Held and R. M. Karp, 1962). Otherwise it visits
/// the nearest cell next, improved by reversals (2-opt).
///
/// # Errors
/// [`OutOfMemory`] if memory runs out.
pub fn route(start: Cell, targets: &[Cell]) -> Result<(Vec<usize>, u32), OutOfMemory> {
    let order = if targets.len() <= EXACT_MAX {
        shortest(start, targets)?
    } else {
        let mut order = nearest_next(start, targets)?;
        if targets.len() <= IMPROVED_MAX {
            improve(start, targets, &mut order);
        }
        order
    };
    let steps = length(start, targets, &order);
    Ok((order, steps))
}

fn length(start: Cell, targets: &[Cell], order: &[usize]) -> u32 {
    let mut here = start;
    let mut steps = 0;
    for &target in order {
        steps += here.manhattan(targets[target]);
        here = targets[target];
    }
    steps
}

/// Finds the shortest order. `best[set][last]` holds the length of the shortest route through the
/// set that ends in `last`, and the cell before it.
fn shortest(start: Cell, targets: &[Cell]) -> Result<Vec<usize>, OutOfMemory> {
    let count = targets.len();
    let mut best = filled((u32::MAX, usize::MAX), (1 << count) * count)?;
    for (last, &target) in targets.iter().enumerate() {
        best[(1 << last) * count + last].0 = start.manhattan(target);
    }
    for set in 1usize..1 << count {
        for last in (0..count).filter(|last| set >> last & 1 == 1) {
            let (steps, _) = best[set * count + last];
            for next in (0..count).filter(|next| set >> next & 1 == 0) {
                let longer = steps.saturating_add(targets[last].manhattan(targets[next]));
                let entry = &mut best[(set | 1 << next) * count + next];
                if longer < entry.0 {
                    *entry = (longer, last);
                }
            }
        }
    }
    let mut set = (1 << count) - 1;
    let mut order = filled(0, count)?;
    let mut last = (0..count).min_by_key(|&last| best[set * count + last].0);
    for place in order.iter_mut().rev() {
        let Some(target) = last else { break };
        *place = target;
        let (_, before) = best[set * count + target];
        set &= !(1 << target);
        last = (before < count).then_some(before);
    }
    Ok(order)
}

fn nearest_next(start: Cell, targets: &[Cell]) -> Result<Vec<usize>, OutOfMemory> {
    let mut left = collect(0..targets.len())?;
    let mut order = filled(0, targets.len())?;
    let mut here = start;
    for place in &mut order {
        let nearest =
            (0..left.len()).min_by_key(|&position| here.manhattan(targets[left[position]]));
        let Some(position) = nearest else { break };
        *place = left.remove(position);
        here = targets[*place];
    }
    Ok(order)
}

/// Reverses sections of the route while that shortens it. A pass visits all sections, and the
/// number of passes is at most that of the targets.
fn improve(start: Cell, targets: &[Cell], order: &mut [usize]) {
    let cell = |order: &[usize], position: usize| targets[order[position]];
    for _ in 0..order.len() {
        let mut improved = false;
        for from in 0..order.len() {
            let before = if from == 0 {
                start
            } else {
                cell(order, from - 1)
            };
            for to in from + 1..order.len() {
                let mut old = before.manhattan(cell(order, from));
                let mut new = before.manhattan(cell(order, to));
                if to + 1 < order.len() {
                    old += cell(order, to).manhattan(cell(order, to + 1));
                    new += cell(order, from).manhattan(cell(order, to + 1));
                }
                if new < old {
                    order[from..=to].reverse();
                    improved = true;
                }
            }
        }
        if !improved {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use jcas_core::rng::{Purpose, below, bits64};

    use super::*;

    fn cells(seed: u64, count: u32) -> Vec<Cell> {
        let draw = |k, axis| below(bits64(seed, k, 0, axis, Purpose::Policy), 12) as u32;
        (0..count)
            .map(|k| Cell {
                x: draw(k, 0),
                y: draw(k, 1),
            })
            .collect()
    }

    fn permutations(
        left: &mut Vec<usize>,
        order: &mut Vec<usize>,
        visit: &mut impl FnMut(&[usize]),
    ) {
        if left.is_empty() {
            visit(order);
        }
        for position in 0..left.len() {
            order.push(left.remove(position));
            permutations(left, order, visit);
            left.insert(position, order.pop().unwrap());
        }
    }

    #[test]
    fn few_targets_are_visited_by_the_shortest_way() {
        let start = Cell { x: 6, y: 6 };
        for seed in 0..20 {
            let targets = cells(seed, 6);
            let mut least = u32::MAX;
            permutations(&mut (0..6).collect(), &mut Vec::new(), &mut |order| {
                least = least.min(length(start, &targets, order));
            });
            assert_eq!(route(start, &targets).unwrap().1, least);
        }
    }

    #[test]
    fn every_target_is_visited_once_and_improving_never_lengthens() {
        let start = Cell { x: 0, y: 0 };
        for seed in 0..20 {
            let targets = cells(seed, 40);
            let (mut order, steps) = route(start, &targets).unwrap();
            let nearest = nearest_next(start, &targets).unwrap();
            let first = length(start, &targets, &nearest);
            assert!(steps <= first, "{steps} {first}");
            order.sort_unstable();
            assert!(order.into_iter().eq(0..40));
        }
    }

    #[test]
    fn no_target_needs_no_step() {
        assert_eq!(route(Cell { x: 1, y: 1 }, &[]), Ok((Vec::new(), 0)));
    }
}
