use alloc::format;
use alloc::string::{String, ToString};

use super::*;

fn toml_of(config: &Config) -> String {
    let mut text = String::new();
    config.write_toml(&mut text).unwrap();
    text
}

fn json_of(config: &Config) -> String {
    let mut text = String::new();
    config.write_json(&mut text).unwrap();
    text
}

#[test]
fn toml_and_json_agree_and_round_trip() {
    let toml =
        Config::from_toml("preset = 'paper'\nuav_count = 15\ndepots = [[0, 0], [3, 4]]").unwrap();
    let json =
        Config::from_json(r#"{"preset": "paper", "uav_count": 15, "depots": [[0, 0], [3, 4]]}"#)
            .unwrap();
    assert_eq!(toml, json);
    assert_eq!(toml.hash(), json.hash());
    assert_eq!(Config::from_toml(&toml_of(&toml)).unwrap(), toml);
    assert_eq!(Config::from_json(&json_of(&toml)).unwrap(), toml);
    assert_ne!(toml.hash(), Config::default().hash());
    let mut counted = Counter::default();
    toml.write_json(&mut counted).unwrap();
    assert_eq!(counted.0, json_of(&toml).len());
}

/// Refused texts and the whole message for each.
const REFUSED: &[(&str, &str)] = &[
    (
        "uav_count = 0",
        "uav_count = 0: must be a whole number from 1 to 4096",
    ),
    (
        "uav_count = -3",
        "uav_count = -3: must be a whole number from 1 to 4096",
    ),
    (
        "uav_count = 2.5",
        "uav_count = 2.5: must be a whole number from 1 to 4096",
    ),
    (
        "uav_count = true",
        "uav_count = true: must be a whole number from 1 to 4096",
    ),
    (
        "uav_cuont = 5",
        "uav_cuont: no such field; did you mean uav_count?",
    ),
    (
        "max_episode_steps = 5",
        "max_episode_steps: no such field; did you mean horizon_steps?",
    ),
    ("\u{9b}31m\u{202e} = 5", "line 1 column 1: must be a key"),
    (
        "'\u{9b}31m\u{202e}' = 5",
        "\\u{9b}31m\\u{202e}: no such field (`jcas config show` lists all)",
    ),
    (
        "\n[radar",
        "line 2 column 1: must be a line FIELD = VALUE; a configuration has no tables",
    ),
    (
        "cell_size_m = nan",
        "cell_size_m = NaN: must be a number from 0.001 to 1000000",
    ),
    (
        "pilot_density_min = 0.4",
        "pilot_density_min = 0.4: must be at most 0.3 (pilot_density_max)",
    ),
    (
        "move_energy_kwh = -1e-3",
        "move_energy_kwh = -0.001: must be a number from 0 to 1",
    ),
    (
        "depots = 5",
        "depots = 5: must be a list of at most 16 cells [x, y]",
    ),
    (
        "target_visibility = 'seen'",
        "target_visibility = 'seen': must be one of known, hidden",
    ),
    (
        "quorum = 3\nquorum = 3",
        "quorum: given twice, must be given once",
    ),
    (
        "[fleet]\nquorum = 3",
        "line 1 column 1: must be a line FIELD = VALUE; a configuration has no tables",
    ),
    (
        "fleet.quorum = 3",
        "fleet.quorum: no such field (`jcas config show` lists all)",
    ),
    (
        "quorum = 3 4",
        "line 1 column 12: must be the end of the line",
    ),
    ("\nquorum = = 3", "line 2 column 10: must be a value"),
    (
        "detection_curve = 'swerling2'",
        "detection_curve = 'swerling2': must be one of logistic, swerling1, table",
    ),
    (
        "detection_curve = 'swerling1'\ndetection_threshold_db = 3",
        "detection_threshold_db = 3.0: must be absent while detection_curve is swerling1, \
         which has no threshold",
    ),
    (
        "preset = 'search'\ndetection_curve = 'swerling1'",
        "sensing_range_m = 150.0: must be absent while detection_curve is swerling1, \
         which has no threshold",
    ),
    (
        "detection_curve = 'swerling1'\nlogistic_slope_per_db = 0.5",
        "logistic_slope_per_db = 0.5: must be 0.25, its default, while detection_curve is \
         swerling1, which has no slope",
    ),
    (
        "false_alarm_probability = 0.01",
        "false_alarm_probability = 0.01: must be from 1e-7 to 1e-3 while detection_curve is \
         logistic (Albersheim's equation)",
    ),
    (
        "sensing_footprint_m = 70",
        "sensing_footprint_m = 70.0: must be absent while false_alarm_per_cell is 0",
    ),
    (
        "false_alarm_per_cell = 0.6",
        "false_alarm_per_cell = 0.6: must be a number from 0 to 0.5",
    ),
    (
        "report_levels = 2",
        "report_levels = 2: must be 0 while false_alarm_per_cell is 0, which leaves no \
         footprint",
    ),
    (
        "false_alarm_per_cell = 0.01\nreport_slots = 4",
        "report_slots = 4: must be 0 while report_levels is 0",
    ),
    (
        "false_alarm_per_cell = 0.01\nreport_levels = 4",
        "report_levels = 4: must be a whole number from 0 to 3",
    ),
    (
        "map_window_radius = 2",
        "map_window_radius = 2: must be 0 (off) while search_maps is off and report_levels \
         is 0",
    ),
    (
        "detection_curve = 'swerling1'\nfalse_alarm_probability = 0.5",
        "false_alarm_probability = 0.5: must be a number from 0.000000000001 to 0.1",
    ),
];

#[test]
fn messages_name_field_value_and_what_is_allowed() {
    let refused = |text: &str| Config::from_toml(text).unwrap_err().to_string();
    for (text, says) in REFUSED {
        assert_eq!(refused(text), *says);
    }
    assert!(refused("hotspot_count = 150").contains("must be at most 143"));
    assert!(refused("depots = [[12, 0]]").contains("[12, 0]"));
    assert!(refused("preset = 'best'").contains("`mission`"));
    assert!(
        refused("horizon_steps = 1000000\nuav_count = 4096\ncharge_power_kw = 10000")
            .contains("2^62")
    );
}

/// The message for a refused list is short for any content.
#[test]
fn messages_are_bounded() {
    let many = "[0, 0], ".repeat(60);
    let long = "x".repeat(100_000);
    for text in [
        format!("depots = [{many}]"),
        format!("depots = '{long}'"),
        format!("{long} = 1"),
        format!("preset = '{long}'"),
        format!("quorum = 1{}", "0".repeat(100_000)),
    ] {
        let message = Config::from_toml(&text).unwrap_err().to_string();
        assert!(message.len() < 200, "{message}");
    }
}

/// What both forms take and refuse alike.
#[test]
fn one_text_has_one_meaning() {
    for (toml, json, legal) in [
        ("quorum = 4", r#"{"quorum": 4}"#, true),
        ("'quorum' = 4 # four", "\t{\"quorum\"\n:4 }\n", true),
        ("", "{}", true),
        ("preset = 'paper'", r#"{"preset": "paper"}"#, true),
        ("preset = 3", r#"{"preset": 3}"#, false),
        ("step_duration_s = 5", r#"{"step_duration_s": 5}"#, true),
        (
            "step_duration_s = 5e-1",
            r#"{"step_duration_s": 5e-1}"#,
            true,
        ),
        (
            "step_duration_s = none",
            r#"{"step_duration_s": null}"#,
            false,
        ),
        (
            "quorum = 3\nquorum = 5",
            r#"{"quorum":3,"quorum":5}"#,
            false,
        ),
        (
            "quorum = 3\n'quorum' = 3",
            r#"{"quorum":3, "quorum" : 3}"#,
            false,
        ),
        (
            "preset='paper'\npreset='paper'",
            r#"{"preset":"paper","preset":"paper"}"#,
            false,
        ),
        ("quorum = 03", r#"{"quorum": 03}"#, false),
        ("quorum = 3.", r#"{"quorum": 3.}"#, false),
        ("quorum = '3'", r#"{"quorum": "3"}"#, false),
        ("quorum = [3]", r#"{"quorum": [3]}"#, false),
        ("quorum = {}", r#"{"quorum": {}}"#, false),
        ("depots = []", r#"{"depots": []}"#, true),
        ("depots = [[1, 2]]", r#"{"depots": [[1, 2]]}"#, true),
        ("depots = [[1, 2, 3]]", r#"{"depots": [[1, 2, 3]]}"#, false),
        ("depots = [[1, -2]]", r#"{"depots": [[1, -2]]}"#, false),
        ("depots = [1, 2]", r#"{"depots": [1, 2]}"#, false),
        ("depots = [[1, 2]", r#"{"depots": [[1, 2]"#, false),
        ("reward_spread = -0.0", r#"{"reward_spread": -0.0}"#, true),
        (
            "sense_energy_kwh = -0.0",
            r#"{"sense_energy_kwh": -0.0}"#,
            true,
        ),
        ("quorum 3", r#"{"quorum" 3}"#, false),
        ("quorum = 3 x", r#"{"quorum": 3} x"#, false),
        ("quorum = 'a\nb'", "{\"quorum\": \"a\nb\"}", false),
        ("\0", "\0", false),
    ] {
        let (a, b) = (Config::from_toml(toml), Config::from_json(json));
        assert_eq!(a.is_ok(), legal, "{toml}: {a:?}");
        assert_eq!(b.is_ok(), legal, "{json}: {b:?}");
        if legal {
            assert_eq!(a, b);
            assert_eq!(a.unwrap().hash(), b.unwrap().hash());
        }
    }
}

#[test]
fn a_detection_table_that_does_not_fit_is_refused_by_name() {
    for (text, says) in [
        (
            "detection_curve = 'table'",
            "detection_table = []: must be a list of 1 to 64 pairs [m, P_d] while detection_curve \
             is table",
        ),
        (
            "detection_table = [[50, 0.9]]",
            "detection_table = [50.0, 0.9]: must be absent unless detection_curve is table",
        ),
        (
            "detection_curve = 'table'\ndetection_table = [[50, 0.9]]\nsensing_range_m = 9",
            "sensing_range_m = 9.0: must be absent while detection_curve is table, which has no \
             threshold",
        ),
        (
            "detection_curve = 'table'\ndetection_table = [[-1, 0.9]]",
            "detection_table = [-1.0, 0.9]: must be pairs [m, P_d] with a range from 0 to 1e6",
        ),
        (
            "detection_curve = 'table'\ndetection_table = [[50, 1]]",
            "detection_table = [50.0, 1.0]: must be pairs [m, P_d] with a P_d above 0 and below 1",
        ),
        (
            "detection_curve = 'table'\ndetection_table = [[50, nan]]",
            "detection_table = [50.0, NaN]: must be pairs [m, P_d] with a P_d above 0 and below 1",
        ),
        (
            "detection_curve = 'table'\ndetection_table = [[50, 0.9], [50, 0.8]]",
            "detection_table = [50.0, 0.8]: must be pairs [m, P_d] of which each has a longer \
             range than the one before",
        ),
        (
            "detection_curve = 'table'\ndetection_table = [[50, 0.8], [60, 0.9]]",
            "detection_table = [60.0, 0.9]: must be pairs [m, P_d] whose P_d does not rise with \
             the range",
        ),
        (
            "detection_curve = 'table'\ndetection_table = [[0, 0.99], [50, 0.6]]",
            "detection_table = [50.0, 0.6]: must be pairs [m, P_d] that end with a P_d of at most \
             0.1, which holds at longer ranges",
        ),
        (
            "detection_table = 3",
            "detection_table = 3: must be a list of at most 64 pairs [m, P_d]",
        ),
        (
            "detection_table = [[true, 3]]",
            "detection_table = [[true, 3]]: must be a list of at most 64 pairs [m, P_d]",
        ),
        (
            "depots = [[1.5, 2]]",
            "depots = [[1.5, 2]]: must be a list of at most 16 cells [x, y]",
        ),
    ] {
        assert_eq!(Config::from_toml(text).unwrap_err().to_string(), says);
    }
}

#[test]
fn a_detection_table_of_64_points_is_read_back_and_one_of_65_refused() {
    let list = |count: u32| {
        let pairs: std::vec::Vec<_> = (0..count)
            .map(|index| format!("[{index}, {}]", 0.9 - f64::from(index) / 76.0))
            .collect();
        format!(
            "detection_table = [{}]\ndetection_curve = 'table'",
            pairs.join(",")
        )
    };
    let config = Config::from_toml(&list(64)).unwrap();
    let last = config.detection_table.as_slice()[63];
    assert_eq!((last.range_m, last.probability), (63.0, 0.9 - 63.0 / 76.0));
    let (mut toml, mut json) = (String::new(), String::new());
    config.write_toml(&mut toml).unwrap();
    config.write_json(&mut json).unwrap();
    for again in [Config::from_toml(&toml), Config::from_json(&json)] {
        let again = again.unwrap();
        assert_eq!(again, config);
        assert_eq!(again.hash(), config.hash());
    }
    assert!(Config::from_toml(&list(65)).is_err());
    // The table is part of the fingerprint.
    assert_ne!(Config::from_toml(&list(63)).unwrap().hash(), config.hash());
}

#[test]
fn null_takes_a_derived_field_back_and_no_other() {
    let given = Config {
        range_min_m: Some(3.0),
        depots: crate::config::Depots::one(crate::config::Cell { x: 1, y: 1 }),
        ..Config::default()
    };
    let text = r#"{"range_min_m": null, "depots": null}"#;
    assert_eq!(given.overlaid(text, Form::Json).unwrap(), Config::default());
    assert_eq!(
        given.assigned("range_min_m", "none").unwrap().range_min_m,
        None
    );
    assert!(given.assigned("quorum", "none").is_err());
    let text = "range_min_m = 'none'\ndepots = []";
    assert_eq!(given.overlaid(text, Form::Toml).unwrap(), Config::default());
}

#[test]
fn toml_writes_numbers_in_its_own_ways() {
    for (text, quorum) in [("0x10", 16), ("1_0", 10), ("+7", 7), ("0b11", 3)] {
        let config = Config::from_toml(&format!("quorum = {text}\nuav_count = 20")).unwrap();
        assert_eq!(config.quorum, quorum);
    }
    for text in ["1__0", "_1", "1_", "0x", "--3", "1e", ".5", "5."] {
        assert!(
            Config::from_toml(&format!("quorum = {text}")).is_err(),
            "{text}"
        );
    }
    let depots = "depots = [ # where they charge\n [1, 2],\n [3, 4], # the last\n]\r\nquorum = 2";
    assert_eq!(Config::from_toml(depots).unwrap().depots.len(), 2);
}

#[test]
fn typed_values_need_no_quotes() {
    let config = Config::default();
    let hidden = config.assigned("target_visibility", "hidden").unwrap();
    assert_eq!(
        hidden,
        config.assigned("target_visibility", "'hidden'").unwrap()
    );
    let message = |field: &str, text: &str| config.assigned(field, text).unwrap_err().to_string();
    assert_eq!(
        message("target_visibility", "seen"),
        "target_visibility = \"seen\": must be one of known, hidden"
    );
    assert_eq!(
        message("quorum", "many"),
        "quorum = \"many\": must be a whole number from 1 to 4096"
    );
    assert_eq!(
        config.assigned("depots", "[[1, 2]]").unwrap().depots.len(),
        1
    );
}
