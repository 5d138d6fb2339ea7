//! The radar equations, evaluated for one UAV and one hotspot.

use super::{Position, SPEED_OF_LIGHT_M_PER_S, Specification};
use std::f64::consts::PI;

impl Specification {
    /// SNR^sens in dB at distance R, before communication load.
    pub fn sensing_snr_db(&self, uav: Position, hotspot: Position) -> f64 {
        self.sensing_snr_at_db(self.range_m(uav, hotspot))
    }

    fn sensing_snr_at_db(&self, range: f64) -> f64 {
        let c = &self.config;
        let lambda = self.wavelength_m();
        let transmitted_w = watts(c.transmit_power_dbm);
        let gains = ratio(c.transmit_gain_dbi) * ratio(c.receive_gain_dbi);
        let cross_section_m2 = ratio(c.radar_cross_section_dbsm);
        let four_pi_cubed = (4.0 * PI) * (4.0 * PI) * (4.0 * PI);
        let range_4 = range * range * range * range;
        let received_w =
            transmitted_w * gains * lambda * lambda * cross_section_m2 / (four_pi_cubed * range_4);
        let noise_w = watts(c.sensing_noise_dbm);
        10.0 * libm::log10(received_w / noise_w) + c.processing_gain_db
            - self.range_resolution_penalty_db(range)
    }

    /// Δ_res(R) = 10·log10(1 + δ/R).
    fn range_resolution_penalty_db(&self, range_m: f64) -> f64 {
        let c = &self.config;
        let natural = SPEED_OF_LIGHT_M_PER_S / (2.0 * c.bandwidth_hz);
        let resolution = c.range_resolution_m.unwrap_or(natural);
        10.0 * libm::log10(1.0 + resolution / range_m)
    }

    /// γ_det: given, or the SNR at the sensing range, or Albersheim's equation for one pulse.
    pub fn detection_threshold_db(&self) -> f64 {
        let c = &self.config;
        if let Some(threshold) = c.detection_threshold_db {
            return threshold;
        }
        if let Some(range) = c.sensing_range_m {
            return self.sensing_snr_at_db(range);
        }
        let pulses: f64 = 1.0;
        let a = libm::log(0.62 / c.false_alarm_probability);
        let b = libm::log(c.detection_probability / (1.0 - c.detection_probability));
        -5.0 * libm::log10(pulses)
            + (6.2 + 4.54 / libm::sqrt(pulses + 0.44)) * libm::log10(a + 0.12 * a * b + 1.7 * b)
    }

    /// p_ij, the probability that a UAV with this pilot density detects in one step.
    pub fn detection_probability(&self, uav: Position, hotspot: Position, pilot: f64) -> f64 {
        let c = &self.config;
        let load = 1.0 - pilot;
        let effective = self.sensing_snr_db(uav, hotspot) - c.comm_load_penalty_db * load;
        let margin = effective - self.detection_threshold_db();
        1.0 / (1.0 + libm::exp(-c.logistic_slope_per_db * margin))
    }
}

fn ratio(db: f64) -> f64 {
    libm::pow(10.0, db / 10.0)
}

fn watts(dbm: f64) -> f64 {
    ratio(dbm) / 1000.0
}
