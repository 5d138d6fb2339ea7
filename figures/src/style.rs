//! Sizes and colours of the texts of every figure, and the header that they share.

use super::canvas::{Align, Canvas, Type};
use super::font::wrap;
use super::palette::{MUTED, TEXT};

pub(super) const TITLE: Type = Type {
    size: 21.0,
    bold: true,
    colour: TEXT,
};
pub(super) const NOTE: Type = Type {
    size: 14.5,
    bold: false,
    colour: MUTED,
};
pub(super) const CAPTION: Type = Type {
    size: 15.0,
    bold: true,
    colour: TEXT,
};
pub(super) const LABEL: Type = Type {
    size: 14.5,
    bold: false,
    colour: TEXT,
};

/// Distance between the edge of the figure and its content.
pub(super) const MARGIN: f64 = 22.0;

/// Fraction of the width that a title or note may take. A viewer that lacks the font uses a wider
/// one.
const SPARE: f64 = 0.86;

/// Draws title and note; returns the height at which they end.
pub(super) fn header(canvas: &mut Canvas, title: &str, note: &str, width: f64) -> f64 {
    let mut y = 28.0;
    for (text, kind, height) in [(title, TITLE, 22.0), (note, NOTE, 18.0)] {
        for line in wrap(text, kind, SPARE * (width - 2.0 * MARGIN)) {
            canvas.text((MARGIN, y), line, kind, Align::Left);
            y += height;
        }
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_title_that_is_too_long_goes_on_below() {
        let end = |title: &str| header(&mut Canvas::default(), title, "a note", 400.0);
        assert_eq!(end("Success"), 68.0);
        assert_eq!(end("Success over the sensing range, and the numbers"), 90.0);
    }
}
