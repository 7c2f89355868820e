// The source of answers: the server of this page, or the answers in the saved file.

export const start = JSON.parse(document.getElementById("start").textContent);

/** The request violates a rule. The message is the same as on the command line. */
export class Refused extends Error {}

/** The server no longer answers. */
export class Gone extends Error {
  constructor() { super("The server has ended. Start `bsm view` again and open its new address. This page keeps its last numbers."); }
}

/** Identifies this page to the server. */
const tab = start.live ? crypto.randomUUID() : "";

/** Sends a request to the server. A later turn of this page cancels requests of earlier turns. */
async function served(route, body, turn, signal) {
  let response;
  const headers = { "Content-Type": "application/json", "X-Bsm-Token": start.token, "X-Bsm-Turn": `${tab}/${turn}` };
  try {
    response = await fetch(`/${route}`, { method: "POST", headers, body: JSON.stringify(body), signal });
  } catch (error) {
    throw signal?.aborted ? error : new Gone();
  }
  const answer = await response.json();
  if (!response.ok) throw new Refused(answer.error);
  // Time of the server [ms].
  answer.took = Number(response.headers.get("Server-Timing")?.match(/dur=([\d.]+)/)?.[1] ?? 0);
  return answer;
}

/** Returns the slider stop nearest to a case, as indices on the axes. */
export function stopOf(entries) {
  return start.answers.axes?.map(([name, values]) => {
    const far = (v) => Math.abs(Math.log(v / entries[name]));
    return values.reduce((best, v, i) => (far(v) < far(values[best]) ? i : best), 0);
  });
}

/** Returns true if results of a case are available. A saved file contains the results of its own case at its slider stops. */
export function holds(entries) {
  const free = start.live ? Object.keys(entries) : start.answers.axes?.map(([name]) => name) ?? [];
  const fixed = (of) => JSON.stringify(Object.entries(of).filter(([name]) => !free.includes(name)).sort());
  return start.live || fixed(entries) === fixed(start.case);
}

/** Reads an answer from the saved file. */
function kept(route, body) {
  const axes = start.answers.axes;
  const stop = axes && stopOf(body.case);
  const middle = !axes || stop.every((place, i) => place === (axes[i][1].length - 1) / 2);
  const here = middle ? start.answers : start.stops[stop[0] * axes[1][1].length + stop[1]];
  const answer = route === "sweep" ? start.map : here[route];
  if (!answer) throw new Refused("This file contains these numbers only for its own case. Use bsm view to calculate them live.");
  if (answer.error) throw new Refused(answer.error);
  // The grooves are the same at every stop.
  return route === "point" ? { ...answer, solve: { ...answer.solve, section: start.answers.point.solve.section } } : answer;
}

export const ask = start.live ? served : async (route, body) => kept(route, body);
