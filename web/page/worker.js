// A worker of the page: it runs one task at a time, so that the page stays responsive.
// The first message brings the bindings and the compiled program; sessions and tasks follow.

let program;

async function begin({ bindings, module }) {
  const loaded = await import(bindings);
  await loaded.default({ module_or_path: module });
  return loaded;
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
    postMessage({ id, fault: last_panic() ?? String(error) });
  }
}

onmessage = async ({ data }) => {
  if (data.module) {
    program = begin(data);
    program.catch((error) => postMessage({ broken: String(error) }));
  } else if (data.session) {
    const { keep_session, last_panic } = await program;
    try {
      keep_session(new Uint8Array(data.session));
    } catch (error) {
      postMessage({ fault: last_panic() ?? String(error) });
    }
  } else {
    await runTask(data);
  }
};
