//! The server: this machine only, one page, one token.

use std::io::{self, Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::RecvTimeoutError;
use std::thread;
use std::time::{Duration, Instant};

use bsm_batch::Workers;
use bsm_case::Scene;
use serde_json::{Value, json};
use thiserror::Error;
use tiny_http::{Header, Method, Request, Response, StatusCode};

use crate::Refusal;
use crate::answer::{Asked, answer};
use crate::form::schema;
use crate::page;
use crate::running::{Running, Turn};

/// Largest body of a request \[B\].
const MOST_BYTES: u64 = 1 << 20;

/// Time that an answer may take.
const PATIENCE: Duration = Duration::from_secs(2);

/// Requests that are served at a time: more than a page asks, so that the newest does not wait for others.
const SERVING: usize = 8;

/// Answers that are being worked out: those that are waited for, and as many that were given up. Beyond, nothing
/// new is begun.
const MOST_RUNNING: usize = 2 * SERVING;

/// Stack of a solve \[B\]: code that is not optimised keeps every intermediate result.
const STACK: usize = 16 << 20;

/// What saves a scene, as the text of its file.
pub type Save = Box<dyn Fn(&str) -> Result<(), String> + Send + Sync>;

/// Why there is no server.
#[derive(Debug, Error)]
pub enum ViewError {
    /// The address cannot be had.
    #[error("cannot listen on 127.0.0.1:{port}: {source}")]
    Listen {
        /// The port that was asked for, 0 for any.
        port: u16,
        /// What the system says.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// There are no random numbers for a token.
    #[error("no random numbers: {0}")]
    Random(String),
    /// There are no threads.
    #[error("cannot start a thread: {0}")]
    Thread(#[from] io::Error),
}

/// A server for one scene.
pub struct Server {
    http: tiny_http::Server,
    port: u16,
    shared: Arc<Shared>,
}

/// What all requests share.
struct Shared {
    token: String,
    hosts: [String; 2],
    scene: Value,
    settings: Value,
    save: Option<Save>,
    workers: Workers<'static>,
    running: Running,
}

/// The threads end with the program.
static NEVER: AtomicBool = AtomicBool::new(false);

impl Server {
    /// Listens on 127.0.0.1.
    ///
    /// * `port`: 0 for a free one. * `settings`: how it is solved at first, as [`bsm_case::Settings::to_json`]. * `save`:
    ///   where the button "save" writes; without it there is none.
    ///
    /// # Errors
    ///
    /// [`ViewError`].
    pub fn start(
        port: u16,
        scene: &Scene,
        settings: &bsm_case::Settings,
        save: Option<Save>,
    ) -> Result<Self, ViewError> {
        let http = tiny_http::Server::http(("127.0.0.1", port))
            .map_err(|source| ViewError::Listen { port, source })?;
        let port = http.server_addr().to_ip().map_or(port, |address| address.port());
        let mut random = [0_u8; 16];
        getrandom::fill(&mut random).map_err(|error| ViewError::Random(error.to_string()))?;
        let shared = Shared {
            token: format!("{:032x}", u128::from_ne_bytes(random)),
            hosts: ["127.0.0.1", "localhost"].map(|name| format!("{name}:{port}")),
            scene: scene.to_json(),
            settings: settings.to_json(),
            save,
            workers: Workers::start(None, &NEVER)?,
            running: Running::most(MOST_RUNNING),
        };
        Ok(Self { http, port, shared: Arc::new(shared) })
    }

    /// The address of the page, with its token.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/?token={}", self.port, self.shared.token)
    }

    /// Serves until the program ends.
    pub fn serve(&self) {
        thread::scope(|scope| {
            for _ in 0..SERVING {
                scope.spawn(|| {
                    while let Ok(request) = self.http.recv() {
                        self.shared.respond(request);
                    }
                });
            }
        });
    }

    /// Ends [`serve`](Self::serve).
    pub fn stop(&self) {
        for _ in 0..SERVING {
            self.http.unblock();
        }
    }
}

/// What a request gets: a status, a type, a body.
type Reply = (u16, &'static str, String);

/// A refusal as the page reads it.
fn refused(status: u16, text: &str) -> Reply {
    (status, "application/json", json!({ "error": text }).to_string())
}

impl Shared {
    fn respond(self: &Arc<Self>, mut request: Request) {
        let began = Instant::now();
        let (status, kind, body) = self.reply(&mut request);
        let timing = format!("total;dur={:.2}", 1e3 * began.elapsed().as_secs_f64());
        let mut response = Response::from_string(body)
            .with_status_code(StatusCode(status))
            .with_chunked_threshold(usize::MAX);
        for (name, value) in [
            ("Content-Type", kind),
            ("Cache-Control", "no-store"),
            ("X-Content-Type-Options", "nosniff"),
            ("Referrer-Policy", "no-referrer"),
            ("Cross-Origin-Resource-Policy", "same-origin"),
            ("Content-Security-Policy", "frame-ancestors 'none'"),
            ("Server-Timing", timing.as_str()),
        ] {
            if let Ok(header) = Header::from_bytes(name, value) {
                response.add_header(header);
            }
        }
        // In one piece: a body after its head would wait for the page to confirm the head, 40 ms.
        let mut bytes = Vec::new();
        let version = request.http_version().clone();
        let whole = response.raw_print(&mut bytes, version, request.headers(), false, None);
        if whole.is_ok() {
            let mut writer = request.into_writer();
            // A page that has gone needs no answer.
            let _ = writer.write_all(&bytes).and_then(|()| writer.flush());
        }
    }

    fn reply(self: &Arc<Self>, request: &mut Request) -> Reply {
        let header = |name: &'static str| {
            let found = request.headers().iter().find(|header| header.field.equiv(name));
            found.map(|header| header.value.as_str().to_owned())
        };
        let (path, query) = request.url().split_once('?').unwrap_or((request.url(), ""));
        let path = path.to_owned();
        let is_ours = |host: &str| self.hosts.iter().any(|known| known == host);
        if !header("Host").is_some_and(|host| is_ours(&host)) {
            return refused(403, "this server is for its own page: the host is another one");
        }
        let foreign = |origin: &String| !origin.strip_prefix("http://").is_some_and(is_ours);
        if header("Origin").as_ref().is_some_and(foreign) {
            return refused(403, "this server is for its own page: the origin is another one");
        }
        let by_query = query.split('&').find_map(|part| part.strip_prefix("token="));
        let token = header("X-Bsm-Token").or(by_query.map(str::to_owned));
        if !token.is_some_and(|token| same(&token, &self.token)) {
            return refused(
                403,
                "the token is missing or wrong: use the address that bsm view printed",
            );
        }
        match (request.method(), path.as_str()) {
            (Method::Get, "/") => (200, "text/html; charset=utf-8", self.page()),
            (Method::Post, route) if route.len() > 1 => {
                let turn = header("X-Bsm-Turn").and_then(|text| Turn::parse(&text));
                match body(request) {
                    Ok(body) => self.posted(turn, &route[1..], body),
                    Err(reply) => reply,
                }
            }
            (Method::Get, "/favicon.ico") => (204, "image/x-icon", String::new()),
            (Method::Get, route) => refused(404, &format!("unknown route `{}`", &route[1..])),
            (method, route) => refused(405, &format!("{route} does not take {method}")),
        }
    }

    fn page(&self) -> String {
        page::html(&json!({
            "live": true,
            "token": self.token,
            "scene": self.scene,
            "settings": self.settings,
            "save": self.save.is_some(),
            "program": bsm_report::PROGRAM,
            "schema": schema(),
        }))
    }

    fn posted(self: &Arc<Self>, turn: Option<Turn>, route: &str, body: Vec<u8>) -> Reply {
        let found = if route == "save" { self.save(&body) } else { self.answer(turn, route, body) };
        match found {
            Ok(answer) => (200, "application/json", answer.to_string()),
            Err(refusal) => {
                let status = match refusal {
                    Refusal::Input(_) => 400,
                    Refusal::Route(_) => 404,
                    Refusal::Overtaken => 409,
                    Refusal::Slow(_) | Refusal::Busy => 503,
                };
                refused(status, &refusal.to_string())
            }
        }
    }

    /// An answer, unless it takes too long or is overtaken.
    fn answer(
        self: &Arc<Self>,
        turn: Option<Turn>,
        route: &str,
        body: Vec<u8>,
    ) -> Result<Value, Refusal> {
        let (begun, answers) = self.running.begin(turn)?;
        let stop = begun.stop();
        let (shared, route) = (Arc::clone(self), route.to_owned());
        let work = move || {
            let found = answer(&route, &body, &shared.workers, &begun.stop());
            begun.end(found);
        };
        let started = thread::Builder::new().stack_size(STACK).spawn(work);
        started.map_err(|error| Refusal::Input(format!("cannot start a thread: {error}")))?;
        match answers.recv_timeout(PATIENCE) {
            Ok(found) => found,
            Err(RecvTimeoutError::Timeout) => {
                stop.store(true, Ordering::Relaxed);
                Err(Refusal::Slow(PATIENCE.as_secs()))
            }
            Err(RecvTimeoutError::Disconnected) => Err(Refusal::Input(
                "the solver ended unexpectedly; please report this scene".to_owned(),
            )),
        }
    }

    /// Writes the scene where the program was told to.
    fn save(&self, body: &[u8]) -> Result<Value, Refusal> {
        let Some(save) = &self.save else {
            let text = "bsm view was started without --save: it writes nothing";
            return Err(Refusal::Input(text.to_owned()));
        };
        let Asked { scene, .. } = Asked::read(body)?;
        scene.check()?;
        let text = serde_json::to_string_pretty(&scene.to_json()).unwrap_or_default() + "\n";
        save(&text).map_err(Refusal::Input)?;
        Ok(json!({ "saved": true }))
    }
}

/// The body of a request, unless it is too large.
fn body(request: &mut Request) -> Result<Vec<u8>, Reply> {
    let too_large = || refused(413, &format!("a request has at most {MOST_BYTES} bytes"));
    if request.body_length().is_some_and(|bytes| bytes as u64 > MOST_BYTES) {
        return Err(too_large());
    }
    let mut body = Vec::new();
    let read = request.as_reader().take(MOST_BYTES + 1).read_to_end(&mut body);
    match read {
        Ok(_) if body.len() as u64 > MOST_BYTES => Err(too_large()),
        Ok(_) => Ok(body),
        Err(error) => Err(refused(400, &format!("cannot read the request: {error}"))),
    }
}

/// Whether two texts are the same, in a time that does not tell where they differ.
fn same(one: &str, other: &str) -> bool {
    let differ = one.bytes().zip(other.bytes()).fold(0, |differ, (a, b)| differ | (a ^ b));
    one.len() == other.len() && differ == 0
}
