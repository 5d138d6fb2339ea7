//! The playground's server on the loopback interface: one page, and the kernel's answers to it.
//!
//! It implements only the HTTP/1.1 that one page needs: a connection carries one request.

use std::io::{self, BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::Duration;

use jcas_web::{answer, page};

/// Maximum length of a request, which holds a configuration and a person's interventions.
const LONGEST_QUESTION: u64 = 1 << 20;
const LONGEST_HEAD: u64 = 1 << 14;
/// Time that a connection may stay silent, and interval at which the listener checks for the end.
const PATIENCE: Duration = Duration::from_secs(5);
const TICK: Duration = Duration::from_millis(20);

/// Serves until `done` returns true.
///
/// # Errors
/// The listener fails. A connection that fails is dropped.
pub fn until(listener: &TcpListener, done: impl Fn() -> bool) -> io::Result<()> {
    listener.set_nonblocking(true)?;
    let port = listener.local_addr()?.port();
    while !done() {
        match listener.accept() {
            // Browsers open connections ahead of their requests, so each connection has its own
            // thread.
            Ok((stream, _)) => drop(std::thread::spawn(move || reply(stream, port))),
            Err(error) if error.kind() == ErrorKind::WouldBlock => std::thread::sleep(TICK),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

fn reply(stream: TcpStream, port: u16) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let response = respond(&mut BufReader::new(&stream), port)?;
    (&stream).write_all(&response)
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
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n\
         X-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
        body.len()
    )
    .into_bytes();
    response.extend_from_slice(body);
    response
}

#[cfg(test)]
mod tests {
    use super::*;

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
