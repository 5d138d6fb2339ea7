//! The waveform's two uses: the radar with its detection curves and footprint, and the radio link.

pub(crate) mod false_alarms;
pub(crate) mod footprint;
pub mod link;
pub(crate) mod radar;
