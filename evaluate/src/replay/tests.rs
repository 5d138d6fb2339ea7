//! The page holds the episode and nothing foreign; a bad trace is refused by name.

use super::{fill, page};
use serde_json::{Value, json};

/// Two UAVs find one hotspot in two steps.
fn trace() -> Vec<Value> {
    let config = json!({
        "grid_width": 4, "grid_height": 3, "cell_size_m": 50.0, "uav_count": 2, "hotspot_count": 1, "quorum": 2,
        "step_duration_s": 10.0, "battery_capacity_kwh": 0.2, "rtb_threshold_kwh": 0.04,
        "pilot_density_min": 0.01, "pilot_density_max": 0.3, "carrier_frequency_hz": 5.8e9,
    });
    let step = |t: u32, found: &[u32]| {
        json!({
            "kind": "step", "t": t, "actions": [[0.8, 1.0], [0.8, 1.0]], "positions": [[2, 1], [3, 2]],
            "pilot_density": [0.3, 0.3], "battery_uj": [1, 2], "grounded": [], "returning": [1], "links": [[0, 1]],
            "knowledge": [found, found], "confirmed": found, "informed": found, "carbon_intensity_mg_per_kwh": 300_000,
            "co2_ng": 0, "throughput": 1.5, "reward": {"detect": 7.0, "carbon": -0.5},
            "observation_hash": "0x1", "state_hash": "0x2",
        })
    };
    vec![
        json!({
            "kind": "header", "format": "jcas-trace", "format_version": 1, "core_version": "0.1.0", "config": config,
            "config_hash": "0x5", "seed": "0x2a", "policy": "swarm", "pilot": "max", "hotspots": [[3, 2]],
            "depots": [[2, 1]], "initial": {"positions": [[2, 1], [2, 1]], "battery_uj": [9, 9]},
        }),
        step(1, &[]),
        step(2, &[0]),
        json!({"kind": "end", "steps": 2, "terminated": true, "truncated": false, "checksum": "0x0"}),
    ]
}

fn text(lines: &[Value]) -> String {
    lines.iter().map(|line| format!("{line}\n")).collect()
}

fn data_of(page: &str) -> Value {
    let opening = "<script type=\"application/json\" id=\"episode\">";
    let (_, rest) = page.split_once(opening).unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn the_page_holds_the_whole_episode() {
    let lines = trace();
    let data = data_of(&page(&text(&lines)).unwrap());
    for field in ["policy", "seed", "hotspots", "depots"] {
        assert_eq!(data["header"][field], lines[0][field]);
    }
    for (shown, recorded) in data["steps"].as_array().unwrap().iter().zip(&lines[1..]) {
        for field in [
            "positions",
            "battery_uj",
            "links",
            "knowledge",
            "confirmed",
            "reward",
        ] {
            assert_eq!(shown[field], recorded[field], "{field}");
        }
    }
    assert_eq!(data["end"]["steps"], 2);
}

#[test]
fn the_title_tells_the_episode() {
    let page = page(&text(&trace())).unwrap();
    assert!(page.contains(
        "<title>swarm, pilot max, N = 2, n = 1, seed 0x2a: complete in 2 steps (jcas replay)</title>"
    ));
}

#[test]
fn the_page_names_no_other_resource() {
    let page = page(&text(&trace())).unwrap();
    let allowed = page.replace("http://www.w3.org/2000/svg", "");
    for foreign in ["http:", "https:", "src=", "@import", "url("] {
        assert!(!allowed.contains(foreign), "{foreign}");
    }
    assert!(page.contains("default-src 'none'"));
}

#[test]
fn text_of_the_trace_cannot_leave_its_place() {
    let hostile = "</script><script>alert(1)</script><!-- {{script}} &";
    let mut lines = trace();
    lines[0]["policy"] = hostile.into();
    let with = page(&text(&lines)).unwrap();
    let without = page(&text(&trace())).unwrap();
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

/// Changes one place of the trace and gives the error's text.
fn refusal(change: impl FnOnce(&mut Vec<Value>)) -> String {
    let mut lines = trace();
    change(&mut lines);
    page(&text(&lines)).unwrap_err().to_string()
}

#[test]
fn a_bad_trace_is_refused_by_line_field_and_value() {
    assert_eq!(
        refusal(|lines| lines[0]["format_version"] = 2.into()),
        "trace line 1: format_version is 2, but must be 1"
    );
    assert_eq!(
        refusal(|lines| lines[2]["t"] = 7.into()),
        "trace line 3: t is 7, but must be 2"
    );
    assert_eq!(
        refusal(|lines| lines[1]["positions"][1] = json!([4, 0])),
        "trace line 2: positions is [4, 0], but must be cells of the 4 x 3 grid"
    );
    assert_eq!(
        refusal(|lines| lines[1]["links"] = json!([[0, 2]])),
        "trace line 2: links is a list with 2, but must be numbers below 2"
    );
    assert_eq!(
        refusal(|lines| lines[1]["battery_uj"] = json!([1])),
        "trace line 2: battery_uj is a list of 1, but must be a list of 2"
    );
    assert_eq!(
        refusal(|lines| lines[0]["seed"] = "forty".into()),
        "trace line 1: seed is forty, but must be 0x and hexadecimal digits of 64 bits"
    );
    assert!(refusal(|lines| lines[1]["reward"]["detect"] = "much".into()).contains("reward"));
}

#[test]
fn a_trace_that_was_cut_is_refused() {
    assert_eq!(
        refusal(|lines| lines.truncate(2)),
        "the trace has no end line after its 1 steps: it was not written to its end"
    );
    assert_eq!(
        refusal(|lines| drop(lines.remove(2))),
        "trace line 3: steps is 2, but must be 1, the number of step lines"
    );
    let whole = text(&trace());
    let cut = &whole[..whole.len() / 2];
    assert!(page(cut).unwrap_err().to_string().starts_with("trace line"));
    assert!(
        page("")
            .unwrap_err()
            .to_string()
            .starts_with("trace line 1")
    );
}
