//! The legend, to the right of the data. Where every series is a line, each name stands beside the
//! end of its line; otherwise the names form a list.

use super::canvas::{Align, Canvas};
use super::font::{text_width, wrap};
use super::palette::look;
use super::plot::Plot;
use super::style::{LABEL, MARGIN};
use super::{Figure, Mark, Series};

/// Width of a sample, which is a stroke and a marker of the series.
const SAMPLE: f64 = 26.0;
/// Distance from the data to the samples, with room for the lines that lead to the names.
const LEAD: f64 = 20.0;
const LINE_HEIGHT: f64 = 17.0;
const GAP: f64 = 6.0;
/// Height of a row in a legend that several plots share.
pub(super) const ROW_HEIGHT: f64 = 22.0;
/// Distance between two names of a row.
const BETWEEN: f64 = 22.0;
const WIDEST_NAME: f64 = 165.0;

/// Width of the legend; 0 for a single series.
pub(super) fn width(series: &[Series]) -> f64 {
    if series.len() < 2 {
        return 0.0;
    }
    let lines = series
        .iter()
        .flat_map(|series| wrap(&series.name, LABEL, WIDEST_NAME));
    let widest = lines
        .map(|line| text_width(&line, LABEL.size, false))
        .fold(0.0, f64::max);
    LEAD + SAMPLE + 6.0 + widest
}

struct Entry {
    index: usize,
    mark: Mark,
    lines: Vec<String>,
    /// Height at which the line ends, if the name stands beside it.
    end: Option<f64>,
    /// Height of the middle of the entry.
    y: f64,
}

impl Entry {
    fn height(&self) -> f64 {
        LINE_HEIGHT * self.lines.len() as f64
    }
}

pub(super) fn draw(canvas: &mut Canvas, figure: &Figure, looks: &[usize], plot: &Plot) {
    let direct = figure.series.iter().all(|series| {
        matches!(series.style.mark, Mark::Line | Mark::PlainLine) && series.labels.is_empty()
    });
    let mut entries: Vec<Entry> = figure
        .series
        .iter()
        .zip(looks)
        .map(|(series, look)| {
            let last = series.points.iter().rev().find(|point| point.is_drawn());
            let end = last.filter(|_| direct).map(|point| plot.at(point).1);
            Entry {
                index: *look,
                mark: series.style.mark,
                lines: wrap(&series.name, LABEL, WIDEST_NAME),
                end,
                y: end.unwrap_or(plot.frame.top),
            }
        })
        .collect();
    if direct {
        entries.sort_by(|a, b| a.y.total_cmp(&b.y));
    }
    spread(&mut entries, plot.frame.top, plot.frame.bottom);
    for entry in &entries {
        draw_entry(canvas, entry, plot.frame.right);
    }
}

/// An entry of a legend that several plots share: text, index in the palette, mark.
pub(super) type Name = (String, usize, Mark);

/// Draws names one below the other, from a given place.
pub(super) fn draw_list(canvas: &mut Canvas, names: &[Name], (x, y): (f64, f64)) {
    for (k, name) in names.iter().enumerate() {
        draw_name(canvas, name, x, y + ROW_HEIGHT * k as f64);
    }
}

/// Draws names side by side in centred rows, from a given height.
pub(super) fn draw_rows(canvas: &mut Canvas, names: &[Name], y: f64, width: f64) {
    for (k, row) in rows(names, width).iter().enumerate() {
        let mut x = (width - row.iter().map(name_width).sum::<f64>() + BETWEEN) / 2.0;
        for name in *row {
            draw_name(canvas, name, x, y + ROW_HEIGHT * k as f64);
            x += name_width(name);
        }
    }
}

/// Cuts names into rows that fit a width.
pub(super) fn rows(names: &[Name], width: f64) -> Vec<&[Name]> {
    let mut rows = Vec::new();
    let (mut start, mut taken) = (0, 0.0);
    for (k, name) in names.iter().enumerate() {
        if k > start && taken + name_width(name) - BETWEEN > width - 2.0 * MARGIN {
            rows.push(&names[start..k]);
            (start, taken) = (k, 0.0);
        }
        taken += name_width(name);
    }
    if start < names.len() {
        rows.push(&names[start..]);
    }
    rows
}

/// Width of a name with the distance to the next name.
pub(super) fn name_width((name, ..): &Name) -> f64 {
    SAMPLE + 6.0 + text_width(name, LABEL.size, false) + BETWEEN
}

fn draw_name(canvas: &mut Canvas, (name, index, mark): &Name, x: f64, y: f64) {
    draw_sample(canvas, *index, *mark, x, y);
    canvas.text((x + SAMPLE + 6.0, y), name.as_str(), LABEL, Align::Left);
}

/// Moves entries apart until none covers another: first downwards, then upwards from the bottom.
fn spread(entries: &mut [Entry], top: f64, bottom: f64) {
    let mut free_from = top - LINE_HEIGHT / 2.0;
    for entry in entries.iter_mut() {
        let half = entry.height() / 2.0;
        entry.y = entry.y.max(free_from + half);
        free_from = entry.y + half + GAP;
    }
    let mut free_to = bottom + LINE_HEIGHT / 2.0;
    for entry in entries.iter_mut().rev() {
        let half = entry.height() / 2.0;
        entry.y = entry.y.min(free_to - half);
        free_to = entry.y - half - GAP;
    }
}

fn draw_entry(canvas: &mut Canvas, entry: &Entry, right: f64) {
    let x = right + LEAD;
    if let Some(end) = entry.end {
        let (colour, ..) = look(entry.index);
        canvas.line(
            &[(right + 3.0, end), (x - 3.0, entry.y)],
            colour.opacity(0.45),
            1.0,
            &[],
        );
    }
    draw_sample(canvas, entry.index, entry.mark, x, entry.y);
    let first = entry.y - LINE_HEIGHT * (entry.lines.len() as f64 - 1.0) / 2.0;
    for (k, line) in entry.lines.iter().enumerate() {
        let y = first + LINE_HEIGHT * k as f64;
        canvas.text((x + SAMPLE + 6.0, y), line.as_str(), LABEL, Align::Left);
    }
}

fn draw_sample(canvas: &mut Canvas, index: usize, mark: Mark, x: f64, y: f64) {
    let (colour, marker, dash) = look(index);
    let middle = (x + SAMPLE / 2.0, y);
    match mark {
        Mark::Bars => canvas.rectangle((x + 6.0, y - 6.0), (x + SAMPLE, y + 6.0), colour),
        Mark::Points => canvas.marker(middle, marker, colour, 1.0),
        Mark::Line | Mark::PlainLine => {
            canvas.line(&[(x, y), (x + SAMPLE, y)], colour, 2.0, dash);
            if mark == Mark::Line {
                canvas.marker(middle, marker, colour, 1.0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_hold_every_name_and_fit() {
        let names: Vec<Name> = (0..9)
            .map(|k| (format!("a rather long name {k}"), k, Mark::Line))
            .collect();
        let rows = rows(&names, 600.0);
        assert!(rows.len() > 1);
        assert_eq!(rows.concat(), names);
        for row in rows {
            assert!(row.iter().map(name_width).sum::<f64>() - BETWEEN <= 600.0 - 2.0 * MARGIN);
        }
    }

    #[test]
    fn names_never_cover_each_other() {
        let entry = |y: f64, lines: usize| Entry {
            index: 0,
            mark: Mark::Line,
            lines: vec![String::new(); lines],
            end: Some(y),
            y,
        };
        let mut entries = vec![
            entry(50.0, 1),
            entry(50.0, 2),
            entry(51.0, 1),
            entry(99.0, 1),
        ];
        spread(&mut entries, 0.0, 100.0);
        for pair in entries.windows(2) {
            let needed = (pair[0].height() + pair[1].height()) / 2.0;
            assert!(
                pair[1].y - pair[0].y >= needed,
                "{} {}",
                pair[0].y,
                pair[1].y
            );
        }
        assert!(entries[3].y <= 100.0);
    }
}
