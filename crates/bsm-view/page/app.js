// The page shows one case in all panels. Every change sends a new request.

import { display, html, narrow, parsed } from "bsm/draw";
import { ask, ServerStopped, served, start } from "bsm/source";
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
import { Comparison } from "bsm/comparison";
import { download, offer } from "bsm/save";

const element = (id) => document.getElementById(id);
const panels = [
  "key",
  "space",
  "section",
  "ellipses",
  "losses",
  "map",
  "models",
  "nut",
  "axis",
  "beside",
  "numbers",
];
const space = new Space(element("space"));
const ellipses = new Ellipses(element("ellipses"));
const inputs = new Inputs(element("inputs"), () => changed());
const map = new ModelMap(element("map"), {
  moved: (values) => inputs.put(values),
  ask: (route, body, signal) => ask(route, body, requestNumber, signal),
  again: () => repeatSlowPanels(),
});
const comparison = new Comparison(element("beside"), {
  edit: (entries) => load(entries),
  changed: () => repeatSlowPanels(),
});
let settings = { ...start.settings };

/** Selects the display units of a case for all pictures. */
const inUnitsOf = (entries) => display(start.schema.display[entries.display_units]);

/** Returns the body of a request: the case and the settings. */
const request = () => ({ case: inputs.case, settings });

// --- Requests are sent in rounds, one round at a time. If the case changes during a round, the next round
// starts when the current round ends. Each round first requests the numbers. The pictures follow in the next
// frame, and the slow panels follow when the case no longer changes. Any change of the case cancels the
// requests for slow panels.
let requestNumber = 0;
let running = false;
let slowTimer;
let slowRequests = new AbortController();

function changed() {
  requestNumber += 1;
  slowRequests.abort();
  clearTimeout(slowTimer);
  element("json").value = JSON.stringify(inputs.case, null, 2);
  title();
  remember();
  space.hold(true);
  if (!running) void updateUntilCurrent();
}

/** Updates the slow panels after a change that does not affect the other panels. */
function repeatSlowPanels() {
  requestNumber += 1;
  clearTimeout(slowTimer);
  remember();
  void updateSlowPanels();
}

/** Returns the answer, or the error if the request fails. */
const attempt = (route, body, signal) => ask(route, body, requestNumber, signal).catch((error) => error);

/** Waits until the next frame is drawn. A hidden page does not wait, because it draws no frames. */
const frame = () =>
  new Promise((then) => {
    const go = () => setTimeout(then);
    if (document.hidden) go();
    else requestAnimationFrame(go);
  });

/** Sends requests until the page shows the current case and settings. */
async function updateUntilCurrent() {
  running = true;
  let drawn = Promise.resolve();
  let sentNumber;
  while (sentNumber !== requestNumber) {
    sentNumber = requestNumber;
    const body = structuredClone(request());
    const point = await attempt("point", body);
    await drawn;
    try {
      showPoint(body, point);
    } catch (error) {
      complain(error);
      console.error(error);
    }
    drawn = frame()
      .then(() => {
        if (!(point instanceof Error)) drawPoint(body, point);
      })
      .catch((error) => {
        complain(error);
        console.error(error);
      });
  }
  await drawn;
  running = false;
  // If the case changed while the last picture was being drawn, a new round starts.
  if (sentNumber !== requestNumber) void updateUntilCurrent();
  else slowTimer = setTimeout(() => void updateSlowPanels(), 120);
}

function complain(error) {
  const alert = element("alert");
  alert.hidden = !error;
  if (!error) {
    inputs.blame(null);
    return;
  }
  const named = !(error instanceof ServerStopped) && inputs.blame(error);
  alert.textContent = error.message;
  alert.dataset.named = named;
}

const markStale = (ids, on) => ids.forEach((id) => element(id).classList.toggle("stale", on));

let shown = { solved: null, nut: null };

/** Shows the numbers, and the pictures that are drawn quickly. */
function showPoint({ case: entries }, point) {
  if (point instanceof Error) {
    complain(point);
    markStale(panels, true);
    return;
  }
  const { solve: solved, slip } = point;
  complain(null);
  inUnitsOf(entries);
  markStale(["key", "space", "section", "ellipses", "losses", "numbers"], false);
  shown.solved = solved;
  element("regime").textContent = solved.regime ?? "";
  showKey(element("key"), solved);
  showNumbers(element("numbers"), solved);
  showSection(element("section"), entries, solved);
  showLosses(element("losses"), solved, slip);
  comparison.show(entries, solved);
  map.point(entries);
}

function drawPoint({ case: entries }, { solve: solved, ellipses: fields }) {
  ellipses.show(fields);
  space.show(entries, solved, shown.nut);
}

/** Updates the slow panels. */
async function updateSlowPanels() {
  if (running) return;
  space.hold(false);
  if (!element("alert").hidden) return;
  slowRequests.abort();
  slowRequests = new AbortController();
  const { signal } = slowRequests;
  const body = structuredClone(request());
  const then = (route, more, act) =>
    attempt(route, { ...body, ...more }, signal).then((answer) => {
      if (!signal.aborted) act(answer);
    });
  const banded = shown.solved?.equivalent_friction_coefficient != null;
  await Promise.all([
    then("compare", {}, (answer) => {
      showModels(element("models"), answer, shown.solved);
      markStale(["models"], false);
    }),
    then("nut", {}, (answer) => {
      shown.nut = answer instanceof Error ? null : answer;
      showNut(element("nut"), answer);
      markStale(["nut"], false);
      space.show(body.case, shown.solved, shown.nut);
      if (answer.warm) void then("warm", {}, (branch) => showWarm(element("nut"), branch, answer));
    }),
    then("axis", {}, (answer) => {
      // A case without axis inputs is only a screw, although some rules of an axis apply to it.
      element("axis").parentElement.hidden = !start.schema.inputs.some(
        ({ group, name }) => group === "axis" && name in body.case,
      );
      showAxis(element("axis"), answer, () => sheet(body));
      markStale(["axis"], false);
    }),
    comparison.solve((entries) =>
      attempt("point", { case: entries, settings: body.settings }, signal).then(
        (answer) => answer.solve ?? answer,
      ),
    ),
    banded
      ? then("solve", { parts: false, band: true }, (answer) => {
          if (!(answer instanceof Error)) {
            showKey(element("key"), answer);
            showLosses(element("losses"), answer, null);
          }
        })
      : null,
  ]);
  // The map is requested last, because its calculation uses all cores.
  if (!signal.aborted) await map.show(body, signal);
  if (signal.aborted) return;
  markStale(["map"], false);
  document.documentElement.dataset.settled = String(
    Number(document.documentElement.dataset.settled ?? 0) + 1,
  );
}

/** Opens the axis sheet as a separate page. */
async function sheet(body) {
  const answer = await attempt("axis", { ...body, sheet: true });
  if (answer instanceof Error) complain(answer);
  return answer.sheet;
}

// --- The address contains the state of the page, so that reloading the page or opening a link restores it.
const state = () => ({
  case: inputs.case,
  settings,
  map: map.choice(),
  beside: comparison.kept.map(({ case: entries }) => entries),
});
let usual, remembering;

function remember() {
  clearTimeout(remembering);
  remembering = setTimeout(() => {
    const words = JSON.stringify(state());
    history.replaceState(
      null,
      "",
      words === usual ? location.pathname + location.search : `#${encodeURIComponent(words)}`,
    );
  }, 150);
}

/** Restores the state of the page from the address. */
function recall() {
  if (location.hash.length < 2) return false;
  try {
    const {
      case: entries,
      settings: set,
      map: choice,
      beside: cases,
    } = JSON.parse(decodeURIComponent(location.hash.slice(1)));
    Object.assign(settings, set);
    head();
    comparison.take(cases.map((entries) => ({ case: entries })));
    load(entries, choice);
    return true;
  } catch (error) {
    complain(new Error(`The part of the address after # is invalid: ${error.message}`));
    return false;
  }
}

// --- The page header.
function title() {
  const words = inputs.case.description ?? "A ball screw";
  element("title").textContent = words;
  document.title = `${words} – bsm`;
}

function head() {
  element("model").value = settings.name;
  element("tolerance").value = settings.tolerance;
  element("tolerance-label").hidden = settings.name !== "auto";
}

element("model").append(...start.schema.models.map((name) => html("option", { value: name }, name)));
head();
const set = () => {
  head();
  comparison.forget();
  changed();
};
const setModel = () => {
  settings.name = element("model").value;
  set();
};
element("model").addEventListener("change", setModel);
element("tolerance").addEventListener("change", () => {
  const value = parsed(element("tolerance").value);
  settings.tolerance = Number.isNaN(value) ? start.settings.tolerance : value;
  set();
});

const say = (button, words) => {
  const former = button.textContent;
  button.textContent = words;
  setTimeout(() => {
    button.textContent = former;
  }, 1200);
};
element("copy").addEventListener("click", async () => {
  try {
    await navigator.clipboard.writeText(element("json").value);
    say(element("copy"), "Copied");
  } catch {
    element("json").closest("details").open = true;
    element("json").select();
    say(element("copy"), "Select and copy");
  }
});
element("reset").addEventListener("click", () => load(start.case));
// Saves the case to the file that the option -o specifies. Without this option, the browser downloads it.
element("save").addEventListener("click", async () => {
  if (!start.save) {
    download("case.json", new Blob([`${element("json").value}\n`], { type: "application/json" }));
    return;
  }
  const answer = await attempt("save", request());
  if (answer instanceof Error) complain(answer);
  else say(element("save"), "Saved");
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
    if (typeof entries !== "object" || entries === null || Array.isArray(entries))
      throw new Error("a case must be a JSON object");
    load(entries);
  } catch (error) {
    complain(new Error(`${from}: ${error.message}`));
  }
}
element("apply").addEventListener("click", () => read(element("json").value, "case"));
element("file").addEventListener("change", async (event) => {
  const [file] = event.target.files;
  if (file) read(await file.text(), file.name);
  event.target.value = "";
});
for (const [kind, on] of [
  ["dragover", true],
  ["dragleave", false],
  ["drop", false],
]) {
  document.addEventListener(kind, async (event) => {
    event.preventDefault();
    document.body.classList.toggle("drop", on);
    // The browser empties the list of files as soon as the event has been handled.
    const [file] = kind === "drop" ? event.dataTransfer.files : [];
    if (file) read(await file.text(), file.name);
  });
}
if (innerWidth < 960) element("inputs-fold").open = false;
const place = served ? "on this machine" : "in this page";
element("about").textContent = `${start.program}. The solver runs ${place}, and no data leave the machine.`;
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  if (shown.solved) changed();
});
let width = innerWidth;
let phone = narrow();
addEventListener("resize", () => {
  if (innerWidth === width) return;
  width = innerWidth;
  ellipses.draw();
  map.draw();
  if (narrow() !== phone) {
    phone = narrow();
    if (shown.solved) changed();
  }
});

for (const panel of document.querySelectorAll(".panel")) offer(panel);
addEventListener("hashchange", () => recall());
comparison.take(start.beside);
inUnitsOf(start.case);
inputs.show(start.case);
map.choices(start.case);
usual = JSON.stringify(state());
if (!recall()) load(start.case);
