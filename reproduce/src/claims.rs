//! The paper's claims beside what was measured, and every cell beside the best baseline.

use super::figures::Curve;
use super::plan::Scale;
use super::table::{Quantity, Row, Table, mean};
use jcas_evaluate::figures::report::{Cell, Table as ReportTable, Tone};

/// One claim of the paper.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// What the paper says.
    pub paper: String,
    /// What was measured, in words and numbers.
    pub measured: String,
    /// Whether it holds; none where this reproduction cannot tell.
    pub holds: Option<bool>,
}

fn rows<'a>(table: &'a Table, preset: &str, policy: &str, pilot: &str) -> Vec<&'a Row> {
    table.select(|row| {
        row.experiment == "grid"
            && row.preset == preset
            && row.policy == policy
            && row.pilot == pilot
    })
}

fn at_fleet(
    table: &Table,
    (preset, policy, pilot): (&str, &str, &str),
    uavs: u32,
    quantity: Quantity,
) -> Option<f64> {
    let rows: Vec<&Row> = rows(table, preset, policy, pilot)
        .into_iter()
        .filter(|row| row.uavs == uavs)
        .collect();
    mean(&rows, quantity).map(|estimate| estimate.value)
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or("not measured".to_owned(), |value| {
        format!("{value:.digits$}")
    })
}

/// Who is measured against the claims, by preset.
const PRESETS: [(&str, (&str, &str), &str); 2] = [
    ("mission", ("learned", "adaptive"), "our settings"),
    ("paper", ("ppo", "adaptive"), "the paper's settings"),
];

/// Claims with what the table says about them.
pub fn claims(scale: &Scale, table: &Table, curves: &[Curve]) -> Vec<Claim> {
    let mut claims = Vec::new();
    for (preset, (policy, pilot), settings) in PRESETS {
        let who = (preset, policy, pilot);
        let tag = format!("preset `{preset}`, {settings}{}", cells_told(scale, preset));
        let over = |quantity| -> Vec<Option<f64>> {
            scale
                .fleets
                .iter()
                .map(|&n| at_fleet(table, who, n, quantity))
                .collect()
        };
        for (uavs, published) in [(10, 0.73), (15, 0.97)] {
            let measured = at_fleet(table, who, uavs, Quantity::Success);
            claims.push(Claim {
                paper: format!("success {published} at N = {uavs} ({tag})"),
                measured: number(measured, 3),
                holds: measured.map(|measured| measured >= published),
            });
        }
        let steps = over(Quantity::Steps);
        claims.push(Claim {
            paper: format!("mission time falls with N and saturates ({tag})"),
            measured: listed(&scale.fleets, &steps, 1),
            holds: all(&steps).map(|steps| {
                let falls: Vec<f64> = steps.windows(2).map(|w| w[0] - w[1]).collect();
                falls.iter().all(|&fall| fall > 0.0) && falls.last() < falls.first()
            }),
        });
        let energy = over(Quantity::Energy);
        claims.push(Claim {
            paper: format!("energy grows less than in proportion to N ({tag})"),
            measured: listed(&scale.fleets, &energy, 3),
            holds: all(&energy).map(|energy| {
                let ratio = energy[energy.len() - 1] / energy[0];
                let fleets = f64::from(scale.fleets[scale.fleets.len() - 1] / scale.fleets[0]);
                ratio < fleets
            }),
        });
        let constant = (preset, policy, "constant");
        for (uavs, text) in [
            (
                10,
                "adaptive and constant pilot within about 5 points at N = 10",
            ),
            (15, "adaptive pilot up to about 10 points better at N = 15"),
        ] {
            let pair = at_fleet(table, who, uavs, Quantity::Success).zip(at_fleet(
                table,
                constant,
                uavs,
                Quantity::Success,
            ));
            let gap = pair.map(|(adaptive, constant)| 100.0 * (adaptive - constant));
            // Two policies that never succeed say nothing about pilots.
            let tells = pair.is_some_and(|(adaptive, constant)| adaptive + constant > 0.0);
            claims.push(Claim {
                paper: format!("{text} ({tag})"),
                measured: match gap {
                    None => "not measured".to_owned(),
                    Some(_) if !tells => "neither ever succeeds".to_owned(),
                    Some(gap) => format!("{gap:+.1} points"),
                },
                holds: gap.filter(|_| tells).map(|gap| {
                    if uavs == 10 {
                        gap.abs() <= 5.0
                    } else {
                        gap >= 5.0
                    }
                }),
            });
        }
        let throughput = |who| at_fleet(table, who, 15, Quantity::Throughput);
        let pair = throughput(who).zip(throughput(constant));
        claims.push(Claim {
            paper: format!("constant pilot lowers throughput, N = 15 ({tag})"),
            measured: pair.map_or("not measured".to_owned(), |(adaptive, constant)| {
                format!("adaptive {adaptive:.3}, constant {constant:.3}")
            }),
            holds: pair.map(|(adaptive, constant)| constant < adaptive),
        });
    }
    claims.push(flat_after_40(curves));
    for (uavs, published) in [(5, 402.0), (10, 598.0), (15, 1253.0), (20, 1751.0)] {
        let times: Vec<f64> = curves
            .iter()
            .filter(|curve| curve.uavs == uavs)
            .map(Curve::whole_training_s)
            .collect();
        let time = (!times.is_empty()).then(|| times.iter().sum::<f64>() / times.len() as f64);
        claims.push(Claim {
            paper: format!("training takes {published} s at N = {uavs} on eight processes"),
            measured: time.map_or("not measured".to_owned(), |time| {
                format!("{time:.0} s for 62 iterations at the pace measured here")
            }),
            holds: time.map(|time| time <= published),
        });
    }
    claims
}

/// Which numbers of hotspots a claim's means run over, where these are not the whole grid's.
fn cells_told(scale: &Scale, preset: &str) -> String {
    let mut trained: Vec<u32> = scale.paper_cells.iter().map(|cell| cell.1).collect();
    trained.sort_unstable();
    trained.dedup();
    if preset == "mission" || trained == scale.hotspots {
        return String::new();
    }
    let trained: Vec<String> = trained.iter().map(u32::to_string).collect();
    format!(", n = {}", trained.join(", "))
}

/// Whether the last third of the iterations still adds a tenth of the gain of the whole training.
fn flat_after_40(curves: &[Curve]) -> Claim {
    let paper = "the return is flat after about 40 iterations".to_owned();
    let long: Vec<&Curve> = curves
        .iter()
        .filter(|curve| curve.returns.len() >= 60)
        .collect();
    if long.is_empty() {
        return Claim {
            paper,
            measured: "not measured: the trainings of this reproduction are shorter".to_owned(),
            holds: None,
        };
    }
    let window = |returns: &[f64]| {
        let finite: Vec<f64> = returns.iter().copied().filter(|r| r.is_finite()).collect();
        finite.iter().sum::<f64>() / finite.len().max(1) as f64
    };
    let flat = long.iter().filter(|curve| {
        let returns = &curve.returns;
        let start = window(&returns[..5]);
        let middle = window(&returns[37..42]);
        let end = window(&returns[returns.len() - 5..]);
        (end - middle).abs() <= 0.1 * (end - start).abs()
    });
    let flat = flat.count();
    Claim {
        paper,
        measured: format!(
            "in {flat} of {} trainings the rest adds at most a tenth of the whole gain",
            long.len()
        ),
        holds: Some(2 * flat >= long.len()),
    }
}

fn all(values: &[Option<f64>]) -> Option<Vec<f64>> {
    values.iter().copied().collect()
}

fn listed(fleets: &[u32], values: &[Option<f64>], digits: usize) -> String {
    if values.iter().all(Option::is_none) {
        return "not measured".to_owned();
    }
    let parts: Vec<String> = fleets
        .iter()
        .zip(values)
        .filter_map(|(n, value)| Some(format!("N = {n}: {:.digits$}", (*value)?)))
        .collect();
    parts.join(", ")
}

fn verdict(holds: Option<bool>) -> (&'static str, Tone) {
    match holds {
        Some(true) => ("holds", Tone::Good),
        Some(false) => ("does not hold", Tone::Bad),
        None => ("open", Tone::Plain),
    }
}

/// The claims as a table of the report.
pub fn report_table(scale: &Scale, table: &Table, curves: &[Curve]) -> ReportTable {
    ReportTable {
        caption: "The paper's claims".to_owned(),
        head: ["The paper", "Measured here", ""]
            .map(str::to_owned)
            .to_vec(),
        rows: claims(scale, table, curves)
            .into_iter()
            .map(|claim| {
                let (text, tone) = verdict(claim.holds);
                vec![
                    claim.paper.into(),
                    claim.measured.into(),
                    Cell::from(text).tone(tone),
                ]
            })
            .collect(),
    }
}

/// A learned cell beside the best baseline on the same missions.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// UAVs, hotspots.
    pub cell: (u32, u32),
    /// The baseline with the highest success, then the shortest missions.
    pub best: Row,
    /// The learned policy, mean over seeds: success, steps, energy, throughput.
    pub learned: [f64; 4],
    /// Success at least the lower end of the baseline's interval.
    pub success_holds: bool,
    /// Steps and energy at least 10 % lower and throughput no lower.
    pub economy_holds: bool,
}

/// Every cell of the grid that both have flown.
pub fn bars(scale: &Scale, table: &Table) -> Vec<Bar> {
    let mut bars = Vec::new();
    for cell in scale.cells() {
        let here = |row: &Row| {
            row.experiment == "grid" && row.preset == "mission" && (row.uavs, row.hotspots) == cell
        };
        let baselines = table.select(|row| here(row) && row.policy != "learned");
        let best = baselines.into_iter().max_by(|a, b| {
            let key = |row: &Row| (row.success_rate, -row.mission_steps, -row.energy_kwh);
            key(a)
                .partial_cmp(&key(b))
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        let learned =
            table.select(|row| here(row) && row.policy == "learned" && row.pilot == "adaptive");
        let of = |quantity| mean(&learned, quantity).map(|estimate| estimate.value);
        let learned = (|| {
            Some([
                of(Quantity::Success)?,
                of(Quantity::Steps)?,
                of(Quantity::Energy)?,
                of(Quantity::Throughput)?,
            ])
        })();
        if let (Some(best), Some(learned)) = (best, learned) {
            bars.push(Bar {
                cell,
                best: best.clone(),
                learned,
                success_holds: learned[0] >= best.success_rate_low,
                economy_holds: learned[1] <= 0.9 * best.mission_steps
                    && learned[2] <= 0.9 * best.energy_kwh
                    && learned[3] >= best.throughput,
            });
        }
    }
    bars
}

impl Bar {
    fn texts(&self) -> [String; 7] {
        let [success, steps, energy, throughput] = self.learned;
        let best = &self.best;
        let change = |learned: f64, best: f64| {
            format!(
                "{learned:.3} ({:+.1} %)",
                100.0 * (learned / best.max(1e-9) - 1.0)
            )
        };
        [
            format!("{}", self.cell.0),
            format!("{}", self.cell.1),
            format!("{}:{}", best.policy, best.pilot),
            format!("{success:.3} (best {:.3})", best.success_rate),
            change(steps, best.mission_steps),
            change(energy, best.energy_kwh),
            change(throughput, best.throughput),
        ]
    }

    fn verdict(&self) -> (&'static str, bool) {
        match (self.success_holds, self.economy_holds) {
            (true, true) => ("success and 10 % economy", true),
            (true, false) => ("success only", false),
            (false, _) => ("missed", false),
        }
    }
}

/// Pictures that the page shows, of those that [`super::figures`] draws.
pub const PICTURES: [(&str, &str); 8] = [
    ("success_over_uavs", "Success over fleet size"),
    ("mission_time_over_uavs", "Mission time over fleet size"),
    ("energy_over_uavs", "Energy over fleet size"),
    ("throughput_over_uavs", "Throughput over fleet size"),
    ("training_returns", "Return over training iterations"),
    ("trade_off", "Success against throughput"),
    (
        "approach",
        "Pilot density over distance to the nearest unconfirmed hotspot",
    ),
    ("battery_co2", "Carbon over renewable share"),
];

const BAR_HEAD: [&str; 8] = [
    "N",
    "n",
    "best baseline",
    "success",
    "steps",
    "energy (kWh)",
    "throughput",
    "reached",
];

/// The cells as a table of the report.
pub fn bar_table(scale: &Scale, table: &Table) -> ReportTable {
    ReportTable {
        caption: "Learned policy beside the best baseline on the same missions".to_owned(),
        head: BAR_HEAD.map(str::to_owned).to_vec(),
        rows: bars(scale, table)
            .iter()
            .map(|bar| {
                let mut cells: Vec<Cell> = bar.texts().map(Cell::from).to_vec();
                let (text, good) = bar.verdict();
                cells.push(Cell::from(text).tone(if good { Tone::Good } else { Tone::Bad }));
                cells
            })
            .collect(),
    }
}

const VARIATION_HEAD: [&str; 6] = [
    "changed",
    "tests",
    "success",
    "steps",
    "energy (kWh)",
    "throughput",
];

/// What becomes of the paper's training when one thing is changed; first as the paper has it.
fn variation_rows(scale: &Scale, table: &Table) -> Vec<[String; 6]> {
    let Some(cell) = scale.variation_cell() else {
        return Vec::new();
    };
    let line = |name: &str, tests: &str, rows: &[&Row]| -> Option<[String; 6]> {
        let of = |quantity, digits| {
            mean(rows, quantity).map(|e| {
                format!(
                    "{:.digits$} [{:.digits$}, {:.digits$}]",
                    e.value, e.low, e.high
                )
            })
        };
        Some([
            name.to_owned(),
            tests.to_owned(),
            of(Quantity::Success, 3)?,
            of(Quantity::Steps, 1)?,
            of(Quantity::Energy, 3)?,
            of(Quantity::Throughput, 3)?,
        ])
    };
    let of_cell = |rows: Vec<&'_ Row>| -> Vec<Row> {
        let rows = rows
            .into_iter()
            .filter(|row| (row.uavs, row.hotspots) == cell);
        rows.cloned().collect()
    };
    let paper = of_cell(rows(table, "paper", "ppo", "adaptive"));
    let varied = scale.variations.iter().map(|variation| {
        let rows =
            table.select(|row| row.experiment == "variation" && row.policy == variation.name);
        (variation.name, variation.tests, of_cell(rows))
    });
    std::iter::once(("nothing", "the paper's equations and settings", paper))
        .chain(varied)
        .filter_map(|(name, tests, rows)| line(name, tests, &rows.iter().collect::<Vec<_>>()))
        .collect()
}

/// The variations as a table of the report.
pub fn variation_table(scale: &Scale, table: &Table) -> ReportTable {
    let (uavs, hotspots) = scale.variation_cell().unwrap_or_default();
    ReportTable {
        caption: format!("The paper's training with one thing changed, N = {uavs}, n = {hotspots}"),
        head: VARIATION_HEAD.map(str::to_owned).to_vec(),
        rows: variation_rows(scale, table)
            .into_iter()
            .map(|row| row.map(Cell::from).to_vec())
            .collect(),
    }
}

fn markdown_head(names: &[&str]) -> String {
    format!(
        "| {} |\n|{}\n",
        names.join(" | "),
        " --- |".repeat(names.len())
    )
}

/// The same as a Markdown page, with the pictures that lie in `pictures` (relative to the page).
pub fn markdown(scale: &Scale, table: &Table, curves: &[Curve], pictures: &str) -> String {
    let mut text = format!(
        "# Results\n\nMade by `jcas reproduce{}` from its `results.csv`: {} missions a cell on the \
         seeds of campaign {}, {} training seed(s).\n\n## The paper's claims\n\n\
         | the paper | measured here | |\n| --- | --- | --- |\n",
        if scale.name == "quick" {
            " --quick"
        } else {
            ""
        },
        scale.episodes,
        jcas_train::run::EVALUATION_SEED,
        scale.seeds.len()
    );
    for claim in claims(scale, table, curves) {
        let (verdict, _) = verdict(claim.holds);
        text += &format!("| {} | {} | {verdict} |\n", claim.paper, claim.measured);
    }
    text += "\n## Every cell against the best baseline\n\n";
    text += "The best baseline has the highest success, then the shortest missions, among five \
             baselines with adaptive and with full pilot density.\n\n";
    text += &markdown_head(&BAR_HEAD);
    for bar in bars(scale, table) {
        text += &format!("| {} | {} |\n", bar.texts().join(" | "), bar.verdict().0);
    }
    let variations = variation_rows(scale, table);
    if let (Some((uavs, hotspots)), true) = (scale.variation_cell(), variations.len() > 1) {
        text += &format!(
            "\n## What the paper's training hangs on\n\nPPO with the paper's settings at N = {uavs}, \
             n = {hotspots}, with one thing changed at a time.\n\n"
        );
        text += &markdown_head(&VARIATION_HEAD);
        for row in variations {
            text += &format!("| {} |\n", row.join(" | "));
        }
    }
    text += "\n## Pictures\n";
    for (name, title) in PICTURES {
        text += &format!("\n![{title}]({pictures}{name}.png)\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(returns: Vec<f64>) -> Curve {
        Curve {
            uavs: 10,
            hotspots: 5,
            seed: 0,
            returns,
            training_s: 1.0,
        }
    }

    #[test]
    fn a_curve_that_goes_on_rising_is_not_flat() {
        let rising = curve((0..62).map(f64::from).collect());
        assert_eq!(flat_after_40(&[rising]).holds, Some(false));
        let flat = curve((0..62).map(|k| f64::from(k.min(35))).collect());
        assert_eq!(flat_after_40(&[flat]).holds, Some(true));
        let short = curve(vec![0.0; 6]);
        assert_eq!(flat_after_40(&[short]).holds, None);
    }
}
