//! The pages of a reproduction: Markdown, and one HTML report with every figure.

use crate::campaign::{OURS, pilot_name};
use crate::chapter::{Block, Chapter};
use crate::claims;
use crate::curves::TRAININGS;
use crate::figures::{self, PICTURES};
use crate::fit::PAPER;
use crate::range::Study;
use crate::readings::{self, FITTED};
use crate::results::Results;
use crate::returns;
use crate::table::{Quantity, Query, mean, numbers_of_hotspots};
use crate::{TABLE, cell_means, comparison_page, endurance, one_range, pilot, seed_spread, text};
use jcas_core::Preset;
use jcas_episode::card::EVALUATION_SEED;
use jcas_figures::report::{Cell, Report, Table as ReportTable};
use jcas_figures::{Draw, FigureError};
use jcas_train::error::TrainError;
use jcas_train::store::write_whole;
use std::path::Path;

const NUMBERS_HEAD: [&str; 5] = [
    "in the preset `paper`",
    "success at N = 10",
    "success at N = 15",
    "steps at N = 10",
    "steps at N = 15",
];
const CLAIMS_HEAD: [&str; 5] = [
    "the paper",
    "holds if",
    "who",
    "measured here, 95 %",
    "verdict",
];
const JUDGED: &str = "A verdict compares an interval with the region in which the claim lies. It \
    is \"holds\" where the interval lies inside, \"does not hold\" where it lies outside, and \
    \"undecided\" otherwise. What was not run, or trained for less than the paper's iterations, \
    is \"not judged\". An interval has the noise of the missions and that of the training. The \
    latter is the standard deviation between training seeds, pooled over the cells with several. \
    It enters where a cell has one seed as well.";
const VARIATION_HEAD: [&str; 6] = [
    "changed",
    "tests",
    "success",
    "steps",
    "energy (kWh)",
    "throughput",
];

impl Results<'_> {
    /// The paper's two numbers and what policies do about them.
    fn numbers(&self) -> Vec<[String; 5]> {
        let learners = self.scope.learners();
        let learned = learners
            .iter()
            .map(|learner| (learner.as_trained(), learner.name, "adaptive"));
        let policies = [
            ("a random walk".to_owned(), "random", "mid"),
            ("the best script, `teams`".to_owned(), "teams", "max"),
        ]
        .into_iter()
        .chain(learned)
        .chain([("our policy".to_owned(), "learned", "adaptive")]);
        let paper = [
            "the paper".to_owned(),
            format!("{}", PAPER[0].rate),
            format!("{}", PAPER[1].rate),
            String::new(),
            String::new(),
        ];
        let measured = policies.map(|(title, policy, pilot)| {
            let at = |uavs, quantity: Quantity| {
                let query = Query::new("grid", Preset::Paper.name(), (policy, pilot)).uavs(uavs);
                let rows = query.rows(&self.table);
                let Some(e) = mean(&rows, quantity) else {
                    return "not run".to_owned();
                };
                let digits = quantity.digits();
                let over = self.scope.over(&numbers_of_hotspots(&rows));
                format!("{:.digits$}{over}", e.value)
            };
            [
                title,
                at(10, Quantity::Success),
                at(15, Quantity::Success),
                at(10, Quantity::Steps),
                at(15, Quantity::Steps),
            ]
        });
        [paper].into_iter().chain(measured).collect()
    }

    /// The paper's two numbers: over the sensing range, then in the preset `paper`.
    fn two_numbers(&self) -> Chapter {
        let mut blocks = readings::numbers(self);
        blocks.push(Block::Text(format!(
            "{FITTED} The rows of this table are means of [{TABLE}](results/{TABLE})."
        )));
        let rows = self.numbers();
        blocks.push(Block::table("Success and mission time", NUMBERS_HEAD, rows));
        Chapter {
            heading: "The paper's two numbers".to_owned(),
            blocks,
        }
    }

    /// The claims with their verdicts.
    fn claims(&self) -> Chapter {
        let judged = claims::judge(self);
        let rows = judged.iter().map(|judged| {
            [
                judged.claim.text.to_owned(),
                judged.claim.holds_if.to_owned(),
                judged.reading.clone(),
                judged.measured.clone(),
                judged.verdict.text().to_owned(),
            ]
        });
        let mut blocks = vec![
            Block::Text(format!(
                "{JUDGED} {}{}\n\n{FITTED}",
                cell_means::told(&self.table),
                claims::by_chance(&judged)
            )),
            Block::table("The paper's claims", CLAIMS_HEAD, rows.collect()),
        ];
        blocks.extend(self.trained());
        Chapter {
            heading: "The paper's claims".to_owned(),
            blocks,
        }
    }

    /// What becomes of the paper's training when one thing is changed; first as the paper has it.
    fn variations(&self) -> Vec<[String; 6]> {
        let Some((uavs, hotspots)) = self.scope.variation_cell() else {
            return Vec::new();
        };
        let line = |experiment, name: &str, shown: &str, tests: &str| -> Option<[String; 6]> {
            let query = Query::new(experiment, Preset::Paper.name(), (name, "adaptive"));
            let rows = query.uavs(uavs).hotspots(hotspots).rows(&self.table);
            let of = |quantity: Quantity| {
                let e = mean(&rows, quantity)?;
                let digits = quantity.digits();
                Some(format!(
                    "{:.digits$} [{:.digits$}, {:.digits$}]",
                    e.value, e.low, e.high
                ))
            };
            Some([
                shown.to_owned(),
                tests.to_owned(),
                of(Quantity::Success)?,
                of(Quantity::Steps)?,
                of(Quantity::Energy)?,
                of(Quantity::Throughput)?,
            ])
        };
        let unchanged = line(
            "grid",
            "ppo",
            "nothing",
            "the paper's equations and settings",
        );
        let changed = self.scope.variations.iter().filter_map(|variation| {
            line("variation", variation.name, variation.name, variation.tests)
        });
        let changed: Vec<_> = changed.collect();
        if changed.is_empty() {
            return Vec::new();
        }
        unchanged.into_iter().chain(changed).collect()
    }

    /// Which cells were trained with the paper's settings, with how many seeds.
    fn trained(&self) -> [Block; 2] {
        let pilots = self.scope.paper_pilots.iter();
        let pilots: Vec<_> = pilots.map(|&pilot| pilot_name(pilot)).collect();
        let mut rows = Vec::new();
        for learner in self.scope.learners() {
            for pilot in &pilots {
                let query = Query::new("grid", Preset::Paper.name(), (learner.name, pilot));
                let mut row = vec![format!("{}, {pilot} pilot", learner.title)];
                for &uavs in &self.scope.fleets {
                    let trained = self.scope.hotspots.iter().filter_map(|&hotspots| {
                        let seeds = query.uavs(uavs).hotspots(hotspots).rows(&self.table).len();
                        match seeds {
                            0 => None,
                            1 => Some(hotspots.to_string()),
                            _ => Some(format!("{hotspots} ({seeds})")),
                        }
                    });
                    row.push(trained.collect::<Vec<_>>().join(", "));
                }
                rows.push(row);
            }
        }
        let mut head = vec!["training".to_owned()];
        head.extend(
            self.scope
                .fleets
                .iter()
                .map(|uavs| format!("n at N = {uavs}")),
        );
        let shortened = self.scope.shortened();
        let but = shortened.as_deref().map_or(String::new(), |shortened| {
            format!(", but with {shortened}, which shows that it runs and not what it comes to")
        });
        let mut text = format!(
            "Of {} cells those of this table were trained with the paper's settings{but}. The \
                number of seeds is in brackets where there are several.",
            self.scope.cells().len()
        );
        let unasked = claims::unasked(self.scope);
        if !unasked.is_empty() {
            text += &format!(" Not asked of such trainings: {}.", unasked.join("; "));
        }
        let caption = "Cells that were trained with the paper's settings".to_owned();
        [
            Block::Text(text),
            Block::Table {
                caption,
                head,
                rows,
            },
        ]
    }

    fn summary(&self) -> String {
        let given: Vec<String> = self
            .scope
            .given
            .iter()
            .map(|folder| format!("`{}`", folder.display()))
            .collect();
        let asked = self.scope.seeds.len() as u64;
        let mut beyond = self.table.rows.iter().filter(|row| row.seed >= asked);
        let more = match beyond.clone().next() {
            Some(_) => ", and more in some cells",
            None => "",
        };
        let others = match beyond.find(|row| row.policy == OURS) {
            Some(_) => " and of other seeds",
            None => "",
        };
        let ours = if given.is_empty() {
            String::new()
        } else {
            format!(" Our policies are those of {}{others}.", given.join(", "))
        };
        format!(
            "A cell has {} missions on the seeds of campaign {EVALUATION_SEED}, and {} training \
                seed(s){more}. Means are over n = {}, or over the numbers that stand beside a \
                value.{ours}",
            self.scope.episodes,
            self.scope.seeds.len(),
            text::list(&self.scope.hotspots)
        )
    }

    /// The Markdown page, with the pictures that lie in `pictures` (relative to the page).
    pub fn markdown(&self, pictures: &str) -> String {
        let quick = if self.scope.name == "quick" {
            " --quick"
        } else {
            ""
        };
        let trainings = if self.curves.is_empty() {
            String::new()
        } else {
            format!(", [{TRAININGS}]({pictures}{TRAININGS}) how trainings went")
        };
        let mut text = "# Results\n\n".to_owned();
        if let Some(finding) = readings::finding(self) {
            text += &format!("{}\n", text::wrapped(&finding));
        }
        if let Some(origin) = &self.origin {
            text += &format!("{}\n", origin);
        }
        text += &text::wrapped(&format!(
            "This page is made by `jcas-lab reproduce{quick}`. {} \
                [results.csv]({pictures}{TABLE}) has every campaign{trainings}.",
            self.summary()
        ));
        text += &self.two_numbers().markdown(pictures);
        if let Some(study) = Study::of(self.scope, &self.table) {
            text += &study.chapter(self.scope, &self.table).markdown(pictures);
        }
        text += &self.claims().markdown(pictures);
        for chapter in comparison_page::chapters(self) {
            text += &chapter.markdown(pictures);
        }
        let variations = self.variations();
        if let (Some((uavs, hotspots)), false) =
            (self.scope.variation_cell(), variations.is_empty())
        {
            text += &format!(
                "\n## What the paper's training hangs on\n\nPPO with the paper's settings at N = \
                    {uavs}, n = {hotspots}, with one thing changed at a time.\n\n{}\n",
                text::wrapped(FITTED)
            );
            text += &text::table(&VARIATION_HEAD, &variations);
        }
        for chapter in self.chapters() {
            text += &chapter.markdown(pictures);
        }
        text += "\n## Pictures\n";
        for picture in self.pictures() {
            text += &format!("\n![{}]({pictures}{}.png)\n", picture.title, picture.name);
        }
        text
    }

    /// The studies that go beyond the paper, as far as they have been flown.
    fn chapters(&self) -> impl Iterator<Item = Chapter> {
        let all = [pilot::chapter, endurance::chapter, seed_spread::chapter];
        let of_table = all
            .into_iter()
            .filter_map(|chapter| chapter(self.scope, &self.table));
        let of_scan = [one_range::chapter(self), returns::chapter(self)];
        of_scan.into_iter().flatten().chain(of_table)
    }

    /// Names of all pictures on the Markdown page.
    pub fn pictures_on_page(&self) -> Vec<String> {
        let study = Study::of(self.scope, &self.table);
        let study = study.map(|study| study.chapter(self.scope, &self.table));
        let first = [self.two_numbers()].into_iter().chain(study);
        let first = first.chain(comparison_page::chapters(self));
        let chapters: Vec<Chapter> = first.chain(self.chapters()).collect();
        let of_chapters = chapters.iter().flat_map(Chapter::figures);
        let names = self.pictures().map(|picture| picture.name);
        names.chain(of_chapters).map(str::to_owned).collect()
    }

    /// Those of the pictures on the Markdown page that show something.
    pub fn pictures(&self) -> impl Iterator<Item = &'static figures::Picture> {
        PICTURES
            .iter()
            .filter(|picture| picture.on_page && picture.shows(self))
    }

    /// Draws every figure and writes the report.
    pub fn write(&self, out: &Path) -> Result<(), TrainError> {
        let mut report = Report::new(
            "The paper's results, measured here",
            &format!(
                "A {} reproduction on this machine: {}.",
                self.scope.name,
                self.summary()
            ),
        );
        let mut gallery = Gallery {
            report: &mut report,
            out,
            section: String::new(),
        };
        if let Some(finding) = readings::finding(self) {
            gallery.begin("The finding");
            gallery.report.text(&finding);
        }
        gallery.chapter(&self.two_numbers())?;
        if let Some(study) = Study::of(self.scope, &self.table) {
            gallery.chapter(&study.chapter(self.scope, &self.table))?;
        }
        gallery.chapter(&self.claims())?;
        for picture in PICTURES.iter().filter(|picture| picture.shows(self)) {
            gallery.begin(picture.section);
            gallery.add(picture.name, &picture.draw(self))?;
        }
        for chapter in comparison_page::chapters(self) {
            gallery.chapter(&chapter)?;
        }
        let variations = self.variations();
        if !variations.is_empty() {
            gallery.begin("What the paper's training hangs on");
            let caption = "The paper's training with one thing changed";
            gallery
                .report
                .table(&plain(caption, VARIATION_HEAD, variations));
        }
        for chapter in self.chapters() {
            gallery.chapter(&chapter)?;
        }
        let path = out.join("report.html");
        report.write(&path).map_err(|error| drawn(&path)(error))
    }
}

fn plain<const K: usize>(caption: &str, head: [&str; K], rows: Vec<[String; K]>) -> ReportTable {
    ReportTable {
        caption: caption.to_owned(),
        head: head.map(str::to_owned).to_vec(),
        rows: rows
            .into_iter()
            .map(|row| row.map(Cell::from).to_vec())
            .collect(),
    }
}

fn drawn(path: &Path) -> impl FnOnce(FigureError) -> TrainError {
    TrainError::format(path)
}

struct Gallery<'a> {
    report: &'a mut Report,
    out: &'a Path,
    section: String,
}

impl Gallery<'_> {
    /// Starts a section unless it has begun.
    fn begin(&mut self, heading: &str) {
        if self.section != heading {
            self.report.section(heading);
            heading.clone_into(&mut self.section);
        }
    }

    fn chapter(&mut self, chapter: &Chapter) -> Result<(), TrainError> {
        self.begin(&chapter.heading);
        for block in &chapter.blocks {
            match block {
                Block::Text(text) => {
                    self.report.text(text);
                }
                Block::Table {
                    caption,
                    head,
                    rows,
                } => {
                    let cells = |row: &Vec<String>| row.iter().map(Cell::from).collect();
                    self.report.table(&ReportTable {
                        caption: caption.clone(),
                        head: head.clone(),
                        rows: rows.iter().map(cells).collect(),
                    });
                }
                Block::Figure { name, figure, .. } => self.add(name, figure.as_ref())?,
            }
        }
        Ok(())
    }

    /// A figure in the report and in files of its own.
    fn add(&mut self, name: &str, figure: &(impl Draw + ?Sized)) -> Result<(), TrainError> {
        let svg = self.out.join(format!("{name}.svg"));
        let text = figure.svg().map_err(drawn(&svg))?;
        write_whole(&svg, text.as_bytes())?;
        let png = self.out.join(format!("{name}.png"));
        write_whole(&png, &figure.png().map_err(drawn(&png))?)?;
        self.report.figure(figure, "").map_err(drawn(&svg))?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scan::Scan;
    use crate::scope::Scope;
    use crate::table::Table;
    use crate::table::testing::table;

    #[test]
    fn a_page_says_where_it_has_more_seeds_than_were_asked_for() {
        let mut table = table("summary", &[(10, 3, 0), (10, 3, 1)]);
        let summary = |seeds, table: &Table| {
            let scope = Scope {
                given: vec!["ours".into()],
                ..Scope::full(seeds)
            };
            Results {
                scope: &scope,
                table: table.clone(),
                comparison: Vec::new(),
                curves: Vec::new(),
                approach: Vec::new(),
                scan: Scan::default(),
                origin: None,
            }
            .summary()
        };
        assert!(summary(1, &table).contains("1 training seed(s), and more in some cells."));
        assert!(summary(2, &table).contains("2 training seed(s)."));
        assert!(summary(1, &table).ends_with("Our policies are those of `ours`."));
        for row in &mut table.rows {
            row.policy = OURS.to_owned();
        }
        assert!(
            summary(1, &table).ends_with("Our policies are those of `ours` and of other seeds.")
        );
    }
}
