//! Knowledge credit: each UAV's share in informing the fleet. It counts the hotspots that a UAV
//! comes to know. Once all are confirmed, it also counts the cells by which a UAV approaches one
//! with other knowledge.
//!
//! An episode ends when every UAV knows every hotspot, and its reward is the same for all. With
//! this credit, two groups out of radio range learn to approach each other.

use jcas_core::{Model, StateRef};

/// State of the credit: the knowledge and the distances of the UAVs of several episodes at the last
/// step.
#[derive(Clone, Debug)]
pub struct KnowledgeCredit {
    uavs: usize,
    /// Hotspots that each UAV knows to be confirmed.
    known: Vec<u32>,
    /// Manhattan distance of each UAV to the nearest UAV with other knowledge. It is 0 without such
    /// a UAV, or while a hotspot is unconfirmed.
    ways: Vec<u32>,
}

/// Gains of the UAVs of an episode since the last step.
#[derive(Clone, Debug, Default)]
pub struct Informed {
    /// Hotspots that each UAV has come to know.
    pub hotspots: Vec<f64>,
    /// Cells by which each UAV has approached the nearest UAV with other knowledge. All are 0 in a
    /// step that informs a UAV, because the nearest one may then be another.
    pub cells: Vec<f64>,
}

impl KnowledgeCredit {
    /// State for `missions` episodes of `uavs` UAVs, before the first observation.
    pub fn new(missions: usize, uavs: usize) -> KnowledgeCredit {
        KnowledgeCredit {
            uavs,
            known: vec![0; missions * uavs],
            ways: vec![0; missions * uavs],
        }
    }

    /// Starts an episode: gains count from this state on.
    pub fn start(&mut self, mission: usize, model: &Model<'_>, state: &StateRef<'_>) {
        let place = mission * self.uavs..(mission + 1) * self.uavs;
        let ways = &mut self.ways[place.clone()];
        for (uav, known) in self.known[place].iter_mut().enumerate() {
            let row = state.knowledge_of(uav);
            *known = row.iter().map(|word| word.count_ones()).sum();
        }
        ways.fill(0);
        if (0..model.hotspot_count()).all(|hotspot| state.confirmed(hotspot)) {
            for (uav, way) in ways.iter_mut().enumerate() {
                let (cell, row) = (state.cell(uav), state.knowledge_of(uav));
                *way = (0..self.uavs)
                    .filter(|&other| state.knowledge_of(other) != row)
                    .map(|other| cell.manhattan(state.cell(other)))
                    .min()
                    .unwrap_or(0);
            }
        }
    }

    /// Computes the gains of each UAV of an episode since the last step.
    pub fn gained(
        &mut self,
        mission: usize,
        model: &Model<'_>,
        state: &StateRef<'_>,
        out: &mut Informed,
    ) {
        let place = mission * self.uavs..(mission + 1) * self.uavs;
        let negative = |number: &u32| -f64::from(*number);
        out.hotspots.clear();
        out.hotspots
            .extend(self.known[place.clone()].iter().map(negative));
        out.cells.clear();
        out.cells
            .extend(self.ways[place.clone()].iter().map(|&way| f64::from(way)));
        self.start(mission, model, state);
        for (hotspots, &known) in out.hotspots.iter_mut().zip(&self.known[place.clone()]) {
            *hotspots += f64::from(known);
        }
        let told = out.hotspots.iter().any(|&hotspots| hotspots > 0.0);
        for (cells, &way) in out.cells.iter_mut().zip(&self.ways[place]) {
            *cells = if told { 0.0 } else { *cells - f64::from(way) };
        }
    }

    /// Computes the gains of an episode that has just been completed, in which every UAV knows
    /// every hotspot.
    pub fn completed(&self, mission: usize, model: &Model<'_>, out: &mut Informed) {
        let all = model.hotspot_count() as f64;
        let known = &self.known[mission * self.uavs..][..self.uavs];
        out.hotspots.clear();
        out.hotspots
            .extend(known.iter().map(|&known| all - f64::from(known)));
        out.cells.clear();
        out.cells.resize(self.uavs, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jcas_core::{Config, Sim};

    const UP: f32 = -0.8;
    const LEFT: f32 = 0.0;
    const RIGHT: f32 = 0.4;

    // UAVs without links walk apart and back. Each gains the new entries of its row of knowledge,
    // and all that it lacks when an episode is completed. Once all hotspots are confirmed,
    // approaches count; the test computes them from the cells.
    #[test]
    fn news_is_what_rows_of_knowledge_gain_and_ways_lead_to_others() {
        let config = Config {
            uav_count: 4,
            hotspot_count: 2,
            quorum: 1,
            sensing_range_m: Some(100.0),
            link_throughput_min: 1000.0,
            ..Config::default()
        };
        let model = Model::new(config).unwrap();
        let mut sim = Sim::new(&model);
        let mut informing = KnowledgeCredit::new(2, 4);
        let (mut news, mut nearer) = (0.0, 0.0);
        for seed in 0..20 {
            sim.reset(seed);
            informing.start(1, &model, &sim.state());
            let mut completed = Informed::default();
            informing.completed(1, &model, &mut completed);
            let missing = |known: &u32| 2.0 - f64::from(*known);
            let expected: Vec<f64> = informing.known[4..].iter().map(missing).collect();
            assert_eq!(completed.hotspots, expected);
            for step in 0..30 {
                let (known, ways) = (informing.known[4..].to_vec(), informing.ways[4..].to_vec());
                let (one, other) = if step % 10 < 5 {
                    (RIGHT, LEFT)
                } else {
                    (LEFT, RIGHT)
                };
                let outcome = sim
                    .step(&[one, 1.0, other, 1.0, one, 1.0, UP, 1.0])
                    .unwrap();
                let state = sim.state();
                let mut gained = Informed::default();
                informing.gained(1, &model, &state, &mut gained);
                let told = (0..4).any(|uav| informing.known[4 + uav] > known[uav]);
                for uav in 0..4 {
                    let knows = (0..2).filter(|&j| state.knows(uav, j)).count() as f64;
                    assert_eq!(gained.hotspots[uav], knows - f64::from(known[uav]));
                    let row = state.knowledge_of(uav);
                    let way = (0..4)
                        .filter(|&i| state.knowledge_of(i) != row)
                        .map(|i| state.cell(i).manhattan(state.cell(uav)))
                        .min()
                        .filter(|_| (0..2).all(|j| state.confirmed(j)));
                    let cells = f64::from(ways[uav]) - f64::from(way.unwrap_or(0));
                    assert_eq!(gained.cells[uav], if told { 0.0 } else { cells });
                    news += gained.hotspots[uav];
                    nearer += gained.cells[uav].abs();
                }
                if outcome.terminated || outcome.truncated {
                    break;
                }
            }
        }
        assert!(
            news > 0.0 && nearer > 0.0,
            "{news} hotspots, {nearer} cells"
        );
    }
}
