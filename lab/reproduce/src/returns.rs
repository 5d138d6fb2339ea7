//! The chapter on what each reading of the reward pays for: the return beside the success.

use crate::chapter::{Block, Chapter};
use crate::readings::{FITTED, FITTED_M};
use crate::results::Results;
use crate::scan::{self, HOTSPOTS, PPO, RANDOM, READINGS, Scan, ScanRow, TEAMS};
use crate::text::told;
use jcas_figures::{Axis, Figure, Panels, Point, Series};

/// Number of UAVs of the fleet whose returns are compared.
const UAVS: u32 = 10;

/// The chapter; none where the scan has not been run.
pub fn chapter(results: &Results) -> Option<Chapter> {
    let scan = &results.scan;
    let mut rows = Vec::new();
    for reading in READINGS {
        for flown in [TEAMS, RANDOM, PPO] {
            let cells = scan.cell(reading, FITTED_M, UAVS, flown);
            let Some(&row) = cells.first() else {
                continue;
            };
            rows.push([
                reading.to_owned(),
                flown.2.to_owned(),
                told(&row.episode_return(), 1),
                told(&row.success(), 3),
                told(&row.steps(), 1),
            ]);
        }
    }
    if rows.is_empty() {
        return None;
    }
    let mut blocks = vec![
        Block::Text(paid(scan)),
        Block::table(
            "Return and success at 150 m, N = 10, n = 5",
            [
                "informing paid",
                "policy",
                "undiscounted return",
                "success",
                "steps",
            ],
            rows,
        ),
    ];
    if let Some(figure) = over_training(results) {
        let title = "Return and success over training";
        blocks.push(Block::Text(
            "Each panel has one training of the paper's PPO. Its return is divided by that of a \
                random walk under the same reading, so that all panels share one axis. The curves \
                are [inform_once_trainings.csv](results/inform_once_trainings.csv), made by \
             `lab/experiments/inform_once_trainings.py`."
                .to_owned(),
        ));
        blocks.push(Block::figure("return_against_mission", title, figure));
    }
    Some(Chapter {
        heading: "The return against the mission".to_owned(),
        blocks,
    })
}

fn paid(scan: &Scan) -> String {
    let mut text = format!(
        "Does the reward pay for the mission? The table has the undiscounted return of a mission \
            beside its success, at N = {UAVS}, n = {HOTSPOTS} in the preset `paper`. {FITTED}\n\n"
    );
    for reading in READINGS {
        let of = |flown| scan.cell(reading, FITTED_M, UAVS, flown).first().copied();
        let (Some(teams), Some(random)) = (of(TEAMS), of(RANDOM)) else {
            continue;
        };
        let ratio = random.episode_return / teams.episode_return;
        text += &format!(
            "Paid {reading}, a random walk earns {ratio:.2} times what `teams` earns, which ends \
                every mission in {:.1} steps. ",
            teams.steps
        );
        if let Some(ppo) = of(PPO) {
            text += &format!("{} ", against(ppo, random));
        }
    }
    text + "A return that grows with the time of a mission teaches a learner not to end it."
}

/// PPO beside a random walk, in a sentence.
fn against(ppo: &ScanRow, random: &ScanRow) -> String {
    let more = ppo.return_low > random.return_high;
    let less = ppo.return_high < random.return_low;
    let earned = match (more, less) {
        (true, _) => "more than",
        (_, true) => "less than",
        _ => "as much as",
    };
    format!(
        "PPO earns {earned} a random walk within the intervals and succeeds in {:.2} of the \
            missions beside {:.2}.",
        ppo.success, random.success
    )
}

fn over_training(results: &Results) -> Option<Panels> {
    let panel = |reading: &&str| {
        let curve: Vec<_> = results
            .scan
            .trainings
            .iter()
            .filter(|line| {
                (
                    line.reading.as_str(),
                    line.range_m,
                    line.uavs,
                    line.hotspots,
                ) == (*reading, FITTED_M, UAVS, HOTSPOTS)
            })
            .collect();
        let of = |flown| {
            results
                .scan
                .cell(reading, FITTED_M, UAVS, flown)
                .first()
                .copied()
        };
        let (random, teams) = (of(RANDOM)?, of(TEAMS)?);
        let unit = random.episode_return;
        let points = |value: &dyn Fn(&scan::ScanIteration) -> Option<f64>| {
            let points = curve
                .iter()
                .filter_map(|line| Some(Point::new(f64::from(line.iteration), value(line)?)));
            points.collect::<Vec<Point>>()
        };
        let last = curve.last()?.iteration;
        let level = |name: &str, value: f64| {
            let ends = [1, last].map(|k| Point::new(f64::from(k), value));
            Series::band(name, ends.to_vec())
        };
        let returns = points(&|line| Some(line.return_mean? / unit));
        let figure = Figure::new(
            format!("paid {reading}"),
            Axis::new("iteration of 4096 environment steps", ""),
            Axis::new("share", "").span(0.0, 1.0),
        )
        .with(Series::band("return over a random walk's", returns))
        .with(Series::band("success", points(&|line| line.success_rate)))
        .with(level("return of teams", teams.episode_return / unit))
        .with(level("return of a random walk", 1.0));
        Some(figure)
    };
    let figures: Vec<Figure> = READINGS.iter().filter_map(panel).collect();
    (!figures.is_empty()).then(|| Panels {
        title: "Return and success over training, under each reading".to_owned(),
        note: format!(
            "The paper's PPO, N = {UAVS}, n = {HOTSPOTS}, 150 m (fitted to a random walk), sampled \
                actions. The first iterations have ended fast missions only."
        ),
        columns: figures.len(),
        figures,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scan::testing::row;

    #[test]
    fn returns_are_compared_by_their_intervals() {
        let random = row(RANDOM, 150.0, 10, 0, 0.774);
        let mut ppo = row(PPO, 150.0, 10, 0, 0.429);
        assert!(against(&ppo, &random).starts_with("PPO earns as much as"));
        (ppo.return_low, ppo.return_high) = (101.1, 103.0);
        assert!(against(&ppo, &random).starts_with("PPO earns more than"));
        assert!(against(&ppo, &random).ends_with("in 0.43 of the missions beside 0.77."));
    }
}
