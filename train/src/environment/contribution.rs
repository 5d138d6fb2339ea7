//! What each UAV contributes to a confirmation: how much likelier it made it.
//!
//! A difference reward (Wolpert and Tumer, "Optimal payoff functions for members of collectives", 2001): the
//! team's expected gain less what it would be without the UAV.

use jcas_core::{Model, StateRef};

/// Which hotspots of some missions were unconfirmed when they were last looked at.
#[derive(Clone, Debug)]
pub struct Contribution {
    hotspots: usize,
    open: Vec<bool>,
}

impl Contribution {
    /// Of so many missions of so many hotspots each, none of which has been looked at.
    pub fn new(missions: usize, hotspots: usize) -> Contribution {
        Contribution {
            hotspots,
            open: vec![false; missions * hotspots],
        }
    }

    fn open(&mut self, mission: usize) -> &mut [bool] {
        &mut self.open[mission * self.hotspots..][..self.hotspots]
    }

    /// Looks at a mission: whatever it was before, what is open now counts.
    pub fn start(&mut self, mission: usize, state: &StateRef<'_>) {
        for (hotspot, open) in self.open(mission).iter_mut().enumerate() {
            *open = !state.confirmed(hotspot);
        }
    }

    /// By how much each UAV raised the expected number of confirmations in the step that led to this state:
    /// the chance that it detects a hotspot and exactly θ − 1 of the others do, over those that were open.
    pub fn gained(
        &mut self,
        mission: usize,
        model: &Model<'_>,
        state: &StateRef<'_>,
        gains: &mut [f64],
    ) {
        gains.fill(0.0);
        let missing = model.config().quorum as usize - 1;
        for hotspot in 0..self.hotspots {
            if !self.open(mission)[hotspot] {
                continue;
            }
            let chances = chances(model, state, hotspot);
            for ((uav, gain), &chance) in gains.iter_mut().enumerate().zip(&chances) {
                let others = chances
                    .iter()
                    .enumerate()
                    .filter(|&(other, _)| other != uav);
                *gain += chance * exactly(missing, others.map(|(_, &chance)| chance));
            }
        }
        self.start(mission, state);
    }
}

/// The chance of each UAV to detect a hotspot from where it is.
fn chances(model: &Model<'_>, state: &StateRef<'_>, hotspot: usize) -> Vec<f64> {
    let there = state.hotspot_cell(hotspot);
    (0..model.uav_count())
        .map(|uav| {
            let cell = state.cell(uav);
            let (dx, dy) = (cell.x.abs_diff(there.x), cell.y.abs_diff(there.y));
            if state.grounded(uav) {
                0.0
            } else {
                model.detection_probability(dx, dy, state.pilot_density(uav))
            }
        })
        .collect()
}

/// The chance that exactly `count` of independent events happen.
fn exactly(count: usize, chances: impl Iterator<Item = f64>) -> f64 {
    // happened[k]: the chance that k of those so far did.
    let mut happened = vec![0.0; count + 1];
    happened[0] = 1.0;
    for chance in chances {
        for k in (0..=count).rev() {
            let fewer = if k > 0 { happened[k - 1] } else { 0.0 };
            happened[k] = happened[k] * (1.0 - chance) + fewer * chance;
        }
    }
    happened[count]
}

#[cfg(test)]
mod tests {
    use super::*;
    use jcas_core::{Config, Sim};

    #[test]
    fn coin_tosses() {
        let fair = |tosses| std::iter::repeat_n(0.5, tosses);
        assert_eq!(exactly(2, fair(4)), 6.0 / 16.0);
        assert_eq!(exactly(0, fair(3)), 1.0 / 8.0);
        assert_eq!(exactly(3, fair(2)), 0.0);
    }

    // Without one of its UAVs a fleet confirms less, by what that UAV gained: worked out from all outcomes.
    #[test]
    fn a_gain_is_the_difference_that_the_uav_makes() {
        let config = Config {
            uav_count: 5,
            hotspot_count: 2,
            detection_threshold_db: Some(-40.0),
            ..Config::default()
        };
        let model = Model::new(config).unwrap();
        let mut sim = Sim::new(&model);
        sim.reset(3);
        let mut contribution = Contribution::new(1, 2);
        contribution.start(0, &sim.state());
        sim.step(&[0.4, 0.0, -0.4, 0.3, 0.8, -0.5, 0.0, 1.0, -0.8, 0.2])
            .unwrap();
        let mut gains = [0.0; 5];
        contribution.gained(0, &model, &sim.state(), &mut gains);
        let confirms = |without: Option<usize>| -> f64 {
            let of = |hotspot| {
                let chances = chances(&model, &sim.state(), hotspot);
                let outcomes = (0..1u32 << 5).filter(|outcome| outcome.count_ones() >= 3);
                let chance = |outcome: u32| -> f64 {
                    let each = chances.iter().enumerate().map(|(uav, &chance)| {
                        let chance = if without == Some(uav) { 0.0 } else { chance };
                        if outcome >> uav & 1 == 1 {
                            chance
                        } else {
                            1.0 - chance
                        }
                    });
                    each.product()
                };
                outcomes.map(chance).sum::<f64>()
            };
            of(0) + of(1)
        };
        assert!(gains.iter().any(|&gain| gain > 0.01), "{gains:?}");
        for (uav, gain) in gains.iter().enumerate() {
            let difference = confirms(None) - confirms(Some(uav));
            assert!(
                (gain - difference).abs() < 1e-12,
                "{uav}: {gain} {difference}"
            );
        }
    }
}
