//! Repeats the golden traces in memory of the caller, and tests that changed files are refused.

use std::fs;
use std::path::Path;

use jcas_core::{Cell, Model, Scratch};
use jcas_trace::{
    Arguments, Problem, Replay, Sink, VerifyError, Workspace, WorkspaceSizes, Writer, configuration,
};

/// Repeats a trace, first to compare it and then to write it again.
fn replay<'t>(trace: &'t str, rewritten: &mut Vec<u8>) -> Result<(), VerifyError<'t>> {
    let model = Model::new(configuration(trace)?).expect("a configuration that was read is legal");
    let mut words = vec![0; model.state_words()];
    let mut scratch = vec![0; Scratch::words_for(&model)];
    let sizes = WorkspaceSizes::of(&model);
    // The content of a workspace does not matter.
    let workspace = Workspace {
        observations: &mut vec![f32::NAN; sizes.observations],
        actions: &mut vec![f32::NAN; sizes.actions],
        arguments: Arguments {
            cells: &mut vec![Cell { x: 9, y: 9 }; sizes.cells],
            charges_uj: &mut vec![1; sizes.uavs],
            throughput: &mut vec![f64::NAN; sizes.uavs],
            matrix: &mut vec![1; sizes.matrix],
        },
    };
    let mut replay = Replay::new(&model, &mut words, &mut scratch, workspace);
    replay.verify(trace)?;
    let mut writer = Writer::new(Text(rewritten));
    replay.fly(trace, &mut writer)?;
    writer.finish().expect("a text takes everything");
    Ok(())
}

struct Text<'t>(&'t mut Vec<u8>);

impl Sink for Text<'_> {
    type Error = ();

    fn take(&mut self, bytes: &[u8]) -> Result<(), ()> {
        self.0.extend_from_slice(bytes);
        Ok(())
    }
}

fn completion() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/golden/completion.jsonl");
    fs::read_to_string(path).expect("a trace")
}

fn golden() -> impl Iterator<Item = String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/golden");
    fs::read_dir(folder)
        .expect("the folder of golden traces")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|kind| kind == "jsonl"))
        .map(|path| fs::read_to_string(path).expect("a trace"))
}

#[test]
fn golden_traces_are_written_anew_byte_for_byte() {
    let mut flown = 0;
    for trace in golden() {
        let mut rewritten = Vec::new();
        replay(&trace, &mut rewritten).expect("a golden trace");
        assert!(rewritten == trace.as_bytes());
        flown += 1;
    }
    assert!(flown >= 15, "{flown} traces");
}

#[test]
fn a_changed_file_is_refused() {
    let trace = completion();
    let refused = |trace: &str| {
        let error = replay(trace, &mut Vec::new()).expect_err("a changed file");
        (error.line, error.to_string())
    };
    let incomplete = "not a whole trace: must end with a checksum that fits".to_owned();
    let cut = &trace[..trace.len() - 1];
    assert_eq!(refused(cut), (0, incomplete.clone()));
    let changed = trace.replacen("\"t\":3,", "\"t\":4,", 1);
    assert_eq!(refused(&changed), (0, incomplete.clone()));

    // The same number in upper case is another text.
    let digits = trace.len() - "0123456789abcdef\"}\n".len();
    let (body, checksum) = trace.split_at(digits);
    let capitals = checksum.to_uppercase();
    assert_ne!(checksum, capitals, "a checksum with letters");
    assert_eq!(refused(&format!("{body}{capitals}")), (0, incomplete));
}

#[test]
fn a_file_that_is_not_flown_so_names_line_and_field() {
    let trace = completion();
    let (body, _) = trace.split_at(trace.rfind(",\"checksum\":").expect("a checksum"));
    let changed = body.replacen("\"co2_ng\":", "\"co2_ng\":1", 2);
    let mut hash = jcas_core::hash::Fnv1a::new();
    hash.write(changed.as_bytes());
    let changed = format!("{changed},\"checksum\":\"0x{:016x}\"}}\n", hash.finish());
    let error = replay(&changed, &mut Vec::new()).expect_err("another number");
    assert_eq!(error.line, 2);
    assert_eq!(error.problem, Problem::Differs("co2_ng"));
}
