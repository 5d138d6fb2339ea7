//! `jcas-portable`: prints a line for each golden trace; exit status 1 if one differs.

use std::env::consts::ARCH;
use std::process::ExitCode;

fn main() -> ExitCode {
    let report = jcas_portable::verify_all();
    print!("{}", report.text);
    println!("{ARCH}: {} of the traces differ", report.failures);
    if report.failures == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
