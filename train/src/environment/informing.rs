//! Each UAV's own news: confirmed hotspots that it has come to know.
//!
//! A mission ends when everybody knows everything, and what it pays for that goes to all alike: where everything is
//! confirmed, a UAV out of reach learns from this that the way back is its own.

use jcas_core::{Model, StateRef};

/// What the UAVs of some missions knew when they were last looked at.
#[derive(Clone, Debug)]
pub struct Informing {
    uavs: usize,
    /// Hotspots that each UAV knows to be confirmed.
    known: Vec<u32>,
}

impl Informing {
    /// Of so many missions of so many UAVs each, none of which has been looked at.
    pub fn new(missions: usize, uavs: usize) -> Informing {
        Informing {
            uavs,
            known: vec![0; missions * uavs],
        }
    }

    /// Looks at a mission: whatever it was before, news counts from here.
    pub fn start(&mut self, mission: usize, state: &StateRef<'_>) {
        let known = &mut self.known[mission * self.uavs..][..self.uavs];
        for (uav, known) in known.iter_mut().enumerate() {
            *known = state
                .knowledge_of(uav)
                .iter()
                .map(|word| word.count_ones())
                .sum();
        }
    }

    /// Hotspots that each UAV of a mission has come to know since it was last looked at.
    pub fn gained(&mut self, mission: usize, state: &StateRef<'_>, hotspots: &mut [f64]) {
        let place = mission * self.uavs;
        for (hotspots, &known) in hotspots.iter_mut().zip(&self.known[place..]) {
            *hotspots = -f64::from(known);
        }
        self.start(mission, state);
        for (hotspots, &known) in hotspots.iter_mut().zip(&self.known[place..]) {
            *hotspots += f64::from(known);
        }
    }

    /// The same of a mission that has just been completed, where everybody knows all.
    pub fn completed(&self, mission: usize, model: &Model<'_>, hotspots: &mut [f64]) {
        let all = model.hotspot_count() as f64;
        for (hotspots, &known) in hotspots.iter_mut().zip(&self.known[mission * self.uavs..]) {
            *hotspots = all - f64::from(known);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jcas_core::{Config, Sim};

    // Of four UAVs that meet at the depot and confirm the hotspot there with certainty, each gains what its row of
    // knowledge gained, and over the whole mission all of it.
    #[test]
    fn news_is_what_the_rows_of_knowledge_gain() {
        let config = Config {
            uav_count: 4,
            hotspot_count: 2,
            quorum: 1,
            detection_threshold_db: Some(-60.0),
            ..Config::default()
        };
        let model = Model::new(config).unwrap();
        let mut sim = Sim::new(&model);
        sim.reset(11);
        let mut informing = Informing::new(2, 4);
        informing.start(1, &sim.state());
        let before: Vec<usize> = (0..4)
            .map(|uav| (0..2).filter(|&j| sim.state().knows(uav, j)).count())
            .collect();
        let mut completed = [0.0; 4];
        informing.completed(1, &model, &mut completed);
        let mut total = [0.0; 4];
        for _ in 0..40 {
            let outcome = sim
                .step(&[-1.0, 1.0, -0.5, 1.0, 0.0, 1.0, 0.5, 1.0])
                .unwrap();
            let mut gained = [0.0; 4];
            informing.gained(1, &sim.state(), &mut gained);
            for (total, gained) in total.iter_mut().zip(gained) {
                assert!(gained >= 0.0);
                *total += gained;
            }
            if outcome.terminated {
                break;
            }
        }
        assert_eq!(
            sim.state().informed_count(),
            2,
            "the radar is all but certain"
        );
        for uav in 0..4 {
            assert_eq!(total[uav], (2 - before[uav]) as f64);
        }
        assert_eq!(total, completed);
    }
}
