//! Figures show their data, are the same each time, and are written completely.

use super::output::Draw;
use super::{Axis, Figure, Interval, Mark, Panels, Point, Series};

fn success() -> Figure {
    let series = |name: &str, rise: f64| {
        let points = [5.0, 10.0, 15.0, 20.0]
            .map(|x: f64| (x, 100.0 * (1.0 - (-rise * x).exp())))
            .map(|(x, y)| Point::interval(x, y, y - 4.0, (y + 4.0).min(100.0)));
        Series::line(name, points.to_vec())
    };
    Figure::new(
        "Success over fleet size",
        Axis::new("Fleet size N", ""),
        Axis::new("Success", "%").span(0.0, 100.0),
    )
    .note("n = 5 hotspots; 95 % intervals")
    .with(series("swarm", 0.3))
    .with(series("teams", 0.2))
    .with(series("<random>", 0.01))
    .reference(73.0, "paper")
}

fn every_kind() -> Vec<Box<dyn Draw>> {
    let wave = |phase: f64| -> Vec<Point> {
        (0..60)
            .map(|k| {
                let (x, y) = (
                    f64::from(k),
                    40.0 - 40.0 * (-f64::from(k) / 12.0).exp() + phase,
                );
                Point::interval(x, y, y - 5.0, y + 5.0)
            })
            .collect()
    };
    let training = Figure::new(
        "Return",
        Axis::new("Iteration", ""),
        Axis::new("Return", ""),
    )
    .with(Series::band("n = 3", wave(0.0)))
    .with(Series::band("n = 5", wave(12.0)));
    let bars = Figure::new(
        "Energy",
        Axis::new("Policy", "").categories(["swarm", "teams"]),
        Axis::new("Energy", "kWh"),
    )
    .with(Series::bars(
        "adaptive",
        vec![Point::interval(0.0, 0.2, 0.18, 0.22), Point::new(1.0, 0.25)],
    ))
    .with(Series::bars(
        "constant",
        vec![Point::new(0.0, 0.3), Point::new(1.0, 0.28)],
    ));
    let scatter = Figure::new(
        "Trade-off",
        Axis::new("Throughput", ""),
        Axis::new("Success", "%"),
    )
    .with(
        Series::points(
            "constant",
            vec![Point::interval(1.2, 80.0, 76.0, 84.0).x_interval(1.1, 1.3)],
        )
        .labels(["0.30"]),
    );
    let costs = Figure::new(
        "Cost",
        Axis::new("N", "").logarithmic(),
        Axis::new("Time", "µs").logarithmic(),
    )
    .with(Series::line(
        "step",
        vec![Point::new(1.0, 2.0), Point::new(1000.0, 900.0)],
    ));
    let panels = Panels {
        title: "All".into(),
        note: String::new(),
        columns: 2,
        figures: vec![success(), success(), success()],
    };
    vec![
        Box::new(success()),
        Box::new(training),
        Box::new(bars),
        Box::new(scatter),
        Box::new(costs),
        Box::new(panels),
    ]
}

#[test]
fn svg_holds_title_axes_units_and_names_as_text() {
    let svg = success().svg().unwrap();
    for text in [
        "Success over fleet size",
        "Fleet size N",
        "Success (%)",
        "swarm",
        "teams",
        "&lt;random&gt;",
        "paper",
    ] {
        assert!(
            svg.contains(&format!("{text}\n</text>")) || svg.contains(&format!(">{text}</text>")),
            "{text}"
        );
    }
    assert!(!svg.contains("<random>") && !svg.contains("jcas-figure-font"));
    assert!(svg.contains("font-family=\"Roboto, "));
    assert!(svg.contains(
        "<title>Success over fleet size: Success (%) over Fleet size N; \
         swarm, teams, &lt;random&gt;</title>"
    ));
}

#[test]
fn every_kind_is_drawn_the_same_each_time() {
    for (first, second) in every_kind().iter().zip(every_kind()) {
        let svg = first.svg().unwrap();
        assert_eq!(svg, second.svg().unwrap());
        assert!(
            !svg.contains("NaN") && !svg.contains("inf"),
            "{}",
            first.description()
        );
    }
}

#[test]
fn png_has_twice_the_pixels_and_is_not_blank() {
    let figure = success();
    let (width, height) = figure.size();
    let bytes = figure.png().unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
        .read_info()
        .unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((info.width, info.height), (2 * width, 2 * height));
    let inked = pixels
        .chunks(3)
        .filter(|pixel| **pixel != [255, 255, 255])
        .count();
    assert!(
        inked > 2_000,
        "{} has only {inked} inked pixels",
        figure.description()
    );
}

#[test]
fn gaps_and_missing_intervals_are_left_out() {
    let points = vec![
        Point::new(1.0, 2.0),
        Point::interval(2.0, f64::NAN, 1.0, 3.0),
        Point::interval(3.0, 4.0, f64::NAN, 5.0),
        Point::new(4.0, f64::INFINITY),
    ];
    let figure = Figure::new("Gaps", Axis::new("x", ""), Axis::new("y", ""))
        .with(Series::line("a", points.clone()))
        .with(Series::line("b", points).styled(Mark::PlainLine, Interval::Band));
    let svg = figure.svg().unwrap();
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    assert_eq!(
        svg.matches("<polygon").count(),
        0,
        "no band without two bounded points in a row"
    );
}

#[test]
fn a_figure_without_data_says_so() {
    let figure = Figure::new("Nothing yet", Axis::new("x", ""), Axis::new("y", ""));
    assert!(figure.svg().unwrap().contains("no data"));
    let with_empty = figure.with(Series::line("a", vec![]));
    assert!(with_empty.svg().unwrap().contains("no data"));
}

#[test]
fn files_appear_whole_and_errors_name_them() {
    let folder = std::env::temp_dir().join(format!("jcas-figures-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (svg, png) = (folder.join("a.svg"), folder.join("a.png"));
    success().write_svg(&svg).unwrap();
    success().write_png(&png).unwrap();
    assert_eq!(
        std::fs::read_to_string(&svg).unwrap(),
        success().svg().unwrap()
    );
    assert_eq!(
        std::fs::read(&png).unwrap(),
        success().png().unwrap(),
        "the same bytes each time"
    );
    assert_eq!(
        std::fs::read_dir(&folder).unwrap().count(),
        2,
        "no temporary file is left"
    );

    let missing = folder.join("no such folder").join("a.svg");
    let message = success().write_svg(&missing).unwrap_err().to_string();
    assert!(
        message.starts_with(&missing.display().to_string()),
        "{message}"
    );
    std::fs::remove_dir_all(&folder).unwrap();
}
