//! Values as they stand in a text.

use super::Form;
use super::scan::Scanner;
use crate::config::{Cell, Depots, DetectionTable};

/// A value in a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TextValue<'t> {
    /// A number written without fraction and exponent, if it fits, and the same as a real.
    Whole(Option<u32>, f64),
    /// Any other number.
    Real(f64),
    /// A text in quotes, without them; escapes are not resolved, as no legal text has any.
    Name(&'t str),
    /// A list of pairs of numbers.
    Pairs(Pairs<'t>),
    /// JSON's null.
    Null,
    /// Anything that no field takes.
    Other,
}

impl TextValue<'_> {
    pub(in crate::config) const fn real(&self) -> Option<f64> {
        match *self {
            Self::Whole(_, value) | Self::Real(value) => Some(value),
            _ => None,
        }
    }

    pub(in crate::config) const fn whole(&self) -> Option<u32> {
        match *self {
            Self::Whole(whole, _) => whole,
            _ => None,
        }
    }
}

/// Most characters of a number; each double can be written with fewer.
const DIGITS: usize = 64;

/// Reads a number. TOML's grammar is wider than JSON's.
pub(super) fn number(raw: &str, toml: bool) -> Option<TextValue<'static>> {
    let unsigned = raw.strip_prefix(['-', '+']).unwrap_or(raw);
    if raw.starts_with('+') && !toml {
        return None;
    }
    if toml && matches!(unsigned, "inf" | "nan") {
        let value = if unsigned == "nan" {
            f64::NAN
        } else if raw.starts_with('-') {
            f64::NEG_INFINITY
        } else {
            f64::INFINITY
        };
        return Some(TextValue::Real(value));
    }
    if toml {
        for (prefix, radix) in [("0x", 16), ("0o", 8), ("0b", 2)] {
            if let Some(digits) = raw.strip_prefix(prefix) {
                let mut plain = [0; DIGITS];
                let digits = without_underscores(digits, &mut plain)?;
                let value = u64::from_str_radix(digits, radix).ok()?;
                return Some(TextValue::Whole(u32::try_from(value).ok(), value as f64));
            }
        }
    }
    let mut plain = [0; DIGITS];
    let raw = if toml {
        without_underscores(raw, &mut plain)?
    } else {
        raw
    };
    let whole = is_decimal(raw)?;
    let value: f64 = raw.parse().ok()?;
    Some(if whole {
        TextValue::Whole(raw.strip_prefix('+').unwrap_or(raw).parse().ok(), value)
    } else {
        TextValue::Real(value)
    })
}

/// Whether a decimal number is whole; `None` for what is no decimal number:
/// sign, digits without leading zeros, fraction, exponent.
fn is_decimal(raw: &str) -> Option<bool> {
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let unsigned = raw.strip_prefix(['-', '+']).unwrap_or(raw);
    let (mantissa, exponent) = match unsigned.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, Some(exponent)),
        None => (unsigned, None),
    };
    let (whole, fraction) = match mantissa.split_once('.') {
        Some((whole, fraction)) => (whole, Some(fraction)),
        None => (mantissa, None),
    };
    let legal = digits(whole)
        && (whole.len() == 1 || !whole.starts_with('0'))
        && fraction.is_none_or(digits)
        && exponent.is_none_or(|text| digits(text.strip_prefix(['-', '+']).unwrap_or(text)));
    legal.then_some(fraction.is_none() && exponent.is_none())
}

/// TOML allows an underscore between two digits.
fn without_underscores<'b>(raw: &str, buffer: &'b mut [u8; DIGITS]) -> Option<&'b str> {
    let bytes = raw.as_bytes();
    let mut len = 0;
    for (index, &byte) in bytes.iter().enumerate() {
        if byte == b'_' {
            let between = index > 0
                && bytes[index - 1].is_ascii_hexdigit()
                && bytes.get(index + 1).is_some_and(u8::is_ascii_hexdigit);
            if !between {
                return None;
            }
            continue;
        }
        *buffer.get_mut(len)? = byte;
        len += 1;
    }
    core::str::from_utf8(&buffer[..len]).ok()
}

/// A list of pairs of numbers, as it stands in a text. Each field reads the pairs that it takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pairs<'t> {
    text: &'t str,
    form: Form,
}

impl<'t> Pairs<'t> {
    pub(super) const fn new(text: &'t str, form: Form) -> Self {
        Self { text, form }
    }

    /// Passes each pair on, up to the first that is refused.
    fn each(self, mut take: impl FnMut(TextValue<'_>, TextValue<'_>) -> Option<()>) -> Option<()> {
        let mut taken = Some(());
        let mut scanner = Scanner::new(self.text, self.form);
        let scanned = scanner.pairs(|first, second| {
            taken = taken.and_then(|()| take(first, second));
        });
        scanned.ok().and(taken)
    }

    /// The pairs as cells; `None` if one is none or they are too many.
    pub(in crate::config) fn cells(self) -> Option<Depots> {
        let mut depots = Depots::CENTRE;
        self.each(|x, y| {
            let (x, y) = (x.whole()?, y.whole()?);
            depots.push(Cell { x, y })
        })?;
        Some(depots)
    }

    /// The pairs as points of a detection table; `None` if one is none or they are too many.
    pub(in crate::config) fn table(self) -> Option<DetectionTable> {
        let mut table = DetectionTable::EMPTY;
        self.each(|range_m, probability| {
            table.push((range_m.real()?, probability.real()?).into())
        })?;
        Some(table)
    }
}
