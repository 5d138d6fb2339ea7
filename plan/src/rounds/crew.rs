//! A crew: the members of a team that are in one cell and do the same, in a sampled episode.

use alloc::vec::Vec;

use jcas_core::energy::settle;
use jcas_core::motion::{destination, nearest, toward};
use jcas_core::{Cell, Model};

use super::Team;
use super::charging::Duty;
use crate::odds::Odds;

#[derive(Clone, Debug)]
pub(super) struct Crew<'t> {
    pub(super) team: &'t Team,
    pub(super) cell: Cell,
    pub(super) known: u64,
    pub(super) duty: Duty,
    /// The hotspot that the crew flies to or stays at.
    pub(super) target: Option<usize>,
    /// The sum of its hazards of detecting the target, if others have confirmed that.
    pub(super) waited: f64,
    /// The charge of each member in µJ, in descending order.
    pub(super) charges_uj: Vec<u64>,
}

impl<'t> Crew<'t> {
    /// Returns the crews of a team where it was formed.
    pub(super) fn of(team: &'t Team) -> Vec<Self> {
        let mut crews: Vec<Self> = Vec::new();
        for member in &team.members {
            let crew = crews.iter_mut().find(|crew| crew.cell == member.cell);
            match crew {
                Some(crew) => crew.charges_uj.push(member.charge_uj),
                None => crews.push(Self {
                    team,
                    cell: member.cell,
                    known: team.known,
                    duty: Duty::Round,
                    target: None,
                    waited: 0.0,
                    charges_uj: Vec::from([member.charge_uj]),
                }),
            }
        }
        for crew in &mut crews {
            crew.charges_uj.sort_unstable_by(|a, b| b.cmp(a));
        }
        crews
    }

    pub(super) fn count(&self) -> usize {
        self.charges_uj.len()
    }

    /// Sets the duty of the members with the highest charge. Returns those with another duty.
    pub(super) fn part(&mut self, model: &Model<'_>) -> Option<Self> {
        let least_uj = self.team.charging.least_uj(model, self.cell);
        let duty = |charge_uj| Duty::of(charge_uj, least_uj);
        self.duty = self.charges_uj.first().map_or(self.duty, |&uj| duty(uj));
        if self.duty != Duty::Round {
            self.target = None;
        }
        let same = self.charges_uj.partition_point(|&uj| duty(uj) == self.duty);
        let others = self.charges_uj.split_off(same);
        (!others.is_empty()).then(|| Self {
            charges_uj: others,
            ..self.clone()
        })
    }

    /// Turns to the next hotspot of the round, then to the nearest one not known.
    pub(super) fn turn(&mut self, hotspots: &[Cell]) {
        let known = self.known;
        let open = |hotspot: usize| known >> hotspot & 1 == 0;
        if self.target.is_some_and(open) {
            return;
        }
        let mut route = self.team.route.iter().copied();
        let nearest = || {
            let left = (0..hotspots.len()).filter(|&hotspot| open(hotspot));
            left.min_by_key(|&hotspot| self.cell.manhattan(hotspots[hotspot]))
        };
        self.target = route.find(|&hotspot| open(hotspot)).or_else(nearest);
        self.waited = 0.0;
    }

    pub(super) fn level(&self, odds: &Odds, hotspots: &[Cell]) -> u8 {
        match (self.duty, self.target) {
            (Duty::Grounded, _) => odds.grounded(),
            (_, Some(hotspot)) if self.cell == hotspots[hotspot] => odds.highest(),
            _ => 0,
        }
    }

    /// Flies one cell toward another one, or home. Returns whether that moved the crew.
    pub(super) fn fly(&mut self, model: &Model<'_>, target: Cell) -> bool {
        let config = model.config();
        let from = self.cell;
        let target = match self.duty {
            Duty::Round => target,
            Duty::Home => model.depots()[nearest(from, model.depots()).0],
            Duty::Grounded => from,
        };
        let motion = toward(from, target);
        self.cell = destination(from, motion, config.grid_width, config.grid_height);
        self.cell != from
    }

    /// Settles the batteries after a step that takes this energy.
    pub(super) fn settle(&mut self, model: &Model<'_>, asked_uj: u64) {
        let plan = model.energy();
        let charges = model.depots().contains(&self.cell);
        let offered_uj = if charges { plan.charge_uj } else { 0 };
        for charge_uj in &mut self.charges_uj {
            *charge_uj = settle(*charge_uj, asked_uj, offered_uj, plan.capacity_uj).battery_uj;
        }
    }
}
