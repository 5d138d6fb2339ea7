//! Writes figures to files: first under a temporary name, so that no partial figure remains under
//! the final name.

use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use plotters::prelude::{BitMapBackend, DrawingBackend, IntoDrawingArea, SVGBackend};

use super::canvas::Canvas;
use super::font::{FAMILIES, REGISTERED};

/// Device pixels per CSS pixel in PNG files.
const PNG_SCALE: u32 = 2;
/// PNG files are drawn larger by this factor and averaged, since plotters does not smooth every
/// edge.
const OVERSAMPLING: u32 = 2;
/// plotters writes whole numbers into SVG, so the picture is drawn larger and shown smaller.
const SVG_SCALE: u32 = 8;
/// Downward shift of text in PNG files, as a fraction of its size. The library plotters centres a
/// line by its box, whose upper part is empty above most letters.
const PNG_TEXT_SINK: f64 = 0.12;

/// The reason why a figure could not be drawn or written.
#[derive(Debug)]
pub enum FigureError {
    /// plotters or the PNG encoder returned an error.
    Draw(String),
    /// The file could not be written.
    Write {
        /// Path of the file.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
}

impl fmt::Display for FigureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Draw(problem) => write!(f, "the figure cannot be drawn: {problem}"),
            Self::Write { path, source } => {
                write!(f, "{} cannot be written: {source}", path.display())
            }
        }
    }
}

impl std::error::Error for FigureError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Draw(_) => None,
            Self::Write { source, .. } => Some(source),
        }
    }
}

/// A figure that can be drawn and written.
pub trait Draw {
    /// Width and height in CSS pixels.
    fn size(&self) -> (u32, u32);

    /// The text that a screen reader reads.
    fn description(&self) -> String;

    /// Puts every shape on the canvas.
    fn draw(&self, canvas: &mut Canvas);

    /// The figure as the text of an SVG file.
    ///
    /// # Errors
    /// plotters cannot draw the figure.
    fn svg(&self) -> Result<String, FigureError> {
        let (width, height) = self.size();
        let drawn = (width * SVG_SCALE, height * SVG_SCALE);
        let mut text = String::new();
        let area = SVGBackend::with_string(&mut text, drawn).into_drawing_area();
        render(self, &area, f64::from(SVG_SCALE), 0.0)?;
        drop(area);
        let text = text.replacen(
            &format!("width=\"{}\" height=\"{}\"", drawn.0, drawn.1),
            &format!("width=\"{width}\" height=\"{height}\""),
            1,
        );
        let title = escape(&self.description());
        // A figure inside a page is at most as wide as the page, and has a name for screen readers.
        let named = text.replacen(
            "<svg ",
            "<svg role=\"img\" style=\"max-width:100%;height:auto\" ",
            1,
        );
        let opened = named.replacen(">\n", &format!(">\n<title>{title}</title>\n"), 1);
        Ok(opened.replace(REGISTERED, FAMILIES))
    }

    /// The figure as the bytes of a PNG file.
    ///
    /// # Errors
    /// plotters or the encoder cannot make the image.
    fn png(&self) -> Result<Vec<u8>, FigureError> {
        let (width, height) = self.size();
        let factor = PNG_SCALE * OVERSAMPLING;
        let mut large = vec![255; (width * height * factor * factor * 3) as usize];
        let backend = BitMapBackend::with_buffer(&mut large, (width * factor, height * factor));
        render(
            self,
            &backend.into_drawing_area(),
            f64::from(factor),
            PNG_TEXT_SINK,
        )?;
        encode_png(
            &averaged(&large, width * PNG_SCALE),
            width * PNG_SCALE,
            height * PNG_SCALE,
        )
    }

    /// Writes the figure as SVG.
    ///
    /// # Errors
    /// The figure cannot be drawn or the file cannot be written.
    fn write_svg(&self, path: impl AsRef<Path>) -> Result<(), FigureError>
    where
        Self: Sized,
    {
        write_file(path.as_ref(), self.svg()?.as_bytes())
    }

    /// Writes the figure as PNG.
    ///
    /// # Errors
    /// The figure cannot be drawn or the file cannot be written.
    fn write_png(&self, path: impl AsRef<Path>) -> Result<(), FigureError>
    where
        Self: Sized,
    {
        write_file(path.as_ref(), &self.png()?)
    }
}

fn render<DB: DrawingBackend>(
    figure: &(impl Draw + ?Sized),
    area: &plotters::drawing::DrawingArea<DB, plotters::coord::Shift>,
    scale: f64,
    sink: f64,
) -> Result<(), FigureError> {
    let mut canvas = Canvas::default();
    let (width, height) = figure.size();
    canvas.rectangle(
        (0.0, 0.0),
        (f64::from(width), f64::from(height)),
        super::palette::PAPER,
    );
    figure.draw(&mut canvas);
    canvas
        .render(area, scale, sink)
        .and_then(|()| area.present())
        .map_err(|error| FigureError::Draw(error.to_string()))
}

/// Averages squares of `OVERSAMPLING` pixels a side; each gives one pixel of the result.
fn averaged(large: &[u8], width: u32) -> Vec<u8> {
    let (width, side) = (width as usize, OVERSAMPLING as usize);
    let stride = width * side * 3;
    let height = large.len() / stride / side;
    let mut small = Vec::with_capacity(width * height * 3);
    for y in 0..height {
        for x in 0..width {
            for channel in 0..3 {
                let square = (0..side * side).map(|k| {
                    let (row, column) = (y * side + k / side, x * side + k % side);
                    u32::from(large[row * stride + column * 3 + channel])
                });
                let count = OVERSAMPLING * OVERSAMPLING;
                small.push(((square.sum::<u32>() + count / 2) / count) as u8);
            }
        }
    }
    small
}

fn encode_png(pixels: &[u8], width: u32, height: u32) -> Result<Vec<u8>, FigureError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(pixels))
        .map_err(|error| FigureError::Draw(error.to_string()))?;
    Ok(bytes)
}

/// Writes a temporary file beside the target and renames it.
pub(super) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), FigureError> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.tmp", std::process::id()));
    let temporary = path.with_file_name(name);
    let written = fs::write(&temporary, bytes).and_then(|()| fs::rename(&temporary, path));
    written.map_err(|source| {
        // The temporary file is of no use after an error. An error of its removal would hide the
        // first one.
        let _ = fs::remove_file(&temporary);
        FigureError::Write {
            path: path.to_owned(),
            source,
        }
    })
}

/// Escapes a text for HTML and SVG, also for attributes.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
