//! Texts of unknown origin, made safe for a terminal.

use core::fmt::{self, Display, Write};

/// A message that may contain text from input. It is displayed with each character escaped that
/// could steer a terminal or change the order of the text around it.
///
/// These are the control characters, line and paragraph separators, and the marks that hide or
/// reorder text. Each is shown as in Rust and JSON 5: `\u{1b}`.
#[derive(Clone, Copy, Debug)]
pub struct Printable<T>(pub T);

impl<T: Display> Display for Printable<T> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(Escape(out), "{}", self.0)
    }
}

struct Escape<'o, 'f>(&'o mut fmt::Formatter<'f>);

impl Write for Escape<'_, '_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let mut rest = text;
        while let Some((plain, c, after)) = split(rest) {
            self.0.write_str(plain)?;
            write!(self.0, "{}", c.escape_unicode())?;
            rest = after;
        }
        self.0.write_str(rest)
    }
}

/// The text before the first unsafe character, the character, and the text after it.
fn split(text: &str) -> Option<(&str, char, &str)> {
    let (plain, rest) = text.split_at_checked(text.find(is_unsafe)?)?;
    let mut characters = rest.chars();
    let c = characters.next()?;
    Some((plain, c, characters.as_str()))
}

fn is_unsafe(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{61c}' | '\u{180e}' | '\u{feff}'
                | '\u{200b}'..='\u{200f}'
                | '\u{2028}'..='\u{202e}'
                | '\u{2060}'..='\u{206f}'
        )
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::Printable;

    #[test]
    fn what_steers_a_terminal_is_escaped_and_the_rest_stays() {
        for (text, shown) in [
            ("", ""),
            ("ρ = 0.3, 50 %", "ρ = 0.3, 50 %"),
            ("a\u{1b}[31mb", "a\\u{1b}[31mb"),
            ("\u{7f}\u{9b}31m", "\\u{7f}\\u{9b}31m"),
            ("a\nb\r\t", "a\\u{a}b\\u{d}\\u{9}"),
            ("x\u{202e}y\u{2066}", "x\\u{202e}y\\u{2066}"),
            ("\u{feff}\u{200b}é\u{2028}", "\\u{feff}\\u{200b}é\\u{2028}"),
        ] {
            assert_eq!(Printable(text).to_string(), shown);
        }
    }
}
