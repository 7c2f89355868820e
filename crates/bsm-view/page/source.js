// Requests answers from the server of this page or, in a saved page, from the solver in the file.

import { solved } from "bsm/solver";

export const start = JSON.parse(document.getElementById("start").textContent);

/** Inputs and outputs of the program by name, each with its label and its unit. */
export const INPUT = new Map(start.schema.inputs.map((input) => [input.name, input]));
export const OUTPUT = new Map(start.schema.outputs.map((output) => [output.name, output]));

/** True if a server answers the requests; false if this file contains the solver. */
export const served = start.token !== undefined;

/**
 * The request violates a rule. The message is the same as on the command line. `key` is the name of the
 * invalid or missing input, if the name is known.
 */
export class Refused extends Error {
  constructor(message, key) {
    super(message);
    this.key = key;
  }
}

/** The server no longer answers. */
export class ServerStopped extends Error {
  constructor() {
    super(
      "The server has ended. Start `bsm view` again and open its new address. " +
        "This page still shows its last numbers.",
    );
  }
}

/** Random id with which this page identifies itself to the server. */
const tab = served ? crypto.randomUUID() : "";

/** Sends a request to the server, which cancels requests from this page with a lower `requestNumber`. */
async function fromServer(route, body, requestNumber, signal) {
  let response;
  const headers = {
    "Content-Type": "application/json",
    "X-Bsm-Token": start.token,
    "X-Bsm-Request": `${tab}/${requestNumber}`,
  };
  try {
    response = await fetch(`/${route}`, { method: "POST", headers, body: JSON.stringify(body), signal });
  } catch (error) {
    throw signal?.aborted ? error : new ServerStopped();
  }
  const answer = await response.json();
  if (!response.ok) throw new Refused(answer.error, answer.key);
  // Computing time on the server [ms]. Some answers are null and store no time.
  if (answer) answer.took = Number(response.headers.get("Server-Timing")?.match(/dur=([\d.]+)/)?.[1] ?? 0);
  return answer;
}

/** Sends a request to the solver in this file. */
async function fromFile(route, body, requestNumber, signal) {
  const began = performance.now();
  const { answer, error, key } = JSON.parse(await solved(route, JSON.stringify(body), signal));
  if (error !== undefined) throw new Refused(error, key);
  // Time from the request to the answer [ms].
  if (answer) answer.took = performance.now() - began;
  return answer;
}

export const ask = served ? fromServer : fromFile;
