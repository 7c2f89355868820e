//! The page as a single HTML file, which contains all modules, libraries and data. The page sends
//! requests only to its own server.

use bsm_case::Case;
use bsm_report::STYLE;
use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};
use serde_json::{Map, Value, json};

const HTML: &str = include_str!("../page/index.html");
const CSS: &str = include_str!("../page/page.css");

/// JavaScript modules, with the names under which they import each other.
const MODULES: [(&str, &str); 17] = [
    ("three", include_str!("../page/vendor/three.js")),
    ("bsm/app", include_str!("../page/app.js")),
    ("bsm/source", include_str!("../page/source.js")),
    ("bsm/solver", include_str!("../page/solver.js")),
    ("bsm/draw", include_str!("../page/draw.js")),
    ("bsm/inputs", include_str!("../page/inputs.js")),
    ("bsm/results", include_str!("../page/results.js")),
    ("bsm/space", include_str!("../page/space.js")),
    ("bsm/section", include_str!("../page/section.js")),
    ("bsm/ellipses", include_str!("../page/ellipses.js")),
    ("bsm/losses", include_str!("../page/losses.js")),
    ("bsm/map", include_str!("../page/map.js")),
    ("bsm/models", include_str!("../page/models.js")),
    ("bsm/nut", include_str!("../page/nut.js")),
    ("bsm/axis", include_str!("../page/axis.js")),
    ("bsm/comparison", include_str!("../page/comparison.js")),
    ("bsm/save", include_str!("../page/save.js")),
];

/// Characters that must be percent-encoded in a `data:` URL inside JSON inside HTML.
const ESCAPED: &AsciiSet = &CONTROLS.add(b'%').add(b'#').add(b'"').add(b'\\').add(b'<').add(b'&');

/// Returns the additional cases, which the page compares with its own case.
pub(crate) fn cases(beside: &[Case]) -> Value {
    beside.iter().map(|case| json!({ "case": case.to_json() })).collect()
}

/// Returns the HTML page together with its initial data.
///
/// * `solver`: the WebAssembly module in base64. If it is missing, a server answers the requests.
pub(crate) fn html(start: &Value, solver: Option<&str>) -> String {
    let address = |text: &str| {
        json!(format!("data:text/javascript;charset=utf-8,{}", utf8_percent_encode(text, ESCAPED)))
    };
    let imports: Map<_, _> =
        MODULES.iter().map(|(name, text)| ((*name).to_owned(), address(text))).collect();
    let solver = solver.map(|module| {
        format!("<script type=\"application/octet-stream\" id=\"solver\">{module}</script>\n")
    });
    // The data must not contain an HTML end tag, because such a tag would end the script element.
    let data = start.to_string().replace('<', "\\u003c");
    // Each placeholder occurs once. The initial data are inserted last, because they may contain
    // text that looks like a placeholder.
    HTML.replacen("@STYLE@", &format!("{STYLE}{CSS}"), 1)
        .replacen("@CONNECT@", if solver.is_none() { "'self'" } else { "'none'" }, 1)
        .replacen("@IMPORTS@", &json!({ "imports": imports }).to_string(), 1)
        .replacen("@SOLVER@", &solver.unwrap_or_default(), 1)
        .replacen("@START@", &data, 1)
}
