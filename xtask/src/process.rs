//! Runs a command with a time limit and keeps its output.

use crate::error::Error;
use std::io::Read;
use std::os::unix::process::CommandExt;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// The result of a command.
pub struct Finished {
    /// Standard output and standard error, one after the other.
    pub output: String,
    /// Whether it ended by itself with status 0.
    pub success: bool,
    /// Whether it had to be stopped.
    pub timed_out: bool,
    /// Wall-clock time.
    pub elapsed: Duration,
}

/// Runs the command in a process group of its own, which is killed at the limit.
/// A solver is a grandchild, and would outlive its parent.
pub fn run(command: &mut Command, limit: Duration) -> Result<Finished, Error> {
    let start = Instant::now();
    let mut child = command
        .process_group(0)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(Error::start(&command.get_program().to_string_lossy()))?;
    let stdout = child.stdout.take().map(collect);
    let stderr = child.stderr.take().map(collect);

    let mut timed_out = false;
    let status = loop {
        if let Some(status) = child.try_wait().map_err(Error::Wait)? {
            break status;
        }
        if !timed_out && start.elapsed() > limit {
            timed_out = true;
            let group = format!("-{}", child.id());
            Command::new("kill")
                .args(["-KILL", "--", &group])
                .status()
                .map_err(|source| Error::Stop {
                    command: format!("{command:?}"),
                    source,
                })?;
        }
        thread::sleep(Duration::from_millis(50));
    };

    let mut output = String::new();
    for reader in [stdout, stderr].into_iter().flatten() {
        output.push_str(&reader.join().unwrap_or_default());
    }
    Ok(Finished {
        output,
        success: status.success() && !timed_out,
        timed_out,
        elapsed: start.elapsed(),
    })
}

/// Reads a pipe to its end on a thread, so that a full pipe never blocks the child.
fn collect(mut pipe: impl Read + Send + 'static) -> thread::JoinHandle<String> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        // A broken pipe ends the text; the exit status gives the reason.
        let _ = pipe.read_to_end(&mut bytes);
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn output_and_status_are_kept() {
        let mut command = Command::new("sh");
        command.args(["-c", "echo out; echo err >&2; exit 3"]);
        let finished = run(&mut command, Duration::from_secs(10)).unwrap();
        assert_eq!(finished.output, "out\nerr\n");
        assert!(!finished.success && !finished.timed_out);
    }

    /// Catches a limit that stops the parent and waits for a grandchild.
    #[test]
    fn the_limit_stops_the_whole_group() {
        let mut command = Command::new("sh");
        command.args(["-c", "sleep 60 & wait"]);
        let finished = run(&mut command, Duration::from_millis(200)).unwrap();
        assert!(finished.timed_out && !finished.success);
        assert!(finished.elapsed < Duration::from_secs(20));
    }
}
