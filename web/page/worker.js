// A worker of the page: it runs one task at a time, so that the page stays responsive.
// The first message brings the bindings and the compiled program; sessions, tasks and the program's later part follow.

import { fetchLaterNow, join, NOT_THERE } from "./{{asset:later.js}}";

let program;

/** Why the later part of the program could not be loaded when a task needed it. */
let lacking = "";

async function begin({ bindings, module, later }) {
  const loaded = await import(bindings);
  const exports = await loaded.default({ module_or_path: module });
  const take = (later) => join(exports, later);
  loaded.load_later_with(() => {
    try {
      take(fetchLaterNow());
    } catch (error) {
      lacking = `${NOT_THERE}: ${error.message}`;
      throw error;
    }
  });
  if (later) {
    take(later);
  }
  return { ...loaded, take };
}

async function runTask({ id, name, input }) {
  const { perform, kept_sessions, last_panic } = await program;
  const report = (activity, fraction) => postMessage({ id, activity, fraction });
  try {
    const outcome = perform(name, new Uint8Array(input), report);
    if (Array.isArray(outcome)) {
      postMessage({ id, unknown: outcome });
    } else {
      postMessage({ id, outcome: outcome.buffer, kept: kept_sessions() }, [outcome.buffer]);
    }
  } catch (error) {
    postMessage(lacking ? { id, lacking } : { id, fault: last_panic() ?? String(error) });
  }
}

onmessage = async ({ data }) => {
  if (data.module) {
    program = begin(data);
    program.catch((error) => postMessage({ broken: String(error) }));
  } else if (data.later) {
    const { take } = await program;
    take(data.later);
  } else if (data.session) {
    const { keep_session, last_panic } = await program;
    try {
      keep_session(new Uint8Array(data.session));
    } catch (error) {
      postMessage(lacking ? { lacking } : { fault: last_panic() ?? String(error) });
    }
  } else {
    await runTask(data);
  }
};
