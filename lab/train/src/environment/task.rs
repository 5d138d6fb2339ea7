//! The training task: a configuration with changed fields and a radar curriculum.

use crate::settings::{Credit, Curriculum, Settings};
use jcas_core::{Config, Model, QuorumWindow, TargetVisibility};
use std::sync::Arc;

/// The task of a run, from the first batch to the last.
#[derive(Clone)]
pub struct TrainingTask {
    model: Arc<Model<'static>>,
    curriculum: Option<Curriculum>,
}

fn built(config: Config) -> Result<Arc<Model<'static>>, String> {
    let model = Model::new(config).map_err(|error| error.to_string())?;
    Ok(Arc::new(model))
}

/// Refuses settings that need the chance of a confirmation, which is known for a quorum within one
/// step.
fn refuse_expectations(config: &Config, settings: &Settings) -> Result<(), String> {
    let window = config.quorum_window.name();
    let detection = settings.shaping.detection;
    if detection > 0.0 {
        return Err(format!(
            "shaping.detection = {detection}: must be 0 where quorum_window is {window}, as the \
             credit is for a quorum within one step"
        ));
    }
    if settings.credit == Credit::Expected {
        return Err(format!(
            "credit = expected: must be team, teacher or uav where quorum_window is {window}, as \
             the expectation is for a quorum within one step"
        ));
    }
    Ok(())
}

impl TrainingTask {
    /// The task of a configuration under these settings. A value that the configuration does not
    /// allow is an error.
    pub fn new(config: &Config, settings: &Settings) -> Result<TrainingTask, String> {
        let mut fields = serde_json::to_value(config).map_err(|error| error.to_string())?;
        for (name, value) in &settings.config_overrides {
            if !Config::FIELDS.iter().any(|field| field.name == name) {
                return Err(format!(
                    "config_overrides.{name}: a configuration has no such field"
                ));
            }
            fields[name] = value.clone();
        }
        let config: Config =
            serde_json::from_value(fields).map_err(|error| format!("config_overrides: {error}"))?;
        if config.quorum_window != QuorumWindow::Step {
            refuse_expectations(&config, settings)?;
        }
        if settings.credit == Credit::Teacher
            && config.target_visibility == TargetVisibility::Hidden
        {
            return Err(
                "credit = teacher: must be team, expected or uav where target_visibility is \
                 hidden, as the teacher knows the hotspots"
                    .into(),
            );
        }
        let task = TrainingTask {
            model: built(config).map_err(|error| format!("config_overrides: {error}"))?,
            curriculum: settings.curriculum,
        };
        if let Some(Curriculum { threshold_db, .. }) = task.curriculum {
            built(task.with_threshold(threshold_db))
                .map_err(|error| format!("curriculum.threshold_db: {error}"))?;
        }
        Ok(task)
    }

    fn with_threshold(&self, threshold_db: f64) -> Config {
        Config {
            detection_threshold_db: Some(threshold_db),
            ..*self.model.config()
        }
    }

    /// The stage that a batch, counted from 0, belongs to.
    pub fn stage(&self, batch: u64) -> u64 {
        match self.curriculum {
            Some(Curriculum {
                batches, stages, ..
            }) if batch < batches => batch * stages / batches,
            Some(Curriculum { stages, .. }) => stages,
            None => 0,
        }
    }

    /// The model of a stage. A model refuses states of another stage's model.
    pub fn model(&self, stage: u64) -> Arc<Model<'static>> {
        match self.curriculum {
            Some(Curriculum {
                threshold_db,
                stages,
                ..
            }) if stage < stages => {
                let progress = stage as f64 / stages as f64;
                let last_db = self.model.detection_threshold_db();
                let eased = self.with_threshold(threshold_db + progress * (last_db - threshold_db));
                built(eased).expect("between two thresholds that are allowed every one is")
            }
            _ => self.model.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Preset;
    use jcas_core::InformPayment;
    use serde_json::Value;
    use std::collections::BTreeMap;

    fn mission<const K: usize>(fields: [(&str, Value); K]) -> BTreeMap<String, Value> {
        let fields = fields.into_iter();
        fields.map(|(name, value)| (name.into(), value)).collect()
    }

    fn settings() -> Settings {
        Settings {
            config_overrides: mission([
                ("quorum", 2.into()),
                ("penalty_revisit", 2.into()),
                ("inform_payment", "every_step".into()),
            ]),
            curriculum: Some(Curriculum {
                threshold_db: -20.0,
                batches: 8,
                stages: 4,
            }),
            ..Settings::preset(Preset::Paper)
        }
    }

    // From -20 dB to the configuration's 12 dB in four stages of two batches: 8 dB a stage.
    #[test]
    fn the_radar_is_eased_in_and_named_fields_are_changed() {
        let config = Config {
            detection_threshold_db: Some(12.0),
            ..Config::default()
        };
        let task = TrainingTask::new(&config, &settings()).unwrap();
        let thresholds = [0, 1, 2, 7, 8, 100]
            .map(|batch| task.model(task.stage(batch)).detection_threshold_db());
        assert_eq!(thresholds, [-20.0, -20.0, -12.0, 4.0, 12.0, 12.0]);
        let expected = Config {
            quorum: 2,
            penalty_revisit: 2.0,
            inform_payment: InformPayment::EveryStep,
            ..config
        };
        assert_eq!(*task.model(4).config(), expected);
    }

    // A serialised configuration leaves out a later field that has its default.
    #[test]
    fn a_field_at_its_default_is_changed_too() {
        let mut settings = settings();
        settings.shaping.detection = 0.0;
        settings.config_overrides = mission([("quorum_window", "episode".into())]);
        let task = TrainingTask::new(&Config::default(), &settings).unwrap();
        let window = task.model(4).config().quorum_window;
        assert_eq!(window, QuorumWindow::Episode);
        settings.shaping.detection = 60.0;
        let told = TrainingTask::new(&Config::default(), &settings).err();
        let told = told.unwrap();
        assert!(told.contains("shaping.detection = 60"), "{told}");
        settings.shaping.detection = 0.0;
        settings.credit = Credit::Expected;
        let told = TrainingTask::new(&Config::default(), &settings).err();
        let told = told.unwrap();
        assert!(told.contains("credit = expected"), "{told}");
        settings.config_overrides = mission([("target_visibility", "hidden".into())]);
        settings.credit = Credit::Teacher;
        let told = TrainingTask::new(&Config::default(), &settings).err();
        let told = told.unwrap();
        assert!(told.contains("credit = teacher"), "{told}");
    }

    #[test]
    fn what_the_configuration_does_not_allow_is_refused_by_name() {
        let refused = |name: &str, value: Value| {
            let mut settings = settings();
            settings.config_overrides = mission([(name, value)]);
            TrainingTask::new(&Config::default(), &settings)
                .err()
                .unwrap()
        };
        assert!(refused("shaping", 1.into()).contains("config_overrides.shaping"));
        assert!(refused("quorum_window", "week".into()).contains("config_overrides"));
        assert!(refused("quorum", 1.5.into()).contains("config_overrides"));
        assert!(refused("quorum", 0.into()).contains("quorum"));
        let mut settings = settings();
        settings.curriculum = Some(Curriculum {
            threshold_db: f64::NAN,
            batches: 3,
            stages: 3,
        });
        let told = TrainingTask::new(&Config::default(), &settings)
            .err()
            .unwrap();
        assert!(told.contains("curriculum.threshold_db"), "{told}");
    }
}
