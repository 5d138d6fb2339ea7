//! Every shipped policy can be read and run as its card says.

use std::fs;
use std::path::Path;

use jcas_core::{Config, Model, Sim};
use jcas_episode::campaign::fly_episode;
use jcas_episode::card;

#[test]
fn every_shipped_policy_flies_what_its_card_says() {
    let policies = Path::new(env!("CARGO_MANIFEST_DIR")).join("../policies");
    let mut seen = 0;
    for entry in fs::read_dir(policies).unwrap() {
        let folder = entry.unwrap().path();
        if !folder.join(card::CARD).is_file() {
            continue;
        }
        let stored = card::load(&folder).unwrap();
        let own = &stored.card;
        assert_eq!(own.config_hash, format!("0x{:016x}", own.config.hash()));
        assert!(!own.evaluations.is_empty());
        assert!(own.evaluations.len().is_multiple_of(own.trained_on.len()));
        assert!(
            own.settings
                .as_ref()
                .is_some_and(|settings| settings.is_object())
        );
        let models: Vec<Model> = own
            .trained_on
            .iter()
            .map(|&(uav_count, hotspot_count)| {
                let config = Config {
                    uav_count,
                    hotspot_count,
                    ..own.config
                };
                let model = Model::new(config).unwrap();
                stored.check(&model).unwrap();
                model
            })
            .collect();
        // The largest fleet succeeds in nearly every episode.
        let model = models.iter().max_by_key(|model| model.uav_count());
        let model = model.unwrap();
        let mut policy = stored.policy(None);
        let flown = fly_episode(model, &mut Sim::new(model), &mut policy, 7).unwrap();
        assert!(flown.terminated, "{folder:?}");
        seen += 1;
    }
    assert_eq!(seen, 2);
}
