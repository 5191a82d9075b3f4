// A worker of the page: it carries out one errand at a time, so that the page never waits.
// The first message brings the bindings and the compiled program; sessions and errands follow.

let program;

async function begin({ bindings, module }) {
  const loaded = await import(bindings);
  await loaded.default({ module_or_path: module });
  return loaded;
}

async function carryOut({ id, name, input }) {
  const { perform, known, last_panic } = await program;
  const tell = (activity, fraction) => postMessage({ id, activity, fraction });
  try {
    const outcome = perform(name, new Uint8Array(input), tell);
    if (Array.isArray(outcome)) {
      postMessage({ id, unknown: outcome });
    } else {
      postMessage({ id, outcome: outcome.buffer, known: known() }, [outcome.buffer]);
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
    const { learn, last_panic } = await program;
    try {
      learn(new Uint8Array(data.session));
    } catch (error) {
      postMessage({ fault: last_panic() ?? String(error) });
    }
  } else {
    await carryOut(data);
  }
};
