//! Configurations: a field out of its range, a misspelt name, a file that does not parse.

use std::fs;

use crate::{INPUT, IO, refuses};

#[test]
fn fields_out_of_range() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, parts) in [
        (["--uavs", "0"], ["uav_count = 0", "1 to 4096"]),
        (
            ["--hotspots", "144"],
            ["hotspot_count = 144", "at most 143"],
        ),
        (
            ["--set", "pilot_density_min=0.5"],
            ["pilot_density_min = 0.5", "at most 0.3"],
        ),
        (
            ["--set", "move_energy_kwh=-0.001"],
            ["move_energy_kwh = -0.001", "from 0 to 1"],
        ),
        (
            ["--set", "cell_size_m=nan"],
            ["cell_size_m = NaN", "0.001 to 1000000"],
        ),
        (
            ["--set", "cell_size_m=inf"],
            ["cell_size_m = inf", "0.001 to 1000000"],
        ),
        (
            ["--set", "uav_count=2.5"],
            ["uav_count = 2.5", "a whole number from 1 to 4096"],
        ),
        (
            ["--set", "uav_count=-5"],
            ["uav_count = -5", "a whole number from 1 to 4096"],
        ),
        (
            ["--set", "target_visibility=seen"],
            ["target_visibility = \"seen\"", "one of known, hidden"],
        ),
        (
            ["--set", "uav_cout=5"],
            ["uav_cout: no such field", "did you mean uav_count?"],
        ),
        (["--set", "uav_count"], ["--set uav_count", "field=value"]),
    ] {
        let arguments = [&["simulate", "--episodes", "1"], arguments.as_slice()].concat();
        refuses(folder.path(), &arguments, INPUT, &parts);
    }
}

#[test]
fn configuration_files() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text, parts) in [
        (
            "nan.toml",
            "cell_size_m = nan\n",
            ["cell_size_m = NaN", "0.001 to 1000000"],
        ),
        (
            "nan.json",
            "{\"cell_size_m\": NaN}",
            ["nan.json", "line 1 column"],
        ),
        (
            "negative.toml",
            "battery_capacity_kwh = -0.2\n",
            ["battery_capacity_kwh = -0.2", "0.000001"],
        ),
        (
            "type.json",
            "{\"uav_count\": \"many\"}",
            ["uav_count = \"many\"", "a whole number"],
        ),
        (
            "unknown.toml",
            "uavs = 5\n",
            ["unknown.toml", "uavs: no such field"],
        ),
        (
            "broken.toml",
            "uav_count = = 5\n",
            ["broken.toml", "line 1"],
        ),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
        refuses(folder.path(), &["config", "check", name], INPUT, &parts);
        refuses(
            folder.path(),
            &["simulate", "--config", name],
            INPUT,
            &parts,
        );
    }
    refuses(
        folder.path(),
        &["config", "check", "absent.toml"],
        IO,
        &["absent.toml", "No such file"],
    );
}
