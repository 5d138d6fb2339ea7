//! The radio link: its budget and its normalised throughput.

use libm::{exp, log2, log10};

use crate::config::Config;
use crate::radio::radar::LIGHT_M_PER_S;

/// Communication SNR in dB at a range in metres: P_t + G_t + G_r - PL - P_n, with the path loss
/// PL = 20 log10(4π f_c/c) + 10 n log10(R).
#[must_use]
pub fn snr_db(config: &Config, range_m: f64) -> f64 {
    let path_loss_db = 20.0
        * log10(4.0 * core::f64::consts::PI * config.carrier_frequency_hz / LIGHT_M_PER_S)
        + 10.0 * config.path_loss_exponent * log10(range_m);
    config.transmit_power_dbm + config.transmit_gain_dbi + config.receive_gain_dbi
        - path_loss_db
        - config.comm_noise_dbm
}

/// Normalised throughput of a waveform that carries only data, log2(1 + SNR) / reference, at a
/// range in metres.
#[must_use]
pub fn full_throughput(config: &Config, range_m: f64) -> f64 {
    let snr = exp(snr_db(config, range_m) * (core::f64::consts::LN_10 / 10.0));
    log2(1.0 + snr) / config.reference_spectral_efficiency
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worked by hand: 20 log10(4π f/c) = 47.71 dB.
    #[test]
    fn hand_worked_link_budget() {
        let config = Config::default();
        assert!((snr_db(&config, 50.0) - 32.30).abs() < 0.005);
        assert!((snr_db(&config, 100.0) - 26.28).abs() < 0.005);
        let snr = 10f64.powf(snr_db(&config, 100.0) / 10.0);
        assert!((full_throughput(&config, 100.0) - (1.0 + snr).log2() / 6.0).abs() < 1e-12);
    }
}
