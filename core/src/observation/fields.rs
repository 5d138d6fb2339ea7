//! The name of every entry of an observation.

use crate::constants::observation::{self as added, REPORT};
use crate::model::Model;

/// A field of an observation: `count` entries with the same meaning, at `offset`,
/// `offset` + `stride` and so on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ObservationField {
    /// Name of the field.
    pub name: &'static str,
    /// Position of the first entry in a row.
    pub offset: usize,
    /// Number of entries: one, one for each hotspot, slot, cell or direction, or none.
    pub count: usize,
    /// Distance from one entry to the next.
    pub stride: usize,
}

/// Names of the fields, in the order of [`fields`].
pub const FIELD_NAMES: [&str; FIELDS] = [
    "x",
    "y",
    "soc",
    "pilot_density",
    "throughput",
    "hotspot_dx",
    "hotspot_dy",
    "hotspot_confirmed",
    "hotspot_known",
    "neighbour_present",
    "neighbour_dx",
    "neighbour_dy",
    "neighbours",
    "carbon_intensity",
    "depot_distance",
    "confirmed",
    "informed",
    "time",
    "map_window",
    "unsearched",
    "tag",
    "report_window",
    "report_dx",
    "report_dy",
    "report_level",
];

/// Number of fields of an observation. Fields that the configuration omits have no entries.
pub const FIELDS: usize = 25;

/// All fields of a UAV's observation; together they name each entry once.
#[must_use]
pub fn fields(model: &Model<'_>) -> [ObservationField; FIELDS] {
    let [window, directions, tag, report_windows, reported] = added::lens(model.config());
    // Fields of a block, how often the block comes.
    let blocks = [
        (5, 1),
        (4, model.hotspot_count()),
        (3, model.neighbour_slots()),
        (6, 1),
        (1, window),
        (1, directions),
        (1, tag),
        (1, report_windows),
        (REPORT, reported / REPORT),
    ];
    let mut all = [ObservationField {
        name: "",
        offset: 0,
        count: 0,
        stride: 1,
    }; FIELDS];
    let (mut next, mut begin) = (0, 0);
    for (stride, count) in blocks {
        for offset in begin..begin + stride {
            all[next] = ObservationField {
                name: FIELD_NAMES[next],
                offset,
                count,
                stride,
            };
            next += 1;
        }
        begin += stride * count;
    }
    all
}

#[cfg(all(test, feature = "alloc"))]
mod tests {
    use super::*;
    use crate::{Config, Preset};
    use std::vec;

    #[test]
    fn every_entry_has_one_name() {
        let small = Config {
            neighbour_slots: 3,
            hotspot_count: 2,
            ..Config::preset(Preset::Search)
        };
        let reporting = Config {
            false_alarm_per_cell: 0.01,
            report_levels: 2,
            report_slots: 5,
            ..small
        };
        let without_maps = Config {
            false_alarm_per_cell: 0.01,
            report_levels: 3,
            map_window_radius: 2,
            ..Config::default()
        };
        let paper = Config::default();
        let search = Config::preset(Preset::Search);
        for config in [paper, search, small, reporting, without_maps] {
            let model = Model::new(config).unwrap();
            let mut named = vec![0; model.observation_len()];
            for field in fields(&model) {
                assert!(!field.name.is_empty());
                for index in 0..field.count {
                    named[field.offset + index * field.stride] += 1;
                }
            }
            assert!(named.iter().all(|&times| times == 1), "{named:?}");
        }
    }
}
