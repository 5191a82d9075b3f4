// The Python package's widget in a real JupyterLab: the player runs offline from the files that the kernel sends, and its
// moment and selection go both ways. TILESCOPE_LAB names a Python that has JupyterLab, anywidget and the package with its page;
// crates/python/test-widget makes it and runs this.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { writeFile } from "node:fs/promises";
import path from "node:path";
import { test } from "node:test";
import { PATIENCE_MS, folder, launch, nothingElse, shows, until, watch } from "./harness.mjs";

const LAB = process.env.TILESCOPE_LAB;

/** What the cells do. The fourth and the last print what Python has. */
const CELLS = [
  "import tilescope\nmade = tilescope.sample(radius=0.03, seed=7)\nw = tilescope.widget(made)\nw",
  "w.cursor = 100",
  "w.selected = 5",
  "print(f'player: {w.cursor} {w.moment} {w.selected} {w.events} {w.note!r}')",
  "w.moment = 'tile'",
  "points = tilescope.widget(tilescope.PointSet(made.points, 0.03), height=400)\npoints",
  "print(f'points: {points.selected} {points.note}')",
];

/** Starts JupyterLab in a folder. Returns its address and a function that ends it. */
async function lab(at) {
  const settings = ["token=''", "password=''", "port=0", "open_browser=False", "allow_root=True", `root_dir=${at}`];
  // Nothing of this machine's user: neither settings nor extensions.
  const own = Object.fromEntries(["CONFIG", "DATA", "RUNTIME"].map((kind) => [`JUPYTER_${kind}_DIR`, at]));
  const words = ["-m", "jupyter", "lab", ...settings.map((one) => `--ServerApp.${one}`), "--LabApp.news_url="];
  const server = spawn(LAB, words, {
    stdio: ["ignore", "ignore", "pipe"],
    env: { ...process.env, ...own, HOME: at, IPYTHONDIR: at },
  });
  let said = "";
  for await (const part of server.stderr) {
    said += part;
    const address = said.match(/http:\/\/(?:localhost|127\.0\.0\.1):[0-9]+/);
    if (address) {
      // What else it says is not needed, and must not fill the pipe.
      server.stderr.resume();
      const stop = async () => {
        server.kill("SIGTERM");
        await once(server, "exit");
      };
      return { address: address[0].replace("localhost", "127.0.0.1"), stop };
    }
  }
  throw new Error(`no address from JupyterLab: ${said}`);
}

const skip = !LAB && "TILESCOPE_LAB is not set: crates/python/test-widget runs it";

test("the widget plays a run in JupyterLab, and Python follows", { skip }, async (t) => {
  const at = await folder(t);
  const empty = { cell_type: "code", metadata: {}, outputs: [], execution_count: null };
  const cells = CELLS.map((source, k) => ({ ...empty, id: `cell-${k}`, source }));
  const metadata = { kernelspec: { name: "python3", display_name: "Python 3" } };
  await writeFile(path.join(at, "set.ipynb"), JSON.stringify({ nbformat: 4, nbformat_minor: 5, metadata, cells }));

  const { address, stop } = await lab(at);
  t.after(stop);
  const browser = await launch();
  t.after(() => browser.close());
  const context = await browser.newContext({ viewport: { width: 1200, height: 1400 } });
  context.setDefaultTimeout(PATIENCE_MS);
  // JupyterLab itself warns about this and that.
  const wrong = watch(context, [address]);
  const page = await context.newPage();
  await page.goto(`${address}/lab/tree/set.ipynb?reset`);
  await page.locator(".jp-Notebook .jp-Cell").nth(CELLS.length - 1).waitFor();
  // A cell that is run before the kernel is there may be left out.
  await page.locator('.jp-Notebook-ExecutionIndicator[data-status="idle"]').first().waitFor();

  const cell = (k) => page.locator(".jp-Notebook .jp-Cell").nth(k);
  const runCell = async (k) => {
    const prompt = () => cell(k).locator(".jp-InputPrompt").textContent();
    const before = await prompt();
    // JupyterLab leaves out keys that come while it is still at work, so that they are pressed until the cell runs.
    await until(`cell ${k} runs`, async () => {
      await cell(k).locator(".cm-content").click();
      await page.keyboard.press("Control+Enter");
      for (let look = 0; look < 40 && (await prompt()) === before; look += 1) {
        await page.waitForTimeout(50);
      }
      return (await prompt()) !== before;
    });
  };
  /** Runs a cell until it prints what is wanted: the kernel is told of a moment some time after the player has shown it. */
  const prints = (k, wanted) =>
    until(`a cell that prints ${wanted}`, async () => {
      await runCell(k);
      const texts = await cell(k).locator(".jp-OutputArea-output pre").allTextContents();
      return texts.join("").match(wanted);
    });
  await runCell(0);
  const frame = await until("the player", async () => page.frames().find((one) => one.url().startsWith("blob:")));
  const state = (wanted) =>
    until("a state of the player", async () => {
      const told = await frame.evaluate(() => window.tilescope && JSON.parse(window.tilescope.ask('{"do":"state"}')).state);
      return told?.ready && wanted(told) ? told : undefined;
    });
  const { events, samples } = await state(({ verified }) => verified);

  await t.test("the moment and the selection that Python sets are shown", async () => {
    await runCell(1);
    await state(({ cursor }) => cursor === 100);
    await runCell(2);
    await state(({ link }) => /select=sample:\d+/.test(link));
  });

  await t.test("Python has the moment that the player shows", async () => {
    await frame.evaluate(() => window.tilescope.ask('{"do":"seek","stage":"eliminate"}'));
    const { cursor } = await state(({ stage }) => stage === "eliminate");
    assert.notEqual(cursor, 100);
    await prints(3, new RegExp(`^player: ${cursor} eliminate 5 ${events} ''$`, "m"));
  });

  await t.test("a stage is gone to by its name", async () => {
    await runCell(4);
    await state(({ stage }) => stage === "tile");
    await page.locator("iframe").scrollIntoViewIfNeeded();
    const { x, y, width } = await page.locator("iframe").boundingBox();
    await shows(page, { x: x + width / 4, y: y + 40, width: width / 2, height: 200 });
  });

  await t.test("a set without a run is shown as points, of which a click selects one", async () => {
    await runCell(5);
    const canvas = cell(5).locator("canvas[role=img]");
    await canvas.waitFor();
    const { width, height } = await canvas.boundingBox();
    await canvas.click({ position: { x: width / 2, y: height / 2 } });
    const [, row] = await prints(6, /^points: (\d+) .*no run to play/m);
    assert.ok(Number(row) < samples, row);
  });

  // Nothing was asked of any other place.
  nothingElse(wrong.filter((line) => line.startsWith("request:")), []);
});
