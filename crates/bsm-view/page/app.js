// The page shows one case in all panels. Every change sends a new request.

import { display, html, narrow, parsed } from "bsm/draw";
import { ask, Gone, served, start } from "bsm/source";
import { Inputs } from "bsm/inputs";
import { showKey, showNumbers } from "bsm/results";
import { Space } from "bsm/space";
import { showSection } from "bsm/section";
import { Ellipses } from "bsm/ellipses";
import { showLosses } from "bsm/losses";
import { ModelMap } from "bsm/map";
import { showModels } from "bsm/models";
import { showNut, showWarm } from "bsm/nut";
import { showAxis } from "bsm/axis";
import { Beside } from "bsm/beside";
import { download, offer } from "bsm/save";

const at = (id) => document.getElementById(id);
const panels = ["key", "space", "section", "ellipses", "losses", "map", "models", "nut", "axis", "beside", "numbers"];
const space = new Space(at("space")), ellipses = new Ellipses(at("ellipses"));
const inputs = new Inputs(at("inputs"), () => changed());
const map = new ModelMap(at("map"), { moved: (values) => inputs.put(values),
  ask: (route, body, signal) => ask(route, body, turn, signal),
  again: () => { turn += 1; clearTimeout(slow); remember(); void rest(); } });
const beside = new Beside(at("beside"), { edit: (entries) => load(entries), changed: () => { turn += 1; clearTimeout(slow); remember(); void rest(); } });
let settings = { ...start.settings };

/** Selects the display units of a case for all pictures. */
const inUnitsOf = (entries) => display(start.schema.display[entries.display_units]);

/** Returns the body of a request: the case and the settings. */
const request = () => ({ case: inputs.case, settings });

// --- Requests are sent in rounds, one round at a time. If the case changes during a round, the next round starts when the current
// round ends. Each round first requests the numbers. The pictures follow in the next frame, and the slow panels follow when the case
// no longer changes. Any change of the case cancels the requests for slow panels.
let turn = 0, running = false, slow, late = new AbortController();

function changed() {
  turn += 1; late.abort(); clearTimeout(slow);
  at("json").value = JSON.stringify(inputs.case, null, 2);
  title();
  remember();
  space.hold(true);
  if (!running) void follow();
}

/** Returns the answer, or the error if the request fails. */
const attempt = (route, body, signal) => ask(route, body, turn, signal).catch((error) => error);

/** Waits until the next frame is drawn. A hidden page does not wait, because it draws no frames. */
const frame = () => new Promise((then) => { const go = () => setTimeout(then); if (document.hidden) go(); else requestAnimationFrame(go); });

/** Sends requests until the page shows the current case and settings. */
async function follow() {
  running = true;
  let drawn = Promise.resolve(), asked;
  while (asked !== turn) {
    asked = turn;
    const body = structuredClone(request()), point = await attempt("point", body);
    await drawn;
    try { tell(body, point); } catch (error) { complain(error); console.error(error); }
    drawn = frame().then(() => { if (!(point instanceof Error)) picture(body, point); }).catch((error) => { complain(error); console.error(error); });
  }
  await drawn;
  running = false;
  // If the case changed while the last picture was being drawn, a new round starts.
  if (asked !== turn) void follow(); else slow = setTimeout(() => void rest(), 120);
}

function complain(error) {
  const alert = at("alert");
  alert.hidden = !error;
  if (!error) { inputs.blame(null); return; }
  const named = !(error instanceof Gone) && inputs.blame(error.message);
  alert.textContent = error.message;
  alert.dataset.named = named;
}

const stale = (ids, on) => ids.forEach((id) => at(id).classList.toggle("stale", on));

let shown = { solved: null, nut: null };

/** Shows the numbers, and the pictures that are drawn quickly. */
function tell({ case: entries }, point) {
  if (point instanceof Error) { complain(point); stale(panels, true); return; }
  const { solve: solved, slip } = point;
  complain(null);
  inUnitsOf(entries);
  stale(["key", "space", "section", "ellipses", "losses", "numbers"], false);
  shown.solved = solved;
  at("regime").textContent = solved.regime ?? "";
  showKey(at("key"), solved);
  showNumbers(at("numbers"), solved);
  showSection(at("section"), entries, solved);
  showLosses(at("losses"), solved, slip);
  beside.show(entries, solved);
  map.point(entries);
}

function picture({ case: entries }, { solve: solved, ellipses: fields }) {
  ellipses.show(fields);
  space.show(entries, solved, shown.nut);
}

/** Updates the slow panels. */
async function rest() {
  if (running) return;
  space.hold(false);
  if (!at("alert").hidden) return;
  late.abort(); late = new AbortController();
  const { signal } = late, body = structuredClone(request());
  const then = (route, more, act) => attempt(route, { ...body, ...more }, signal).then((answer) => { if (!signal.aborted) act(answer); });
  const banded = shown.solved?.equivalent_friction_coefficient != null;
  await Promise.all([
    then("compare", {}, (answer) => { showModels(at("models"), answer, shown.solved); stale(["models"], false); }),
    then("nut", {}, (answer) => {
      shown.nut = answer instanceof Error ? null : answer;
      showNut(at("nut"), answer); stale(["nut"], false);
      space.show(body.case, shown.solved, shown.nut);
      if (answer.warm) void then("warm", {}, (branch) => showWarm(at("nut"), branch, answer));
    }),
    then("axis", {}, (answer) => {
      // A case without axis inputs is only a screw, although some rules of an axis apply to it.
      at("axis").parentElement.hidden = !start.schema.inputs.some(({ group, name }) => group === "axis" && name in body.case);
      showAxis(at("axis"), answer, () => sheet(body)); stale(["axis"], false);
    }),
    beside.solve((entries) => attempt("point", { case: entries, settings: body.settings }, signal).then((answer) => answer.solve ?? answer)),
    banded ? then("solve", { parts: false, band: true },
      (answer) => { if (!(answer instanceof Error)) { showKey(at("key"), answer);
        showLosses(at("losses"), answer, null); } }) : null,
  ]);
  // The map is requested last, because its calculation uses all cores.
  if (!signal.aborted) await map.show(body, signal);
  if (signal.aborted) return;
  stale(["map"], false);
  document.documentElement.dataset.settled = String(Number(document.documentElement.dataset.settled ?? 0) + 1);
}

/** Opens the axis sheet as a separate page. */
async function sheet(body) {
  const answer = await attempt("axis", { ...body, sheet: true });
  if (answer instanceof Error) complain(answer);
  return answer.sheet;
}

// --- The address contains the state of the page, so that reloading the page or opening a link restores this state.
const state = () => ({ case: inputs.case, settings, map: map.choice(), beside: beside.kept.map(({ case: entries }) => entries) });
let usual, remembering;

function remember() {
  clearTimeout(remembering);
  remembering = setTimeout(() => {
    const words = JSON.stringify(state());
    history.replaceState(null, "", words === usual ? location.pathname + location.search : `#${encodeURIComponent(words)}`);
  }, 150);
}

/** Restores the state of the page from the address. */
function recall() {
  if (location.hash.length < 2) return false;
  try {
    const { case: entries, settings: set, map: choice, beside: cases } = JSON.parse(decodeURIComponent(location.hash.slice(1)));
    Object.assign(settings, set);
    head();
    beside.take(cases.map((entries) => ({ case: entries })));
    load(entries, choice);
    return true;
  } catch (error) { complain(new Error(`The part of the address after # is invalid: ${error.message}`)); return false; }
}

// --- The page header.
function title() {
  const words = inputs.case.description ?? "A ball screw";
  at("title").textContent = words; document.title = `${words} – bsm`;
}

function head() {
  at("model").value = settings.name; at("tolerance").value = settings.tolerance;
  at("tolerance-label").hidden = settings.name !== "auto";
}

at("model").append(...start.schema.models.map((name) => html("option", { value: name }, name)));
head();
const set = () => { head(); beside.forget(); changed(); };
const setModel = () => { settings.name = at("model").value; set(); };
at("model").addEventListener("change", setModel);
at("tolerance").addEventListener("change",
  () => { const value = parsed(at("tolerance").value);
    settings.tolerance = Number.isNaN(value) ? start.settings.tolerance : value; set(); });

const say = (button, words) => { const former = button.textContent; button.textContent = words; setTimeout(() => { button.textContent = former; }, 1200); };
at("copy").addEventListener("click", async () => {
  try { await navigator.clipboard.writeText(at("json").value);
    say(at("copy"), "Copied"); } catch { at("json").closest("details").open = true; at("json").select();
    say(at("copy"), "Select and copy"); }
});
at("reset").addEventListener("click", () => load(start.case));
// Saves the case to the file that the option -o specifies. Without this option, the browser downloads the case.
at("save").addEventListener("click", async () => {
  if (!start.save) { download("case.json", new Blob([`${at("json").value}\n`], { type: "application/json" })); return; }
  const answer = await attempt("save", request());
  if (answer instanceof Error) complain(answer); else say(at("save"), "Saved");
});

function load(entries, choice) {
  inUnitsOf(entries);
  inputs.show(entries);
  map.choices(entries, choice);
  changed();
}

function read(words, from) {
  try {
    const entries = JSON.parse(words);
    if (typeof entries !== "object" || entries === null || Array.isArray(entries)) throw new Error("a case must be a JSON object");
    load(entries);
  } catch (error) { complain(new Error(`${from}: ${error.message}`)); }
}
at("apply").addEventListener("click", () => read(at("json").value, "case"));
at("file").addEventListener("change", async (event) => { const [file] = event.target.files;
  if (file) read(await file.text(), file.name); event.target.value = ""; });
for (const [kind, on] of [["dragover", true], ["dragleave", false], ["drop", false]])
  document.addEventListener(kind, async (event) => {
    event.preventDefault();
    document.body.classList.toggle("drop", on);
    // The browser empties the list of files as soon as the event has been handled.
    const [file] = kind === "drop" ? event.dataTransfer.files : [];
    if (file) read(await file.text(), file.name);
  });
if (innerWidth < 960) at("inputs-fold").open = false;
at("about").textContent =
  `${start.program}. The solver runs ${served ? "on this machine" : "in this page"}, and no data leave the machine.`;
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { if (shown.solved) changed(); });
let width = innerWidth, phone = narrow();
addEventListener("resize", () => {
  if (innerWidth === width) return;
  width = innerWidth; ellipses.draw(); map.draw();
  if (narrow() !== phone) { phone = narrow(); if (shown.solved) changed(); }
});

for (const panel of document.querySelectorAll(".panel")) offer(panel);
addEventListener("hashchange", () => recall());
beside.take(start.beside);
inUnitsOf(start.case);
inputs.show(start.case); map.choices(start.case);
usual = JSON.stringify(state());
if (!recall()) load(start.case);
