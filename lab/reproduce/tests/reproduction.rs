//! The reproduction in miniature: every part runs, files appear, nothing is flown twice.

use jcas_core::Preset;
use jcas_episode::shard::Shard;
use jcas_reproduce::scope::{CONSTANT_PILOT, Part, Scope};
use jcas_reproduce::shard::{RowCounts, fly_shard, merge, outline, tables};
use jcas_reproduce::variation::variations;
use jcas_reproduce::{Progress, ProgressSink, publish, reproduce};
use jcas_train::metrics::Row;
use jcas_train::run::Observer;
use jcas_train::settings::Settings;
use std::path::{Path, PathBuf};

struct Silent {
    chapters: Vec<String>,
    stop_after: usize,
}

impl Observer for Silent {
    fn iteration(&mut self, _row: &Row, _total: u64, _left_s: f64) {}

    fn stop(&mut self) -> bool {
        self.chapters.len() > self.stop_after
    }
}

impl ProgressSink for Silent {
    fn chapter(&mut self, title: &str) {
        self.chapters.push(title.to_owned());
    }
}

fn narrator(stop_after: usize) -> Silent {
    Silent {
        chapters: Vec::new(),
        stop_after,
    }
}

fn small(settings: &Settings, workers: usize) -> Settings {
    Settings {
        actor_hidden: vec![16],
        critic_hidden: vec![16],
        environments: 2 * workers,
        workers,
        batch_steps: 8 * workers,
        total_steps: 8 * workers as u64,
        epochs: 1,
        evaluation_episodes: 1,
        ..settings.clone()
    }
}

fn scope() -> Scope {
    let quick = Scope::quick(1);
    Scope {
        fleets: vec![10, 15],
        hotspots: vec![1, 2],
        episodes: 2,
        tuned: small(&quick.tuned, 4),
        paper: small(&quick.paper, 2),
        paper_cells: vec![(10, 1), (10, 2)],
        paper_pilots: vec![None, Some(CONSTANT_PILOT)],
        variations: variations()[..2].to_vec(),
        densities: vec![0.01, 0.3],
        renewable_shares: vec![0.0, 1.0],
        ranges: vec![1.0, 3.0, 5.0],
        pilot_densities: (vec![0.01, 0.3], Vec::new()),
        endurance_fleets: vec![10],
        trained_ranges: (vec![3.0], vec![(10, 1)]),
        presets: vec![Preset::Paper, Preset::Mission],
        ..quick
    }
}

/// Tables, figures and pages of a finished reproduction of [`scope`].
fn everything_is_written(out: &Path, results: &str, compared: &str) {
    let learners = scope().learners().len();
    // Each cell and preset has fifteen baselines and two learned policies. Densities, batteries,
    // the paper's cells and variations follow. Each range and cell has two scripts and a few
    // trainings. Pilot densities are flown in four cases. Three scripts charge with two chargers.
    let paper = 2 * 4 * 17 + 2 * 2 + 2 * 2 + 2 * 2 * learners + 2 + 3 * 4 * 2 + learners;
    let beyond = 4 * 2 * 3 + 3 * 2;
    assert_eq!(results.lines().count(), 1 + paper + beyond);
    // Each cell has two planners, and scripts with two densities each: six with known hotspots, in
    // two presets with ours, and five with hidden ones.
    let known = 2 * 4 * (6 * 2 + 2 + 1);
    assert_eq!(compared.lines().count(), 1 + known + 4 * (5 * 2 + 2));
    for file in [
        "success_over_range",
        "paper_success_over_uavs",
        "training_returns",
        "training_time",
        "success_over_uavs",
        "throughput_over_hotspots_n15",
        "trade_off",
        "approach",
        "battery_co2",
        "search_mission_time_over_uavs",
        "pilot_throughput",
        "endurance_co2",
    ] {
        for kind in ["svg", "png"] {
            let path = out.join(format!("{file}.{kind}"));
            assert!(path.metadata().unwrap().len() > 500, "{}", path.display());
        }
    }
    let page = std::fs::read_to_string(out.join("results.md")).unwrap();
    assert!(page.contains("success 0.73 at N = 10"), "{page}");
    let numbers = page.find("| the paper | 0.73 | 0.97 |").unwrap();
    assert!(numbers < page.find("The paper's claims").unwrap(), "{page}");
    assert!(page.contains("\n| a random walk | 1, 2 |"), "{page}");
    assert!(
        std::fs::read_to_string(out.join("report.html"))
            .unwrap()
            .contains("</html>")
    );
}

/// The tables are enough for the page, and nothing of the paper's training is trained again.
fn tables_alone_give_the_same_page(out: &Path) {
    let page = out.join("docs/results.md");
    std::fs::create_dir_all(page.parent().unwrap()).unwrap();
    publish(&scope(), out, &page).unwrap();
    let text = std::fs::read_to_string(&page).unwrap();
    assert!(text.contains("](results/trade_off.png)"), "{text}");
    assert!(text.contains("| inform_once |"), "{text}");
    assert!(out.join("docs/results/trade_off.png").exists());
    assert!(out.join("docs/results/results.csv").exists());
    assert!(
        text.contains("credit of each UAV, constant pilot | 1, 2 |  |\n"),
        "{text}"
    );

    let pages = scope().parts(Vec::new());
    let tables = out.join("docs/results");
    assert_eq!(
        reproduce(&pages, &tables, &mut narrator(usize::MAX)).unwrap(),
        Progress::Finished
    );
    let again = out.join("again/results.md");
    std::fs::create_dir_all(again.parent().unwrap()).unwrap();
    publish(&scope(), &tables, &again).unwrap();
    assert_eq!(std::fs::read_to_string(&again).unwrap(), text);
    assert!(text.contains("](results/training_returns.png)"), "{text}");
    assert!(text.contains("](results/trainings.csv)"), "{text}");
    let trained = scope().parts(vec![Part::Paper, Part::Variations, Part::TrainedRanges]);
    let mut from_tables = narrator(usize::MAX);
    reproduce(&trained, &tables, &mut from_tables).unwrap();
    assert!(
        !tables.join("policies").exists(),
        "{:?}",
        from_tables.chapters
    );
}

/// Another reproduction does not take these results for its own.
fn other_results_are_refused(out: &Path, results: &str) {
    let refused = |scope: Scope| {
        let error = reproduce(&scope, out, &mut narrator(usize::MAX)).unwrap_err();
        error.to_string()
    };
    let told = refused(Scope {
        episodes: 3,
        ..scope()
    });
    assert!(told.contains("campaigns of 2 missions"), "{told}");
    let mut other = scope();
    other.tuned.shaping.time_penalty += 0.1;
    let told = refused(other);
    assert!(told.contains("other settings"), "{told}");
    let changed = results.replacen("0x", "0xf", 1);
    std::fs::write(out.join("results.csv"), changed).unwrap();
    let told = refused(scope());
    assert!(told.contains("of another configuration"), "{told}");
}

fn a_given_policy_is_flown_not_trained(out: &Path) {
    let given = Scope {
        presets: vec![Preset::Paper],
        ..scope()
    };
    let given = given
        .parts(vec![Part::Tuned])
        .with(vec![out.join("policies/learned-paper-adaptive-s0")]);
    let flown = out.join("given");
    reproduce(&given, &flown, &mut narrator(usize::MAX)).unwrap();
    assert!(!flown.join("policies").exists());
    let results = std::fs::read_to_string(flown.join("results.csv")).unwrap();
    assert_eq!(results.matches("learned,adaptive").count(), 4);
    assert_eq!(results.matches("learned,constant").count(), 4);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes without optimisation")]
fn a_reproduction_goes_on_where_it_was_stopped_and_draws_everything() {
    let out = std::env::temp_dir().join(format!("jcas-reproduce-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&out);
    let stopped = reproduce(&scope(), &out, &mut narrator(2)).unwrap();
    assert_eq!(stopped, Progress::Stopped);
    assert!(out.join("report.html").exists());
    let done = reproduce(&scope(), &out, &mut narrator(usize::MAX)).unwrap();
    assert_eq!(done, Progress::Finished);

    let results = std::fs::read_to_string(out.join("results.csv")).unwrap();
    let compared = std::fs::read_to_string(out.join("comparison.csv")).unwrap();
    everything_is_written(&out, &results, &compared);
    tables_alone_give_the_same_page(&out);

    let mut again = narrator(usize::MAX);
    reproduce(&scope(), &out, &mut again).unwrap();
    assert!(
        !again
            .chapters
            .iter()
            .any(|chapter| chapter.starts_with("training"))
    );
    let now = |name| std::fs::read_to_string(out.join(name)).unwrap();
    assert_eq!(now("results.csv"), results);
    assert_eq!(now("comparison.csv"), compared);

    other_results_are_refused(&out, &results);
    a_given_policy_is_flown_not_trained(&out);
    std::fs::remove_dir_all(&out).unwrap();
}

/// Every part at one cell, with two seeds: trainings of both fly the same script beside them. The
/// paper's training is flown over the sensing range as well.
fn narrow() -> Scope {
    Scope {
        fleets: vec![10],
        hotspots: vec![1],
        seeds: vec![0, 1],
        paper_cells: vec![(10, 1)],
        variations: variations()[..1].to_vec(),
        presets: vec![Preset::Mission],
        ..scope()
    }
}

/// Flies a shard to its end, with a stop on the way.
fn whole_shard(out: &Path, shard: Shard) -> RowCounts {
    let mut early = narrator(4);
    let stopped = fly_shard(&narrow(), out, shard, &mut early).unwrap();
    assert_eq!(stopped, None, "{:?}", early.chapters);
    let done = fly_shard(&narrow(), out, shard, &mut narrator(usize::MAX));
    done.unwrap().expect("nothing stops it")
}

#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes without optimisation")]
fn merged_shards_have_the_bytes_of_the_single_run() {
    let folder = tempfile::tempdir().unwrap();
    let single = folder.path().join("single");
    reproduce(&narrow(), &single, &mut narrator(usize::MAX)).unwrap();
    let units = outline(&narrow(), folder.path()).unwrap().units;
    for count in [2, 3] {
        let mut shards: Vec<(Shard, PathBuf, RowCounts)> = Vec::new();
        for number in (1..=count).rev() {
            let shard = Shard { number, count };
            let out = folder.path().join(format!("{number}-of-{count}"));
            std::fs::create_dir(&out).unwrap();
            let rows = whole_shard(&out, shard);
            assert!(rows.results > 0 && rows.comparison > 0, "{shard:?}");
            shards.push((shard, out, rows));
        }
        let given: Vec<_> = shards
            .iter()
            .map(|(shard, out, rows)| (*shard, out.as_path(), *rows))
            .collect();
        let merged = merge(&given, units).unwrap();
        assert_eq!(merged.len(), 2);
        for (name, bytes) in merged {
            let whole = std::fs::read(single.join(name)).unwrap();
            assert!(bytes == whole, "{name} of {count} shards");
        }
        // One shard has each policy, with what only that policy needs.
        for name in [
            "approach-s0.csv",
            "approach-s1.csv",
            "approach-ppo-s1.csv",
            "policies/ppo-10x1-adaptive-s1/policy.safetensors",
            "policies/learned-mission-constant-s0/policy.safetensors",
        ] {
            let found = shards.iter().map(|(_, out, _)| out.join(name));
            let found: Vec<_> = found.filter(|path| path.exists()).collect();
            assert_eq!(found.len(), 1, "{name}: {found:?}");
            let whole = std::fs::read(single.join(name)).unwrap();
            assert!(std::fs::read(&found[0]).unwrap() == whole, "{name}");
        }
    }
}

/// Shards of scripts alone, for what merging refuses.
fn scripted(folder: &Path) -> [(Shard, &Path, RowCounts); 2] {
    let scripts = narrow().parts(vec![Part::Baselines]);
    [1, 2].map(|number| {
        let shard = Shard { number, count: 2 };
        let rows = fly_shard(&scripts, folder, shard, &mut narrator(usize::MAX));
        (shard, folder, rows.unwrap().unwrap())
    })
}

#[test]
fn what_a_shard_did_not_fly_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let shards = scripted(folder.path());
    let units = shards.iter().map(|(.., rows)| rows.results).sum::<usize>() as u64;
    assert!(merge(&shards, units).is_ok());
    let [table, _] = tables(shards[0].0, folder.path());
    let text = std::fs::read_to_string(&table).unwrap();
    let line = text.lines().nth(1).unwrap();
    let (_, campaign) = line.split_once(',').unwrap();
    for (changed, told) in [
        (text.replace(&format!("{line}\n"), ""), "rows: must be"),
        (text.replace(line, &format!("1,{campaign}")), "which shard"),
        (text.replace(line, &format!("x,{campaign}")), "unit = x"),
        (text.replace(line, &format!("999,{campaign}")), "unit = 999"),
        (text.replace("unit,", "step,"), "first column must be unit"),
    ] {
        assert_ne!(changed, text, "{told}");
        std::fs::write(&table, changed).unwrap();
        let error = merge(&shards, units).unwrap_err().to_string();
        assert!(error.contains(told), "{told}: {error}");
        assert!(
            error.contains("shard-1-of-2-results.csv") || told == "which shard",
            "{error}"
        );
    }
}
