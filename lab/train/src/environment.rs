//! The interface of an environment: several equal episodes side by side, stepped together.
//!
//! The trait is the whole contract between PPO and the simulator. So tests can run the algorithm on
//! an environment whose best return is known.

pub mod fleet;
pub mod knowledge_credit;
pub mod task;
pub mod teacher;

use crate::error::FormatError;
use crate::settings::Credit;
use jcas_core::MotionMap;
use jcas_policy::network::row::RowLayout;

/// Sizes that every environment of one group shares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shape {
    /// Missions side by side (M).
    pub environments: usize,
    /// UAVs in each mission (N).
    pub agents: usize,
    /// Floats of one UAV's observation.
    pub observation_len: usize,
    /// Floats of the global state that the critic sees.
    pub global_len: usize,
    /// Hotspots of each mission (n); 0 where the task has none.
    pub hotspots: usize,
    /// Neighbour slots of an observation; 0 where the task has none.
    pub neighbour_slots: usize,
    /// Width and height of the grid; positions are fractions of these less one.
    pub grid: [u32; 2],
    /// Reach of the radar in cells, where P_d is a half.
    pub reach: f32,
    /// The order of the motions over the bins of u_dir.
    pub motion_map: MotionMap,
}

impl Shape {
    /// Rows of the observation matrix: one for each UAV of each mission.
    pub fn rows(&self) -> usize {
        self.environments * self.agents
    }

    /// The layout of an observation.
    pub fn row_layout(&self) -> RowLayout {
        RowLayout {
            observation_len: self.observation_len,
            hotspots: self.hotspots,
            slots: self.neighbour_slots,
            cells: self.grid.map(|cells| cells.saturating_sub(1)),
            motion_map: self.motion_map,
        }
    }

    /// Cells that a position difference of 1 stands for, along x and y.
    pub fn position_cells(&self) -> [f32; 2] {
        self.row_layout().cells.map(|cells| cells as f32)
    }
}

/// What one step of M missions returns. All buffers are sized by [`StepOut::new`].
#[derive(Clone, Debug)]
pub struct StepOut {
    /// Rewards: the team's of each episode (M), or each UAV's own (M·N), as requested.
    pub rewards: Vec<f32>,
    /// The raw action that the teacher chose for each UAV in the state before the step (M·N × 2),
    /// if requested.
    pub labels: Vec<f32>,
    /// The mission ended by itself: nothing follows.
    pub terminated: Vec<bool>,
    /// The mission was cut at the horizon: its value goes on.
    pub truncated: Vec<bool>,
    /// Global state at the end of a mission that ended in this step (M × S); else unspecified.
    pub final_global: Vec<f32>,
    /// Summaries of the missions that ended in this step, in the order of their index.
    pub finished: Vec<Episode>,
}

impl StepOut {
    /// Buffers for a group of this shape. Their lengths request what the credit needs.
    pub fn new(shape: Shape, credit: Credit) -> StepOut {
        let rewards = match credit {
            Credit::Team | Credit::Teacher => shape.environments,
            Credit::Uav => shape.rows(),
        };
        let labels = if credit == Credit::Teacher {
            2 * shape.rows()
        } else {
            0
        };
        StepOut {
            rewards: vec![0.0; rewards],
            labels: vec![0.0; labels],
            terminated: vec![false; shape.environments],
            truncated: vec![false; shape.environments],
            final_global: vec![0.0; shape.environments * shape.global_len],
            finished: Vec::new(),
        }
    }
}

/// A finished mission, as the training log reports it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Episode {
    /// Undiscounted sum of the rewards the configuration pays.
    pub return_sum: f64,
    /// Whether the mission was completed.
    pub success: bool,
    /// Steps it took.
    pub steps: u32,
    /// Energy spent by the whole fleet, kWh.
    pub energy_kwh: f64,
    /// Mean of the fleet's normalised throughput over the steps.
    pub throughput: f64,
}

/// M missions that step together and start again by themselves.
pub trait VectorEnvironment: Send {
    /// Sizes of every buffer.
    fn shape(&self) -> Shape;

    /// Starts every mission anew; mission m takes its seed from (`seed`, m).
    fn reset(&mut self, seed: u64);

    /// Observations (M·N × O) and global states (M × S) of the missions as they are now.
    fn observe(&mut self, observations: &mut [f32], global: &mut [f32]);

    /// Steps all missions by `actions` (M·N × 2, each in [-1, 1]); ended missions start anew.
    fn step(&mut self, actions: &[f32], out: &mut StepOut);

    /// Serialises everything that the future of the episodes depends on.
    fn save(&self) -> Vec<u8>;

    /// Restores the output of [`VectorEnvironment::save`].
    fn load(&mut self, bytes: &[u8]) -> Result<(), FormatError>;
}
