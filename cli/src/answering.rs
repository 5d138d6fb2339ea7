//! An answer of the playground that is computed in a process of its own.
//!
//! A process can be ended at any moment, even while its policy computes. So the server bounds the
//! time of every answer, and an answer that nobody waits for takes no more work. The process ends
//! when its standard input does, so it never outlives the server.

use std::io::{self, BufRead, Read, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

/// The command line of the process, which runs [`answer`].
const ARGUMENTS: [&str; 2] = ["play", "--answer"];
/// The time that [`Answering::poll`] waits.
const TICK: Duration = Duration::from_millis(20);

/// A process that computes an answer. It ends with this value.
pub struct Answering {
    process: Child,
    /// The process ends when this is closed.
    stdin: Option<ChildStdin>,
    answer: Receiver<io::Result<Vec<u8>>>,
}

impl Answering {
    /// Begins to compute the answer to a request.
    ///
    /// # Errors
    /// The process cannot be started.
    pub fn begin(question: &[u8]) -> io::Result<Self> {
        let mut process = Command::new(std::env::current_exe()?)
            .args(ARGUMENTS)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()?;
        let pipes = (process.stdin.take(), process.stdout.take());
        let (sender, answer) = channel();
        // From here on the process ends with this value, also where the next line fails.
        let mut answering = Self {
            process,
            stdin: None,
            answer,
        };
        let (Some(mut stdin), Some(mut stdout)) = pipes else {
            return Err(io::ErrorKind::BrokenPipe.into());
        };
        writeln!(stdin, "{}", question.len())?;
        stdin.write_all(question)?;
        answering.stdin = Some(stdin);
        std::thread::Builder::new().spawn(move || {
            let mut answer = Vec::new();
            let read = stdout.read_to_end(&mut answer).map(|_| answer);
            // Nobody waits any more for an answer that is given up.
            let _sent = sender.send(read);
        })?;
        Ok(answering)
    }

    /// Waits a short time for the answer. It is `None` while the process computes.
    ///
    /// # Errors
    /// The process has failed.
    pub fn poll(&mut self) -> io::Result<Option<Vec<u8>>> {
        match self.answer.recv_timeout(TICK) {
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(io::ErrorKind::BrokenPipe.into()),
            Ok(answer) => {
                let answer = answer?;
                if answer.is_empty() {
                    return Err(io::ErrorKind::UnexpectedEof.into());
                }
                Ok(Some(answer))
            }
        }
    }
}

/// Reads a request from standard input, its length before it, and returns the answer.
///
/// # Errors
/// The input is no such request.
pub fn answer() -> io::Result<String> {
    let mut input = io::stdin().lock();
    let mut length = String::new();
    input.read_line(&mut length)?;
    let length = length.trim().parse().map_err(io::Error::other)?;
    let mut question = Vec::new();
    input.by_ref().take(length).read_to_end(&mut question)?;
    drop(input);
    std::thread::Builder::new().spawn(|| {
        let _rest = io::copy(&mut io::stdin().lock(), &mut io::sink());
        std::process::exit(0);
    })?;
    Ok(jcas_web::answer(&String::from_utf8_lossy(&question)))
}

impl Drop for Answering {
    fn drop(&mut self) {
        // An error means that the process has ended by itself.
        let _killed = self.process.kill();
        let _ended = self.process.wait();
    }
}
