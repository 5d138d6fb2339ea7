//! Values of options on the command line: an error says what is allowed.

use clap::Command;
use displaydoc::Display;
use jcas_core::{Cell, Config};

/// The reason why a text is no value of an option.
#[derive(Clone, Debug, Display, PartialEq, thiserror::Error)]
pub enum ValueError {
    /// must be a whole number from {low} to {high}
    Whole {
        /// The least number.
        low: u64,
        /// The greatest number.
        high: u64,
    },
    /// {field} = {text}: must be a whole number from {low} to {high}
    Field {
        /// The field of the configuration.
        field: &'static str,
        /// The text.
        text: String,
        /// The least number.
        low: f64,
        /// The greatest number.
        high: f64,
    },
    /// must be a number above 0
    NotPositive,
    /// must be 0x and up to sixteen hexadecimal digits, or a decimal number
    Seed,
    /// must be a column and a row, such as 3,8
    Cell,
    #[displaydoc(
        "must be a latitude above -89 and below 89 and a longitude from -180 to 180, such as \
         48.137,11.575"
    )]
    /// The text is no latitude and longitude.
    Place,
}

/// Lets every option take a negative number, which its parser then refuses with a range. Otherwise
/// clap takes the number for an unknown option.
#[must_use]
pub fn accept_negative(command: Command) -> Command {
    command
        .mut_args(|argument| {
            let takes = argument.get_action().takes_values() && !argument.is_positional();
            argument.allow_negative_numbers(takes)
        })
        .mut_subcommands(accept_negative)
}

/// Parses a whole number, such as a seed.
///
/// # Errors
/// The text is none.
pub fn whole(text: &str) -> Result<u64, ValueError> {
    from(0, text)
}

/// Parses a whole number above 0, such as a number of episodes.
///
/// # Errors
/// The text is none.
pub fn above_zero(text: &str) -> Result<u64, ValueError> {
    from(1, text)
}

fn from(low: u64, text: &str) -> Result<u64, ValueError> {
    match text.parse() {
        Ok(number) if number >= low => Ok(number),
        _ => {
            let high = u64::MAX;
            Err(ValueError::Whole { low, high })
        }
    }
}

/// Parses a number of UAVs.
///
/// # Errors
/// No configuration may have this value.
pub fn uavs(text: &str) -> Result<u32, ValueError> {
    field("uav_count", text)
}

/// Parses a number of hotspots.
///
/// # Errors
/// No configuration may have this value.
pub fn hotspots(text: &str) -> Result<u32, ValueError> {
    field("hotspot_count", text)
}

fn field(field: &'static str, text: &str) -> Result<u32, ValueError> {
    let info = Config::FIELDS.iter().find(|info| info.name == field);
    let (low, high) = info.map_or((0.0, 0.0), |info| (info.low, info.high));
    match text.parse::<u32>() {
        Ok(number) if (low..=high).contains(&f64::from(number)) => Ok(number),
        _ => {
            let text = text.to_owned();
            Err(ValueError::Field {
                field,
                text,
                low,
                high,
            })
        }
    }
}

/// Parses a number above 0, such as a duration.
///
/// # Errors
/// The text is none.
pub fn positive(text: &str) -> Result<f64, ValueError> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err(ValueError::NotPositive),
    }
}

/// Parses the seed of an episode.
///
/// # Errors
/// The text is none.
pub fn seed(text: &str) -> Result<u64, ValueError> {
    let seed = match text.strip_prefix("0x") {
        Some(digits) => u64::from_str_radix(digits, 16),
        None => text.parse(),
    };
    seed.or(Err(ValueError::Seed))
}

/// Parses a cell.
///
/// # Errors
/// The text is none.
pub fn cell(text: &str) -> Result<Cell, ValueError> {
    let pair = text.split_once(',').and_then(|(x, y)| {
        let (x, y) = (x.trim().parse().ok()?, y.trim().parse().ok()?);
        Some(Cell { x, y })
    });
    pair.ok_or(ValueError::Cell)
}

/// Parses a latitude and a longitude, in degrees.
///
/// # Errors
/// The text is none.
pub fn place(text: &str) -> Result<(f64, f64), ValueError> {
    let pair = text.split_once(',').and_then(|(latitude, longitude)| {
        let latitude: f64 = latitude.trim().parse().ok()?;
        let longitude: f64 = longitude.trim().parse().ok()?;
        (latitude.abs() < 89.0 && longitude.abs() <= 180.0).then_some((latitude, longitude))
    });
    pair.ok_or(ValueError::Place)
}
