use std::{
    io::{Read, Write},
    net::{Shutdown, TcpStream as Stream},
};

use super::{super::health::State as Wall, *};

/// Longer than any answer takes here, so that a test that would hang fails.
const PATIENCE: Duration = Duration::from_secs(30);

fn served() -> (Status, Arc<Health>) {
    let health = Arc::new(Health::new());
    let status = Status::serve(([127, 0, 0, 1], 0).into(), health.clone()).expect("a port");
    (status, health)
}

fn connected(status: &Status) -> Stream {
    let stream = Stream::connect(status.address()).expect("a connection");
    stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
    stream
}

/// The whole answer to `bytes`, as far as it comes.
fn asked(status: &Status, bytes: &[u8]) -> String {
    let mut stream = connected(status);
    // A server that has answered already may have closed.
    let _ = stream.write_all(bytes);
    let mut answer = Vec::new();
    let mut part = [0; 4096];
    while let Ok(n @ 1..) = stream.read(&mut part) {
        answer.extend_from_slice(&part[..n]);
    }
    String::from_utf8_lossy(&answer).into_owned()
}

fn got(status: &Status, path: &str) -> String {
    asked(
        status,
        format!("GET {path} HTTP/1.1\r\nHost: wall\r\n\r\n").as_bytes(),
    )
}

fn body(answer: &str) -> &str {
    answer.split_once("\r\n\r\n").map_or("", |(_, body)| body)
}

#[test]
fn the_page_and_the_json_say_how_the_wall_is() {
    let (status, health) = served();
    health.update(|about| {
        about.state = Wall::Faulty;
        about.exhibit = "Leonardo & <company>".into();
        about.faults = vec!["exhibit.toml:3:1: found <script>\"x\"</script>".into()];
    });
    health.frame(12.5);
    health.session();
    let json: serde_json::Value =
        serde_json::from_str(body(&got(&status, "/status.json"))).expect("JSON");
    for (key, value) in [
        ("state", "faulty".into()),
        ("exhibit", "Leonardo & <company>".into()),
        ("frames_completed", serde_json::Value::from(1)),
        ("worst_ms", 12.5.into()),
        ("sessions_today", 1.into()),
        ("lines_lost", 0.into()),
        ("version", env!("CARGO_PKG_VERSION").into()),
    ] {
        assert_eq!(json[key], value, "{key}");
    }
    assert_eq!(json["faults"].as_array().map(Vec::len), Some(1));
    let page = got(&status, "/?x=1");
    assert!(page.starts_with("HTTP/1.1 200 OK\r\n"), "{page}");
    assert!(page.contains("Leonardo &amp; &lt;company&gt;") && page.contains("Recto: faulty"));
    assert!(page.contains("&lt;script&gt;") && !page.contains("<script"));
    assert!(page.contains("http-equiv=\"refresh\""));
}

#[test]
fn nothing_else_is_answered() {
    let (status, _) = served();
    for path in [
        "/../../etc/passwd",
        "/..%2f..%2fetc/passwd",
        "//status.json",
        "/status.json/",
        "/status.json%00",
        "/STATUS.JSON",
        "/exhibit.toml",
        "/%",
        "http://other/secret",
    ] {
        let answer = got(&status, path);
        let refused = ["HTTP/1.1 404", "HTTP/1.1 400"];
        assert!(
            refused.iter().any(|code| answer.starts_with(code)),
            "{path}: {answer}"
        );
        assert!(!answer.contains("root:"));
    }
    for method in [
        "POST", "PUT", "DELETE", "HEAD", "OPTIONS", "PATCH", "TRACE", "BREW",
    ] {
        let request = format!("{method} / HTTP/1.1\r\nHost: wall\r\n\r\n");
        let answer = asked(&status, request.as_bytes());
        assert!(answer.starts_with("HTTP/1.1 405"), "{method}: {answer}");
        assert!(answer.to_lowercase().contains("allow: get"), "{answer}");
    }
    let with_body = "GET / HTTP/1.1\r\nHost: wall\r\nContent-Length: 5\r\n\r\nhello";
    assert!(asked(&status, with_body.as_bytes()).starts_with("HTTP/1.1 413"));
    let posted = format!(
        "POST / HTTP/1.1\r\nHost: wall\r\nContent-Length: 9999999\r\n\r\n{}",
        "x".repeat(100_000)
    );
    assert!(asked(&status, posted.as_bytes()).starts_with("HTTP/1.1 405"));
    // And what is none of HTTP.
    for bytes in [
        &b"\x16\x03\x01\x02\x00"[..],
        b"\r\n\r\n\0\0\0",
        b"GET\r\n\r\n",
        &[0xff; 5000],
    ] {
        assert!(!asked(&status, bytes).starts_with("HTTP/1.1 200"));
    }
    assert!(got(&status, "/").starts_with("HTTP/1.1 200"));
}

#[test]
fn a_huge_header_is_refused() {
    let (status, _) = served();
    let one = format!(
        "GET / HTTP/1.1\r\nHost: wall\r\nX: {}\r\n\r\n",
        "x".repeat(4 << 20)
    );
    let answer = asked(&status, one.as_bytes());
    assert!(!answer.starts_with("HTTP/1.1 200"), "{answer}");
    let many = format!("GET / HTTP/1.1\r\n{}\r\n", "X: y\r\n".repeat(10_000));
    assert!(!asked(&status, many.as_bytes()).starts_with("HTTP/1.1 200"));
    assert!(got(&status, "/").starts_with("HTTP/1.1 200"));
}

#[test]
fn idle_and_slow_clients_keep_nobody_waiting_for_good() {
    let (status, _) = served();
    let mut idle: Vec<Stream> = (0..200).map(|_| connected(&status)).collect();
    // Some begin to speak and never end.
    for stream in idle.iter_mut().step_by(2) {
        stream.write_all(b"GET / HTTP/1.1\r\nHo").expect("sent");
    }
    assert!(got(&status, "/status.json").starts_with("HTTP/1.1 200"));
    // More than may be connected at once: the next waits until some have been sent away.
    idle.extend((0..100).map(|_| connected(&status)));
    assert!(got(&status, "/status.json").starts_with("HTTP/1.1 200"));
    // They were sent away, by an end or an error, and not by patience.
    let mut rest = [0; 64];
    match idle[1].read(&mut rest) {
        Ok(n) => assert_eq!(n, 0),
        Err(error) => assert_eq!(error.kind(), io::ErrorKind::ConnectionReset),
    }
    let _ = idle[0].shutdown(Shutdown::Both);
}

#[test]
fn a_port_that_is_taken_is_an_error_in_words() {
    let (status, health) = served();
    let error = Status::serve(status.address(), health.clone()).expect_err("taken");
    let words = error.to_string();
    assert!(
        words.starts_with("the status port 127.0.0.1:") && words.contains("not served"),
        "{words}"
    );
    // Of a network for documentation: no machine has it.
    assert!(Status::serve(([203, 0, 113, 1], 0).into(), health).is_err());
}

#[test]
fn the_port_is_free_again_when_it_is_no_longer_served() {
    let (status, health) = served();
    let address = status.address();
    drop(status);
    let ended = std::time::Instant::now() + PATIENCE;
    while Status::serve(address, health.clone()).is_err() {
        assert!(std::time::Instant::now() < ended, "still served");
        thread::sleep(PAUSE);
    }
}
