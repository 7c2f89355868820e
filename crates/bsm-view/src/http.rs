//! The subset of HTTP/1.1 that the page needs: one request per connection, with limits on its size
//! and duration, and one response.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::time::{Duration, Instant};

/// Maximum size of the request line and headers \[B\].
const MAX_HEAD: usize = 16 << 10;

/// Maximum number of header lines in a request.
const MAX_HEAD_LINES: usize = 64;

/// Maximum size of a request body \[B\].
const MAX_BODY: usize = 1 << 20;

/// Time limits for a client: for sending its request, for receiving the response, and for closing
/// the connection.
const TO_SEND: Duration = Duration::from_secs(5);
const TO_TAKE: Duration = Duration::from_secs(30);
const TO_CLOSE: Duration = Duration::from_secs(1);

/// HTTP status and message for a rejected request.
pub(crate) type HttpRefusal = (u16, String);

/// A connection with a deadline for reading and writing.
pub(crate) struct Connection<'a> {
    stream: &'a TcpStream,
    until: Instant,
}

/// The request line and headers of a request.
pub(crate) struct Head {
    pub(crate) method: String,
    pub(crate) target: String,
    lines: Vec<(String, String)>,
    /// Beginning of the body, which arrived together with the headers.
    rest: Vec<u8>,
}

impl<'a> Connection<'a> {
    pub(crate) fn new(stream: &'a TcpStream) -> Self {
        Self { stream, until: Instant::now() + TO_SEND }
    }

    /// Returns the time that is left until the deadline.
    fn left(&self) -> io::Result<Duration> {
        let left = self.until.saturating_duration_since(Instant::now());
        if left.is_zero() { Err(ErrorKind::TimedOut.into()) } else { Ok(left) }
    }

    /// Reads the request line and the headers of a request.
    pub(crate) fn head(&mut self) -> Result<Head, HttpRefusal> {
        let mut bytes = Vec::new();
        loop {
            let mut lines = [httparse::EMPTY_HEADER; MAX_HEAD_LINES];
            let mut request = httparse::Request::new(&mut lines);
            match request.parse(&bytes) {
                Ok(httparse::Status::Complete(length)) => {
                    return Ok(Head::of(&request, &bytes[length..]));
                }
                Ok(httparse::Status::Partial) if bytes.len() < MAX_HEAD => {}
                Ok(httparse::Status::Partial) | Err(httparse::Error::TooManyHeaders) => {
                    let error = "the request has too many headers, or its headers are too long";
                    return Err((431, error.to_owned()));
                }
                Err(error) => return Err((400, format!("cannot read the request: {error}"))),
            }
            let room = (MAX_HEAD - bytes.len()) as u64;
            let mut part = [0; 4096];
            let length =
                Read::take(&mut *self, room).read(&mut part).map_err(|error| unread(&error))?;
            if length == 0 {
                return Err(unread(&ErrorKind::UnexpectedEof.into()));
            }
            bytes.extend_from_slice(&part[..length]);
        }
    }

    /// Reads the body of a request.
    pub(crate) fn body(&mut self, head: &Head) -> Result<Vec<u8>, HttpRefusal> {
        if head.line("Transfer-Encoding").is_some() {
            return Err((
                411,
                "Transfer-Encoding is not supported; send Content-Length".to_owned(),
            ));
        }
        let length = match head.line("Content-Length").map(str::parse) {
            None => 0,
            Some(Ok(length)) => length,
            Some(Err(_)) => return Err((400, "Content-Length must be a number".to_owned())),
        };
        if length > MAX_BODY {
            return Err((413, format!("the body of a request may have at most {MAX_BODY} bytes")));
        }
        let mut body = head.rest.clone();
        body.truncate(length);
        let missing = (length - body.len()) as u64;
        Read::take(&mut *self, missing).read_to_end(&mut body).map_err(|error| unread(&error))?;
        if body.len() < length {
            return Err(unread(&ErrorKind::UnexpectedEof.into()));
        }
        Ok(body)
    }

    /// Sends the response and closes the connection. Errors are ignored because the client may have
    /// disconnected.
    pub(crate) fn answer(mut self, status: u16, lines: &[(&str, &str)], body: &str) {
        let length = body.len();
        let mut answer = format!(
            "HTTP/1.1 {status} {}\r\nConnection: close\r\nContent-Length: {length}\r\n",
            phrase(status)
        );
        for (name, value) in lines {
            answer.extend([name, ": ", value, "\r\n"]);
        }
        answer.extend(["\r\n", body]);
        self.until = Instant::now() + TO_TAKE;
        if self.write_all(answer.as_bytes()).is_ok()
            && self.stream.shutdown(Shutdown::Write).is_ok()
        {
            // All data that the client has sent are read before the connection is closed.
            // Otherwise, the operating system would discard response data that have not been sent
            // yet.
            self.until = Instant::now() + TO_CLOSE;
            let _ = io::copy(&mut self, &mut io::sink());
        }
    }
}

impl Read for Connection<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.stream.set_read_timeout(Some(self.left()?))?;
        self.stream.read(buffer)
    }
}

impl Write for Connection<'_> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.stream.set_write_timeout(Some(self.left()?))?;
        self.stream.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

impl Head {
    fn of(request: &httparse::Request<'_, '_>, rest: &[u8]) -> Self {
        let text = |text: Option<&str>| text.unwrap_or_default().to_owned();
        let line = |line: &httparse::Header<'_>| {
            (line.name.to_owned(), String::from_utf8_lossy(line.value).into_owned())
        };
        Self {
            method: text(request.method),
            target: text(request.path),
            lines: request.headers.iter().map(line).collect(),
            rest: rest.to_vec(),
        }
    }

    /// Returns the value of the first header that has the given name.
    pub(crate) fn line(&self, name: &str) -> Option<&str> {
        let (_, value) = self.lines.iter().find(|(known, _)| known.eq_ignore_ascii_case(name))?;
        Some(value)
    }
}

fn unread(error: &io::Error) -> HttpRefusal {
    match error.kind() {
        ErrorKind::TimedOut | ErrorKind::WouldBlock => {
            (408, format!("the request did not arrive within {} s", TO_SEND.as_secs()))
        }
        _ => (400, format!("cannot read the request: {error}")),
    }
}

/// Returns the reason phrase of an HTTP status.
fn phrase(status: u16) -> &'static str {
    match status {
        200 => "OK",
        204 => "No Content",
        400 => "Bad Request",
        403 => "Forbidden",
        404 => "Not Found",
        405 => "Method Not Allowed",
        408 => "Request Timeout",
        409 => "Conflict",
        411 => "Length Required",
        413 => "Content Too Large",
        431 => "Request Header Fields Too Large",
        _ => "Service Unavailable",
    }
}
