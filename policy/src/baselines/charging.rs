//! `charging` and `clean`: tours of UAVs that return to charge before the autopilot sends them.

use jcas_core::energy::kwh;
use jcas_core::motion::toward;
use jcas_core::{Cell, Model, Motion, StateRef};

use super::memory::{OutOfMemory, filled};
use super::pilot::PilotMode;
use super::steering::{Steering, can_fly};
use super::teams::Teams;

/// The share of its capacity from which a battery counts as full. It is below 1 because each step
/// spends energy.
const FULL: f64 = 0.98;
/// Steps that a UAV can wait for clean energy on its reserve.
const PATIENCE_STEPS: f64 = 40.0;
/// The share of its range up to which a carbon intensity counts as clean.
const CLEAN: f64 = 0.2;

/// Steers like [`Teams`] with the UAVs that need not charge. A UAV flies home when its charge is
/// below what the way to the nearest depot takes, or below the threshold of the autopilot. It stays
/// there until its battery is full.
///
/// With `clean`, it flies home earlier, with a reserve, and waits beside the depot. It enters the
/// depot when the carbon intensity billed in the next step is low, or when the reserve is spent.
#[derive(Clone, Debug)]
pub struct Charging {
    teams: Teams,
    clean: bool,
    going_home: Vec<bool>,
    /// The depot nearest to each UAV.
    depots: Vec<Cell>,
}

impl Charging {
    /// Charges at any carbon intensity.
    #[must_use]
    pub fn greedy(pilot: PilotMode) -> Self {
        Self {
            teams: Teams::new(pilot),
            clean: false,
            going_home: Vec::new(),
            depots: Vec::new(),
        }
    }

    /// Waits for clean energy as long as its reserve allows.
    #[must_use]
    pub fn clean(pilot: PilotMode) -> Self {
        Self {
            clean: true,
            ..Self::greedy(pilot)
        }
    }

    /// Returns the charge, in kWh, below which a UAV `way` cells from a depot flies home.
    fn needed_kwh(&self, model: &Model<'_>, way: u32) -> f64 {
        let config = model.config();
        let step_kwh = kwh(model.energy().most_asked_uj());
        // The UAV may move one cell farther before the next decision, and must then come back.
        let home_kwh = f64::from(way + 2) * step_kwh;
        let waiting_kwh = config.hover_energy_kwh
            + config.comm_energy_kwh
            + config.sense_energy_kwh * config.pilot_density_min / config.pilot_density_max;
        let reserve_kwh = if self.clean {
            PATIENCE_STEPS * waiting_kwh
        } else {
            0.0
        };
        home_kwh.max(config.rtb_threshold_kwh) + reserve_kwh
    }

    fn homeward(&self, model: &Model<'_>, state: &StateRef<'_>, uav: usize, depot: Cell) -> Motion {
        let here = state.cell(uav);
        let carbon = model.carbon();
        let dirty = carbon.normalised(state.carbon_intensity_mg_per_kwh()) > CLEAN;
        // With this charge the UAV can hover one more step before the autopilot takes over.
        let least_kwh =
            model.config().rtb_threshold_kwh + 2.0 * kwh(model.energy().most_asked_uj());
        let can_wait = kwh(state.battery_uj(uav)) >= least_kwh;
        if self.clean && here.manhattan(depot) == 1 && dirty && can_wait {
            Motion::Stay
        } else {
            toward(here, depot)
        }
    }
}

impl Steering for Charging {
    fn reset(&mut self, model: &Model<'_>, seed: u64) -> Result<(), OutOfMemory> {
        self.teams.reset(model, seed)?;
        self.going_home = filled(false, model.uav_count())?;
        self.depots = filled(Cell::default(), model.uav_count())?;
        Ok(())
    }

    fn steer(
        &mut self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        motions: &mut [Motion],
    ) -> Result<(), OutOfMemory> {
        let capacity_kwh = model.config().battery_capacity_kwh;
        for (uav, depot) in self.depots.iter_mut().enumerate() {
            let here = state.cell(uav);
            let nearest = model.depots().iter().min_by_key(|d| d.manhattan(here));
            *depot = nearest.copied().unwrap_or(here);
        }
        for uav in 0..model.uav_count() {
            let way = state.cell(uav).manhattan(self.depots[uav]);
            let charge_kwh = kwh(state.battery_uj(uav));
            if charge_kwh < self.needed_kwh(model, way) {
                self.going_home[uav] = true;
            } else if charge_kwh >= FULL * capacity_kwh {
                self.going_home[uav] = false;
            }
        }
        let flies = |uav: usize| can_fly(state, uav) && !self.going_home[uav];
        self.teams.steer_with(model, state, flies, motions)?;
        for (uav, motion) in motions.iter_mut().enumerate() {
            if self.going_home[uav] {
                *motion = self.homeward(model, state, uav, self.depots[uav]);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Policy;
    use crate::baselines::BaselineKind;
    use jcas_core::config::Depots;
    use jcas_core::{Config, Metrics, Sim};

    /// Returns a configuration with batteries for about sixty moves, which one step at a depot
    /// fills.
    fn config() -> Config {
        Config {
            uav_count: 10,
            hotspot_count: 30,
            horizon_steps: 1000,
            battery_capacity_kwh: 0.06,
            rtb_threshold_kwh: 0.0,
            depots: Depots::from_slice(&[Cell { x: 2, y: 2 }, Cell { x: 9, y: 9 }]).unwrap(),
            charge_power_kw: 21.6,
            ..Config::default()
        }
    }

    fn flown(kind: BaselineKind, seed: u64) -> Metrics {
        let model = Model::new(config()).unwrap();
        let mut sim = Sim::new(&model);
        let mut policy = kind.build_privileged(PilotMode::Adaptive);
        let mut actions = vec![0.0; model.action_len()];
        sim.reset(seed);
        policy.reset(&model, seed);
        for _ in 0..model.config().horizon_steps {
            policy.act(&model, &sim.state(), &mut actions);
            let outcome = sim.step(&actions).unwrap();
            if outcome.terminated {
                break;
            }
        }
        sim.state().metrics()
    }

    #[test]
    fn nobody_runs_out_without_an_autopilot() {
        for kind in [BaselineKind::Charging, BaselineKind::Clean] {
            for seed in 0..5 {
                let metrics = flown(kind, seed);
                assert!(metrics.terminated, "{kind} {metrics:?}");
                assert_eq!(metrics.shortfall_kwh, 0.0, "{kind} {metrics:?}");
            }
        }
        assert!(flown(BaselineKind::Teams, 0).truncated);
    }

    #[test]
    fn who_waits_charges_cleaner_energy() {
        let intensity = |kind| {
            let all: Vec<Metrics> = (0..20).map(|seed| flown(kind, seed)).collect();
            let sum = |of: fn(&Metrics) -> f64| all.iter().map(of).sum::<f64>();
            sum(|metrics| metrics.co2_kg) / sum(|metrics| metrics.grid_kwh)
        };
        let (greedy, clean) = (
            intensity(BaselineKind::Charging),
            intensity(BaselineKind::Clean),
        );
        // UAVs that fly over a depot also charge, at any intensity.
        assert!((greedy - 0.325).abs() < 0.01, "{greedy}");
        assert!(clean < 0.92 * greedy, "{clean} {greedy}");
    }
}
