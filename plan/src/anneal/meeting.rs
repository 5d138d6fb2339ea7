//! The radio components of the fleet, with all UAVs but one fixed.

use super::Annealer;

impl Annealer<'_, '_> {
    /// Computes the radio components of the other UAVs in a step.
    pub(super) fn find_parts(&mut self, step: usize) {
        let (odds, uavs) = (&self.problem.odds, self.paths.uav_count());
        let part_of = &mut self.part_of[step * uavs..][..uavs];
        let place = |uav: usize| {
            (
                odds.cell(self.paths.cell(uav, step)),
                self.paths.level(uav, step),
            )
        };
        part_of.fill(u8::MAX);
        let mut parts = 0;
        let mut open = [0u8; crate::gather::UAVS_MAX];
        for seed in 0..uavs {
            if seed == self.uav || part_of[seed] != u8::MAX {
                continue;
            }
            part_of[seed] = parts;
            open[0] = seed as u8;
            let mut count = 1;
            while count > 0 {
                count -= 1;
                let here = place(usize::from(open[count]));
                for uav in 0..uavs {
                    if uav != self.uav && part_of[uav] == u8::MAX && odds.linked(here, place(uav)) {
                        part_of[uav] = parts;
                        open[count] = uav as u8;
                        count += 1;
                    }
                }
            }
            parts += 1;
        }
        self.parts[step] = if parts == 0 {
            0
        } else {
            u128::MAX >> (128 - parts)
        };
    }

    /// Computes whether the fleet is one radio component in a step.
    pub(super) fn meet(&mut self, step: usize) {
        let cell = self.paths.cell(self.uav, step);
        let level = self.paths.level(self.uav, step);
        self.meets[step] = self.joins_all(step, cell, level);
    }

    /// Returns whether the UAV whose turn it is, in a cell and at a level, links all radio
    /// components of the others in a step.
    pub(super) fn joins_all(&self, step: usize, cell: u32, level: u8) -> bool {
        let odds = &self.problem.odds;
        let uavs = self.paths.uav_count();
        let here = (odds.cell(cell), level);
        let mut met = 0u128;
        for uav in (0..uavs).filter(|&uav| uav != self.uav) {
            let there = odds.cell(self.paths.cell(uav, step));
            if odds.linked(here, (there, self.paths.level(uav, step))) {
                met |= 1 << self.part_of[step * uavs + uav];
            }
        }
        met == self.parts[step]
    }
}
