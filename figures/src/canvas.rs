//! A list of shapes in CSS pixels, which plotters draws on any of its backends.

use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind};
use plotters::element::{Circle, PathElement, Polygon, Rectangle, Text};
use plotters::prelude::DrawingBackend;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{RGBAColor, ShapeStyle, TextStyle};

use super::font::font;
use super::palette::{Colour, Marker, PAPER};

pub(super) type Place = (f64, f64);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Align {
    Left,
    Centre,
    Right,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Type {
    pub size: f64,
    pub bold: bool,
    pub colour: Colour,
}

#[derive(Debug)]
enum Shape {
    Line {
        points: Vec<Place>,
        colour: Colour,
        width: f64,
    },
    Fill {
        points: Vec<Place>,
        colour: Colour,
    },
    Box {
        from: Place,
        to: Place,
        colour: Colour,
    },
    Disc {
        at: Place,
        radius: f64,
        colour: Colour,
    },
    Text {
        at: Place,
        text: String,
        font: Type,
        align: Align,
    },
}

/// The surface on which a figure draws.
#[derive(Debug, Default)]
pub struct Canvas {
    shapes: Vec<Shape>,
}

impl Canvas {
    pub(super) fn line(&mut self, points: &[Place], colour: Colour, width: f64, dash: &[f64]) {
        for part in dashes(points, dash) {
            self.shapes.push(Shape::Line {
                points: part,
                colour,
                width,
            });
        }
    }

    pub(super) fn fill(&mut self, points: Vec<Place>, colour: Colour) {
        self.shapes.push(Shape::Fill { points, colour });
    }

    pub(super) fn rectangle(&mut self, from: Place, to: Place, colour: Colour) {
        self.shapes.push(Shape::Box { from, to, colour });
    }

    pub(super) fn disc(&mut self, at: Place, radius: f64, colour: Colour) {
        self.shapes.push(Shape::Disc { at, radius, colour });
    }

    /// Adds a text; `at` is the middle of its height.
    pub(super) fn text(&mut self, at: Place, text: impl Into<String>, font: Type, align: Align) {
        let text = text.into();
        self.shapes.push(Shape::Text {
            at,
            text,
            font,
            align,
        });
    }

    /// Adds a marker; size 1 is about 8 pixels wide.
    pub(super) fn marker(&mut self, (x, y): Place, marker: Marker, colour: Colour, size: f64) {
        let at = |(dx, dy): &Place| (x + dx * size, y + dy * size);
        let mut polygon = |corners: &[Place]| self.fill(corners.iter().map(at).collect(), colour);
        match marker {
            Marker::Triangle => polygon(&[(-4.6, 3.8), (4.6, 3.8), (0.0, -4.6)]),
            Marker::Downward => polygon(&[(-4.6, -3.8), (4.6, -3.8), (0.0, 4.6)]),
            Marker::Diamond => polygon(&[(-5.0, 0.0), (0.0, -5.0), (5.0, 0.0), (0.0, 5.0)]),
            Marker::Square => polygon(&[(-3.6, -3.6), (3.6, -3.6), (3.6, 3.6), (-3.6, 3.6)]),
            Marker::Disc => self.disc((x, y), 4.0 * size, colour),
            Marker::Ring => {
                self.disc((x, y), 4.4 * size, colour);
                self.disc((x, y), 2.4 * size, PAPER);
            }
            Marker::Cross => {
                self.line(
                    &[(-3.6, -3.6), (3.6, 3.6)].map(|end| at(&end)),
                    colour,
                    2.0 * size,
                    &[],
                );
                self.line(
                    &[(-3.6, 3.6), (3.6, -3.6)].map(|end| at(&end)),
                    colour,
                    2.0 * size,
                    &[],
                );
            }
            Marker::Plus => {
                self.line(
                    &[(-4.6, 0.0), (4.6, 0.0)].map(|end| at(&end)),
                    colour,
                    2.0 * size,
                    &[],
                );
                self.line(
                    &[(0.0, -4.6), (0.0, 4.6)].map(|end| at(&end)),
                    colour,
                    2.0 * size,
                    &[],
                );
            }
        }
    }

    /// Draws all shapes with `scale` device pixels per CSS pixel. `sink` moves text down by a
    /// fraction of its size, since backends differ in their vertical centre of a line.
    pub(super) fn render<DB: DrawingBackend>(
        &self,
        area: &DrawingArea<DB, Shift>,
        scale: f64,
        sink: f64,
    ) -> Result<(), DrawingAreaErrorKind<DB::ErrorType>> {
        let pixel = |(x, y): Place| ((x * scale).round() as i32, (y * scale).round() as i32);
        for shape in &self.shapes {
            match shape {
                Shape::Line {
                    points,
                    colour,
                    width,
                } => {
                    let style = ShapeStyle {
                        color: rgba(*colour),
                        filled: false,
                        stroke_width: (width * scale).round().max(1.0) as u32,
                    };
                    area.draw(&PathElement::new(
                        points.iter().copied().map(pixel).collect::<Vec<_>>(),
                        style,
                    ))?;
                }
                Shape::Fill { points, colour } => {
                    let corners: Vec<_> = points.iter().copied().map(pixel).collect();
                    area.draw(&Polygon::new(corners, rgba(*colour)))?;
                }
                Shape::Box { from, to, colour } => {
                    let style = ShapeStyle::from(rgba(*colour)).filled();
                    area.draw(&Rectangle::new([pixel(*from), pixel(*to)], style))?;
                }
                Shape::Disc { at, radius, colour } => {
                    let style = ShapeStyle::from(rgba(*colour)).filled();
                    area.draw(&Circle::new(
                        pixel(*at),
                        (radius * scale).round() as i32,
                        style,
                    ))?;
                }
                Shape::Text {
                    at,
                    text,
                    font: kind,
                    align,
                } => {
                    let colour = rgba(kind.colour);
                    let style = TextStyle::from(font(kind.size * scale, kind.bold))
                        .color(&colour)
                        .pos(Pos::new(horizontal(*align), VPos::Center));
                    let sunk = kind.size * sink;
                    let at = (at.0, at.1 + sunk);
                    area.draw(&Text::new(text.clone(), pixel(at), style))?;
                }
            }
        }
        Ok(())
    }
}

fn horizontal(align: Align) -> HPos {
    match align {
        Align::Left => HPos::Left,
        Align::Centre => HPos::Center,
        Align::Right => HPos::Right,
    }
}

fn rgba(Colour(red, green, blue, opacity): Colour) -> RGBAColor {
    RGBAColor(red, green, blue, opacity)
}

/// Cuts a polyline into the strokes of a dash pattern (on, off, on, off). An empty pattern leaves
/// the polyline whole.
fn dashes(points: &[Place], pattern: &[f64]) -> Vec<Vec<Place>> {
    if pattern.is_empty() {
        return vec![points.to_vec()];
    }
    let mut strokes = Vec::new();
    let mut stroke: Vec<Place> = points.first().copied().into_iter().collect();
    let (mut phase, mut left) = (0, pattern[0]);
    for ends in points.windows(2) {
        let [(ax, ay), (bx, by)] = [ends[0], ends[1]];
        let length = (bx - ax).hypot(by - ay);
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let at = (
                ax + (bx - ax) * done / length,
                ay + (by - ay) * done / length,
            );
            if phase % 2 == 0 {
                stroke.push(at);
                strokes.push(std::mem::take(&mut stroke));
            } else {
                stroke = vec![at];
            }
            phase = (phase + 1) % pattern.len();
            left = pattern[phase];
        }
        left -= length - done;
        if phase % 2 == 0 {
            stroke.push((bx, by));
        }
    }
    if stroke.len() > 1 {
        strokes.push(stroke);
    }
    strokes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(stroke: &[Place]) -> f64 {
        stroke
            .windows(2)
            .map(|p| (p[1].0 - p[0].0).hypot(p[1].1 - p[0].1))
            .sum()
    }

    #[test]
    fn dashes_follow_the_pattern_around_corners() {
        let strokes = dashes(&[(0.0, 0.0), (10.0, 0.0), (10.0, 10.0)], &[8.0, 4.0]);
        let lengths: Vec<f64> = strokes.iter().map(|stroke| length(stroke)).collect();
        assert_eq!(lengths, [8.0, 8.0]);
        assert_eq!(strokes[1], [(10.0, 2.0), (10.0, 10.0)]);
    }

    #[test]
    fn a_dash_bends_where_the_line_does() {
        let strokes = dashes(&[(0.0, 0.0), (5.0, 0.0), (5.0, 5.0)], &[8.0, 4.0]);
        assert_eq!(strokes, [vec![(0.0, 0.0), (5.0, 0.0), (5.0, 3.0)]]);
    }

    #[test]
    fn without_a_pattern_the_line_is_whole() {
        let points = [(0.0, 0.0), (1.0, 2.0), (3.0, 4.0)];
        assert_eq!(dashes(&points, &[]), [points.to_vec()]);
    }
}
