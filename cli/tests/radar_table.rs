//! A detection table in a CSV file: what is refused, by line and value, and what flies.

mod support;

use std::fs;
use std::path::Path;

use support::{jcas, succeed};

/// Each file, and what the message says after the file's name.
const REFUSED: [(&str, &str); 13] = [
    (
        "",
        "line 1: must name the columns range_m and p_d; it is \"\"",
    ),
    (
        "range_m;p_d\n",
        "line 1: must name the columns range_m and p_d; it is \"range_m;p_d\"",
    ),
    (
        "range_m,p_d\n",
        "must have a line of numbers below the names",
    ),
    (
        "range_m,p_d\n50,0.9\n60,high\n",
        "line 3: p_d = \"high\": must be a number",
    ),
    (
        "p_d,range_m\n0.9,\n",
        "line 2: range_m = \"\": must be a number",
    ),
    (
        "range_m,p_d\n50,0.9\n60\n",
        "line 3: p_d = \"\": must be a number",
    ),
    (
        "range_m,p_d\n50,1\n",
        "line 2: detection_table = [50.0, 1.0]: must be pairs [m, P_d] with a P_d above 0 and \
         below 1",
    ),
    (
        "range_m,p_d\n50,0.9\n\n-60,0.5\n",
        "line 4: detection_table = [-60.0, 0.5]: must be pairs [m, P_d] with a range from 0 to 1e6",
    ),
    (
        "range_m,p_d\n50,0.9\n60,0.5\n60,0.4\n",
        "line 4: detection_table = [60.0, 0.4]: must be pairs [m, P_d] of which each has a longer \
         range than the one before",
    ),
    (
        "p_d,range_m\n0.8,50\n0.9,60\n",
        "line 3: detection_table = [60.0, 0.9]: must be pairs [m, P_d] whose P_d does not rise \
         with the range",
    ),
    (
        "range_m,p_d\n0,0.99\n50,0.6\n",
        "line 3: detection_table = [50.0, 0.6]: must be pairs [m, P_d] that end with a P_d of at \
         most 0.1, which holds at longer ranges",
    ),
    (
        "range_m,p\u{1b}[31mRED\n1,2\n",
        "line 1: must name the columns range_m and p_d; it is \"range_m,p\\u{1b}[31mRED\"",
    ),
    (
        "range_m,pilot_density,p_d\n50,0.2,0.9\n50,0.1,0.8\n",
        "must have lines with pilot_density = 0.3, the configured pilot_density_max; it has 0.2, \
         0.1",
    ),
];

fn message(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = jcas(folder, arguments);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}");
    assert!(output.stdout.is_empty(), "{arguments:?} printed a result");
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn a_file_that_is_no_table_is_refused_by_line_and_value() {
    let folder = tempfile::tempdir().unwrap();
    for (text, says) in REFUSED {
        fs::write(folder.path().join("p_d.csv"), text).unwrap();
        for arguments in [
            &["config", "radar-table", "p_d.csv"][..],
            &["simulate", "--radar-table", "p_d.csv"],
        ] {
            let said = message(folder.path(), arguments, 2);
            assert_eq!(said, format!("error: p_d.csv: {says}\n"));
        }
    }
    let absent = message(folder.path(), &["config", "radar-table", "none.csv"], 3);
    assert!(absent.starts_with("error: none.csv: "), "{absent}");
}

#[test]
fn a_table_has_at_most_64_points() {
    let folder = tempfile::tempdir().unwrap();
    let lines = |count: u32| -> String {
        let rows = (0..count).map(|row| format!("{row},{}\n", 0.9 - 0.0128 * f64::from(row)));
        "range_m,p_d\n"
            .chars()
            .chain(rows.flat_map(|row| row.chars().collect::<Vec<_>>()))
            .collect()
    };
    let arguments = ["config", "radar-table", "p_d.csv"];
    fs::write(folder.path().join("p_d.csv"), lines(65)).unwrap();
    let said = message(folder.path(), &arguments, 2);
    assert_eq!(
        said,
        "error: p_d.csv: line 66: must be one of at most 64 points of a table\n"
    );
    fs::write(folder.path().join("p_d.csv"), lines(64)).unwrap();
    succeed(folder.path(), &arguments);
}

/// The published table crosses P_d = 0.5 between its lines at 90 m and 100 m. The logit is linear
/// there: 90 + 10 · ln(0.548195/0.451805) / (that + ln(0.592593/0.407407)) = 93.4 m.
#[test]
fn the_published_table_is_checked_and_plotted() {
    let folder = tempfile::tempdir().unwrap();
    let published = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/radar/p_d.csv");
    fs::copy(published, folder.path().join("p_d.csv")).unwrap();
    let arguments = [
        "config",
        "radar-table",
        "p_d.csv",
        "--set",
        "pilot_gain=coherent",
    ];
    let said = succeed(
        folder.path(),
        &[&arguments[..], &["--figure", "p_d.svg"]].concat(),
    );
    assert!(
        said.starts_with("p_d.csv: valid, 16 points at pilot density 0.3\n"),
        "{said}"
    );
    let row: Vec<_> = said.lines().nth(3).unwrap().split_whitespace().collect();
    let flown_m: f64 = row[1].parse().unwrap();
    assert!((flown_m - 93.4).abs() <= 0.5, "{said}");
    assert_eq!(row[0], "0.3", "{said}");
    let figure = fs::read_to_string(folder.path().join("p_d.svg")).unwrap();
    for name in ["pilot density 0.01", "0.01 in the file"] {
        assert!(figure.contains(name), "no {name} in the figure");
    }
    let refused = message(
        folder.path(),
        &[&arguments[..], &["--figure", "p_d.pdf"]].concat(),
        2,
    );
    assert_eq!(
        refused,
        "error: --figure p_d.pdf: must end in .svg or .png\n"
    );
}

#[test]
fn a_file_flies_as_the_same_table_in_the_configuration() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("p_d.csv"),
        "\u{feff}\"range_m\",\"p_d\",pilot_density\r\n0,0.9,0.3\r\n0,0.1,0.01\r\n\r\n100,0.1,0.3",
    )
    .unwrap();
    let file = ["--radar-table", "p_d.csv"];
    let fields = [
        "--set",
        "detection_curve=table",
        "--set",
        "detection_table=[[0, 0.9], [100, 0.1]]",
    ];
    for command in [
        &["config", "show", "--json"][..],
        &["simulate", "--episodes", "20", "--json"],
    ] {
        let of_file = succeed(folder.path(), &[command, &file].concat());
        assert_eq!(
            of_file,
            succeed(folder.path(), &[command, &fields].concat())
        );
        assert_ne!(of_file, succeed(folder.path(), command));
    }
}
