//! The server of the page. It accepts only requests that come from this machine and contain the
//! server's token.
//!
//! The requests `POST /solve`, `/slip`, `/ellipses`, `/point` (which combines the first three),
//! `/compare`, `/nut`, `/warm`, `/axis`, `/sweep` and `/schema` have the body `{"case": {..},
//! "settings": {..}}`, and the token in the header `X-Bsm-Token`. The responses contain the output
//! of the commands with `--json` and the data for the graphics.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::RecvTimeoutError;
use std::thread;
use std::time::{Duration, Instant};

use bsm_batch::Workers;
use bsm_case::Case;
use serde_json::{Value, json};
use thiserror::Error;

use crate::Refusal;
use crate::answer::{Request, answer};
use crate::form::schema;
use crate::http::{Connection, Head, HttpRefusal};
use crate::page;
use crate::running::{RequestId, Running};

/// Time limits for calculating an answer. The second limit applies only to warm states as a
/// function of the speed. The second limit can be longer, because no other panel of the page waits
/// for these states.
const TIME_LIMITS: [Duration; 2] = [Duration::from_secs(2), Duration::from_secs(60)];

/// Maximum number of running calculations, including stopped calculations that have not ended yet.
/// While this number of calculations is running, further requests are refused. A single page waits
/// for at most half of this number of answers.
const MAX_RUNNING: usize = 16;

/// Pause after the operating system failed to accept a connection for lack of resources.
const NO_ROOM: Duration = Duration::from_millis(50);

/// Stack size of a solver thread \[B\]. Debug builds keep every intermediate result on the stack.
const STACK: usize = 16 << 20;

/// A function that saves the text of a case file.
pub type Save = Box<dyn Fn(&str) -> Result<(), String> + Send + Sync>;

/// The reason why the server cannot be started.
#[derive(Debug, Error)]
pub enum ViewError {
    /// The server cannot listen on the requested port.
    #[error("cannot listen on 127.0.0.1:{port}: {source}")]
    Listen {
        /// The requested port; 0 means any free port.
        port: u16,
        /// The error that the operating system reported.
        source: io::Error,
    },
    /// The operating system provides no random numbers for the token.
    #[error("cannot create a random token: {0}")]
    Random(String),
    /// The threads of the server cannot be started.
    #[error("cannot start a thread: {0}")]
    Thread(#[from] io::Error),
}

/// A server that provides the page for one case.
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
    ended: AtomicBool,
    shared: Arc<ServerState>,
}

/// Data of the server that all requests share.
struct ServerState {
    token: String,
    hosts: [String; 2],
    case: Value,
    beside: Value,
    settings: Value,
    save: Option<Save>,
    workers: Workers<'static>,
    running: Running,
}

/// Stop flag of the solver threads, which is never set because the threads end with the program.
static NEVER: AtomicBool = AtomicBool::new(false);

impl Server {
    /// Creates a server that listens on 127.0.0.1.
    ///
    /// * `port`: port number; 0 means any free port.
    /// * `beside`: further cases, which the page compares with `case`.
    /// * `settings`: initial model settings of the page.
    /// * `save`: function for the button "Save case". If it is `None`, the browser downloads the
    ///   case.
    ///
    /// # Errors
    ///
    /// Returns [`ViewError`] if the port is not available, or if the operating system provides no
    /// random numbers or threads.
    pub fn start(
        port: u16,
        case: &Case,
        beside: &[Case],
        settings: &bsm_case::Settings,
        save: Option<Save>,
    ) -> Result<Self, ViewError> {
        let listen = || {
            let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
            listener.local_addr().map(|address| (listener, address))
        };
        let (listener, address) = listen().map_err(|source| ViewError::Listen { port, source })?;
        let port = address.port();
        let mut random = [0_u8; 16];
        getrandom::fill(&mut random).map_err(|error| ViewError::Random(error.to_string()))?;
        let shared = ServerState {
            token: format!("{:032x}", u128::from_ne_bytes(random)),
            hosts: ["127.0.0.1", "localhost"].map(|name| format!("{name}:{port}")),
            // The page shows only the given inputs. Missing groove inputs are estimated again for
            // every answer.
            case: case.without_estimates().to_json(),
            beside: page::cases(beside),
            settings: settings.to_json(),
            save,
            workers: Workers::start(None, &NEVER)?,
            running: Running::with_limit(MAX_RUNNING),
        };
        Ok(Self { listener, address, ended: AtomicBool::new(false), shared: Arc::new(shared) })
    }

    /// Returns the URL of the page, including its token.
    pub fn address(&self) -> String {
        format!("http://{}/?token={}", self.address, self.shared.token)
    }

    /// Answers requests until the program ends or [`stop`](Self::stop) is called. Each connection
    /// has its own thread, so slow clients do not delay other clients.
    pub fn serve(&self) {
        while !self.ended.load(Ordering::Relaxed) {
            let Ok((stream, _)) = self.listener.accept() else {
                thread::sleep(NO_ROOM);
                continue;
            };
            let (stream, shared) = (Arc::new(stream), Arc::clone(&self.shared));
            let served = Arc::clone(&stream);
            if let Err(error) = thread::Builder::new().spawn(move || shared.serve(&served)) {
                let reply = refused(503, &Refusal::Thread(error).to_json());
                respond(Connection::new(&stream), &reply, Instant::now());
            }
        }
    }

    /// Makes [`serve`](Self::serve) end its loop and return.
    pub fn stop(&self) {
        self.ended.store(true, Ordering::Relaxed);
        // This connection wakes the loop, which is waiting for connections.
        let _ = TcpStream::connect(self.address);
    }
}

/// A response: status, content type and body.
type Reply = (u16, &'static str, String);

/// Returns the response to a refused request.
///
/// * `refusal`: JSON object in the form of [`Refusal::to_json`].
fn refused(status: u16, refusal: &Value) -> Reply {
    (status, "application/json", refusal.to_string())
}

/// Sends a response and closes the connection.
fn respond(connection: Connection<'_>, (status, kind, body): &Reply, began: Instant) {
    let timing = format!("total;dur={:.2}", 1e3 * began.elapsed().as_secs_f64());
    let lines = [
        ("Content-Type", *kind),
        ("Cache-Control", "no-store"),
        ("X-Content-Type-Options", "nosniff"),
        ("Referrer-Policy", "no-referrer"),
        ("Cross-Origin-Resource-Policy", "same-origin"),
        ("Content-Security-Policy", "frame-ancestors 'none'"),
        ("Server-Timing", timing.as_str()),
    ];
    connection.answer(*status, &lines, body);
}

impl ServerState {
    /// Reads the request of a connection and answers it.
    fn serve(self: &Arc<Self>, stream: &TcpStream) {
        let mut connection = Connection::new(stream);
        let head = connection.head();
        let began = Instant::now();
        let reply = head
            .and_then(|head| self.reply(&head, &mut connection))
            .unwrap_or_else(|(status, text)| refused(status, &Refusal::input(text).to_json()));
        respond(connection, &reply, began);
    }

    fn reply(
        self: &Arc<Self>,
        head: &Head,
        connection: &mut Connection<'_>,
    ) -> Result<Reply, HttpRefusal> {
        let refuse = |status: u16, text: &str| Err((status, text.to_owned()));
        let (path, query) = head.target.split_once('?').unwrap_or((&head.target, ""));
        let is_ours = |host: &str| self.hosts.iter().any(|known| known == host);
        if !head.line("Host").is_some_and(is_ours) {
            return refuse(403, "rejected: unexpected Host header");
        }
        let foreign = |origin: &str| !origin.strip_prefix("http://").is_some_and(is_ours);
        if head.line("Origin").is_some_and(foreign) {
            return refuse(403, "rejected: unexpected Origin header");
        }
        let by_query = query.split('&').find_map(|part| part.strip_prefix("token="));
        if !head.line("X-Bsm-Token").or(by_query).is_some_and(|token| same(token, &self.token)) {
            return refuse(
                403,
                "the token is missing or wrong; use the address that bsm view printed",
            );
        }
        match (head.method.as_str(), path) {
            ("GET", "/") => Ok((200, "text/html; charset=utf-8", self.page())),
            ("POST", route) if route.len() > 1 => {
                let id = head.line("X-Bsm-Request").and_then(RequestId::parse);
                Ok(self.posted(id, &route[1..], connection.body(head)?))
            }
            ("GET", "/favicon.ico") => Ok((204, "image/x-icon", String::new())),
            ("GET", route) => refuse(404, &format!("unknown route `{route}`")),
            (method, route) => refuse(405, &format!("{route} does not accept {method}")),
        }
    }

    fn page(&self) -> String {
        let start = json!({
            "token": self.token,
            "case": self.case,
            "beside": self.beside,
            "settings": self.settings,
            "save": self.save.is_some(),
            "program": bsm_report::PROGRAM,
            "schema": schema(),
        });
        page::html(&start, None)
    }

    fn posted(self: &Arc<Self>, id: Option<RequestId>, route: &str, body: Vec<u8>) -> Reply {
        let found = if route == "save" { self.save(&body) } else { self.answer(id, route, body) };
        match found {
            Ok(answer) => (200, "application/json", answer.to_string()),
            Err(refusal) => {
                let status = match refusal {
                    Refusal::Input { .. } => 400,
                    Refusal::Route(_) => 404,
                    Refusal::Superseded => 409,
                    Refusal::Slow(_) | Refusal::Busy | Refusal::Thread(_) => 503,
                };
                refused(status, &refusal.to_json())
            }
        }
    }

    /// Calculates the answer to a request. Returns an error if the calculation takes too long or if
    /// a newer request replaces this request.
    fn answer(
        self: &Arc<Self>,
        id: Option<RequestId>,
        route: &str,
        body: Vec<u8>,
    ) -> Result<Value, Refusal> {
        let (begun, answers) = self.running.begin(id)?;
        let stop = begun.stop();
        let patience = TIME_LIMITS[usize::from(route == "warm")];
        let (shared, route) = (Arc::clone(self), route.to_owned());
        let work = move || {
            let found = answer(&route, &body, &shared.workers, &begun.stop());
            begun.end(found);
        };
        let started = thread::Builder::new().stack_size(STACK).spawn(work);
        started.map_err(Refusal::Thread)?;
        match answers.recv_timeout(patience) {
            Ok(found) => found,
            Err(RecvTimeoutError::Timeout) => {
                stop.store(true, Ordering::Relaxed);
                Err(Refusal::Slow(patience.as_secs()))
            }
            Err(RecvTimeoutError::Disconnected) => {
                Err(Refusal::input("the solver ended unexpectedly; please report this case"))
            }
        }
    }

    /// Saves the case to the file that the option `-o` specifies.
    fn save(&self, body: &[u8]) -> Result<Value, Refusal> {
        let Some(save) = &self.save else {
            let text = "cannot save the case, because bsm view was started without -o CASE.json";
            return Err(Refusal::input(text));
        };
        let Request { case, settings, .. } = Request::read(body)?;
        // A case is saved only if the program accepts its inputs, so that the saved file can be
        // opened again.
        case.with_groove()?.problem(&settings)?;
        let text = serde_json::to_string_pretty(&case.to_json()).unwrap_or_default() + "\n";
        save(&text).map_err(Refusal::input)?;
        Ok(json!({ "saved": true }))
    }
}

/// Returns true if two strings are equal. The computing time does not depend on the position of the
/// first difference, so an attacker cannot guess the token by measuring times.
fn same(one: &str, other: &str) -> bool {
    let differ = one.bytes().zip(other.bytes()).fold(0, |differ, (a, b)| differ | (a ^ b));
    one.len() == other.len() && differ == 0
}
