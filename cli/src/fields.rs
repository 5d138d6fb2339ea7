//! The fields of the configuration by subject, for tables that people read.

use jcas_core::Config;
use jcas_core::config::FieldInfo;

/// Subjects in the order of their tables, each with words that occur in the names of its fields. A
/// field belongs to the first subject with such a word.
const SUBJECTS: [(&str, &[&str]); 6] = [
    (
        "Reward",
        &["reward", "penalty", "shaping", "inform_payment"],
    ),
    (
        "Energy and carbon",
        &[
            "kwh",
            "charge",
            "renewable",
            "carbon",
            "step_duration",
            "soc",
        ],
    ),
    (
        "Knowledge and observation",
        &[
            "visibility",
            "slots",
            "map",
            "tag",
            "report",
            "quorum",
            "learned",
        ],
    ),
    ("Links", &["path_loss", "comm_noise", "spectral", "link"]),
    (
        "World",
        &[
            "grid",
            "cell_size",
            "uav_count",
            "hotspot_count",
            "horizon",
            "depots",
            "start_cells",
        ],
    ),
    ("Radar", &[""]),
];
/// The order in which a reader meets the subjects.
const ORDER: [&str; 6] = [
    "World",
    "Radar",
    "Links",
    "Energy and carbon",
    "Knowledge and observation",
    "Reward",
];

/// Returns each subject with the positions of its fields in [`Config::FIELDS`].
pub fn by_subject() -> impl Iterator<Item = (&'static str, Vec<usize>)> {
    ORDER.into_iter().map(|subject| {
        let fields = Config::FIELDS.iter().enumerate();
        let own = fields.filter(|(_, info)| subject_of(info) == subject);
        (subject, own.map(|(index, _)| index).collect())
    })
}

fn subject_of(info: &FieldInfo) -> &'static str {
    let holds = |words: &[&str]| words.iter().any(|word| info.name.contains(word));
    let subject = SUBJECTS.iter().find(|(_, words)| holds(words));
    subject.map_or("Radar", |(subject, _)| subject)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_has_one_subject() {
        let mut all: Vec<usize> = by_subject().flat_map(|(_, fields)| fields).collect();
        all.sort_unstable();
        assert_eq!(all, (0..Config::FIELDS.len()).collect::<Vec<_>>());
        let subject = |name| {
            subject_of(
                Config::FIELDS
                    .iter()
                    .find(|info| info.name == name)
                    .unwrap(),
            )
        };
        for (name, expected) in [
            ("quorum", "Knowledge and observation"),
            ("cell_size_m", "World"),
            ("sensing_range_m", "Radar"),
            ("comm_energy_kwh", "Energy and carbon"),
            ("link_throughput_min", "Links"),
            ("reward_throughput", "Reward"),
        ] {
            assert_eq!(subject(name), expected, "{name}");
        }
    }
}
