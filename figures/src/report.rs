//! One self-contained HTML page: sections of text, figures and tables, in reading order.

use std::path::Path;

use super::output::{Draw, FigureError, escape, write_file};

const STYLE: &str = include_str!("report.css");

/// A table with more rows is folded.
const ROWS_OPEN: usize = 12;

/// A report under construction.
#[derive(Clone, Debug)]
pub struct Report {
    title: String,
    contents: Vec<(String, String)>,
    body: String,
}

/// A table; columns of numbers are aligned to the right.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// The caption.
    pub caption: String,
    /// Head of each column.
    pub head: Vec<String>,
    /// The rows; each has as many cells as the head.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell of a table.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cell {
    /// The text of the cell.
    pub text: String,
    /// Whether the cell is marked as good or bad.
    pub tone: Tone,
}

/// The tone of a cell, shown by colour and by weight or a mark.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    /// The cell has no tone.
    #[default]
    Plain,
    /// The value is good: it holds, is the best, or reaches its goal.
    Good,
    /// The value is bad: it does not hold or misses its goal.
    Bad,
}

impl<T: Into<String>> From<T> for Cell {
    fn from(text: T) -> Self {
        Self {
            text: text.into(),
            tone: Tone::Plain,
        }
    }
}

impl Cell {
    /// Returns the cell with a tone.
    #[must_use]
    pub fn tone(mut self, tone: Tone) -> Self {
        self.tone = tone;
        self
    }
}

impl Report {
    /// Starts a report; the summary stands under its title.
    pub fn new(title: impl Into<String>, summary: &str) -> Self {
        let mut report = Self {
            title: title.into(),
            contents: Vec::new(),
            body: String::new(),
        };
        report.text(summary);
        report
    }

    /// Starts a section, which the table of contents lists.
    pub fn section(&mut self, heading: &str) -> &mut Self {
        let anchor = format!("section-{}", self.contents.len() + 1);
        self.push(&format!("<h2 id=\"{anchor}\">{}</h2>", inline(heading)));
        self.contents.push((anchor, heading.to_owned()));
        self
    }

    /// Adds paragraphs, which empty lines separate. `code` between backticks is set as code, and
    /// `**words**` in bold; everything else is plain text.
    pub fn text(&mut self, text: &str) -> &mut Self {
        for paragraph in text
            .split("\n\n")
            .map(str::trim)
            .filter(|paragraph| !paragraph.is_empty())
        {
            self.push(&format!("<p>{}</p>", inline(paragraph)));
        }
        self
    }

    /// Adds a prominent link to a page beside the report.
    pub fn link(&mut self, page: &str, text: &str) -> &mut Self {
        let line = format!("<a href=\"{}\">{}</a>", escape(page), inline(text));
        self.push(&format!("<p class=\"link\">{line}</p>"));
        self
    }

    /// Adds a bulleted list.
    pub fn list<T: AsRef<str>>(&mut self, items: impl IntoIterator<Item = T>) -> &mut Self {
        let items: String = items
            .into_iter()
            .map(|item| format!("<li>{}</li>\n", inline(item.as_ref())))
            .collect();
        self.push(&format!("<ul>\n{items}</ul>"));
        self
    }

    /// Adds a figure with a remark, which may be empty.
    ///
    /// # Errors
    /// The figure cannot be drawn.
    pub fn figure(
        &mut self,
        figure: &(impl Draw + ?Sized),
        caption: &str,
    ) -> Result<&mut Self, FigureError> {
        let svg = figure.svg()?;
        let caption = if caption.is_empty() {
            String::new()
        } else {
            format!("<figcaption>{}</figcaption>\n", inline(caption))
        };
        self.push(&format!("<figure>\n{svg}{caption}</figure>"));
        Ok(self)
    }

    /// Adds a table.
    pub fn table(&mut self, table: &Table) -> &mut Self {
        let numeric: Vec<bool> = (0..table.head.len())
            .map(|column| {
                let mut cells = table.rows.iter().filter_map(|row| row.get(column));
                cells.all(|cell| cell.text.is_empty() || is_number(&cell.text))
            })
            .collect();
        let head = |(column, name): (usize, &String)| {
            let class = if numeric[column] {
                " class=\"number\""
            } else {
                ""
            };
            format!("<th scope=\"col\"{class}>{}</th>", inline(name))
        };
        let head: String = table.head.iter().enumerate().map(head).collect();
        let rows: String = table
            .rows
            .iter()
            .map(|cells| row(cells, &numeric))
            .collect();
        let caption = inline(&table.caption);
        let table_html = format!(
            "<div class=\"table\"><table>\n<caption>{caption}</caption>\n\
             <thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>"
        );
        let count = table.rows.len();
        if count > ROWS_OPEN {
            self.push(&format!(
                "<details><summary>Table of {count} rows</summary>\n{table_html}</details>"
            ));
        } else {
            self.push(&table_html);
        }
        self
    }

    /// Returns the whole page.
    pub fn html(&self) -> String {
        let title = escape(&self.title);
        let links: String = self
            .contents
            .iter()
            .map(|(anchor, heading)| {
                format!("<li><a href=\"#{anchor}\">{}</a></li>\n", inline(heading))
            })
            .collect();
        let contents = if self.contents.len() < 2 {
            String::new()
        } else {
            format!("<nav aria-label=\"Contents\"><ol>\n{links}</ol></nav>\n")
        };
        let (summary, rest) = match self.body.find("<h2 ") {
            Some(start) => self.body.split_at(start),
            None => (self.body.as_str(), ""),
        };
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta http-equiv=\"Content-Security-Policy\" \
             content=\"default-src 'none'; style-src 'unsafe-inline'; img-src data:\">\n\
             <link rel=\"icon\" href=\"data:,\">\n<title>{title}</title>\n\
             <style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n\
             {summary}{contents}{rest}</main>\n</body>\n</html>\n"
        )
    }

    /// Writes the page, first under a temporary name.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), FigureError> {
        write_file(path.as_ref(), self.html().as_bytes())
    }

    fn push(&mut self, html: &str) {
        self.body.push_str(html);
        self.body.push('\n');
    }
}

fn row(cells: &[Cell], numeric: &[bool]) -> String {
    let cells: String = cells
        .iter()
        .enumerate()
        .map(|(column, cell)| {
            let text = inline(&cell.text);
            let tone = match cell.tone {
                Tone::Plain => "",
                Tone::Good => "good",
                Tone::Bad => "bad",
            };
            let kind = if numeric.get(column) == Some(&true) {
                "number"
            } else {
                ""
            };
            let class = format!("{kind} {tone}").trim().to_owned();
            let class = if class.is_empty() {
                String::new()
            } else {
                format!(" class=\"{class}\"")
            };
            if column == 0 {
                format!("<th scope=\"row\"{class}>{text}</th>")
            } else {
                format!("<td{class}>{text}</td>")
            }
        })
        .collect();
    format!("<tr>{cells}</tr>\n")
}

fn is_number(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_digit() || "+-−<≤≥>±".contains(c))
        && text.contains(|c: char| c.is_ascii_digit())
}

/// Escapes a text and sets the parts between backticks or double asterisks.
fn inline(text: &str) -> String {
    let code = between(&escape(text), "`", "code");
    between(&code, "**", "strong")
}

/// Puts every second part between marks into an element; an unpaired mark is left unchanged.
fn between(text: &str, mark: &str, element: &str) -> String {
    let parts: Vec<&str> = text.split(mark).collect();
    let mut html = String::new();
    for (k, part) in parts.iter().enumerate() {
        if k % 2 == 0 {
            html.push_str(part);
        } else if k + 1 < parts.len() {
            html.push_str(&format!("<{element}>{part}</{element}>"));
        } else {
            html.push_str(mark);
            html.push_str(part);
        }
    }
    html
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Figure, Point, Series};

    fn report() -> Report {
        let mut report = Report::new(
            "Fleet <size>",
            "One **bold** word & `a < b`.\n\nSecond paragraph.",
        );
        let figure = Figure::new("Success", Axis::new("N", ""), Axis::new("success", "%")).with(
            Series::line("swarm", vec![Point::new(5.0, 40.0), Point::new(10.0, 90.0)]),
        );
        report
            .section("Success")
            .figure(&figure, "It rises.")
            .unwrap();
        report.section("Table of `N`").table(&Table {
            caption: "Numbers".into(),
            head: vec!["N".into(), "`claim`".into()],
            rows: vec![
                vec!["5".into(), Cell::from("holds").tone(Tone::Good)],
                vec!["".into(), "open".into()],
            ],
        });
        report
    }

    #[test]
    fn the_page_is_whole_and_loads_nothing() {
        let html = report().html();
        assert!(html.starts_with("<!doctype html>") && html.ends_with("</html>\n"));
        assert_eq!(html.matches("<svg ").count(), 1);
        let allowed = html.replace("http://www.w3.org/2000/svg", "");
        for foreign in ["http:", "https:", "src=", "@import", "url(", "<script"] {
            assert!(!allowed.contains(foreign), "{foreign}");
        }
        for anchor in ["section-1", "section-2"] {
            assert!(
                html.contains(&format!("href=\"#{anchor}\""))
                    && html.contains(&format!("id=\"{anchor}\""))
            );
        }
    }

    #[test]
    fn text_is_escaped_and_marked_up() {
        let html = report().html();
        assert!(html.contains("<h1>Fleet &lt;size&gt;</h1>"));
        assert!(html.contains(
            "<p>One <strong>bold</strong> word &amp; <code>a &lt; b</code>.</p>\n\
             <p>Second paragraph.</p>"
        ));
        assert!(html.contains(">Table of <code>N</code></h2>"));
        assert!(html.contains(">Table of <code>N</code></a>"));
        assert!(html.contains("<th scope=\"col\"><code>claim</code></th>"));
        assert_eq!(inline("a * b ** c"), "a * b ** c");
    }

    #[test]
    fn numbers_are_aligned_and_tones_marked() {
        let html = report().html();
        assert!(html.contains(
            "<tr><th scope=\"row\" class=\"number\">5</th><td class=\"good\">holds</td></tr>"
        ));
        for text in ["−3.2", "95 %", "< 0.1", "+5"] {
            assert!(is_number(text), "{text}");
        }
        assert!(!is_number("N = 5") && !is_number("-"));
    }

    #[test]
    fn a_long_table_is_folded() {
        let table = |rows: usize| Table {
            caption: String::new(),
            head: vec!["N".to_owned()],
            rows: (0..rows).map(|row| vec![row.to_string().into()]).collect(),
        };
        let html = |rows| Report::new("Rows", "").table(&table(rows)).html();
        assert!(!html(ROWS_OPEN).contains("<details>"));
        assert!(html(ROWS_OPEN + 1).contains("<details><summary>Table of 13 rows</summary>"));
    }

    #[test]
    fn a_column_with_words_in_it_stays_on_the_left() {
        let row = |text: &str| vec![Cell::from(text)];
        let table = Table {
            caption: String::new(),
            head: vec!["measured".to_owned()],
            rows: vec![row("0.9"), row("not measured")],
        };
        let mut report = Report::new("Mixed", "");
        report.table(&table);
        assert!(!report.html().contains("class=\"number\""));
    }
}
