//! Sizes and colours of the texts of every figure, and the head that they share.

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

/// Between the edge of the figure and what is in it.
pub(super) const MARGIN: f64 = 22.0;

/// Title and note; gives the height at which they end.
pub(super) fn header(canvas: &mut Canvas, title: &str, note: &str, width: f64) -> f64 {
    canvas.text((MARGIN, 28.0), title, TITLE, Align::Left);
    let mut y = 50.0;
    for line in wrap(note, NOTE.size, width - 2.0 * MARGIN) {
        canvas.text((MARGIN, y), line, NOTE, Align::Left);
        y += 18.0;
    }
    y
}
