//! `jcas play`: serves the playground to a browser.

use std::net::{Ipv4Addr, TcpListener};
use std::path::Path;
use std::time::Duration;

use clap::Args;

use crate::error::{CliError, Outcome};
use crate::serve::Limits;
use crate::{answering, files, interrupt, numbers, serve};

const EXAMPLES: &str = "\
Examples:
  jcas play                        opens the playground in the browser
  jcas play --port 8080 --no-open  says where it is, and waits";

/// Run episodes in the browser and change them while they run
///
/// Serves one page on the loopback interface until Ctrl-C; only programs on this machine and the
/// page itself can reach it. The address of the page holds the whole episode: every reader of an
/// address sees the same episode, bit for bit.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Play {
    /// Port to serve on; 0 takes any free port
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    port: u16,
    /// Do not open a browser
    #[arg(long)]
    no_open: bool,
    /// Time in seconds after which an episode that is still computed is given up
    #[arg(long, value_name = "S", default_value_t = 20, value_parser = numbers::above_zero)]
    time_limit: u64,
    /// Answer one request of the page from standard input, and end
    #[arg(long, hide = true)]
    answer: bool,
}

impl Play {
    /// Serves until Ctrl-C.
    pub fn run(self) -> Result<Outcome, CliError> {
        if self.answer {
            let answer = answering::answer();
            let answer = answer.map_err(CliError::io(Path::new("standard input")))?;
            files::print_raw(answer.as_bytes())?;
            return Ok(Outcome::Done);
        }
        let failed =
            |error: std::io::Error| CliError::input(format!("port = {}: {error}", self.port));
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, self.port)).map_err(failed)?;
        let address = format!("http://{}/", listener.local_addr().map_err(failed)?);
        files::print(&format!("{address}\n"))?;
        if !self.no_open
            && let Err(error) = open::that_detached(&address)
        {
            eprintln!("no browser opens ({error}): open {address} yourself");
        }
        let limits = Limits {
            answer: Duration::from_secs(self.time_limit),
            ..Limits::default()
        };
        serve::until(limits, &listener, interrupt::requested).map_err(failed)?;
        Ok(Outcome::Done)
    }
}
