//! A page and JSON that say how the wall is, over HTTP. It answers reads of these two and nothing
//! else, touches no file of the exhibit, and hangs on no one who asks.

use std::{
    fmt::Write as _,
    future::Future,
    io,
    net::{SocketAddr, TcpListener as StdListener},
    pin::Pin,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    task::{Context, Poll},
    thread,
    time::Duration,
};

use axum::{
    Router,
    body::Body,
    extract::State,
    http::{HeaderMap, HeaderValue, Method, StatusCode, Uri, header},
    response::{IntoResponse, Response},
    serve::Listener,
};
use tokio::{
    io::{AsyncRead, AsyncWrite, ReadBuf},
    net::{TcpListener, TcpStream},
    time::{Sleep, sleep},
};

use super::{
    health::{Health, Report},
    together::{Role, Standing},
};

/// From its first byte to the last of its answer, a connection may take so long.
const LIFETIME: Duration = Duration::from_secs(5);
/// Whoever comes while so many are connected waits until one of them is gone. Below the usual limit
/// of open files, of which the program itself has some hundred.
const MOST_CONNECTIONS: usize = 256;
/// How often those that wait are thought of.
const PAUSE: Duration = Duration::from_millis(20);
/// The page reads itself again after so many seconds.
const AGAIN_S: u32 = 5;

/// Why nothing answers.
#[derive(Debug, thiserror::Error)]
#[error(
    "the status port {address} is not served: {source}; choose another one, or stop whoever has it"
)]
pub struct StatusError {
    address: SocketAddr,
    source: io::Error,
}

/// The port, served by a thread of its own until this is dropped.
#[derive(Debug)]
pub struct Status {
    address: SocketAddr,
    is_over: Arc<AtomicBool>,
}

impl Status {
    /// Serves `health` at an address, which whoever calls has taken from the installation: other
    /// machines can read it only if that says so.
    ///
    /// # Errors
    /// If the address is taken, or not one of this machine's. The wall goes on without.
    pub fn serve(address: SocketAddr, health: Arc<Health>) -> Result<Self, StatusError> {
        let fault = |source| StatusError { address, source };
        let listener = StdListener::bind(address).map_err(fault)?;
        listener.set_nonblocking(true).map_err(fault)?;
        let address = listener.local_addr().map_err(fault)?;
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .map_err(fault)?;
        let is_over = Arc::new(AtomicBool::new(false));
        let over = is_over.clone();
        thread::Builder::new()
            .name("status".to_owned())
            .spawn(move || {
                // A port that cannot be served any more is seen by whoever reads it.
                let _ = runtime.block_on(answer(listener, health, over));
            })
            .map_err(fault)?;
        Ok(Self { address, is_over })
    }

    /// Where it is read; the port that was given where any was asked for.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for Status {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
    }
}

async fn answer(
    listener: StdListener,
    health: Arc<Health>,
    over: Arc<AtomicBool>,
) -> io::Result<()> {
    let guarded = Guarded {
        listener: TcpListener::from_std(listener)?,
        connected: Arc::default(),
    };
    let routes = Router::new().fallback(read).with_state(health);
    let until_over = async move {
        while !over.load(Ordering::Relaxed) {
            sleep(PAUSE * 10).await;
        }
    };
    axum::serve(guarded, routes)
        .with_graceful_shutdown(until_over)
        .await
}

/// What is said to a request.
async fn read(
    State(health): State<Arc<Health>>,
    method: Method,
    uri: Uri,
    headers: HeaderMap,
) -> Response {
    let has_body = headers.contains_key(header::TRANSFER_ENCODING)
        || headers
            .get(header::CONTENT_LENGTH)
            .is_some_and(|n| n != "0");
    let mut response = if method != Method::GET {
        let allow = [(header::ALLOW, "GET")];
        (StatusCode::METHOD_NOT_ALLOWED, allow, "only GET\n").into_response()
    } else if has_body {
        (StatusCode::PAYLOAD_TOO_LARGE, "no bodies\n").into_response()
    } else {
        match uri.path() {
            "/" => of_type("text/html; charset=utf-8", page(&health.report())),
            "/status.json" => match serde_json::to_string_pretty(&health.report()) {
                Ok(json) => of_type("application/json", json + "\n"),
                Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
            },
            _ => (StatusCode::NOT_FOUND, "only / and /status.json\n").into_response(),
        }
    };
    let headers = response.headers_mut();
    for (name, value) in [
        (header::CONNECTION, "close"),
        (header::CACHE_CONTROL, "no-store"),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (
            header::CONTENT_SECURITY_POLICY,
            "default-src 'none'; style-src 'unsafe-inline'; frame-ancestors 'none'",
        ),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

fn of_type(kind: &'static str, text: String) -> Response {
    ([(header::CONTENT_TYPE, kind)], Body::from(text)).into_response()
}

/// The page, for people.
fn page(report: &Report) -> String {
    let about = &report.about;
    let mut rows = String::new();
    let mut row = |name: &str, value: &str| {
        // Writing to a string does not fail.
        let _ = writeln!(rows, "<tr><th>{name}</th><td>{}</td></tr>", escaped(value));
    };
    row("exhibit", &about.exhibit);
    row("folder", &about.folder);
    row("scene", &about.scene);
    row("language", &about.language);
    let times = &report.frame_times;
    let frames = match times.frames_in_last_minute {
        0 => "none in the last minute: nothing moves".to_owned(),
        n => format!(
            "{n} in the last minute: half of them took up to {:.1} ms, 19 of 20 up to {:.1} ms, the slowest {:.1} ms",
            times.median_ms, times.p95_ms, times.worst_ms
        ),
    };
    row("frames", &frames);
    row("frames completed", &report.frames_completed.to_string());
    let mib = |bytes: u64| format!("{:.0} MiB", bytes as f64 / f64::from(1 << 20));
    row(
        "memory",
        &report.memory_bytes.map_or("unknown".to_owned(), mib),
    );
    let degrees = |t: f64| format!("{t:.0} °C");
    row(
        "temperature",
        &report.temperature_c.map_or("unknown".to_owned(), degrees),
    );
    row("sessions today", &report.sessions_today.to_string());
    row("lines lost", &report.lines_lost.to_string());
    for (name, words) in report.machines.iter().flat_map(machines) {
        row(&name, &words);
    }
    row(
        "started",
        &format!("{}, {} ago", report.started, ago(report.uptime_s)),
    );
    row("version", report.version);
    let faults: String = match about.faults.as_slice() {
        [] => "<p>No faults.</p>".to_owned(),
        faults => {
            let item = |fault: &String| format!("<li>{}</li>\n", escaped(fault));
            let items: String = faults.iter().map(item).collect();
            format!("<ul>\n{items}</ul>")
        }
    };
    let state = about.state.word();
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width\">\
         <meta http-equiv=\"refresh\" content=\"{AGAIN_S}\">\n<title>Recto: {state}</title>\n\
         <style>body{{font:16px/1.5 sans-serif;max-width:46em;margin:2em auto;padding:0 1em;\
         background:#f7f4ee;color:#222}}th{{text-align:left;padding-right:1.5em;vertical-align:top;\
         font-weight:normal;color:#555}}li,td{{overflow-wrap:anywhere}}</style></head>\n\
         <body><h1>Recto: {state}</h1>\n{faults}\n<table>\n{rows}</table>\n\
         <p>{}, again in {AGAIN_S} s; <a href=\"/status.json\">as JSON</a></p></body></html>\n",
        escaped(&report.now)
    )
}

/// Who this machine is among others, and how it is with them.
fn machines(standing: &Standing) -> Vec<(String, String)> {
    let silent = |s: Option<f64>| match s {
        Some(s) => format!("heard {s:.1} s ago"),
        None => "not heard yet".to_owned(),
    };
    let clock = |offset: Option<f64>, within: Option<f64>| match (offset, within) {
        (Some(offset), Some(within)) => {
            format!(", clock {offset:.1} ± {within:.1} ms from the leader's")
        }
        _ => String::new(),
    };
    let mut rows = vec![(
        "machine".to_owned(),
        match standing.role {
            Role::Leads => format!("{}, leads at {}", standing.machine, standing.address),
            Role::Follows => format!("{}, follows {}", standing.machine, standing.address),
        },
    )];
    for peer in &standing.followers {
        let behind = match peer.behind {
            Some(0) => ", up to date".to_owned(),
            Some(n) => format!(", {n} pictures behind"),
            None => String::new(),
        };
        let words = format!(
            "{}{behind}{}",
            silent(peer.silent_s),
            clock(peer.clock_offset_ms, peer.clock_within_ms)
        );
        rows.push((format!("follower {}", peer.machine), words));
    }
    if let Some(leader) = &standing.leader {
        let version = leader.shown_version;
        let words = format!(
            "{}{}{}",
            silent(leader.silent_s),
            version.map_or(String::new(), |version| format!(", picture {version}")),
            clock(leader.clock_offset_ms, leader.clock_within_ms)
        );
        rows.push(("leader".to_owned(), words));
    }
    rows
}

fn ago(s: u64) -> String {
    match (s / 86400, s / 3600 % 24, s / 60 % 60) {
        (0, 0, minutes) => format!("{minutes} min"),
        (0, hours, minutes) => format!("{hours} h {minutes} min"),
        (days, hours, _) => format!("{days} d {hours} h"),
    }
}

fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c => out.push(c),
        }
    }
    out
}

/// A listener whose connections are few and short.
struct Guarded {
    listener: TcpListener,
    connected: Arc<AtomicUsize>,
}

impl Listener for Guarded {
    type Io = Visit;
    type Addr = SocketAddr;

    async fn accept(&mut self) -> (Visit, SocketAddr) {
        loop {
            if self.connected.load(Ordering::Relaxed) < MOST_CONNECTIONS
                && let Ok((stream, address)) = self.listener.accept().await
            {
                self.connected.fetch_add(1, Ordering::Relaxed);
                let visit = Visit {
                    stream,
                    end: Box::pin(sleep(LIFETIME)),
                    connected: self.connected.clone(),
                };
                return (visit, address);
            }
            sleep(PAUSE).await;
        }
    }

    fn local_addr(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }
}

/// A connection that ends by itself.
struct Visit {
    stream: TcpStream,
    end: Pin<Box<Sleep>>,
    connected: Arc<AtomicUsize>,
}

impl Visit {
    fn is_in_time(&mut self, context: &mut Context<'_>) -> io::Result<()> {
        match self.end.as_mut().poll(context) {
            Poll::Ready(()) => Err(io::ErrorKind::TimedOut.into()),
            Poll::Pending => Ok(()),
        }
    }
}

impl Drop for Visit {
    fn drop(&mut self) {
        self.connected.fetch_sub(1, Ordering::Relaxed);
    }
}

impl AsyncRead for Visit {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        self.is_in_time(context)?;
        Pin::new(&mut self.stream).poll_read(context, buffer)
    }
}

impl AsyncWrite for Visit {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        self.is_in_time(context)?;
        Pin::new(&mut self.stream).poll_write(context, bytes)
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.is_in_time(context)?;
        Pin::new(&mut self.stream).poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.is_in_time(context)?;
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}

#[cfg(test)]
#[path = "status_tests.rs"]
mod tests;
