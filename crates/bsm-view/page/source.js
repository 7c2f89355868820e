// The source of answers: the server of this page, or the solver in the saved file.

import { solved } from "bsm/solver";

export const start = JSON.parse(document.getElementById("start").textContent);

/** True if a server answers the requests. Otherwise this file contains the solver. */
export const served = start.token !== undefined;

/** The request violates a rule. The message is the same as on the command line. */
export class Refused extends Error {}

/** The server no longer answers. */
export class Gone extends Error {
  constructor() { super("The server has ended. Start `bsm view` again and open its new address. This page keeps its last numbers."); }
}

/** Identifies this page to the server. */
const tab = served ? crypto.randomUUID() : "";

/** Sends a request to the server. A later turn of this page cancels requests of earlier turns. */
async function fromServer(route, body, turn, signal) {
  let response;
  const headers = { "Content-Type": "application/json", "X-Bsm-Token": start.token, "X-Bsm-Turn": `${tab}/${turn}` };
  try {
    response = await fetch(`/${route}`, { method: "POST", headers, body: JSON.stringify(body), signal });
  } catch (error) {
    throw signal?.aborted ? error : new Gone();
  }
  const answer = await response.json();
  if (!response.ok) throw new Refused(answer.error);
  // Time of the server [ms]. Some answers are null.
  if (answer) answer.took = Number(response.headers.get("Server-Timing")?.match(/dur=([\d.]+)/)?.[1] ?? 0);
  return answer;
}

/** Sends a request to the solver in this file. */
async function fromFile(route, body, turn, signal) {
  const began = performance.now(), { answer, error } = JSON.parse(await solved(route, JSON.stringify(body), signal));
  if (error !== undefined) throw new Refused(error);
  // Time until the answer has arrived [ms].
  if (answer) answer.took = performance.now() - began;
  return answer;
}

export const ask = served ? fromServer : fromFile;
