//! Reads what `cargo kani` prints (regular output format).
//!
//! Kani's own verdict is not enough: it also says SUCCESSFUL when a cover property is unsatisfiable
//! or when every assertion is unreachable. This module therefore derives the verdict from the
//! single checks.

/// One `Check n: name` entry.
#[derive(Debug, PartialEq)]
pub struct Check {
    /// `function.class.number`.
    pub name: String,
    pub status: String,
    pub description: String,
    pub location: String,
}

impl Check {
    fn is_cover(&self) -> bool {
        self.class() == "cover"
    }

    /// The second part of the name, counted from its end.
    fn class(&self) -> &str {
        self.name.rsplit('.').nth(1).unwrap_or("")
    }

    /// Whether this is an assertion in a harness or in a property that it checks.
    fn is_claim(&self) -> bool {
        self.class() == "assertion"
            && self.description.starts_with("assertion failed")
            && self.location.contains("proofs")
    }
}

/// Kani's output for one harness.
#[derive(Debug, Default)]
pub struct HarnessReport {
    /// Full path of the harness within its crate.
    pub harness: String,
    pub checks: Vec<Check>,
    pub verdicts: Vec<String>,
    pub seconds: Option<f64>,
    /// Kani stopped CBMC at the harness's time limit.
    pub timed_out: bool,
    /// `(satisfied, all)` cover properties, by Kani's own count.
    pub covers: Option<(u32, u32)>,
    /// Name and version of the SAT solver.
    pub solver: Option<String>,
}

/// The verdict of a run.
#[derive(Debug, PartialEq)]
pub struct Proven {
    pub checks: usize,
    /// Checks in library code that the harness's inputs never reach.
    pub unreachable: usize,
    pub covers: usize,
    pub seconds: f64,
}

/// The version in "CBMC version 6.6.0 (cbmc-6.6.0) 64-bit x86_64 linux".
pub fn cbmc_version(output: &str) -> Option<String> {
    let mut versions = output
        .lines()
        .filter_map(|line| line.strip_prefix("CBMC version "));
    Some(versions.next()?.split(' ').next()?.to_owned())
}

impl HarnessReport {
    /// One report for each harness that Kani began to check.
    pub fn parse_all(output: &str) -> Vec<Self> {
        let mut reports: Vec<HarnessReport> = Vec::new();
        for line in output.lines().map(str::trim) {
            if let Some(rest) = line.strip_prefix("Checking harness ") {
                reports.push(HarnessReport {
                    harness: rest.trim_end_matches("...").to_owned(),
                    ..HarnessReport::default()
                });
            } else if let Some(report) = reports.last_mut() {
                report.read_line(line);
            }
        }
        reports
    }

    fn read_line(&mut self, line: &str) {
        if let Some(rest) = line.strip_prefix("Check ") {
            if let Some((number, name)) = rest.split_once(": ")
                && number.bytes().all(|byte| byte.is_ascii_digit())
            {
                self.checks.push(Check {
                    name: name.to_owned(),
                    status: String::new(),
                    description: String::new(),
                    location: String::new(),
                });
            }
        } else if let Some(verdict) = line.strip_prefix("VERIFICATION:- ") {
            self.verdicts.push(without_colour(verdict));
        } else if let Some(time) = line.strip_prefix("Verification Time: ") {
            self.seconds = time.trim_end_matches('s').parse().ok();
        } else if let Some(solver) = line.strip_prefix("Solving with ") {
            self.solver = Some(solver.to_owned());
        } else if line.starts_with("CBMC timed out") {
            self.timed_out = true;
        } else if line.starts_with("** ") && line.contains("cover properties satisfied") {
            self.covers = satisfied(line);
        } else if let Some(check) = self.checks.last_mut() {
            if let Some(status) = line.strip_prefix("- Status: ") {
                check.status = without_colour(status);
            } else if let Some(description) = line.strip_prefix("- Description: ") {
                check.description = description.trim_matches('"').to_owned();
            } else if let Some(location) = line.strip_prefix("- Location: ") {
                check.location = location.to_owned();
            }
        }
    }

    /// Accepts the run as a proof with `covers` witnesses, or says why not.
    pub fn accept(&self, covers: u32) -> Result<Proven, String> {
        self.is_one_success()?;
        let (witnesses, checks): (Vec<_>, Vec<_>) = self.checks.iter().partition(|c| c.is_cover());
        if checks.is_empty() {
            return Err("no check was made".to_owned());
        }
        for check in &checks {
            match check.status.as_str() {
                "SUCCESS" => {}
                "UNREACHABLE" if !check.is_claim() => {}
                status => return Err(format!("{status}: {} ({})", check.description, check.name)),
            }
        }
        if !checks.iter().any(|check| check.is_claim()) {
            return Err("no assertion of the harness was checked".to_owned());
        }
        for witness in &witnesses {
            if witness.status != "SATISFIED" {
                return Err(format!("cover {}: {}", witness.status, witness.description));
            }
        }
        if self.covers != Some((covers, covers)) {
            return Err(format!(
                "Kani counts {:?} cover properties, the ledger says {covers}",
                self.covers
            ));
        }
        if witnesses.len() != covers as usize {
            return Err(format!(
                "{} cover properties, the ledger says {covers}",
                witnesses.len()
            ));
        }
        let unreachable = checks
            .iter()
            .filter(|check| check.status == "UNREACHABLE")
            .count();
        Ok(Proven {
            checks: checks.len(),
            unreachable,
            covers: witnesses.len(),
            seconds: self.seconds.unwrap_or(0.0),
        })
    }

    /// Whether Kani finished with exactly one verdict, and that verdict is success.
    fn is_one_success(&self) -> Result<(), String> {
        if self.timed_out {
            return Err("CBMC timed out".to_owned());
        }
        if self.verdicts != ["SUCCESSFUL"] {
            let failed = self.checks.iter().find(|check| check.status == "FAILURE");
            return Err(match failed {
                Some(check) => format!("FAILURE: {} ({})", check.description, check.name),
                None => format!("verdict {:?}", self.verdicts),
            });
        }
        Ok(())
    }
}

/// "** 3 of 3 cover properties satisfied"
fn satisfied(line: &str) -> Option<(u32, u32)> {
    let numbers: Vec<u32> = line
        .split(' ')
        .filter_map(|word| word.parse().ok())
        .collect();
    match numbers[..] {
        [satisfied, all] => Some((satisfied, all)),
        _ => None,
    }
}

/// Drops the escape sequences with which Kani colours a verdict.
fn without_colour(text: &str) -> String {
    let mut plain = String::new();
    let mut rest = text.chars();
    while let Some(c) = rest.next() {
        if c == '\u{1b}' {
            for escaped in rest.by_ref() {
                if escaped == 'm' {
                    break;
                }
            }
        } else {
            plain.push(c);
        }
    }
    plain.trim().to_owned()
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// Kani's output for a proven harness.
    pub const PROVEN: &str = r#"
Kani Rust Verifier 0.67.0 (cargo plugin)
   Compiling jcas-core v0.1.0
    Finished `dev` profile [unoptimized + debuginfo] target(s) in 1.20s
Checking harness proofs::energy::the_ledger_balances...
CBMC version 6.6.0 (cbmc-6.6.0) 64-bit x86_64 linux
Solving with MiniSAT 2.2.1 with simplifier
85905 variables, 92661 clauses
SAT checker: instance is UNSATISFIABLE

RESULTS:
Check 1: energy::spend.arithmetic_overflow.1
	 - Status: SUCCESS
	 - Description: "attempt to subtract with overflow"
	 - Location: core/src/energy.rs:40:5 in function energy::spend

Check 2: proofs::energy::the_ledger_balances.assertion.1
	 - Status: SUCCESS
	 - Description: "assertion failed: after <= capacity"
	 - Location: core/src/proofs/energy.rs:20:5 in function proofs::energy::the_ledger_balances

Check 3: energy::spend.assertion.1
	 - Status: UNREACHABLE
	 - Description: "attempt to divide by zero"
	 - Location: core/src/energy.rs:44:9 in function energy::spend

Check 4: proofs::energy::the_ledger_balances.cover.1
	 - Status: SATISFIED
	 - Description: "the battery runs empty"
	 - Location: core/src/proofs/energy.rs:22:5 in function proofs::energy::the_ledger_balances


SUMMARY:
 ** 0 of 3 failed (1 unreachable)

 ** 1 of 1 cover properties satisfied


VERIFICATION:- SUCCESSFUL
Verification Time: 0.8153s

Manual Harness Summary:
Complete - 1 successfully verified harnesses, 0 failures, 1 total.
"#;

    /// Kani's output for a harness that reached its time limit.
    pub const TIMED_OUT: &str = "
Checking harness proofs::energy::the_ledger_balances...
CBMC failed
VERIFICATION:- FAILED
CBMC timed out. You may want to rerun your proof with a larger timeout or use stubbing to \
reduce the size of the code the verifier reasons about.

Manual Harness Summary:
Verification failed for - proofs::energy::the_ledger_balances
Complete - 0 successfully verified harnesses, 1 failures, 1 total.
";

    /// Catches a phrase of Kani's output that the reader no longer recognises.
    #[test]
    fn the_phrases_of_kani_are_read() {
        let proven = &HarnessReport::parse_all(PROVEN)[0];
        assert_eq!(proven.harness, "proofs::energy::the_ledger_balances");
        assert_eq!(proven.verdicts, ["SUCCESSFUL"]);
        assert_eq!(
            proven.solver.as_deref(),
            Some("MiniSAT 2.2.1 with simplifier")
        );
        assert_eq!(cbmc_version(PROVEN).as_deref(), Some("6.6.0"));
        assert_eq!(proven.covers, Some((1, 1)));
        assert!(!proven.timed_out);
        let stopped = &HarnessReport::parse_all(TIMED_OUT)[0];
        assert_eq!(stopped.verdicts, ["FAILED"]);
        assert!(stopped.timed_out && stopped.covers.is_none());
    }

    #[test]
    fn covers_that_kani_does_not_count_are_rejected() {
        let output = PROVEN.replace("** 1 of 1 cover", "** 0 of 1 cover");
        assert!(verdict(&output).unwrap_err().contains("Kani counts"));
    }

    fn verdict(output: &str) -> Result<Proven, String> {
        HarnessReport::parse_all(output)[0].accept(1)
    }

    #[test]
    fn a_proof_with_its_witness_is_accepted() {
        let proven = verdict(PROVEN).unwrap();
        assert_eq!(
            proven,
            Proven {
                checks: 3,
                unreachable: 1,
                covers: 1,
                seconds: 0.8153
            }
        );
    }

    #[test]
    fn colours_do_not_matter() {
        let coloured = PROVEN
            .replace("Status: SUCCESS", "Status: \u{1b}[32mSUCCESS\u{1b}[0m")
            .replace(":- SUCCESSFUL", ":- \u{1b}[32mSUCCESSFUL\u{1b}[0m");
        assert!(verdict(&coloured).is_ok());
    }

    #[test]
    fn a_harness_that_is_missing_has_no_report() {
        let none = "error: no harnesses matched the name: `proofs::x`\n";
        assert!(HarnessReport::parse_all(none).is_empty());
    }

    #[test]
    fn an_unsatisfied_cover_is_rejected_though_kani_says_successful() {
        for status in ["UNSATISFIABLE", "UNREACHABLE", "UNDETERMINED"] {
            let output = PROVEN.replace("SATISFIED", status);
            assert!(verdict(&output).unwrap_err().contains(status), "{status}");
        }
    }

    #[test]
    fn a_lost_cover_is_rejected() {
        assert!(
            HarnessReport::parse_all(PROVEN)[0]
                .accept(2)
                .unwrap_err()
                .contains("ledger says 2")
        );
    }

    #[test]
    fn an_unreachable_claim_is_rejected_though_kani_says_successful() {
        let claim = "Status: SUCCESS\n\t - Description: \"assertion failed: after";
        assert!(PROVEN.contains(claim));
        let output = PROVEN.replace(claim, &claim.replace("SUCCESS", "UNREACHABLE"));
        assert!(verdict(&output).unwrap_err().contains("UNREACHABLE"));
    }

    #[test]
    fn a_run_without_checks_or_without_claims_is_rejected() {
        let empty = PROVEN.replace("Check ", "Chuck ");
        assert_eq!(verdict(&empty).unwrap_err(), "no check was made");
        let foreign = PROVEN
            .replace("core/src/proofs", "core/src")
            .replace("proofs::", "x::");
        let foreign = foreign.replace("Checking harness x::", "Checking harness proofs::");
        assert!(
            verdict(&foreign)
                .unwrap_err()
                .contains("no assertion of the harness")
        );
    }

    #[test]
    fn failures_undetermined_checks_and_time_outs_are_rejected() {
        let failed = PROVEN
            .replace("Status: SUCCESS", "Status: FAILURE")
            .replace(":- SUCCESSFUL", ":- FAILED")
            .replace(
                "1 successfully verified harnesses, 0",
                "0 successfully verified harnesses, 1",
            );
        assert!(
            verdict(&failed)
                .unwrap_err()
                .starts_with("FAILURE: attempt to subtract")
        );

        let undetermined = PROVEN.replace("Status: SUCCESS", "Status: UNDETERMINED");
        assert!(verdict(&undetermined).unwrap_err().contains("UNDETERMINED"));

        assert_eq!(verdict(TIMED_OUT).unwrap_err(), "CBMC timed out");

        let cut = PROVEN.split("VERIFICATION").next().unwrap();
        assert!(verdict(cut).unwrap_err().contains("verdict []"));
    }
}
