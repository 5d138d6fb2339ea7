//! Requests of the playground's page: each gets one JSON object as its answer.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|request: &str| {
    let answer = jcas_web::answer(request);
    assert!(answer.starts_with('{') && answer.ends_with('}'), "{answer}");
});
