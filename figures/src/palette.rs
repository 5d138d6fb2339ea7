//! The palette: colour (after Okabe and Ito, darkened where white paper requires it), marker and
//! dash.

/// A colour as red, green, blue and opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Colour(pub u8, pub u8, pub u8, pub f64);

impl Colour {
    pub(super) fn opacity(self, opacity: f64) -> Self {
        Self(self.0, self.1, self.2, opacity)
    }
}

pub(super) const TEXT: Colour = Colour(0x1f, 0x27, 0x33, 1.0);
pub(super) const MUTED: Colour = Colour(0x5a, 0x66, 0x7b, 1.0);
pub(super) const AXIS: Colour = Colour(0x8a, 0x94, 0xa6, 1.0);
pub(super) const GRID: Colour = Colour(0xe4, 0xe8, 0xef, 1.0);
pub(super) const PAPER: Colour = Colour(0xff, 0xff, 0xff, 1.0);

const COLOURS: [Colour; 8] = [
    Colour(0x00, 0x72, 0xb2, 1.0),
    Colour(0xd5, 0x5e, 0x00, 1.0),
    Colour(0x00, 0x8f, 0x68, 1.0),
    Colour(0xb8, 0x5a, 0x94, 1.0),
    Colour(0xd0, 0x8c, 0x00, 1.0),
    Colour(0x38, 0xa0, 0xd8, 1.0),
    Colour(0x33, 0x3b, 0x49, 1.0),
    Colour(0x8a, 0x2b, 0x2b, 1.0),
];

const DASHES: [&[f64]; 5] = [
    &[],
    &[8.0, 4.0],
    &[2.0, 3.0],
    &[9.0, 3.0, 2.0, 3.0],
    &[14.0, 4.0],
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Marker {
    Disc,
    Square,
    Triangle,
    Diamond,
    Cross,
    Downward,
    Ring,
    Plus,
}

const MARKERS: [Marker; 8] = [
    Marker::Disc,
    Marker::Square,
    Marker::Triangle,
    Marker::Diamond,
    Marker::Cross,
    Marker::Downward,
    Marker::Ring,
    Marker::Plus,
];

/// Colour, marker and dash of the series at an index of the palette. Markers shift by one on each
/// round through the colours, so that the first 64 indices all differ.
pub(super) fn look(index: usize) -> (Colour, Marker, &'static [f64]) {
    let round = index / COLOURS.len();
    (
        COLOURS[index % COLOURS.len()],
        MARKERS[(index + round) % MARKERS.len()],
        DASHES[(index + round) % DASHES.len()],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_places_look_the_same() {
        let looks: Vec<_> = (0..64).map(look).collect();
        for (i, a) in looks.iter().enumerate() {
            for b in &looks[..i] {
                assert!((a.0, a.1) != (b.0, b.1), "place {i}");
            }
        }
    }

    #[test]
    fn the_first_series_differ_without_colour() {
        for i in 0..8 {
            for k in 0..i {
                assert_ne!(look(i).1, look(k).1);
            }
        }
    }
}
