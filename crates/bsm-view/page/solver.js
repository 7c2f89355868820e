// The solver of a saved page: a WebAssembly module that runs in workers.

/** Maximum number of requests that are processed at the same time. */
const MAX_RUNNING = Math.max(2, navigator.hardwareConcurrency ?? 2);
/** Time limit for an answer [s]. Warm states for all possible grooves take the longest time. */
const TIME_LIMIT = 120;

/**
 * The program of a worker. For each request, it creates a new instance of the module. Through the interface
 * WASI, the instance reads the request from its standard input and writes the answer to its standard output.
 */
function work() {
  const run = async (module, request) => {
    const input = new TextEncoder().encode(request);
    const output = new TextDecoder();
    let read = 0;
    let answer = "";
    let memory;
    const view = () => new DataView(memory.buffer);
    const bytes = (at, count) => new Uint8Array(memory.buffer, at, count);
    /** Calls `act` with each buffer of a list, and stores the sum of its results. */
    const each = (list, count, sum, act) => {
      let total = 0;
      for (let i = 0; i < count; i += 1)
        total += act(bytes(view().getUint32(list + 8 * i, true), view().getUint32(list + 8 * i + 4, true)));
      view().setUint32(sum, total, true);
      return 0;
    };
    const wasi_snapshot_preview1 = {
      fd_read: (file, list, count, sum) =>
        each(list, count, sum, (buffer) => {
          const part = input.subarray(read, read + buffer.length);
          buffer.set(part);
          read += part.length;
          return part.length;
        }),
      fd_write: (file, list, count, sum) =>
        each(list, count, sum, (buffer) => {
          if (file === 1) answer += output.decode(buffer, { stream: true });
          return buffer.length;
        }),
      clock_time_get: (clock, precision, time) => {
        view().setBigUint64(time, BigInt(Math.round(1e6 * performance.now())), true);
        return 0;
      },
      random_get: (at, count) => {
        crypto.getRandomValues(bytes(at, count));
        return 0;
      },
      // There are no environment variables.
      environ_sizes_get: (count, size) => {
        view().setUint32(count, 0, true);
        view().setUint32(size, 0, true);
        return 0;
      },
      environ_get: () => 0,
      // There are no folders. EBADF is 8.
      fd_prestat_get: () => 8,
      fd_prestat_dir_name: () => 8,
      fd_close: () => 0,
      sched_yield: () => 0,
      proc_exit: (code) => {
        throw new Error(`exit code ${code}`);
      },
    };
    const { exports } = await WebAssembly.instantiate(module, { wasi_snapshot_preview1 });
    memory = exports.memory;
    exports._start();
    return answer;
  };
  onmessage = async ({ data: { module, request } }) => {
    try {
      postMessage({ answer: await run(module, request) });
    } catch (error) {
      postMessage({ error: String(error) });
    }
  };
}

/** Decompresses and compiles the module that the page contains. */
async function compile() {
  const packed = Uint8Array.from(atob(document.getElementById("solver").textContent), (letter) =>
    letter.charCodeAt(0),
  );
  const plain = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(plain).arrayBuffer());
}

let compiled;
let address;
let running = 0;
const idle = [];
const waiting = [];

/** Starts waiting requests until the maximum number of requests is running. */
function next() {
  while (waiting.length && running < MAX_RUNNING) waiting.shift()();
}

/** Returns the answer to a request as text. `signal` stops the calculation. */
export async function solved(route, body, signal) {
  const module = await (compiled ??= compile());
  address ??= URL.createObjectURL(new Blob([`(${work})()`], { type: "text/javascript" }));
  return new Promise((then, fail) => {
    waiting.push(() => {
      if (signal?.aborted) {
        fail(signal.reason);
        return;
      }
      running += 1;
      const worker = idle.pop() ?? new Worker(address);
      const end = () => {
        clearTimeout(timer);
        signal?.removeEventListener("abort", abort);
        running -= 1;
        next();
      };
      const stop = (error) => {
        worker.terminate();
        fail(error);
        end();
      };
      const abort = () => stop(signal.reason);
      const tooLong =
        `stopped after ${TIME_LIMIT} s, because this point takes too long for the page; ` +
        "the command line has no such limit";
      const timer = setTimeout(() => stop(new Error(tooLong)), 1000 * TIME_LIMIT);
      const failed = (words) =>
        stop(new Error(`the solver ended unexpectedly (${words}); please report this case`));
      signal?.addEventListener("abort", abort);
      worker.onmessage = ({ data: { answer, error } }) => {
        if (error) {
          failed(error);
          return;
        }
        idle.push(worker);
        then(answer);
        end();
      };
      worker.onerror = ({ message }) => failed(message);
      worker.postMessage({ module, request: `${route}\n${body}` });
    });
    next();
  });
}
