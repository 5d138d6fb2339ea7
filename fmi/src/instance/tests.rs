//! Fields, outputs and texts of an instance.

use super::*;

fn reference_of(name: &str) -> u32 {
    let variables = all();
    let variable = variables.iter().find(|variable| variable.name == name);
    variable.expect("a field is a variable").reference
}

#[test]
fn nan_means_derived_only_where_a_field_can_be() {
    let mut unit = Instance::new(None).expect("an instance");
    let set = |unit: &mut Instance, name: &str, value: f64| {
        unit.set(reference_of(name), Values::Float64(vec![value]))
    };
    set(&mut unit, "cell_size_m", 40.0).expect("a legal value");
    let refused = set(&mut unit, "cell_size_m", f64::NAN).expect_err("no number");
    assert_eq!(refused.to_string(), "cell_size_m = NaN: must be a number");
    let derived = Config::FIELDS.iter().find(|info| may_be_derived(info.name));
    let derived = derived.expect("a field can be derived").name;
    set(&mut unit, derived, f64::NAN).expect("it is derived");
}

/// Five UAVs in one cell raise false alarms in half of the cells around them, so that two of
/// them agree on some.
#[test]
fn reports_and_false_confirmations_are_outputs() {
    let mut unit = Instance::new(None).expect("an instance");
    let mut set = |name: &str, values: Values| {
        unit.set(reference_of(name), values).expect(name);
    };
    set("preset", Values::String(vec!["isac".into()]));
    set("uav_count", Values::UInt32(vec![5]));
    set("quorum", Values::UInt32(vec![2]));
    set("false_alarm_per_cell", Values::Float64(vec![0.5]));
    let mut episode = Episode::new(&unit.setup).expect("an episode");
    let counts = |episode: &Episode, name: &str| match output(name, episode) {
        Ok(Values::UInt32(counts)) => counts,
        other => panic!("{other:?}"),
    };
    assert_eq!(counts(&episode, "reported_count"), [0; 5]);
    assert_eq!(counts(&episode, "false_confirmation_count"), [0]);
    episode.step(&unit.inputs).expect("a step");
    assert!(
        counts(&episode, "reported_count")
            .iter()
            .all(|&count| count > 0)
    );
    assert!(counts(&episode, "false_confirmation_count")[0] > 0);
}

/// Inputs that the importer has not set are the motion stay, in any order of the bins.
#[test]
fn a_fleet_without_actions_stays() {
    let motions = jcas_core::MotionMap::ALL.iter().map(|map| map.name());
    for map in motions {
        let mut unit = Instance::new(None).expect("an instance");
        let name = Values::String(vec![map.to_owned()]);
        unit.set(reference_of("motion_map"), name).expect("a map");
        let mut episode = Episode::new(&unit.setup).expect("an episode");
        let before = output("cell", &episode).expect("an output");
        episode.step(&unit.inputs).expect("a step");
        assert_eq!(
            output("cell", &episode).expect("an output"),
            before,
            "{map}"
        );
    }
}

#[test]
fn a_detection_table_is_a_text_in_json() {
    let mut unit = Instance::new(None).expect("an instance");
    let mut set = |name: &str, text: &str| {
        unit.set(reference_of(name), Values::String(vec![text.to_owned()]))
    };
    set("detection_curve", "table").expect("a curve");
    set("detection_table", "[[20, 0.9], [80, 0.1]]").expect("a table");
    assert!(set("detection_table", "[[20, 0.9").is_err());
    let config = unit.setup.config().expect("a legal configuration");
    let points = config.detection_table.as_slice();
    assert_eq!(points, [(20.0, 0.9).into(), (80.0, 0.1).into()]);
}
