//! The calls of a host simulator as values, so that they can be recorded, replayed and compared.

use crate::config::Cell;
use crate::error::Error;
use crate::model::Model;
use crate::state::StateMut;
use crate::state::scratch::Scratch;

/// Declares the calls once: the enum, the name of each, the list of names, and which calls come
/// within a step.
macro_rules! calls {
    ($(
        $(#[doc = $doc:literal])+
        $name:ident {
            $( $(#[doc = $field_doc:literal])+ $field:ident: $type:ty ),+ $(,)?
        } = $kind:literal, within_step: $within:literal,
    )+) => {
        /// A call by which a host simulator replaces a part of the model. See the method of
        /// [`Model`] that has the same name for units, ranges and errors.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Call<'a> {
            $( $(#[doc = $doc])+ $name { $( $(#[doc = $field_doc])+ $field: $type ),+ }, )+
        }

        impl Call<'_> {
            /// The name of each call, in the order of the enum.
            pub const KINDS: [&'static str; [$( $kind ),+].len()] = [$( $kind ),+];

            /// The name of the call, which is that of the kernel's method and of the trace line.
            #[must_use]
            pub const fn kind(&self) -> &'static str {
                match self {
                    $( Self::$name { .. } => $kind, )+
                }
            }

            /// Whether the call comes between two parts of a step. The other calls come between two
            /// steps.
            #[must_use]
            pub const fn within_step(&self) -> bool {
                match self {
                    $( Self::$name { .. } => $within, )+
                }
            }
        }
    };
}

calls! {
    /// [`Model::set_starts`].
    SetStarts {
        /// One cell for each UAV.
        cells: &'a [Cell],
    } = "set_starts", within_step: false,
    /// [`Model::set_hotspots`].
    SetHotspots {
        /// One cell for each hotspot.
        cells: &'a [Cell],
    } = "set_hotspots", within_step: false,
    /// [`Model::set_batteries`].
    SetBatteries {
        /// The charge of each UAV in microjoules.
        charges_uj: &'a [u64],
    } = "set_batteries", within_step: false,
    /// [`Model::set_battery`].
    SetBattery {
        /// Index of the UAV.
        uav: usize,
        /// Its charge in microjoules.
        charge_uj: u64,
    } = "set_battery", within_step: false,
    /// [`Model::move_hotspot`].
    MoveHotspot {
        /// Index of the hotspot.
        hotspot: usize,
        /// Its new cell.
        cell: Cell,
    } = "move_hotspot", within_step: false,
    /// [`Model::set_positions`].
    SetPositions {
        /// One cell for each UAV.
        cells: &'a [Cell],
    } = "set_positions", within_step: true,
    /// [`Model::ground`].
    Ground {
        /// Index of the UAV.
        uav: usize,
    } = "ground", within_step: true,
    /// [`Model::confirm_hotspot`].
    ConfirmHotspot {
        /// Index of the hotspot.
        hotspot: usize,
    } = "confirm_hotspot", within_step: true,
    /// [`Model::step_sense_with`].
    StepSenseWith {
        /// N rows of n bytes; 0: no detection.
        detections: &'a [u8],
    } = "step_sense_with", within_step: true,
    /// [`Model::step_communicate_with`].
    StepCommunicateWith {
        /// N rows of N bytes; 0: no link.
        links: &'a [u8],
        /// The mean normalised throughput of each UAV, where the host measured it.
        throughput: Option<&'a [f64]>,
    } = "step_communicate_with", within_step: true,
}

impl Call<'_> {
    /// Applies the call to a state.
    ///
    /// # Errors
    /// The errors of the [`Model`] method that has the same name.
    pub fn apply(
        &self,
        model: &Model<'_>,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
    ) -> Result<(), Error> {
        match *self {
            Self::SetStarts { cells } => model.set_starts(state, scratch, cells),
            Self::SetHotspots { cells } => model.set_hotspots(state, scratch, cells),
            Self::SetBatteries { charges_uj } => model.set_batteries(state, scratch, charges_uj),
            Self::SetBattery { uav, charge_uj } => {
                model.set_battery(state, scratch, uav, charge_uj)
            }
            Self::MoveHotspot { hotspot, cell } => {
                model.move_hotspot(state, scratch, hotspot, cell)
            }
            Self::SetPositions { cells } => model.set_positions(state, cells),
            Self::Ground { uav } => model.ground(state, uav),
            Self::ConfirmHotspot { hotspot } => model.confirm_hotspot(state, hotspot),
            Self::StepSenseWith { detections } => model.step_sense_with(state, scratch, detections),
            Self::StepCommunicateWith { links, throughput } => {
                model.step_communicate_with(state, scratch, links, throughput)
            }
        }
    }
}
