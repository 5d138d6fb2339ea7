//! When a UAV on a round flies home, and with what charge it leaves a depot again.

use jcas_core::motion::nearest;
use jcas_core::{Cell, Model};
use jcas_policy::{MemoryError, MemoryReader, charge_to_leave_uj};

use crate::draws::Draws;

/// Parts into which the charges above the return-to-base threshold are divided.
const PARTS: u64 = 4;

/// What a UAV does in a step, by its charge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Duty {
    /// It goes its round.
    Round,
    /// It flies to the nearest depot, or charges there.
    Home,
    /// Its battery is empty.
    Grounded,
}

impl Duty {
    /// Returns the duty of a UAV with a charge, of which it needs the least to go its round.
    pub(super) fn of(charge_uj: u64, least_uj: u64) -> Self {
        if charge_uj == 0 {
            Self::Grounded
        } else if charge_uj < least_uj {
            Self::Home
        } else {
            Self::Round
        }
    }
}

/// The rule by which the members of a team charge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Charging {
    /// The charge in µJ at which a member leaves a depot.
    leave_uj: u64,
    /// Whether a member turns home as long as its charge lasts for the way. The kernel's threshold
    /// may be too low for that.
    reserve: bool,
}

impl Charging {
    /// Returns the rule of the policies, with a reserve for the way home.
    pub(super) fn as_policies(model: &Model<'_>) -> Self {
        Self {
            leave_uj: charge_to_leave_uj(model) as u64,
            reserve: true,
        }
    }

    /// Draws another rule.
    pub(super) fn drawn(model: &Model<'_>, draws: &mut Draws) -> Self {
        let plan = model.energy();
        let low = plan.rtb_uj.min(plan.capacity_uj);
        let part = draws.below(PARTS as usize + 1) as u64;
        Self {
            leave_uj: low + (plan.capacity_uj - low) / PARTS * part,
            reserve: draws.below(2) == 0,
        }
    }

    /// Returns the least charge in µJ with which a UAV in a cell goes its round.
    pub(super) fn least_uj(self, model: &Model<'_>, cell: Cell) -> u64 {
        let plan = model.energy();
        let depot_cells = nearest(cell, model.depots()).1;
        if depot_cells == 0 && self.leave_uj > plan.rtb_uj {
            return self.leave_uj;
        }
        if !self.reserve {
            return plan.rtb_uj;
        }
        // After this step it may be one cell farther away.
        let home_uj = plan.most_asked_at_uj(true, model.config().pilot_density_min);
        let way_uj = (u64::from(depot_cells) + 1).saturating_mul(home_uj);
        plan.rtb_uj.max(way_uj.saturating_add(plan.most_asked_uj()))
    }

    /// Returns the duty of a UAV with a charge in a cell.
    pub(super) fn duty(self, model: &Model<'_>, cell: Cell, charge_uj: u64) -> Duty {
        Duty::of(charge_uj, self.least_uj(model, cell))
    }

    pub(super) fn save(self, write: &mut dyn FnMut(u64)) {
        write(self.leave_uj);
        write(u64::from(self.reserve));
    }

    pub(super) fn load(read: &mut MemoryReader<'_>) -> Result<Self, MemoryError> {
        Ok(Self {
            leave_uj: read.word()?,
            reserve: read.flag()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use jcas_core::{Config, Preset};

    use super::*;
    use crate::battery;

    fn config() -> Config {
        Config {
            grid_width: 30,
            grid_height: 1,
            battery_capacity_kwh: 0.02,
            rtb_threshold_kwh: 0.001,
            depots: jcas_core::config::Depots::one(Cell { x: 0, y: 0 }),
            ..Config::preset(Preset::Mission)
        }
    }

    /// The threshold lasts for one move. A UAV with a reserve is at the depot again before its
    /// battery is empty, at the highest consumption.
    #[test]
    fn a_reserve_lasts_for_the_way_home() {
        let model = Model::new(config()).unwrap();
        let charging = Charging::as_policies(&model);
        let mut charge_uj = model.energy().capacity_uj;
        let mut x = 0;
        while charging.duty(&model, Cell { x, y: 0 }, charge_uj) == Duty::Round {
            let (from, to) = (Cell { x, y: 0 }, Cell { x: x + 1, y: 0 });
            charge_uj = battery::after(&model, charge_uj, from, to, 1.0);
            x += 1;
        }
        assert!(x > 5, "{x}");
        while x > 0 {
            let here = Cell { x, y: 0 };
            assert_eq!(charging.duty(&model, here, charge_uj), Duty::Home);
            let density = model.config().pilot_density_min;
            charge_uj = battery::after(&model, charge_uj, here, Cell { x: x - 1, y: 0 }, density);
            x -= 1;
        }
        assert!(charge_uj > 0);
    }

    #[test]
    fn a_uav_stays_on_a_depot_as_the_policies_do() {
        let model = Model::new(config()).unwrap();
        let charging = Charging::as_policies(&model);
        let depot = model.depots()[0];
        let enough_uj = charge_to_leave_uj(&model) as u64;
        assert_eq!(charging.duty(&model, depot, enough_uj - 1), Duty::Home);
        assert_eq!(charging.duty(&model, depot, enough_uj), Duty::Round);
    }
}
