//! The episodes that the page offers by name.

use serde_json::{Value, json};

/// Returns the scenes: name, a few words, and the episode as the page's address holds it.
pub(crate) fn scenes() -> Value {
    let scene = |name: &str, summary: &str, episode: Value| {
        json!({
            "name": name,
            "summary": summary,
            "mission": episode,
        })
    };
    json!([
        scene("Teams", "Known hotspots, which teams divide", json!({})),
        scene(
            "Search",
            "Hidden hotspots; lines abreast sweep the grid",
            json!({ "preset": "search" }),
        ),
        scene(
            "Plan",
            "The same search, planned before the first step",
            json!({ "preset": "search", "policy": "plan" }),
        ),
        scene(
            "False alarms",
            "A radar that errs; a quorum checks each report",
            json!({ "preset": "isac" }),
        ),
        scene(
            "Large fleet",
            "60 UAVs and 20 hotspots on 24 × 24 cells",
            json!({ "set": {
                "uav_count": 60, "hotspot_count": 20, "grid_width": 24, "grid_height": 24,
                "horizon_steps": 200,
            } }),
        ),
        scene(
            "Short batteries",
            "30 hotspots; a battery lasts sixty moves",
            json!({ "set": {
                "hotspot_count": 30, "horizon_steps": 1000, "battery_capacity_kwh": 0.06,
                "rtb_threshold_kwh": 0.012, "depots": [[2, 2], [9, 9]], "charge_power_kw": 21.6,
            } }),
        ),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As the page asks for a scene.
    fn fly(scene: &Value) -> Value {
        let episode = &scene["mission"];
        let mut config = episode["set"].as_object().cloned().unwrap_or_default();
        if let Some(preset) = episode.get("preset") {
            config.insert("preset".to_owned(), preset.clone());
        }
        let mut question =
            json!({ "ask": "fly", "config": config, "pilot": "adaptive", "seed": 1 });
        if let Some(policy) = episode.get("policy") {
            question["policy"] = policy.clone();
        }
        serde_json::from_str(&crate::answer(&question.to_string())).unwrap()
    }

    #[test]
    fn every_scene_succeeds() {
        for scene in scenes().as_array().unwrap() {
            let answer = fly(scene);
            let end = &answer["episode"]["end"];
            assert_eq!(
                end["terminated"], true,
                "{}: {}",
                scene["name"], answer["error"]
            );
        }
    }
}
