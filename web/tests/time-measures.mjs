// Times the measures that move with a run in a browser, as `tilescope bench --live` does natively: on one thread, without
// drawing, with a clock of whole milliseconds. Usage, after web/build:
//   node time-measures.mjs [BROWSER ...]    a browser's command, such as chromium or firefox-esr; it must be installed
// It opens a page of its own in each browser, without a window, which loads the built program and sends its table here.

import { spawn } from "node:child_process";
import { mkdtemp, readFile, readdir, rm } from "node:fs/promises";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import path from "node:path";

import { DIST } from "./harness.mjs";

/** The radii of runs of 10,041 and 100,218 samples. */
const RADII = [0.00836, 0.0026437];
/** A browser that has sent nothing for so long is ended. */
const PATIENCE_MS = 600_000;

const TYPES = { ".js": "text/javascript", ".wasm": "application/wasm" };

/** Returns the page that loads the program and sends what it measured. */
async function pageOf(radii) {
  const names = await readdir(DIST);
  const one = (pattern) => {
    const found = names.filter((name) => pattern.test(name));
    if (found.length !== 1) throw new Error(`${DIST} has ${found.length} files like ${pattern}; run web/build first`);
    return found[0];
  };
  const bindings = one(/^tilescope-\w+\.js$/);
  const program = one(/^tilescope_bg-\w+\.wasm$/);
  const later = one(/^later-\w+\.js$/);
  return `<!doctype html><title>Timing</title><script type="module">
    const send = (path, text) => fetch(path, { method: "POST", body: text });
    try {
      const program = await import("./${bindings}");
      const { fetchLater, join } = await import("./${later}");
      const exports = await program.default({ module_or_path: "./${program}" });
      // Measures are in the program's later part, as they are where the page is just opened.
      join(exports, await fetchLater());
      const rows = ${JSON.stringify(radii)}.flatMap((radius) => JSON.parse(program.time_measures(radius)));
      await send("/rows", JSON.stringify(rows));
    } catch (error) {
      await send("/failed", String(error));
    }
  </script>`;
}

/** Serves the built folder and that page; resolves with the rows that the page sends. */
function serve(page) {
  let settle;
  const rows = new Promise((resolve, reject) => {
    settle = { resolve, reject };
  });
  const answer = async (request, response) => {
    if (request.method === "POST") {
      let text = "";
      for await (const part of request) text += part;
      response.end();
      if (request.url === "/rows") settle.resolve(JSON.parse(text));
      else settle.reject(new Error(text));
      return;
    }
    if (request.url === "/timing") {
      response.setHeader("content-type", "text/html").end(page);
      return;
    }
    // Only names without folders are served: a request cannot leave the built folder.
    const name = path.basename(request.url);
    const bytes = await readFile(path.join(DIST, name)).catch(() => undefined);
    if (!bytes) return response.writeHead(404).end();
    response.setHeader("content-type", TYPES[path.extname(name)] ?? "application/octet-stream").end(bytes);
  };
  const server = createServer((request, response) => {
    answer(request, response).catch((error) => response.destroy(error));
  });
  return { server, rows };
}

/** Returns how to start a browser without a window, with a profile of its own. */
function commandOf(browser, profile, address) {
  return path.basename(browser).startsWith("firefox")
    ? ["--headless", "--no-remote", "--profile", profile, address]
    : ["--headless", "--no-sandbox", "--no-first-run", `--user-data-dir=${profile}`, address];
}

async function timeIn(browser) {
  const { server, rows } = serve(await pageOf(RADII));
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const profile = await mkdtemp(path.join(tmpdir(), "tilescope-timing-"));
  const address = `http://127.0.0.1:${server.address().port}/timing`;
  const child = spawn(browser, commandOf(browser, profile, address), { stdio: "ignore" });

  let timer;
  const late = new Promise((_, reject) => {
    timer = setTimeout(() => reject(new Error(`${browser} sent nothing in ${PATIENCE_MS / 1000} s`)), PATIENCE_MS);
  });
  const gone = new Promise((_, reject) => {
    child.on("error", reject);
    child.on("exit", (code) => reject(new Error(`${browser} ended with ${code} before it sent anything`)));
  });
  try {
    return await Promise.race([rows, late, gone]);
  } finally {
    clearTimeout(timer);
    child.kill();
    server.close();
    server.closeAllConnections();
    await rm(profile, { recursive: true, force: true, maxRetries: 5, retryDelay: 200 });
  }
}

function print(browser, rows) {
  console.log(`${browser}\nsamples motion analysis     steps        ms  arrived  frequencies`);
  for (const row of rows) {
    const percent = (part) => `${Math.round(100 * part)}%`;
    const parts = row.analysis ? [percent(row.arrived), percent(row.frequencies)] : ["", ""];
    const cells = [
      String(row.samples).padStart(7),
      row.motion.padEnd(6),
      (row.analysis ? "with" : "without").padEnd(8),
      String(Math.round(row.steps)).padStart(9),
      row.milliseconds.toFixed(3).padStart(9),
      parts[0].padStart(8),
      parts[1].padStart(12),
    ];
    console.log(cells.join(" "));
  }
}

const browsers = process.argv.slice(2);
for (const browser of browsers.length > 0 ? browsers : ["chromium"]) {
  print(browser, await timeIn(browser));
}
