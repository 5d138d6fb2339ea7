//! The playground's server on the loopback interface: one page, and the kernel's answers to it.
//!
//! It implements only the HTTP/1.1 that one page needs: a connection carries one request.

use std::io::{self, BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::time::{Duration, Instant};

use jcas_web::{answer, page};

/// Maximum length of a request, which holds a configuration and a person's interventions.
const LONGEST_QUESTION: u64 = 1 << 20;
const LONGEST_HEAD: u64 = 1 << 14;
/// Interval at which the listener looks for connections and for the end.
const TICK: Duration = Duration::from_millis(20);

/// What clients may take of this machine.
#[derive(Clone, Copy)]
struct Limits {
    /// Connections, each of which has a thread. Others wait in the listener's queue.
    connections: usize,
    /// Time for a whole request to arrive, and again for its whole response to leave.
    time: Duration,
}

const LIMITS: Limits = Limits {
    connections: 32,
    time: Duration::from_secs(5),
};

/// Serves until `done` returns true.
///
/// # Errors
/// The listener fails. A connection that fails is dropped.
pub fn until(listener: &TcpListener, done: impl Fn() -> bool) -> io::Result<()> {
    until_within(LIMITS, listener, done)
}

fn until_within(limits: Limits, listener: &TcpListener, done: impl Fn() -> bool) -> io::Result<()> {
    listener.set_nonblocking(true)?;
    let port = listener.local_addr()?.port();
    // Every open connection holds one more reference.
    let open = Arc::new(());
    while !done() {
        if Arc::strong_count(&open) > limits.connections {
            std::thread::sleep(TICK);
            continue;
        }
        match listener.accept() {
            Ok((stream, _)) => {
                let open = Arc::clone(&open);
                // Browsers open connections ahead of their requests, so each connection has its own
                // thread. Without a thread, the connection is dropped.
                drop(std::thread::Builder::new().spawn(move || {
                    let replied = reply(&stream, port, limits.time);
                    drop(open);
                    replied
                }));
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => std::thread::sleep(TICK),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

fn reply(stream: &TcpStream, port: u16, time: Duration) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    let response = respond(&mut BufReader::new(Timed::new(stream, time)), port)?;
    Timed::new(stream, time).write_all(&response)
}

/// A stream whose reads or writes end together at one instant. A time limit for each of them alone
/// would let a client that sends byte by byte stay for ever.
struct Timed<'a> {
    stream: &'a TcpStream,
    end: Instant,
}

impl<'a> Timed<'a> {
    fn new(stream: &'a TcpStream, time: Duration) -> Self {
        let end = Instant::now() + time;
        Self { stream, end }
    }

    fn left(&self) -> io::Result<Option<Duration>> {
        let left = self.end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(ErrorKind::TimedOut.into());
        }
        Ok(Some(left))
    }
}

impl Read for Timed<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.stream.set_read_timeout(self.left()?)?;
        self.stream.read(buffer)
    }
}

impl Write for Timed<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream.set_write_timeout(self.left()?)?;
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

/// The head of a request: what precedes its body.
struct Head {
    method: String,
    path: String,
    host: String,
    length: u64,
}

/// Builds the whole response to a request.
fn respond(input: &mut impl BufRead, port: u16) -> io::Result<Vec<u8>> {
    let Some(head) = read_head(input)? else {
        return Ok(response(
            "400 Bad Request",
            "text/plain",
            b"not a request\n",
        ));
    };
    // A foreign page may use a DNS name that resolves to this machine (DNS rebinding). It must not
    // reach the kernel.
    if ![format!("127.0.0.1:{port}"), format!("localhost:{port}")].contains(&head.host) {
        return Ok(response(
            "403 Forbidden",
            "text/plain",
            b"only for this machine\n",
        ));
    }
    Ok(match (head.method.as_str(), head.path.as_str()) {
        ("GET", "/") => response(
            "200 OK",
            "text/html; charset=utf-8",
            page::served().as_bytes(),
        ),
        ("POST", "/answer") if head.length > LONGEST_QUESTION => response(
            "413 Content Too Large",
            "text/plain",
            b"too long a question\n",
        ),
        ("POST", "/answer") => {
            let mut question = vec![0; head.length as usize];
            input.read_exact(&mut question)?;
            let answered = answer(&String::from_utf8_lossy(&question));
            response("200 OK", "application/json", answered.as_bytes())
        }
        _ => response("404 Not Found", "text/plain", b"there is / and /answer\n"),
    })
}

fn read_head(input: &mut impl BufRead) -> io::Result<Option<Head>> {
    let mut lines = input.by_ref().take(LONGEST_HEAD).lines();
    let first = lines.next().transpose()?.unwrap_or_default();
    let mut words = first.split(' ').map(str::to_owned);
    let (Some(method), Some(path)) = (words.next(), words.next()) else {
        return Ok(None);
    };
    let mut head = Head {
        method,
        path,
        host: String::new(),
        length: 0,
    };
    for line in lines {
        let line = line?;
        if line.is_empty() {
            return Ok(Some(head));
        }
        let Some((name, value)) = line.split_once(':') else {
            return Ok(None);
        };
        match name.to_ascii_lowercase().as_str() {
            "host" => head.host = value.trim().to_owned(),
            "content-length" => match value.trim().parse() {
                Ok(length) => head.length = length,
                Err(_) => return Ok(None),
            },
            _ => {}
        }
    }
    Ok(None)
}

fn response(status: &str, kind: &str, body: &[u8]) -> Vec<u8> {
    let mut response = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n\
         Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
        body.len()
    )
    .into_bytes();
    response.extend_from_slice(body);
    response
}

#[cfg(test)]
mod tests {
    use std::net::{Ipv4Addr, SocketAddr};
    use std::sync::atomic::{AtomicBool, Ordering};

    use super::*;

    /// Serves on the loopback interface while a client runs.
    fn while_served(limits: Limits, client: impl FnOnce(SocketAddr)) {
        struct Ends<'a>(&'a AtomicBool);
        impl Drop for Ends<'_> {
            fn drop(&mut self) {
                self.0.store(true, Ordering::SeqCst);
            }
        }
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let address = listener.local_addr().unwrap();
        let ended = AtomicBool::new(false);
        std::thread::scope(|scope| {
            // A client that panics must end the server too.
            let _ends = Ends(&ended);
            scope.spawn(|| until_within(limits, &listener, || ended.load(Ordering::SeqCst)));
            client(address);
        });
    }

    #[test]
    fn a_request_that_drips_in_is_cut_off() {
        let time = Duration::from_millis(300);
        let limits = Limits { time, ..LIMITS };
        while_served(limits, |address| {
            let mut stream = TcpStream::connect(address).unwrap();
            let started = Instant::now();
            // Each byte comes long before the limit, but the line never ends.
            while stream.write_all(b"G").is_ok() {
                assert!(started.elapsed() < 30 * time, "the request is still read");
                std::thread::sleep(time / 10);
            }
            assert!(started.elapsed() >= time);
        });
    }

    #[test]
    fn a_response_that_nobody_reads_is_given_up() {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let _client = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let (stream, _) = listener.accept().unwrap();
        let mut output = Timed::new(&stream, Duration::from_millis(300));
        // This is more than the buffers of both ends hold.
        assert!(output.write_all(&vec![0; 1 << 26]).is_err());
    }

    #[test]
    fn idle_connections_are_bounded() {
        let time = Duration::from_millis(300);
        let limits = Limits {
            connections: 2,
            time,
        };
        while_served(limits, |address| {
            let started = Instant::now();
            let _idle = [0, 1].map(|_| TcpStream::connect(address).unwrap());
            let mut third = TcpStream::connect(address).unwrap();
            let port = address.port();
            write!(
                third,
                "GET /none HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n"
            )
            .unwrap();
            let mut answer = String::new();
            third.read_to_string(&mut answer).unwrap();
            assert!(answer.starts_with("HTTP/1.1 404"), "{answer}");
            assert!(started.elapsed() >= time, "it did not wait for an idle one");
        });
    }

    fn ask(request: &str) -> String {
        let response = respond(&mut request.as_bytes(), 80).unwrap();
        String::from_utf8(response).unwrap()
    }

    #[test]
    fn the_page_and_the_kernel_answer() {
        let page = ask("GET / HTTP/1.1\r\nHost: localhost:80\r\n\r\n");
        assert!(page.starts_with("HTTP/1.1 200 OK"));
        assert!(page.contains("jcas playground"));
        let question = r#"{"ask":"about"}"#;
        let about = ask(&format!(
            "POST /answer HTTP/1.1\r\nhost: 127.0.0.1:80\r\nContent-Length: {}\r\n\r\n{question}",
            question.len()
        ));
        assert!(about.contains("uav_count"), "{about}");
    }

    #[test]
    fn what_does_not_belong_here_is_refused() {
        let status = |request: &str| ask(request)[9..12].to_owned();
        assert_eq!(
            status("GET / HTTP/1.1\r\nHost: evil.example:80\r\n\r\n"),
            "403"
        );
        assert_eq!(status("GET / HTTP/1.1\r\n\r\n"), "403");
        assert_eq!(
            status("GET /etc HTTP/1.1\r\nHost: localhost:80\r\n\r\n"),
            "404"
        );
        assert_eq!(status("hello\r\n\r\n"), "400");
        assert_eq!(status(""), "400");
        let long = format!(
            "POST /answer HTTP/1.1\r\nHost: localhost:80\r\nContent-Length: {}\r\n\r\n",
            LONGEST_QUESTION + 1
        );
        assert_eq!(status(&long), "413");
        let unread = "POST /answer HTTP/1.1\r\nHost: localhost:80\r\nContent-Length: 9\r\n\r\n{}";
        assert!(respond(&mut unread.as_bytes(), 80).is_err());
    }
}
