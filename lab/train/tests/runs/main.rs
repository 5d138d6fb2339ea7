//! Runs on the real kernel: interrupted and continued, written and read back, exported.

mod going_on;
mod policies;

use jcas_core::Config;
use jcas_policy::head::Head;
use jcas_train::metrics::Row;
use jcas_train::policy::files::Precision;
use jcas_train::run::{Observer, RunSpec, Start};
use jcas_train::settings::{NetworkKind, Preset, Settings, Shaping};

fn settings(network: NetworkKind) -> Settings {
    Settings {
        network,
        head: Head::Hybrid,
        actor_hidden: vec![24, 16],
        critic_hidden: vec![24, 16],
        environments: 8,
        workers: 4,
        batch_steps: 256,
        total_steps: 7 * 256,
        epochs: 2,
        minibatch_rows: 128,
        critic_minibatch_rows: 64,
        normalise_values: true,
        evaluation_episodes: 2,
        shaping: Shaping {
            informing: 1.0,
            ..Shaping::default()
        },
        ..Settings::preset(Preset::Paper)
    }
}

fn config() -> Config {
    Config {
        uav_count: 4,
        hotspot_count: 3,
        horizon_steps: 20,
        ..Config::default()
    }
}

fn fleets() -> Vec<Config> {
    let larger = Config {
        uav_count: 7,
        ..config()
    };
    vec![config(), larger]
}

fn plan(name: &str, settings: Settings) -> RunSpec {
    let out = std::env::temp_dir().join(format!("jcas-train-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&out);
    RunSpec {
        settings,
        configs: vec![config()],
        drawn_around: None,
        out,
        name: name.into(),
        precision: Precision::Single,
        device: "cpu".into(),
    }
}

/// Asks to stop after some iterations.
struct StopAfter(u64);

impl Observer for StopAfter {
    fn iteration(&mut self, _row: &Row, _total: u64, _left_s: f64) {
        self.0 -= 1;
    }

    fn stop(&mut self) -> bool {
        self.0 == 0
    }
}

/// Reads of the first iterations what would be said of a success in them.
struct Successes(Vec<String>);

impl Observer for Successes {
    fn iteration(&mut self, row: &Row, _total: u64, _left_s: f64) {
        let succeeded = Row {
            success_rate: Some(1.0),
            ..row.clone()
        };
        self.0.push(succeeded.success());
    }

    fn stop(&mut self) -> bool {
        self.0.len() == 2
    }
}

/// Episodes of 40 steps cannot fail within the first batch of 32: all that end there have
/// succeeded.
#[test]
fn the_success_of_the_first_to_end_is_called_so() {
    let mut plan = plan("first", settings(NetworkKind::Set));
    plan.configs[0].horizon_steps = 40;
    let mut successes = Successes(Vec::new());
    plan.train(&Start::Fresh, &mut successes).unwrap();
    assert_eq!(successes.0, ["1.00 of the first to end", "1.00"]);
    std::fs::remove_dir_all(plan.out).unwrap();
}
