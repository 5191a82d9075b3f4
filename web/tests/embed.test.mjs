// A page of another origin holds the program in a frame and speaks with it; a page that is not allowed hears nothing.

import assert from "node:assert/strict";
import { createServer } from "node:http";
import { once } from "node:events";
import { test } from "node:test";
import { PATIENCE_MS, shows, state, watch } from "./harness.mjs";
import { host } from "./shared.mjs";

/** Serves one page on an origin of its own, which it may hold. */
async function lecture(t, html) {
  const server = createServer((request, response) => {
    response.setHeader("Content-Type", "text/html; charset=utf-8");
    response.end(html(`http://${request.headers.host}`));
  });
  server.listen(0, "127.0.0.1");
  await once(server, "listening");
  t.after(() => server.close());
  return `http://127.0.0.1:${server.address().port}`;
}

/** A page that keeps what it hears, and asks by `ask`. */
const PAGE = (frame) => `<!doctype html><title>Lecture</title><link rel="icon" href="data:,">
<iframe id="frame" src="${frame}" width="900" height="600"></iframe>
<script>
  window.heard = [];
  addEventListener("message", (message) => heard.push({ origin: message.origin, ...message.data }));
  let next = 0;
  window.ask = (request, origin) => {
    const id = next++;
    document.getElementById("frame").contentWindow.postMessage({ tilescope: 1, id, ...request }, origin);
    return id;
  };
</script>`;

async function opened(t, query) {
  const { server, browser } = await host();
  const page = await browser.newPage({ viewport: { width: 1000, height: 700 } });
  t.after(() => page.close());
  const frame = (own) => `${server.address}/?embed=player&engine=cpu${query(own)}#v=1&radius=0.02`;
  const wrong = watch(page, server.address);
  await page.goto(await lecture(t, (own) => PAGE(frame(own))));
  return { page, wrong, origin: server.address };
}

/** Asks from the page and returns the answer. */
async function answer(page, request, origin) {
  const id = await page.evaluate(([request, origin]) => window.ask(request, origin), [request, origin]);
  await page.waitForFunction((id) => window.heard.some((message) => message.id === id), id, { timeout: PATIENCE_MS });
  return page.evaluate((id) => window.heard.find((message) => message.id === id), id);
}

test("a page of another origin loads, steps, seeks and asks", async (t) => {
  const { page, wrong, origin } = await opened(t, (named) => `&origin=${encodeURIComponent(named)}`);
  await page.waitForFunction(() => window.heard.some(({ event }) => event === "ready"), null, { timeout: PATIENCE_MS });
  const told = async (wished) => {
    for (let k = 0; k < 600; k += 1) {
      const { state } = await answer(page, { do: "state" }, origin);
      if (wished(state)) {
        return state;
      }
      await page.waitForTimeout(50);
    }
    throw new Error("the state did not come to be as wished");
  };
  await told((state) => state.ready);
  assert.equal((await answer(page, { do: "load", parameters: { seed: 21, radius: 0.03 } }, origin)).ok, true);
  const loaded = await told((state) => state.ready && state.seed === 21);
  assert.ok(loaded.samples > 0);
  assert.equal((await answer(page, { do: "seek", event: 100 }, origin)).ok, true);
  await told((state) => state.cursor === 100);
  assert.equal((await answer(page, { do: "step", by: 1, unit: "event" }, origin)).ok, true);
  await told((state) => state.cursor === 101);
  const refused = await answer(page, { do: "tidy" }, origin);
  assert.equal(refused.ok, false);
  assert.match(refused.error, /tidy/);
  await shows(page, { x: 100, y: 60, width: 600, height: 350 });
  const heard = await page.evaluate(() => window.heard);
  assert.ok(heard.every((message) => message.origin === origin));
  assert.ok(heard.some(({ event }) => event === "state"));
  assert.deepEqual(wrong.filter((line) => !line.startsWith("request:")), []);
});

test("a page whose origin is not named hears nothing", async (t) => {
  const { page, origin } = await opened(t, () => "");
  const frame = page.frames().find((frame) => frame.url().startsWith(origin));
  await frame.waitForFunction(() => Boolean(window.tilescope), null, { timeout: PATIENCE_MS });
  await page.evaluate((origin) => window.ask({ do: "state" }, origin), origin);
  await page.waitForTimeout(1_000);
  assert.deepEqual(await page.evaluate(() => window.heard), []);
});

test("the example page works", async (t) => {
  const { server, browser } = await host();
  const page = await browser.newPage({ viewport: { width: 1200, height: 900 } });
  t.after(() => page.close());
  const wrong = watch(page, server.address);
  await page.goto(`${server.address}/example/lecture.html`);
  const frame = page.frameLocator("iframe");
  await frame.locator("#loading[hidden]").waitFor({ state: "attached", timeout: PATIENCE_MS });
  const said = (pattern) =>
    page.waitForFunction((text) => new RegExp(text).test(document.getElementById("sentence").textContent), pattern, {
      timeout: PATIENCE_MS,
    });
  await said("^Finish");
  await page.click("#load");
  await said("^Finish: 7");
  await page.click("#eliminate");
  await said("^Tile");
  await page.click("#step");
  await said("^(?!Tile)");
  const log = await page.textContent("#log");
  assert.ok(log.includes('"ok":true') && !log.includes('"ok":false'), log);
  await shows(page, { x: 350, y: 320, width: 500, height: 300 });
  assert.deepEqual(wrong, []);
});

test("a canvas alone shows the run and none of the controls, and may begin hidden", async (t) => {
  const { server, browser } = await host();
  const page = await browser.newPage({ viewport: { width: 800, height: 600 } });
  t.after(() => page.close());
  const wrong = watch(page, server.address);
  await page.goto(`${server.address}/?embed=canvas&engine=cpu#v=1&radius=0.02`);
  await state(page, (told) => told.ready && told.verified);
  await shows(page, { x: 100, y: 450, width: 600, height: 130 });
  // A frame of a slide that is not shown yet.
  const slide = await browser.newPage({ viewport: { width: 800, height: 600 } });
  t.after(() => slide.close());
  const html = `<!doctype html><title>Slides</title><link rel="icon" href="data:,">
<script>window.heard = []; addEventListener("message", ({ data }) => heard.push(data));</script>
<iframe src="${server.address}/?embed=player&engine=cpu&origin=ORIGIN" width="600" height="400" style="display:none"></iframe>`;
  const origin = await lecture(t, (own) => html.replace("ORIGIN", encodeURIComponent(own)));
  await slide.goto(origin);
  await slide.waitForFunction(() => window.heard.some(({ event }) => event === "ready"), null, { timeout: PATIENCE_MS });
  assert.deepEqual(wrong, []);
});

test("Escape and then Tab lead out of a frame", async (t) => {
  const { page, origin } = await opened(t, (named) => `&origin=${encodeURIComponent(named)}`);
  const frame = page.frames().find((frame) => frame.url().startsWith(origin));
  await state(frame, (told) => told.ready);
  const at = () => page.evaluate(() => document.activeElement?.id);
  await frame.locator("#canvas").focus();
  for (let k = 0; k < 3; k += 1) {
    await page.keyboard.press("Tab");
  }
  assert.equal(await at(), "frame", "Tab goes round within");
  await page.keyboard.press("Escape");
  await page.keyboard.press("Shift+Tab");
  assert.notEqual(await at(), "frame");
});
