//! The server of the playground, met as a browser, a program and an attacker meet it.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// An episode within all limits of the page that takes hours to plan.
const ENDLESS: &str = r#"{"ask":"fly","config":{"preset":"isac","uav_count":2,
    "hotspot_count":1,"grid_width":64,"grid_height":64,"horizon_steps":1000,"quorum":3},
    "policy":"replan","pilot":"max","seed":1}"#;

struct Server {
    process: Child,
    address: String,
}

impl Server {
    fn start(time_limit_s: &str) -> Self {
        let mut process = Command::new(assert_cmd::cargo::cargo_bin!("jcas"))
            .args(["play", "--no-open", "--time-limit", time_limit_s])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        let mut output = BufReader::new(process.stdout.take().unwrap());
        output.read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("http://").unwrap();
        let address = address.strip_suffix('/').unwrap().to_owned();
        Self { process, address }
    }

    fn connect(&self) -> TcpStream {
        TcpStream::connect(&self.address).unwrap()
    }

    /// Posts a question and returns the connection.
    fn post(&self, question: &str) -> TcpStream {
        let mut stream = self.connect();
        let Self { address, .. } = self;
        write!(
            stream,
            "POST /answer HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\n\
             Sec-Fetch-Site: same-origin\r\nContent-Type: application/json\r\n\
             Content-Length: {}\r\n\r\n{question}",
            question.len()
        )
        .unwrap();
        stream
    }

    fn page(&self) -> String {
        let mut stream = self.connect();
        write!(stream, "GET / HTTP/1.1\r\nHost: {}\r\n\r\n", self.address).unwrap();
        whole(&mut stream)
    }

    /// The number of processes that compute an answer.
    fn answering(&self) -> usize {
        let id = self.process.id();
        let threads = std::fs::read_dir(format!("/proc/{id}/task")).unwrap();
        let children = threads.map(|thread| {
            let list = thread.unwrap().path().join("children");
            // A thread may end while its list is read.
            let list = std::fs::read_to_string(list).unwrap_or_default();
            list.split_whitespace().count()
        });
        children.sum()
    }

    fn waits_until(&self, answering: usize) {
        let end = Instant::now() + Duration::from_secs(60);
        while self.answering() != answering {
            assert!(Instant::now() < end, "not {answering} processes");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.process.kill().unwrap();
        self.process.wait().unwrap();
    }
}

fn whole(stream: &mut TcpStream) -> String {
    let mut text = String::new();
    stream.read_to_string(&mut text).unwrap();
    text
}

#[test]
fn a_mission_is_answered_and_one_without_end_is_given_up() {
    let server = Server::start("2");
    let about = whole(&mut server.post(r#"{"ask":"about"}"#));
    assert!(
        about.starts_with("HTTP/1.1 200") && about.contains("uav_count"),
        "{about}"
    );
    let started = Instant::now();
    let answer = whole(&mut server.post(ENDLESS));
    assert!(answer.contains("more than 2 s to compute"), "{answer}");
    assert!(started.elapsed() >= Duration::from_secs(2));
}

#[cfg(target_os = "linux")]
#[test]
fn work_ends_with_its_connection_and_is_bounded_in_number() {
    let server = Server::start("600");
    let asked: Vec<_> = (0..4).map(|_| server.post(ENDLESS)).collect();
    server.waits_until(4);
    let fifth = whole(&mut server.post(ENDLESS));
    assert!(fifth.starts_with("HTTP/1.1 503"), "{fifth}");
    drop(asked);
    server.waits_until(0);
}

#[cfg(target_os = "linux")]
#[test]
fn work_ends_with_the_server() {
    let server = Server::start("600");
    let _asked = server.post(ENDLESS);
    server.waits_until(1);
    let id = server.process.id();
    let children = std::fs::read_dir(format!("/proc/{id}/task")).unwrap();
    let lists = children.map(|thread| thread.unwrap().path().join("children"));
    let list: String = lists
        .map(|list| std::fs::read_to_string(list).unwrap())
        .collect();
    let child = format!("/proc/{}/stat", list.trim());
    drop(server);
    let end = Instant::now() + Duration::from_secs(60);
    // An orphan that has ended may stay as a zombie.
    while std::fs::read_to_string(&child).is_ok_and(|stat| !stat.contains(") Z ")) {
        assert!(Instant::now() < end, "the answer is still computed");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn idle_connections_do_not_delay_a_page() {
    let server = Server::start("20");
    let _idle: Vec<_> = (0..161).map(|_| server.connect()).collect();
    let started = Instant::now();
    assert!(server.page().contains("jcas playground"));
    assert!(
        started.elapsed() < Duration::from_secs(4),
        "{:?}",
        started.elapsed()
    );
}
