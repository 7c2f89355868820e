//! Tests of the server: which requests it accepts, and how it answers them.

use std::fs;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::sync::Arc;
use std::sync::Mutex;
use std::thread;
use std::time::Duration;

use bsm_case::{Case, Settings};
use bsm_view::{Save, Server};
use serde_json::{Value, json};

/// A server that is stopped at the end of the test.
struct TestServer {
    server: Arc<Server>,
    thread: Option<thread::JoinHandle<()>>,
    port: u16,
    token: String,
}

impl TestServer {
    fn start(save: Option<Save>) -> Self {
        let server = Server::start(0, &case(), &[], &Settings::default(), save).expect("a server");
        let server = Arc::new(server);
        let address = server.address();
        let (host, token) = address.split_once("/?token=").expect("a token");
        let port = host.rsplit(':').next().and_then(|port| port.parse().ok()).expect("a port");
        let serving = Arc::clone(&server);
        let thread = Some(thread::spawn(move || serving.serve()));
        Self { server, thread, port, token: token.to_owned() }
    }

    /// Sends a request exactly as given and returns the status and body of the response.
    fn send(&self, head: &str, body: &str) -> (u16, String) {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("a connection");
        let length = body.len();
        let request = format!("{head}\r\nContent-Length: {length}\r\n\r\n{body}");
        // Errors are ignored, because the server may reject a request before the client has sent
        // all of it.
        let _ = stream.write_all(request.as_bytes());
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        let answer = String::from_utf8(answer).expect("text");
        let status = answer.split(' ').nth(1).and_then(|status| status.parse().ok());
        let body = answer.split_once("\r\n\r\n").map_or("", |(_, body)| body);
        (status.unwrap_or_else(|| panic!("no status in {answer:?}")), body.to_owned())
    }

    fn head(&self, line: &str) -> String {
        format!("{line} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nX-Bsm-Token: {}", self.port, self.token)
    }

    fn post(&self, route: &str, body: &Value) -> (u16, Value) {
        let (status, body) = self.send(&self.head(&format!("POST /{route}")), &body.to_string());
        (status, serde_json::from_str(&body).unwrap_or_else(|error| panic!("{error}: {body}")))
    }
}

impl Drop for TestServer {
    fn drop(&mut self) {
        self.server.stop();
        self.thread.take().map(thread::JoinHandle::join);
    }
}

fn example_case(name: &str) -> Case {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name);
    Case::from_json(&fs::read(path).expect("an example")).expect("a case")
}

fn case() -> Case {
    example_case("feed_drive.json")
}

fn example_request() -> Value {
    json!({ "case": case().to_json() })
}

#[test]
fn wrong_tokens_hosts_and_origins_are_refused() {
    let served = TestServer::start(None);
    let TestServer { port, token, .. } = &served;
    let host = format!("Host: 127.0.0.1:{port}");
    let body = example_request().to_string();
    for (head, expected) in [
        (format!("POST /solve HTTP/1.1\r\n{host}\r\nX-Bsm-Token: {token}"), 200),
        (format!("POST /solve HTTP/1.1\r\nHost: localhost:{port}\r\nX-Bsm-Token: {token}"), 200),
        (
            format!(
                "POST /solve HTTP/1.1\r\n{host}\r\nX-Bsm-Token: {token}\r\nOrigin: http://127.0.0.1:{port}"
            ),
            200,
        ),
        (format!("POST /solve HTTP/1.1\r\n{host}"), 403),
        (format!("POST /solve HTTP/1.1\r\n{host}\r\nX-Bsm-Token: {}", "0".repeat(32)), 403),
        (format!("POST /solve HTTP/1.1\r\n{host}\r\nX-Bsm-Token: {}", &token[..31]), 403),
        (format!("GET / HTTP/1.1\r\n{host}"), 403),
        (format!("GET /?token=wrong HTTP/1.1\r\n{host}"), 403),
        // In a DNS rebinding attack, the host name of another site resolves to the address of this
        // server.
        (format!("POST /solve HTTP/1.1\r\nHost: evil.example:{port}\r\nX-Bsm-Token: {token}"), 403),
        (format!("POST /solve HTTP/1.1\r\nX-Bsm-Token: {token}\r\nHost: 127.0.0.1:1"), 403),
        (
            format!(
                "POST /solve HTTP/1.1\r\n{host}\r\nX-Bsm-Token: {token}\r\nOrigin: https://evil.example"
            ),
            403,
        ),
        (format!("POST /solve HTTP/1.1\r\n{host}\r\nX-Bsm-Token: {token}\r\nOrigin: null"), 403),
        (format!("OPTIONS /solve HTTP/1.1\r\n{host}\r\nX-Bsm-Token: {token}"), 405),
        (format!("GET /solve HTTP/1.1\r\n{host}\r\nX-Bsm-Token: {token}"), 404),
        (format!("PUT /solve HTTP/1.1\r\n{host}\r\nX-Bsm-Token: {token}"), 405),
    ] {
        let (status, answer) = served.send(&head, &body);
        assert_eq!(status, expected, "{head}\n{answer}");
        assert!(status == 200 || answer.contains("\"error\""), "{answer}");
    }
}

#[test]
fn invalid_requests_return_the_same_messages_as_the_command_line() {
    let served = TestServer::start(None);
    let mut bad = example_request();
    bad["case"]["ball_diameter_mm"] = json!(-3.5);
    let mut unknown = example_request();
    unknown["case"]["ball_diametre_mm"] = json!(6.0);
    let with = |member: &str, value: Value| {
        let mut request = example_request();
        request[member] = value;
        request
    };
    let model = with("settings", json!({ "name": "elastisch" }));
    let setting = with("settings", json!({ "model": "rigid" }));
    let large = json!({ "case": { "description": "x".repeat(1 << 20) } });
    let many = {
        let mut many = example_request();
        many["vary"] = json!(["screw_speed_rpm=1:1000:1000", "axial_load_N=1:1000:1000"]);
        many["columns"] = json!(["efficiency"]);
        many
    };
    for (route, body, status, words) in [
        ("solve", &bad, 400, "`ball_diameter_mm` = -3.5 must be a finite number > 0"),
        ("solve", &unknown, 400, "did you mean `ball_diameter_mm`"),
        ("solve", &model, 400, "elastisch"),
        ("solve", &setting, 400, "`model` is not a setting; the settings are name, tolerance"),
        ("solve", &json!({}), 400, "case is missing"),
        ("solve", &json!({ "case": 1 }), 400, "`case` must be an object"),
        ("solve", &with("parts", json!("no")), 400, "parts: invalid type"),
        ("solve", &with("bands", json!(true)), 400, "unknown field `bands`"),
        ("sweep", &example_request(), 400, "vary is missing"),
        ("solve", &json!([1]), 400, "list"),
        ("elsewhere", &example_request(), 404, "unknown route `elsewhere`"),
        ("solve", &large, 413, "1048576 bytes"),
        ("sweep", &many, 400, "1000000 points"),
        ("save", &example_request(), 400, "-o CASE.json"),
    ] {
        let (found, answer) = served.post(route, body);
        let text = answer["error"].as_str().expect("words");
        assert!(found == status && text.contains(words), "{route}: {found} {text}");
    }
    // The page marks the field of the invalid input.
    for (request, key) in [(&bad, json!("ball_diameter_mm")), (&setting, json!("model"))] {
        assert_eq!(served.post("solve", request).1["key"], key);
    }
    assert_eq!(served.post("solve", &json!({})).1["key"], Value::Null);
    let (status, answer) = served.send(&served.head("POST /solve"), "{\"case\": {");
    assert!(status == 400 && answer.contains("is not valid JSON"), "{status} {answer}");
}

#[test]
fn server_answers_match_the_commands() {
    let served = TestServer::start(None);
    let (status, solved) = served.post("solve", &example_request());
    assert_eq!(status, 200, "{solved}");
    let work = &mut bsm_dyn::ModelWorkspace::default();
    let problem = case().problem(&Settings::default()).expect("a problem");
    let record = bsm_case::Record::new(problem.solve(work));
    for (name, value) in &record.to_json() {
        assert_eq!(&solved[name], value, "{name}");
    }
    let mut request = example_request();
    request["vary"] = json!(["screw_speed_rpm=500:1500:2", "axial_load_N=8000,9000"]);
    request["columns"] = json!(["efficiency"]);
    let (status, map) = served.post("sweep", &request);
    assert_eq!(status, 200, "{map}");
    assert_eq!(map["axes"][1]["values"], json!([8000.0, 9000.0]));
    // The third point of the map is the case itself. Rows of a sweep agree with single solves to
    // within 1e-10.
    let [point, solved] = [&map["columns"]["efficiency"][2], &solved["efficiency"]];
    let [point, solved] = [point, solved].map(|value| value.as_f64().expect("a number"));
    assert!((point - solved).abs() < 1e-10, "{point} {solved}");
    for route in ["compare", "slip", "ellipses", "schema"] {
        let (status, answer) = served.post(route, &example_request());
        assert!(status == 200 && answer.get("error").is_none(), "{route}: {answer}");
    }
    // After every change, the page requests `point`, which must return all results of a point
    // except for the torque contributions.
    let (_, point) = served.post("point", &example_request());
    let mut request = example_request();
    request["parts"] = json!(false);
    for route in ["solve", "slip", "ellipses"] {
        assert_eq!(point[route], served.post(route, &request).1, "{route}");
    }
    let oil = json!({ "case": example_case("feed_drive_oil.json").to_json(), "band": true });
    let (_, answer) = served.post("solve", &oil);
    assert!(answer["band"]["ball_torque_Nm"]["low"].is_number(), "{answer}");
    let (_, fields) = served.post("ellipses", &oil);
    assert_eq!(fields["contacts"].as_array().map(Vec::len), Some(2), "{fields}");
    let (_, nut) =
        served.post("nut", &json!({ "case": example_case("nut_double.json").to_json() }));
    assert!(
        nut["balls"]["nut_plus_N"]["values"].as_array().is_some_and(|balls| balls.len() > 10),
        "{nut}"
    );
    let sized = |sheet: bool| {
        let request = json!({ "case": example_case("axis.json").to_json(), "sheet": sheet });
        served.post("axis", &request).1
    };
    let axis = sized(true);
    assert!(axis["rules"].as_array().is_some_and(|rules| rules.len() > 8), "{axis}");
    assert!(axis["sheet"].as_str().is_some_and(|page| page.starts_with("<!doctype html>")));
    assert!(sized(false).get("sheet").is_none());
}

/// For a lubricated contact, the friction that the page draws must be the friction in the model:
/// the integral of friction times sliding speed must equal the sliding power.
#[test]
fn drawn_friction_matches_the_power_loss_of_the_model() {
    let served = TestServer::start(None);
    let oil = json!({ "case": example_case("feed_drive_oil.json").to_json() });
    let ((_, solved), (_, fields)) = (served.post("solve", &oil), served.post("ellipses", &oil));
    let number = |value: &Value| value.as_f64().expect("a number");
    let (mut lost, mut balls) = (0.0, 0.0);
    for contact in fields["contacts"].as_array().expect("contacts") {
        let list = |name: &str| contact[name].as_array().expect("a field").clone();
        let [pressure, v_a, v_t, f_a, f_t] = [
            "pressure_MPa",
            "slip_across_m_s",
            "slip_along_m_s",
            "friction_across",
            "friction_along",
        ]
        .map(list);
        let (mut power, mut load) = (0.0, 0.0);
        for i in (0..pressure.len()).filter(|i| !pressure[*i].is_null()) {
            let p = number(&pressure[i]);
            load += p;
            power -= p * (number(&v_a[i]) * number(&f_a[i]) + number(&v_t[i]) * number(&f_t[i]));
        }
        lost += power / load * number(&contact["normal_load_N"]);
        balls = number(&solved["inputs"]["loaded_balls"]);
    }
    let sliding = number(&solved["sliding_power_W"]);
    // The integrand has a kink at the edge of the ellipse, so the integral over a grid of 49 points
    // per side has an error of a few percent.
    assert!((lost * balls / sliding - 1.0).abs() < 0.05, "{} {sliding}", lost * balls);
}

/// Returns the request for a map that takes minutes to calculate on one core: forty thousand points
/// with a lubricated ball and the highest accuracy.
fn long_map() -> Value {
    json!({
        "case": example_case("feed_drive_oil.json").to_json(),
        "settings": { "name": "traction", "accuracy": 1e-13 },
        "vary": ["screw_speed_rpm=100:3000:200", "axial_load_N=1000:20000:200"],
        "columns": ["efficiency"],
    })
}

#[test]
fn a_map_that_takes_too_long_ends_with_a_message() {
    let served = TestServer::start(None);
    let (status, answer) = served.post("sweep", &long_map());
    let text = answer["error"].as_str().expect("words");
    assert!(status == 503 && text.contains("stopped after 2 s"), "{status} {text}");
    // After the map has been stopped, the solver threads must be available again.
    let (status, answer) = served.post("solve", &example_request());
    assert_eq!(status, 200, "{answer}");
}

/// Regression test: after the user moved a slider, the calculation of the previous map continued
/// for 2 s and delayed the new results.
#[test]
fn newer_request_from_a_page_cancels_the_previous_one() {
    let served = TestServer::start(None);
    let post = |route: &str, id: &str| {
        format!("{}\r\nX-Bsm-Request: {id}", served.head(&format!("POST /{route}")))
    };
    thread::scope(|scope| {
        let old = scope.spawn(|| served.send(&post("sweep", "a/1"), &long_map().to_string()));
        // A newer request cannot stop the map before the calculation of the map has started, so the
        // loop repeats the newer request.
        let overtaken = loop {
            thread::sleep(Duration::from_millis(50));
            let (status, answer) =
                served.send(&post("point", "a/2"), &example_request().to_string());
            assert_eq!(status, 200, "{answer}");
            if old.is_finished() {
                break old.join().expect("an answer");
            }
        };
        let (status, answer) = overtaken;
        assert!(status == 409 && answer.contains("replaced"), "{status} {answer}");
    });
}

#[test]
fn cases_are_saved_only_if_saving_is_enabled() {
    let kept = Arc::new(Mutex::new(String::new()));
    let seen = Arc::clone(&kept);
    let save: Save = Box::new(move |text| {
        let mut kept = seen.lock().map_err(|error| error.to_string())?;
        text.clone_into(&mut kept);
        Ok(())
    });
    let served = TestServer::start(Some(save));
    let (status, answer) = served.post("save", &example_request());
    assert_eq!((status, &answer["saved"]), (200, &json!(true)));
    let text = kept.lock().expect("a text").clone();
    assert_eq!(Case::from_json(text.as_bytes()).expect("a case"), case());
    // Regression test: a case without inputs overwrote the saved case.
    let (status, answer) = served.post("save", &json!({ "case": {} }));
    assert!(status == 400 && answer["error"].is_string(), "{status} {answer}");
    assert_eq!(*kept.lock().expect("a text"), text);
}

/// Regression test: a request with an excessive length in its header ended the program even without
/// a token, and a header of 100 MB was read completely.
#[test]
fn oversized_requests_are_rejected() {
    let served = TestServer::start(None);
    let open = format!("Host: 127.0.0.1:{}\r\n", served.port);
    let known = format!("{open}X-Bsm-Token: {}\r\n", served.token);
    let much = "Content-Length: 1000000000000000\r\n";
    for (line, lines, expected) in [
        ("GET /", format!("Host: x\r\n{much}"), 403),
        ("POST /solve", format!("{open}{much}"), 403),
        ("POST /solve", format!("{known}{much}"), 413),
        ("POST /solve", format!("{known}Content-Length: 99999999999999999999999\r\n"), 400),
        ("POST /solve", format!("{known}Content-Length: -1\r\n"), 400),
        ("POST /solve", format!("{known}Transfer-Encoding: chunked\r\n"), 411),
        ("GET /", format!("{open}X: {}\r\n", "x".repeat(1 << 20)), 431),
        ("GET /", format!("{open}{}", "X: x\r\n".repeat(100)), 431),
        ("GET /", "no colon\r\n".to_owned(), 400),
    ] {
        let (status, answer) = served.send(&format!("{line} HTTP/1.1\r\n{lines}X-End: 1"), "");
        assert_eq!(status, expected, "{line} {answer}");
        assert!(answer.contains("\"error\""), "{answer}");
    }
    assert_eq!(served.post("solve", &example_request()).0, 200);
}

/// Regression test: eight clients that sent no request body or did not read their responses blocked
/// all other clients.
#[test]
fn slow_clients_do_not_delay_other_clients() {
    let served = TestServer::start(None);
    let connect = |request: &str| {
        let mut stream = TcpStream::connect(("127.0.0.1", served.port)).expect("a connection");
        stream.write_all(request.as_bytes()).expect("a request");
        stream
    };
    let post = served.head("POST /solve");
    let page = format!("{}\r\n\r\n", served.head("GET /"));
    let silent: Vec<_> =
        (0..40).map(|_| connect(&format!("{post}\r\nContent-Length: 5000\r\n\r\n{{"))).collect();
    let begun: Vec<_> = (0..40).map(|_| connect("GET / HTTP/1.1\r\nHost")).collect();
    let deaf: Vec<_> = (0..40).map(|_| connect(&page)).collect();
    assert_eq!(served.post("solve", &example_request()).0, 200);
    for mut stream in [silent, begun].into_iter().flatten() {
        // After a timeout, the server must send responses to slow clients and disconnect them.
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("text");
        assert!(answer.starts_with("HTTP/1.1 408 "), "{answer}");
    }
    drop(deaf);
}

/// The page must send requests only to its own server, and the text of a case must not be able to
/// end a script element.
#[test]
fn the_page_is_self_contained() {
    let mut case = case();
    case.description = Some("</script><script>alert(1)</script>".to_owned());
    let served = TestServer::start(None);
    let (status, page) = served.send(&served.head("GET /"), "");
    assert_eq!(status, 200);
    assert!(page.contains("connect-src 'self'"));
    for mark in ["src=\"http", "href=\"http", "@import", "url(http"] {
        assert!(!page.contains(mark), "{mark}");
    }
    let solver = bsm_view::PageSolver { version: "", module: "AGFzbQ==" };
    let page = bsm_view::saved(&case, &[], &Settings::default(), &solver);
    assert!(page.contains("connect-src 'none'"));
    assert!(page.contains("id=\"solver\">AGFzbQ==</script>"));
    assert!(!page.contains("<script>alert"), "a text of the case is part of the page");
    assert!(page.contains("\\u003c/script>"));
}
