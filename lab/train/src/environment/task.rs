//! The training task: a configuration with changed fields.

use crate::error::SettingError;
use crate::settings::{Credit, Settings};
use jcas_core::{Config, Model, TargetVisibility};
use std::sync::Arc;

/// The task of a run.
#[derive(Clone)]
pub struct TrainingTask {
    /// The model of every episode.
    pub model: Arc<Model<'static>>,
}

impl TrainingTask {
    /// The task of a configuration under these settings. A value that the configuration does not
    /// allow is an error.
    pub fn new(config: &Config, settings: &Settings) -> Result<TrainingTask, SettingError> {
        let mut fields = serde_json::to_value(config)?;
        for (name, value) in &settings.config_overrides {
            if !Config::FIELDS.iter().any(|field| field.name == name) {
                return Err(SettingError::Name {
                    group: "config_overrides",
                    name: name.clone(),
                    allowed: "the fields of a configuration".into(),
                });
            }
            fields[name] = value.clone();
        }
        let config: Config = serde_json::from_value(fields)?;
        if settings.credit == Credit::Teacher
            && config.target_visibility == TargetVisibility::Hidden
        {
            let allowed = "team or uav where target_visibility is hidden";
            return Err(SettingError::value("credit", "teacher", allowed));
        }
        let model = Model::new(config).map_err(SettingError::Configuration)?;
        Ok(TrainingTask {
            model: Arc::new(model),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Preset;
    use jcas_core::{InformPayment, QuorumWindow};
    use serde_json::Value;
    use std::collections::BTreeMap;

    fn settings<const K: usize>(fields: [(&str, Value); K]) -> Settings {
        let fields = fields.into_iter();
        Settings {
            config_overrides: fields
                .map(|(name, value)| (name.into(), value))
                .collect::<BTreeMap<String, Value>>(),
            ..Settings::preset(Preset::Paper)
        }
    }

    #[test]
    fn named_fields_are_changed_and_no_others() {
        let config = Config {
            detection_threshold_db: Some(12.0),
            ..Config::default()
        };
        let changes = settings([
            ("quorum", 2.into()),
            ("penalty_revisit", 2.into()),
            ("inform_payment", "every_step".into()),
            ("quorum_window", "episode".into()),
        ]);
        let expected = Config {
            quorum: 2,
            penalty_revisit: 2.0,
            inform_payment: InformPayment::EveryStep,
            quorum_window: QuorumWindow::Episode,
            ..config
        };
        let task = TrainingTask::new(&config, &changes).unwrap();
        assert_eq!(*task.model.config(), expected);
    }

    #[test]
    fn a_teacher_that_knows_the_hotspots_is_refused_where_they_are_hidden() {
        let mut hidden = settings([("target_visibility", "hidden".into())]);
        hidden.credit = Credit::Teacher;
        let refusal = TrainingTask::new(&Config::default(), &hidden).err();
        let refusal = refusal.unwrap().to_string();
        assert!(refusal.contains("credit: teacher"), "{refusal}");
    }

    #[test]
    fn what_the_configuration_does_not_allow_is_refused_by_name() {
        let refused = |name: &str, value: Value| {
            let task = TrainingTask::new(&Config::default(), &settings([(name, value)]));
            task.err().unwrap().to_string()
        };
        assert!(refused("shaping", 1.into()).contains("config_overrides.shaping"));
        assert!(refused("quorum_window", "week".into()).contains("config_overrides"));
        assert!(refused("quorum", 1.5.into()).contains("config_overrides"));
        assert!(refused("quorum", 0.into()).contains("quorum"));
    }
}
