//! Configurations as TOML and JSON: a text that is accepted is written and read back unchanged.

#![no_main]

use jcas_core::Config;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Ok(config) = Config::from_toml(text) {
        let mut written = String::new();
        config.write_toml(&mut written).unwrap();
        assert_eq!(Config::from_toml(&written).unwrap(), config);
    }
    if let Ok(config) = Config::from_json(text) {
        let mut written = String::new();
        config.write_json(&mut written).unwrap();
        let again = Config::from_json(&written).unwrap();
        assert_eq!(again, config);
        assert_eq!(again.hash(), config.hash());
    }
});
