//! The solver of a saved page. It reads one request from standard input and writes the answer to
//! standard output. The page runs it as WebAssembly, once for each request.
//!
//! The first line of the input is the route, and the rest is the body of the request. The output is
//! an object with the member `answer` or, if the request is refused, with the members `error` (the
//! message) and `key` (the name of the invalid or missing input, or null).

use std::io::{self, Read, Write};
use std::sync::atomic::AtomicBool;

use bsm_batch::Workers;
use bsm_view::answer;
use serde_json::json;

fn main() -> io::Result<()> {
    let mut request = String::new();
    io::stdin().read_to_string(&mut request)?;
    let (route, body) = request.split_once('\n').unwrap_or((&request, ""));
    let never = AtomicBool::new(false);
    let workers = Workers::start(None, &never)?;
    let reply = match answer(route, body.as_bytes(), &workers, &never) {
        Ok(answer) => json!({ "answer": answer }),
        Err(refusal) => refusal.to_json(),
    };
    io::stdout().write_all(reply.to_string().as_bytes())
}
