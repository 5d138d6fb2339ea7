//! The playground's server on the loopback interface: one page, and the kernel's answers to it.
//!
//! It implements only the HTTP/1.1 that one page needs: a connection carries one request. A library
//! would leave to us what is difficult here: access control, and work that ends with its
//! connection.

use std::io::{self, BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

use jcas_web::page;

use crate::answering::Answering;

/// Maximum length of a request, which holds a configuration and a person's interventions.
const LONGEST_QUESTION: u64 = 1 << 20;
const LONGEST_HEAD: u64 = 1 << 14;
/// Interval at which the listener looks for connections and for the end.
const TICK: Duration = Duration::from_millis(10);

/// What clients may take of this machine.
#[derive(Clone, Copy)]
pub struct Limits {
    /// Connections, each of which has a thread. A new one closes the oldest that has not asked yet.
    pub connections: usize,
    /// Answers that are computed at the same time.
    pub answers: usize,
    /// Time for a whole request to arrive, and again for its whole response to leave.
    pub transfer: Duration,
    /// Time to compute an answer.
    pub answer: Duration,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            connections: 64,
            answers: 4,
            transfer: Duration::from_secs(5),
            answer: Duration::from_secs(20),
        }
    }
}

/// A client's connection, which its thread and the listener share.
struct Connection {
    stream: TcpStream,
    /// Whether the whole request has arrived.
    has_asked: AtomicBool,
}

/// What all connections share.
struct Server {
    limits: Limits,
    port: u16,
    open: Mutex<Vec<Arc<Connection>>>,
    answers: AtomicUsize,
}

/// Serves until `done` returns true.
///
/// # Errors
/// The listener fails. A connection that fails is dropped.
pub fn until(limits: Limits, listener: &TcpListener, done: impl Fn() -> bool) -> io::Result<()> {
    listener.set_nonblocking(true)?;
    let server = Arc::new(Server {
        limits,
        port: listener.local_addr()?.port(),
        open: Mutex::default(),
        answers: AtomicUsize::new(0),
    });
    while !done() {
        if !server.has_room() {
            std::thread::sleep(TICK);
            continue;
        }
        match listener.accept() {
            Ok((stream, _)) => server.begin(stream),
            Err(error) if error.kind() == ErrorKind::WouldBlock => std::thread::sleep(TICK),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

impl Server {
    fn connections(&self) -> std::sync::MutexGuard<'_, Vec<Arc<Connection>>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether another connection can be accepted. If needed, closes the oldest that is idle.
    fn has_room(&self) -> bool {
        let mut open = self.connections();
        if open.len() < self.limits.connections {
            return true;
        }
        let idle = |one: &Arc<Connection>| !one.has_asked.load(Ordering::Relaxed);
        let Some(oldest) = open.iter().position(idle) else {
            return false;
        };
        // An error means that the client has closed it.
        let _closed = open.remove(oldest).stream.shutdown(Shutdown::Both);
        true
    }

    /// Browsers open connections ahead of their requests, so each connection has its own thread.
    /// Without a thread, the connection is dropped.
    fn begin(self: &Arc<Self>, stream: TcpStream) {
        let server = Arc::clone(self);
        let connection = Arc::new(Connection {
            stream,
            has_asked: AtomicBool::new(false),
        });
        self.connections().push(Arc::clone(&connection));
        let own = Arc::clone(&connection);
        let thread = std::thread::Builder::new().spawn(move || {
            // A connection that fails is over.
            let _replied = server.reply(&own);
            server.end(&own);
        });
        if thread.is_err() {
            self.end(&connection);
        }
    }

    fn end(&self, connection: &Arc<Connection>) {
        self.connections()
            .retain(|one| !Arc::ptr_eq(one, connection));
    }

    fn reply(&self, connection: &Connection) -> io::Result<()> {
        let stream = &connection.stream;
        stream.set_nonblocking(false)?;
        let mut input = BufReader::new(Timed::new(stream, self.limits.transfer));
        let request = read_request(&mut input, self.port)?;
        connection.has_asked.store(true, Ordering::Relaxed);
        let response = match request {
            Request::Refused(status, reason) => response(status, "text/plain", reason.as_bytes()),
            Request::Page => {
                let page = page::served();
                response("200 OK", "text/html; charset=utf-8", page.as_bytes())
            }
            Request::Question(question) => self.answer(&question, stream)?,
        };
        Timed::new(stream, self.limits.transfer).write_all(&response)
    }

    fn answer(&self, question: &[u8], stream: &TcpStream) -> io::Result<Vec<u8>> {
        let _busy = match Busy::begin(&self.answers, self.limits.answers) {
            Some(busy) => busy,
            None => {
                let reason = b"too many episodes are computed\n";
                return Ok(response("503 Service Unavailable", "text/plain", reason));
            }
        };
        stream.set_nonblocking(true)?;
        let mut answering = Answering::begin(question)?;
        let end = Instant::now() + self.limits.answer;
        let answered = loop {
            if let Some(answer) = answering.poll()? {
                break answer;
            }
            if is_closed(stream) {
                return Err(ErrorKind::ConnectionAborted.into());
            }
            if Instant::now() >= end {
                break overdue(self.limits.answer).into_bytes();
            }
        };
        stream.set_nonblocking(false)?;
        Ok(response("200 OK", "application/json", &answered))
    }
}

/// One of the answers that are computed at present.
struct Busy<'a>(&'a AtomicUsize);

impl<'a> Busy<'a> {
    fn begin(answers: &'a AtomicUsize, most: usize) -> Option<Self> {
        let busy = Self(answers);
        (answers.fetch_add(1, Ordering::SeqCst) < most).then_some(busy)
    }
}

impl Drop for Busy<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Whether the client of a stream that does not block is gone.
fn is_closed(stream: &TcpStream) -> bool {
    match stream.peek(&mut [0]) {
        Ok(bytes) => bytes == 0,
        Err(error) => error.kind() != ErrorKind::WouldBlock,
    }
}

fn overdue(limit: Duration) -> String {
    let reason = format!(
        "this episode takes more than {} s to compute: choose a smaller fleet, grid or horizon, \
         another policy, or a longer --time-limit of jcas play",
        limit.as_secs_f64()
    );
    serde_json::json!({ "error": reason }).to_string()
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
        let mut stream = self.stream;
        stream.read(buffer)
    }
}

impl Write for Timed<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream.set_write_timeout(self.left()?)?;
        let mut stream = self.stream;
        stream.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        let mut stream = self.stream;
        stream.flush()
    }
}

/// What a client asks for.
enum Request {
    /// The page.
    Page,
    /// An answer of the kernel to this text.
    Question(Vec<u8>),
    /// Nothing that is served: the status and the reason.
    Refused(&'static str, &'static str),
}

/// The head of a request: what precedes its body.
#[derive(Default)]
struct Head {
    method: String,
    path: String,
    host: String,
    origin: Option<String>,
    /// The site of the request, as the browser states it (`Sec-Fetch-Site`).
    site: Option<String>,
    content_type: String,
    length: u64,
}

/// Reads a whole request.
fn read_request(input: &mut impl BufRead, port: u16) -> io::Result<Request> {
    let Some(head) = read_head(input)? else {
        return Ok(Request::Refused("400 Bad Request", "not a request\n"));
    };
    if head.is_foreign(port) {
        let reason = "only for programs and the page of this machine\n";
        return Ok(Request::Refused("403 Forbidden", reason));
    }
    Ok(match (head.method.as_str(), head.path.as_str()) {
        ("GET", "/") => Request::Page,
        ("POST", "/answer") if !head.is_json() => Request::Refused(
            "415 Unsupported Media Type",
            "Content-Type: must be application/json\n",
        ),
        ("POST", "/answer") if head.length > LONGEST_QUESTION => {
            Request::Refused("413 Content Too Large", "too long a question\n")
        }
        ("POST", "/answer") => {
            let mut question = vec![0; head.length as usize];
            input.read_exact(&mut question)?;
            Request::Question(question)
        }
        _ => Request::Refused("404 Not Found", "there is / and /answer\n"),
    })
}

impl Head {
    /// Whether a page of another origin may be the author. A foreign page may post without asking,
    /// and it may use a DNS name that resolves to this machine (DNS rebinding).
    fn is_foreign(&self, port: u16) -> bool {
        let hosts = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
        let own_host = hosts.contains(&self.host);
        let own_origin = self.origin.as_ref().is_none_or(|origin| {
            origin
                .strip_prefix("http://")
                .is_some_and(|host| host == self.host)
        });
        // Opening the address, or following a link to it, gives the page.
        let own_site = match self.site.as_deref() {
            None | Some("same-origin" | "none") => true,
            Some(_) => self.method == "GET",
        };
        !(own_host && own_origin && own_site)
    }

    fn is_json(&self) -> bool {
        let essence = self.content_type.split(';').next().unwrap_or_default();
        essence.trim().eq_ignore_ascii_case("application/json")
    }
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
        ..Head::default()
    };
    for line in lines {
        let line = line?;
        if line.is_empty() {
            return Ok(Some(head));
        }
        let Some((name, value)) = line.split_once(':') else {
            return Ok(None);
        };
        let value = value.trim();
        match name.to_ascii_lowercase().as_str() {
            "host" => head.host = value.to_owned(),
            "origin" => head.origin = Some(value.to_owned()),
            "sec-fetch-site" => head.site = Some(value.to_owned()),
            "content-type" => head.content_type = value.to_owned(),
            "content-length" => match value.parse() {
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
         Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n\
         Cross-Origin-Resource-Policy: same-origin\r\nConnection: close\r\n\r\n",
        body.len()
    )
    .into_bytes();
    response.extend_from_slice(body);
    response
}

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;

    use super::*;

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
    fn a_request_that_drips_in_is_cut_off() {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let mut client = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let (stream, _) = listener.accept().unwrap();
        let time = Duration::from_millis(300);
        let started = Instant::now();
        let dripping = std::thread::spawn(move || {
            // Each byte comes long before the limit, but the line never ends.
            while started.elapsed() < 30 * time && client.write_all(b"G").is_ok() {
                std::thread::sleep(time / 10);
            }
        });
        let mut input = BufReader::new(Timed::new(&stream, time));
        assert!(read_request(&mut input, 80).is_err());
        assert!(started.elapsed() >= time);
        drop(input);
        drop(stream);
        dripping.join().unwrap();
    }

    /// The status of the refusal, or what is asked for.
    fn asked(request: &str) -> String {
        match read_request(&mut request.as_bytes(), 80).unwrap() {
            Request::Page => "page".to_owned(),
            Request::Question(question) => String::from_utf8(question).unwrap(),
            Request::Refused(status, _) => status[..3].to_owned(),
        }
    }

    fn posted(head: &str) -> String {
        asked(&format!(
            "POST /answer HTTP/1.1\r\nhost: 127.0.0.1:80\r\n{head}Content-Length: 2\r\n\r\n{{}}"
        ))
    }

    const JSON: &str = "Content-Type: application/json; charset=utf-8\r\n";

    #[test]
    fn the_page_and_programs_of_this_machine_may_ask() {
        assert_eq!(
            asked("GET / HTTP/1.1\r\nHost: localhost:80\r\n\r\n"),
            "page"
        );
        assert_eq!(posted(JSON), "{}");
        let own = "Origin: http://127.0.0.1:80\r\nSec-Fetch-Site: same-origin\r\n";
        assert_eq!(posted(&format!("{own}{JSON}")), "{}");
        let link = "GET / HTTP/1.1\r\nHost: localhost:80\r\nSec-Fetch-Site: cross-site\r\n\r\n";
        assert_eq!(asked(link), "page");
    }

    #[test]
    fn a_page_of_another_origin_may_not_ask() {
        for head in [
            "Origin: https://evil.example\r\n",
            "Origin: http://localhost:80\r\n",
            "Origin: http://127.0.0.1:81\r\n",
            "Origin: null\r\n",
            "Sec-Fetch-Site: cross-site\r\n",
            "Sec-Fetch-Site: same-site\r\n",
        ] {
            assert_eq!(posted(&format!("{head}{JSON}")), "403", "{head}");
        }
        // A form can post these types without a question to the server.
        assert_eq!(posted(""), "415");
        assert_eq!(posted("Content-Type: text/plain\r\n"), "415");
    }

    #[test]
    fn what_does_not_belong_here_is_refused() {
        assert_eq!(
            asked("GET / HTTP/1.1\r\nHost: evil.example:80\r\n\r\n"),
            "403"
        );
        assert_eq!(asked("GET / HTTP/1.1\r\n\r\n"), "403");
        assert_eq!(
            asked("GET /etc HTTP/1.1\r\nHost: localhost:80\r\n\r\n"),
            "404"
        );
        assert_eq!(asked("hello\r\n\r\n"), "400");
        assert_eq!(asked(""), "400");
        let long = format!(
            "POST /answer HTTP/1.1\r\nHost: localhost:80\r\n{JSON}Content-Length: {}\r\n\r\n",
            LONGEST_QUESTION + 1
        );
        assert_eq!(asked(&long), "413");
        let unread = format!(
            "POST /answer HTTP/1.1\r\nHost: localhost:80\r\n{JSON}Content-Length: 9\r\n\r\n{{}}"
        );
        assert!(read_request(&mut unread.as_bytes(), 80).is_err());
    }
}
