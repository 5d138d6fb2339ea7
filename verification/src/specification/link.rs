//! The link budget, evaluated for one pair, and the graph that follows from it.

use super::{Position, SPEED_OF_LIGHT_M_PER_S, Specification, World};
use std::f64::consts::PI;

impl Specification {
    /// SNR^comm in dB between two cells.
    pub fn comm_snr_db(&self, a: Position, b: Position) -> f64 {
        let c = &self.config;
        let reference = 4.0 * PI * c.carrier_frequency_hz / SPEED_OF_LIGHT_M_PER_S;
        let path_loss = 20.0 * libm::log10(reference)
            + 10.0 * c.path_loss_exponent * libm::log10(self.range_m(a, b));
        c.transmit_power_dbm + c.transmit_gain_dbi + c.receive_gain_dbi
            - path_loss
            - c.comm_noise_dbm
    }

    /// η_ij: what a UAV with this pilot density reaches toward another cell.
    pub fn link_throughput(&self, from: Position, to: Position, pilot: f64) -> f64 {
        let snr = libm::pow(10.0, self.comm_snr_db(from, to) / 10.0);
        (1.0 - pilot) * libm::log2(1.0 + snr) / self.config.reference_spectral_efficiency
    }

    /// Links every pair of flying UAVs of which both hear the other well enough.
    pub fn link_up(&self, world: &mut World) {
        let n = self.uavs();
        let least = self.config.link_throughput_min;
        for i in 0..n {
            for k in 0..n {
                let (here, there) = (world.position[i], world.position[k]);
                let out = self.link_throughput(here, there, world.pilot[i]);
                let back = self.link_throughput(there, here, world.pilot[k]);
                let both_fly = !world.grounded[i] && !world.grounded[k];
                world.linked[i][k] = i != k && both_fly && out >= least && back >= least;
            }
        }
        self.measure(world);
    }

    /// What each UAV reaches toward its neighbours, and the fleet's mean.
    pub(super) fn measure(&self, world: &mut World) {
        let n = self.uavs();
        for i in 0..n {
            let mut sum = 0.0;
            let mut neighbours = 0;
            for k in 0..n {
                if world.linked[i][k] {
                    let (here, there) = (world.position[i], world.position[k]);
                    sum += self.link_throughput(here, there, world.pilot[i]);
                    neighbours += 1;
                }
            }
            world.throughput[i] = if neighbours == 0 {
                0.0
            } else {
                sum / f64::from(neighbours)
            };
        }
        world.mean_throughput = world.throughput.iter().sum::<f64>() / n as f64;
    }

    /// The paper's consensus, literally: N rounds, each from the round before.
    pub fn consensus(&self, world: &mut World) {
        let n = self.uavs();
        for _ in 0..n {
            let before = world.knows.clone();
            for i in 0..n {
                for k in 0..n {
                    if world.linked[i][k] {
                        for j in 0..self.hotspots() {
                            world.knows[i][j] = world.knows[i][j] || before[k][j];
                        }
                    }
                }
            }
        }
    }
}
