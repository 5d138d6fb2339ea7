//! The page holds only the episode; an invalid trace is refused by name.

use jcas_core::{Cell, Config, Model};
use serde_json::Value;

use super::{fill, page, page_of};
use crate::trace::{self, Trace};
use jcas_policy::{BaselineKind, PilotMode};

/// The trace of an episode of four UAVs, as text.
fn flight() -> String {
    let config = Config {
        grid_width: 6,
        grid_height: 5,
        uav_count: 4,
        hotspot_count: 2,
        horizon_steps: 60,
        ..Config::default()
    };
    let model = Model::new(config).unwrap();
    let mut policy = BaselineKind::Greedy.build(&model, PilotMode::Max).unwrap();
    let mut text = Vec::new();
    trace::record(&model, &mut policy, 42, &mut text).unwrap();
    String::from_utf8(text).unwrap()
}

fn recorded() -> Trace {
    trace::read(flight().as_bytes()).unwrap()
}

fn data_of(page: &str) -> Value {
    let opening = "<script type=\"application/json\" id=\"episode\">";
    let (_, rest) = page.split_once(opening).unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn the_page_holds_the_whole_episode() {
    let text = flight();
    let lines: Vec<Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let data = data_of(&page(&text).unwrap());
    assert_eq!(data["header"], lines[0]);
    let steps = data["steps"].as_array().unwrap();
    assert_eq!(steps.len(), lines.len() - 2);
    for (shown, recorded) in steps.iter().zip(&lines[1..]) {
        for (field, value) in shown.as_object().unwrap() {
            assert_eq!(*value, recorded[field], "{field}");
        }
        for field in ["positions", "battery_uj", "links", "knowledge", "reward"] {
            assert!(shown.get(field).is_some(), "{field}");
        }
    }
    assert_eq!(data["end"], *lines.last().unwrap());
}

#[test]
fn the_title_tells_the_episode() {
    let mut trace = recorded();
    for (terminated, result) in [(true, "complete"), (false, "not complete")] {
        (trace.end.terminated, trace.end.truncated) = (terminated, !terminated);
        let link = if terminated { "in" } else { "after" };
        let title = format!(
            "<title>greedy, pilot max, N = 4, n = 2, seed 0x000000000000002a: \
             {result} {link} {} steps (jcas replay)</title>",
            trace.end.steps
        );
        assert!(page_of(&trace).unwrap().contains(&title), "{title}");
    }
}

#[test]
fn the_page_names_no_other_resource() {
    let page = page(&flight()).unwrap();
    let allowed = page.replace("http://www.w3.org/2000/svg", "");
    for foreign in ["http:", "https:", "src=", "@import", "url("] {
        assert!(!allowed.contains(foreign), "{foreign}");
    }
    assert!(page.contains("default-src 'none'"));
}

#[test]
fn text_of_the_trace_cannot_leave_its_place() {
    let hostile = "</script><script>alert(1)</script><!-- {{script}} &";
    let mut trace = recorded();
    trace.header.policy = hostile.into();
    let with = page_of(&trace).unwrap();
    let without = page(&flight()).unwrap();
    assert_eq!(data_of(&with)["header"]["policy"], hostile);
    for tag in ["<script", "</script", "<!--"] {
        assert_eq!(
            with.matches(tag).count(),
            without.matches(tag).count(),
            "{tag}"
        );
    }
}

#[test]
fn a_mark_inside_a_value_is_left_alone() {
    let filled = fill("a {{x}} b {{y}} c", &[("{{x}}", "{{y}}"), ("{{y}}", "2")]);
    assert_eq!(filled, "a {{y}} b 2 c");
}

/// A page of an episode with false alarms holds them, and one without has no word of them.
#[test]
fn false_alarms_and_reports_are_shown_where_there_are_any() {
    let silent = data_of(&page(&flight()).unwrap());
    assert!(silent["steps"][0].get("reports").is_none());
    assert!(silent.get("footprint_cells").is_none());
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/golden/reports.jsonl");
    let text = std::fs::read_to_string(path).unwrap();
    let shown = data_of(&page(&text).unwrap());
    let recorded: Vec<Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    // A footprint of 100 m on cells of 50 m.
    assert_eq!(shown["footprint_cells"], 2.0);
    for field in ["false_alarms", "falsely_confirmed", "reports"] {
        let last = recorded.len() - 2;
        assert_eq!(
            shown["steps"][last - 1][field],
            recorded[last][field],
            "{field}"
        );
    }
}

/// Changes one place of the trace and returns the error's text.
fn refusal(change: impl FnOnce(&mut Trace)) -> String {
    let mut trace = recorded();
    change(&mut trace);
    page_of(&trace).unwrap_err().to_string()
}

#[test]
fn what_does_not_exist_is_refused_by_line_field_and_value() {
    assert_eq!(
        refusal(|trace| trace.steps[1].positions[0] = Cell { x: 6, y: 0 }),
        "line 3: positions holds [6, 0]: must be on the 6 x 5 grid"
    );
    assert_eq!(
        refusal(|trace| trace.header.depots[0] = Cell { x: 0, y: 5 }),
        "line 1: depots holds [0, 5]: must be on the 6 x 5 grid"
    );
    assert_eq!(
        refusal(|trace| trace.steps[0].links.push([0, 4])),
        "line 2: links holds 4: must be below 4"
    );
    assert_eq!(
        refusal(|trace| trace.steps[0].knowledge[3].push(2)),
        "line 2: knowledge holds 2: must be below 2"
    );
    assert_eq!(
        refusal(|trace| trace.header.hotspots.truncate(1)),
        "line 1: hotspots has 1 elements: must have 2"
    );
}

#[test]
fn a_trace_that_was_cut_or_changed_is_refused() {
    let whole = flight();
    let cut = &whole[..whole.len() / 2];
    assert!(page(cut).unwrap_err().to_string().contains("truncated"));
    let changed = whole.replacen("\"t\":1", "\"t\":9", 1);
    assert!(page(&changed).unwrap_err().to_string().contains("t = 9"));
    let changed = whole.replacen("greedy", "worm", 1);
    assert!(page(&changed).unwrap_err().to_string().contains("checksum"));
    assert!(page("").is_err());
}
