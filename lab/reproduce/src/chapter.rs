//! A chapter of the results: written once, shown as Markdown and in the report.

use jcas_figures::Draw;

/// What belongs under one heading.
pub struct Chapter {
    /// The heading.
    pub heading: String,
    /// In the order of reading.
    pub blocks: Vec<Block>,
}

/// A part of a chapter.
pub enum Block {
    /// Paragraphs of Markdown.
    Text(String),
    /// A table.
    Table {
        /// What it shows.
        caption: String,
        /// Heads of its columns.
        head: Vec<String>,
        /// Its rows.
        rows: Vec<Vec<String>>,
    },
    /// A figure, in files of its own.
    Figure {
        /// Name of its files.
        name: String,
        /// What it shows.
        title: String,
        /// How it is drawn.
        figure: Box<dyn Draw>,
    },
}

impl Block {
    /// A table whose rows have the width of its head.
    pub fn table<const K: usize>(caption: &str, head: [&str; K], rows: Vec<[String; K]>) -> Block {
        Block::Table {
            caption: caption.to_owned(),
            head: head.map(str::to_owned).to_vec(),
            rows: rows.into_iter().map(|row| row.to_vec()).collect(),
        }
    }

    /// A figure.
    pub fn figure(name: &str, title: &str, figure: impl Draw + 'static) -> Block {
        Block::Figure {
            name: name.to_owned(),
            title: title.to_owned(),
            figure: Box::new(figure),
        }
    }
}

impl Chapter {
    /// Names of its figures.
    pub fn figures(&self) -> impl Iterator<Item = &str> {
        self.blocks.iter().filter_map(|block| match block {
            Block::Figure { name, .. } => Some(name.as_str()),
            Block::Text(_) | Block::Table { .. } => None,
        })
    }

    /// As Markdown, with the pictures that lie in `pictures` (relative to the page).
    pub fn markdown(&self, pictures: &str) -> String {
        let mut text = format!("\n## {}\n", self.heading);
        for block in &self.blocks {
            text += "\n";
            match block {
                Block::Text(words) => text += &crate::text::wrapped(words),
                Block::Table { head, rows, .. } => {
                    text += &crate::text::table(head, rows);
                }
                Block::Figure { name, title, .. } => {
                    text += &format!("![{title}]({pictures}{name}.png)\n");
                }
            }
        }
        text
    }
}
