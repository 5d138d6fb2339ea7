//! The font of the figures, embedded in the program: no system font is used.

use std::sync::OnceLock;

use plotters::style::{FontDesc, FontFamily, FontStyle, register_font};

use super::canvas::Type;

/// The name that plotters writes into SVG; [`super::output`] replaces it with [`FAMILIES`].
pub(super) const REGISTERED: &str = "jcas-figure-font";

/// The font families that an SVG viewer looks for, the drawn font first.
pub(super) const FAMILIES: &str = "Roboto, 'Helvetica Neue', Arial, 'Liberation Sans', sans-serif";

const REGULAR: &[u8] = include_bytes!("font/Roboto-Regular.ttf");
const MEDIUM: &[u8] = include_bytes!("font/Roboto-Medium.ttf");

/// Returns the font in a size; the first call registers it with plotters.
pub(super) fn font(size: f64, bold: bool) -> FontDesc<'static> {
    static REGISTERED_ONCE: OnceLock<()> = OnceLock::new();
    REGISTERED_ONCE.get_or_init(|| {
        for (style, bytes) in [(FontStyle::Normal, REGULAR), (FontStyle::Bold, MEDIUM)] {
            assert!(
                register_font(REGISTERED, style, bytes).is_ok(),
                "the embedded font is a valid font"
            );
        }
    });
    let style = if bold {
        FontStyle::Bold
    } else {
        FontStyle::Normal
    };
    FontDesc::new(FontFamily::Name(REGISTERED), size, style)
}

/// Width of a line of text in pixels.
pub(super) fn text_width(text: &str, size: f64, bold: bool) -> f64 {
    // The width is measured at a large size, since plotters rounds to whole pixels.
    const SCALE: f64 = 16.0;
    let extent = font(size * SCALE, bold).box_size(text);
    f64::from(extent.map_or(0, |(width, _)| width)) / SCALE
}

/// Breaks a text at spaces so that no line is wider than the limit, except for a long single word.
pub(super) fn wrap(text: &str, kind: Type, limit: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if text_width(&format!("{line} {word}"), kind.size, kind.bold) <= limit => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::style::NOTE;

    #[test]
    fn text_is_measured_with_the_embedded_font() {
        let narrow = text_width("iiii", 12.0, false);
        let wide = text_width("mmmm", 12.0, false);
        assert!(narrow > 8.0 && wide > 2.0 * narrow, "{narrow} {wide}");
        assert!((text_width("mmmm", 24.0, false) / wide - 2.0).abs() < 0.05);
    }

    #[test]
    fn long_names_are_broken_at_spaces() {
        let lines = wrap("pilot density held at its largest value", NOTE, 120.0);
        assert!(lines.len() > 1);
        assert!(
            lines
                .iter()
                .all(|line| text_width(line, NOTE.size, NOTE.bold) <= 120.0)
        );
        assert_eq!(lines.join(" "), "pilot density held at its largest value");
    }
}
