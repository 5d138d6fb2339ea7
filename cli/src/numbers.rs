//! Numbers on the command line: an error names the option, the value and the range.

use clap::Command;
use jcas_core::Config;

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
pub fn whole(text: &str) -> Result<u64, String> {
    from(0, text)
}

/// Parses a whole number above 0, such as a number of missions.
///
/// # Errors
/// The text is none.
pub fn above_zero(text: &str) -> Result<u64, String> {
    from(1, text)
}

fn from(low: u64, text: &str) -> Result<u64, String> {
    match text.parse() {
        Ok(number) if number >= low => Ok(number),
        _ => Err(format!("must be a whole number from {low} to {}", u64::MAX)),
    }
}

/// Parses a number of UAVs.
///
/// # Errors
/// No configuration may have this value.
pub fn uavs(text: &str) -> Result<u32, String> {
    field("uav_count", text)
}

/// Parses a number of hotspots.
///
/// # Errors
/// No configuration may have this value.
pub fn hotspots(text: &str) -> Result<u32, String> {
    field("hotspot_count", text)
}

fn field(name: &str, text: &str) -> Result<u32, String> {
    let info = Config::FIELDS.iter().find(|info| info.name == name);
    let (low, high) = info.map_or((0.0, 0.0), |info| (info.low, info.high));
    match text.parse::<u32>() {
        Ok(number) if (low..=high).contains(&f64::from(number)) => Ok(number),
        _ => Err(format!(
            "{name} = {text}: must be a whole number from {low} to {high}"
        )),
    }
}
