//! The link budget, and the graph that follows from it.

use super::{Position, SPEED_OF_LIGHT_M_PER_S, Specification, World};
use jcas_core::Config;
use std::f64::consts::PI;

/// log2(1 + SNR^comm) at range R, in bit/s/Hz.
pub fn spectral_efficiency(c: &Config, range_m: f64) -> f64 {
    let reference = 4.0 * PI * c.carrier_frequency_hz / SPEED_OF_LIGHT_M_PER_S;
    let path_loss_db =
        20.0 * libm::log10(reference) + 10.0 * c.path_loss_exponent * libm::log10(range_m);
    let snr_db = c.transmit_power_dbm + c.transmit_gain_dbi + c.receive_gain_dbi
        - path_loss_db
        - c.comm_noise_dbm;
    libm::log2(1.0 + libm::pow(10.0, snr_db / 10.0))
}

impl Specification {
    /// Returns η_ij, the normalised throughput of a UAV with this pilot density to another cell.
    pub fn link_throughput(&self, from: Position, to: Position, pilot: f64) -> f64 {
        let efficiency = self.spectral_efficiency.between(from, to);
        (1.0 - pilot) * efficiency / self.config.reference_spectral_efficiency
    }

    /// Links each pair of flying UAVs that reach the threshold in both directions.
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

    /// Computes each UAV's mean throughput toward its neighbours, and the fleet's mean.
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

    /// Makes the paper's consensus: N rounds, each from the result of the round before.
    pub fn consensus(&self, world: &mut World) {
        // After a round without a change, no round changes anything.
        let mut settled = false;
        for _ in 0..self.uavs() {
            if settled {
                break;
            }
            let before = world.knows.clone();
            for i in 0..self.uavs() {
                for k in 0..self.uavs() {
                    if world.linked[i][k] {
                        for j in 0..self.hotspots() {
                            world.knows[i][j] = world.knows[i][j] || before[k][j];
                        }
                    }
                }
            }
            settled = world.knows == before;
        }
    }
}
