//! What the members of a radio component may infer about hidden hotspots.
//!
//! The members know where each of them was in each step, and at which pilot density it sensed. They
//! also know their reports, and each other UAV's observations up to the last contact with it. No
//! hotspot that they search for has been confirmed by these observations.
//!
//! Let λ_c be the probability of all this if cell c holds a hotspot, divided by that if it does
//! not. Cells are independent once it is given which of them hold hotspots. So a set S of n
//! distinct cells has the probability Π λ_c over c in S, up to a factor. The chance of a cell,
//!
//! ```text
//! π_c = λ_c e_(n-1)(λ without λ_c) / e_n(λ)
//! ```
//!
//! with the elementary symmetric polynomials e, is computed exactly.
//!
//! Without reports λ_c is the chance M that no step had a quorum. With them, let C(ℓ) be the chance
//! that no UAV has seen a hotspot in c in more than ℓ steps. It is a product over the UAVs. The
//! report's level is ℓ with probability C(ℓ) - C(ℓ-1) if c holds none. If it holds one, level 0 has
//! the probability C(0), which includes that no step had a quorum. The other levels share the rest,
//! M - C(0), in the ratio of their C(ℓ) - C(ℓ-1). That ratio is exact if a quorum is as rare for
//! one of these levels as for another; all else is exact.

use alloc::vec;
use alloc::vec::Vec;

use jcas_core::{Cell, Model, StateRef};
use jcas_policy::geometry::one_more;

use crate::objective::fewer_than;
use crate::odds::Odds;

/// Halvings of the interval in which the scale of the odds lies.
const HALVINGS: u32 = 60;
/// The range of the scale of the odds, as a power of two.
const SCALE_MAX: f64 = 1000.0;

/// Where a UAV was in a step, and the level at which it sensed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Observation {
    pub(crate) cell: Cell,
    pub(crate) level: u8,
}

/// The observations of a UAV, step by step, as the members of a component know them.
#[derive(Clone, Debug)]
pub(crate) struct Observations<'l> {
    /// Observations that the members have received.
    pub(crate) received: &'l [Observation],
    /// Observations since then that the members only assume.
    pub(crate) assumed: &'l [Observation],
}

/// Probabilities of what is known about a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Likelihood {
    /// If the cell holds a hotspot.
    hotspot: f64,
    /// If it holds none.
    empty: f64,
}

/// Returns, for each cell, the chance that it holds a hotspot that no UAV has confirmed.
///
/// `member` is any member of the component, and `known` says which hotspots it knows.
pub(crate) fn chances(
    model: &Model<'_>,
    state: &StateRef<'_>,
    member: usize,
    known: &[bool],
    observations: &[Observations<'_>],
) -> Vec<f64> {
    let config = model.config();
    let odds = Odds::new(model, Vec::new());
    let hotspots = (0..known.len()).filter(|&hotspot| known[hotspot]);
    let taken: Vec<Cell> = hotspots
        .map(|hotspot| state.hotspot_cell(hotspot))
        .chain(model.depots().iter().copied())
        .collect();
    let cells = 0..config.cell_count() as u32;
    let likelihoods: Vec<Option<Likelihood>> = cells
        .clone()
        .map(|index| {
            let (cell, level) = (odds.cell(index), state.report_level(member, index as usize));
            (!taken.contains(&cell)).then(|| likelihood(model, &odds, cell, level, observations))
        })
        .collect();
    let left = known.iter().filter(|known| !**known).count();
    let mut chances = among(&likelihoods, left);
    for (chance, index) in chances.iter_mut().zip(cells) {
        *chance *= missed_since(model, &odds, odds.cell(index), observations);
    }
    chances
}

/// Returns the probabilities of the observations that the members have received, and of a report's
/// level.
fn likelihood(
    model: &Model<'_>,
    odds: &Odds,
    cell: Cell,
    level: u32,
    observations: &[Observations<'_>],
) -> Likelihood {
    let received = || {
        observations
            .iter()
            .map(|observations| observations.received)
    };
    let missed = missed(model, odds, cell, received());
    let levels = model.config().report_levels as usize;
    if levels == 0 {
        return Likelihood {
            hotspot: missed,
            empty: 1.0,
        };
    }
    let level = level as usize;
    let seen = at_most(received(), levels, |observation| {
        odds.detection(observation.level, observation.cell, cell)
    });
    let raised = at_most(received(), levels, |observation| {
        if observation.level == odds.grounded() {
            return 0.0;
        }
        let (dx, dy) = (
            observation.cell.x.abs_diff(cell.x),
            observation.cell.y.abs_diff(cell.y),
        );
        model.false_alarm_probability(dx, dy)
    });
    if level == 0 {
        return Likelihood {
            hotspot: seen[0],
            empty: raised[0],
        };
    }
    let some = 1.0 - seen[0];
    let share = if some > 0.0 {
        (seen[level] - seen[level - 1]) / some
    } else {
        0.0
    };
    Likelihood {
        hotspot: f64::max(missed - seen[0], 0.0) * f64::max(share, 0.0),
        empty: f64::max(raised[level] - raised[level - 1], 0.0),
    }
}

/// Returns C(ℓ) for each ℓ up to the number of levels: the chance that no UAV has seen a hotspot in
/// more than ℓ steps. The highest level stands for any number of steps.
fn at_most<'l>(
    observations: impl Iterator<Item = &'l [Observation]>,
    levels: usize,
    chance: impl Fn(&Observation) -> f64,
) -> Vec<f64> {
    let mut most = vec![1.0; levels + 1];
    let mut exactly = vec![0.0; levels];
    for observations in observations {
        exactly.fill(0.0);
        exactly[0] = 1.0;
        for observation in observations {
            one_more(&mut exactly, chance(observation));
        }
        let mut below = 0.0;
        for (most, exactly) in most.iter_mut().zip(&exactly) {
            below += exactly;
            *most *= below;
        }
    }
    most
}

/// Returns M: the chance that no step of these observations had a quorum of detections of a
/// hotspot.
fn missed<'l>(
    model: &Model<'_>,
    odds: &Odds,
    hotspot: Cell,
    observations: impl Iterator<Item = &'l [Observation]> + Clone,
) -> f64 {
    let quorum = model.config().quorum as usize;
    let steps = observations
        .clone()
        .map(<[Observation]>::len)
        .max()
        .unwrap_or(0);
    let in_step = |step: usize| {
        let chances = observations
            .clone()
            .filter_map(move |observations| observations.get(step));
        chances.map(|observation| odds.detection(observation.level, observation.cell, hotspot))
    };
    (0..steps)
        .map(|step| fewer_than(quorum, in_step(step)))
        .product()
}

/// Returns the chance that the assumed observations have not confirmed a hotspot. UAVs out of
/// contact are taken to confirm among themselves.
fn missed_since(
    model: &Model<'_>,
    odds: &Odds,
    hotspot: Cell,
    observations: &[Observations<'_>],
) -> f64 {
    // All assumed observations end now, so they are compared from their ends.
    let quorum = model.config().quorum as usize;
    let steps = observations
        .iter()
        .map(|observations| observations.assumed.len())
        .max()
        .unwrap_or(0);
    (1..=steps)
        .map(|ago| {
            let assumed = observations.iter().map(|observations| observations.assumed);
            let now = assumed
                .filter_map(|observations| observations.get(observations.len().wrapping_sub(ago)));
            fewer_than(
                quorum,
                now.map(|observation| odds.detection(observation.level, observation.cell, hotspot)),
            )
        })
        .product()
}

/// Returns the chance of each cell, if `count` hotspots lie in distinct cells. A cell without a
/// likelihood holds none.
///
/// If what is known excludes every set of cells, all cells that may hold one are equally likely.
fn among(likelihoods: &[Option<Likelihood>], count: usize) -> Vec<f64> {
    // Any scale of the odds gives the same chances. This one makes the number of hotspots likely,
    // so that no sum underflows.
    let scaled = |exponent: f64| {
        let scale = libm::exp2(exponent);
        likelihoods.iter().map(move |of| match of {
            Some(of) if of.hotspot > 0.0 => of.hotspot * scale / (of.hotspot * scale + of.empty),
            _ => 0.0,
        })
    };
    let (mut low, mut high) = (-SCALE_MAX, SCALE_MAX);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if scaled(middle).sum::<f64>() < count as f64 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let chances: Vec<f64> = scaled(high).collect();
    given_count(&chances, count).unwrap_or_else(|| {
        let open = likelihoods.iter().flatten().count();
        let chance = f64::min(count as f64 / open as f64, 1.0);
        let each = |of: &Option<Likelihood>| if of.is_some() { chance } else { 0.0 };
        likelihoods.iter().map(each).collect()
    })
}

/// Returns the chances of independent events, given that `count` of them happen. There are none if
/// that is impossible.
///
/// The chance that the events from i on make up the rest follows from those from i + 1 on.
fn given_count(chances: &[f64], count: usize) -> Option<Vec<f64>> {
    let width = count + 1;
    let mut after = vec![0.0; (chances.len() + 1) * width];
    after[chances.len() * width] = 1.0;
    for (index, &p) in chances.iter().enumerate().rev() {
        let (now, next) = after[index * width..].split_at_mut(width);
        now.copy_from_slice(&next[..width]);
        one_more(now, p);
    }
    let all = after[count];
    if all <= 0.0 {
        return None;
    }
    let mut before = vec![0.0; width];
    before[0] = 1.0;
    let mut given = Vec::with_capacity(chances.len());
    for (index, &p) in chances.iter().enumerate() {
        let rest = &after[(index + 1) * width..][..width];
        let others: f64 = (0..count).map(|k| before[k] * rest[count - 1 - k]).sum();
        given.push(f64::min(p * others / all, 1.0));
        one_more(&mut before, p);
    }
    Some(given)
}

#[cfg(test)]
mod tests {
    use super::*;
    use jcas_core::{Config, Preset};

    const HERE: Cell = Cell { x: 0, y: 0 };
    const THERE: Cell = Cell { x: 1, y: 1 };

    /// Two UAVs on a grid of two by two cells with a false alarm in a tenth of the observations.
    fn model(quorum: u32) -> Model<'static> {
        Model::new(Config {
            grid_width: 2,
            grid_height: 2,
            cell_size_m: 150.0,
            uav_count: 2,
            hotspot_count: 2,
            quorum,
            false_alarm_per_cell: 0.1,
            sensing_footprint_m: Some(150.0),
            ..Config::preset(Preset::Isac)
        })
        .unwrap()
    }

    /// The observations of two UAVs in two steps, the first UAV at the highest density.
    fn observed(odds: &Odds) -> [[Observation; 2]; 2] {
        let observation = |cell, level| Observation { cell, level };
        let high = odds.highest();
        [
            [
                observation(HERE, high),
                observation(Cell { x: 1, y: 0 }, high),
            ],
            [observation(HERE, high - 1), observation(THERE, 0)],
        ]
    }

    fn received<'l>(observed: &'l [[Observation; 2]; 2]) -> Vec<Observations<'l>> {
        let observations = observed.iter().map(|received| Observations {
            received,
            assumed: &[],
        });
        observations.collect()
    }

    /// The probability of each level, by the sum over all outcomes of the four observations that
    /// have no quorum.
    fn levels(chances: [[f64; 2]; 2], quorum: u32) -> [f64; 3] {
        let mut sums = [0.0; 3];
        for outcome in 0u32..16 {
            let seen = |uav: usize, step: usize| outcome >> (2 * uav + step) & 1;
            let any_quorum = (0..2).any(|step| seen(0, step) + seen(1, step) >= quorum);
            let most = (0..2).map(|uav| seen(uav, 0) + seen(uav, 1)).max().unwrap();
            let mut probability = 1.0;
            for uav in 0..2 {
                for step in 0..2 {
                    let p = chances[uav][step];
                    probability *= if seen(uav, step) == 1 { p } else { 1.0 - p };
                }
            }
            sums[most as usize] += if any_quorum { 0.0 } else { probability };
        }
        sums
    }

    /// With three of two UAVs for a quorum, every level is exact. With two, level 0 is, and so is
    /// the sum of the others.
    #[test]
    fn likelihoods_are_the_sums_over_all_outcomes() {
        for quorum in [2, 3] {
            let model = model(quorum);
            let odds = Odds::new(&model, Vec::new());
            let observed = observed(&odds);
            for cell in (0..4).map(|index| odds.cell(index)) {
                let seen = levels(
                    observed.map(|observations| {
                        observations.map(|observation| {
                            odds.detection(observation.level, observation.cell, cell)
                        })
                    }),
                    quorum,
                );
                let raised = levels(
                    observed.map(|observations| {
                        observations.map(|observation| {
                            if observation.cell.manhattan(cell) < 2 {
                                0.1
                            } else {
                                0.0
                            }
                        })
                    }),
                    3,
                );
                let got: Vec<Likelihood> = (0..3)
                    .map(|level| likelihood(&model, &odds, cell, level, &received(&observed)))
                    .collect();
                let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b} {got:?}");
                for level in 0..3 {
                    near(got[level].empty, raised[level]);
                }
                near(got[0].hotspot, seen[0]);
                near(got[1].hotspot + got[2].hotspot, seen[1] + seen[2]);
                if quorum == 3 {
                    near(got[1].hotspot, seen[1]);
                }
            }
        }
    }

    /// Six cells, of which the sets of each size are weighed one by one.
    #[test]
    fn chances_of_cells_are_the_sums_over_all_sets() {
        let odds = [0.2, 3.0, 1.0, 0.0, 40.0, 1e-7];
        let likelihoods = odds.map(|odds| {
            Some(Likelihood {
                hotspot: odds * 1e-200,
                empty: 1e-200,
            })
        });
        for count in 0..5u32 {
            let (mut sums, mut all) = ([0.0; 6], 0.0);
            for set in (0u32..1 << 6).filter(|set| set.count_ones() == count) {
                let cells = || (0..6).filter(move |cell| set >> cell & 1 == 1);
                let weight: f64 = cells().map(|cell| odds[cell]).product();
                all += weight;
                cells().for_each(|cell| sums[cell] += weight);
            }
            for (got, sum) in among(&likelihoods, count as usize).iter().zip(sums) {
                assert!(
                    (got - sum / all).abs() < 1e-9,
                    "{count}: {got} {}",
                    sum / all
                );
            }
        }
    }

    /// A report that no false alarm explains is a hotspot, and contradictions leave the prior.
    #[test]
    fn certain_and_impossible_cells_are_chances_too() {
        let certain = Some(Likelihood {
            hotspot: 0.1,
            empty: 0.0,
        });
        let even = Some(Likelihood {
            hotspot: 1.0,
            empty: 1.0,
        });
        let never = Some(Likelihood {
            hotspot: 0.0,
            empty: 1.0,
        });
        let chances = among(&[certain, even, even, None, never], 2);
        assert_eq!(chances[0], 1.0);
        assert!((chances[1] - 0.5).abs() < 1e-12 && (chances[2] - 0.5).abs() < 1e-12);
        assert_eq!(&chances[3..], [0.0, 0.0]);
        assert_eq!(among(&[never, None, never], 1), [0.5, 0.0, 0.5]);
    }

    /// With a quorum of one, a report that confirmed nothing is a false alarm.
    #[test]
    fn a_report_that_did_not_confirm_alone_is_false() {
        let model = model(1);
        let odds = Odds::new(&model, Vec::new());
        let observed = observed(&odds);
        assert_eq!(
            likelihood(&model, &odds, THERE, 1, &received(&observed)).hotspot,
            0.0
        );
    }

    /// Observations that the members assume leave only what they have not confirmed.
    #[test]
    fn assumed_observations_count_back_from_now() {
        let model = model(2);
        let odds = Odds::new(&model, Vec::new());
        let observed = observed(&odds);
        let observations = [
            Observations {
                received: &observed[0][..1],
                assumed: &observed[0][1..],
            },
            Observations {
                received: &[],
                assumed: &observed[1],
            },
        ];
        let p =
            |observation: Observation| odds.detection(observation.level, observation.cell, HERE);
        let expected = 1.0 - p(observed[0][1]) * p(observed[1][1]);
        let got = missed_since(&model, &odds, HERE, &observations);
        assert!((got - expected).abs() < 1e-12, "{got} {expected}");
    }
}
