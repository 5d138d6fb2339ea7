//! Sweeps: lists of cells, and results of another sweep.

use std::fs;

use crate::support::succeed;
use crate::{INPUT, refuses};

#[test]
fn results_of_another_sweep_are_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let sweep = [
        "sweep",
        "--uavs",
        "5",
        "--hotspots",
        "3",
        "--episodes",
        "2",
        "--no-figures",
    ];
    succeed(folder.path(), &sweep);
    let before = fs::read(folder.path().join("out/results.csv")).unwrap();
    for other in [
        ["--seed", "2"].as_slice(),
        &["--set", "horizon_steps=50"],
        &["--vary", "quorum=2,3"],
    ] {
        let arguments = [&sweep, other].concat();
        refuses(
            folder.path(),
            &arguments,
            INPUT,
            &["results.csv", "another sweep", "--overwrite"],
        );
        assert_eq!(
            fs::read(folder.path().join("out/results.csv")).unwrap(),
            before
        );
    }
    succeed(
        folder.path(),
        &[&sweep, ["--seed", "2", "--overwrite"].as_slice()].concat(),
    );
    assert_ne!(
        fs::read(folder.path().join("out/results.csv")).unwrap(),
        before
    );
}

#[test]
fn lists_of_a_sweep() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, parts) in [
        (["--vary", "quorum"], ["--vary quorum", "field=value,value"]),
        (
            ["--vary", "uav_count=3,4"],
            ["--vary uav_count=3,4", "must be given as --uavs 3,4"],
        ),
        (["--uavs", "5,0"], ["uav_count = 0", "1 to 4096"]),
        (["--policy", "greedy,clever"], ["policy = clever", "teams"]),
        (
            ["--vary", "cell_size_m=50,nan"],
            ["cell_size_m = NaN", "0.001"],
        ),
    ] {
        let arguments = [&["sweep", "--episodes", "1"], arguments.as_slice()].concat();
        refuses(folder.path(), &arguments, INPUT, &parts);
        assert!(!folder.path().join("out").exists());
    }
}
