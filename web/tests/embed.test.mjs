// A page of another origin holds the program in a frame and speaks with it; a page that is not allowed hears nothing.

import assert from "node:assert/strict";
import { createServer } from "node:http";
import { once } from "node:events";
import { test } from "node:test";
import { PATIENCE_MS, changed, ready, serve, shows, state, until } from "./harness.mjs";
import { contextOf, host, opened as openedAt } from "./shared.mjs";

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

/** Where the run is seen on that page. */
const WITHIN = { x: 100, y: 60, width: 600, height: 350 };

/** Opens that page; `query` is the end of the frame's query, given the page's own origin. */
async function opened(t, query, wishes = {}) {
  const { address: origin } = await host();
  const frame = (own) => `${origin}/?embed=player&engine=cpu${query(own)}#v=1&radius=0.02`;
  const own = await lecture(t, (own) => PAGE(frame(own)));
  const { context } = await contextOf(t, { settings: { viewport: { width: 1000, height: 700 } }, origins: [own], ...wishes });
  const page = await context.newPage();
  await page.goto(own);
  return { page, frame: page.frames().find((frame) => frame.url().startsWith(origin)), origin };
}

const named = (own) => `&origin=${encodeURIComponent(own)}`;

/** Waits until a page has heard something. @param {(message: any) => boolean} wanted */
function heard(page, wanted) {
  return until("a message", async () => (await page.evaluate(() => window.heard)).find(wanted));
}

/** Asks from the page and returns the answer. */
async function answer(page, request, origin) {
  const id = await page.evaluate(([request, origin]) => window.ask(request, origin), [request, origin]);
  return heard(page, (message) => message.id === id);
}

/** As `opened`, once the run is there; also how to ask, and to wait for a state. */
async function asking(t, query = "") {
  const { page, frame, origin } = await opened(t, (own) => named(own) + query);
  await heard(page, ({ event }) => event === "ready");
  const told = (wished) =>
    until("a state as wished", async () => {
      const { state } = await answer(page, { do: "state" }, origin);
      return wished(state) && state;
    });
  const done = async (request) => assert.equal((await answer(page, request, origin)).ok, true, JSON.stringify(request));
  await told((state) => state.ready);
  await shows(page, WITHIN);
  return { page, frame, origin, told, done };
}

test("a page of another origin loads, steps, seeks and asks", async (t) => {
  const { page, origin, told, done } = await asking(t);
  await done({ do: "load", parameters: { seed: 21, radius: 0.03 } });
  const loaded = await told((state) => state.ready && state.seed === 21);
  assert.ok(loaded.samples > 0);
  await done({ do: "seek", event: 100 });
  await told((state) => state.cursor === 100);
  await done({ do: "step", by: 1, unit: "event" });
  await told((state) => state.cursor === 101);
  await done({ do: "seek", part: 0.5 });
  const half = await told((state) => state.cursor > 101);
  assert.ok(Math.abs(half.cursor - half.events / 2) <= 1, `${half.cursor} of ${half.events}`);
  const refused = await answer(page, { do: "tidy" }, origin);
  assert.equal(refused.ok, false);
  assert.match(refused.error, /tidy/);
  await shows(page, WITHIN);
  const all = await page.evaluate(() => window.heard);
  assert.ok(all.every((message) => message.origin === origin));
  assert.ok(all.some(({ event }) => event === "state"));
});

test("a page of another origin opens a link, plays and pauses", async (t) => {
  const { page, origin, told, done } = await asking(t);
  const { ok, dropped } = await answer(page, { do: "load", link: "v=1&seed=22&radius=0.03&at=50&clock=event&hologram=yes" }, origin);
  assert.equal(ok, true);
  assert.match(dropped.join(), /hologram/);
  await told((state) => state.ready && state.seed === 22 && state.cursor === 50 && !state.playing);
  await shows(page, WITHIN);
  const before = await page.screenshot({ clip: WITHIN });
  await done({ do: "play", speed: 2 });
  const playing = await told((state) => state.cursor > 50);
  assert.equal(playing.playing, true);
  await changed(page, before, WITHIN);
  await done({ do: "pause" });
  const paused = await told((state) => !state.playing);
  assert.ok(paused.cursor < paused.events, "it played to the end");
  // What went on would be past it.
  await done({ do: "step", by: 1, unit: "event" });
  await told((state) => state.cursor === paused.cursor + 1);
});

/** Has what was sent to a frame before arrive, and what the frame has sent before too. */
async function flush(page, frame) {
  await page.evaluate(() => document.getElementById("frame").contentWindow.postMessage("flush", "*"));
  await frame.waitForFunction(() => window.flushed);
  await frame.evaluate(() => parent.postMessage({ flushed: true }, "*"));
  await heard(page, ({ flushed }) => flushed);
}

/** Has a frame note that what was sent to it has arrived. */
const listen = (frame) =>
  frame.evaluate(() => addEventListener("message", ({ data }) => (window.flushed ||= data === "flush")));

for (const [name, query] of [
  ["that is not named", () => ""],
  ["other than the one that is named", () => `&origin=${encodeURIComponent("https://other.example")}`],
]) {
  test(`a page of an origin ${name} hears nothing`, async (t) => {
    const { page, frame, origin } = await opened(t, query);
    const before = await state(frame, (told) => told.ready && told.verified !== null);
    await shows(page, WITHIN);
    await listen(frame);
    await page.evaluate((origin) => window.ask({ do: "state" }, origin), origin);
    await page.evaluate((origin) => window.ask({ do: "seek", event: 100 }, origin), origin);
    await flush(page, frame);
    assert.deepEqual(await page.evaluate(() => window.heard), [{ origin, flushed: true }]);
    assert.equal((await state(frame)).cursor, before.cursor);
  });
}

test("a window that does not hold the frame is not listened to", async (t) => {
  const { page, frame, origin, told } = await asking(t);
  const { cursor } = await told(() => true);
  await listen(frame);
  // It has the origin that is named, and may reach the frame by the page that both are on.
  await page.evaluate((origin) => {
    const other = document.createElement("iframe");
    document.body.append(other);
    other.contentWindow.eval(`
      window.heard = [];
      addEventListener("message", ({ data }) => heard.push(data));
      parent.frames[0].postMessage({ tilescope: 1, id: "other", do: "seek", event: 100 }, "${origin}");
    `);
  }, origin);
  // The frame itself is none either.
  await frame.evaluate((origin) => window.postMessage({ tilescope: 1, id: "own", do: "seek", event: 100 }, origin), origin);
  await flush(page, frame);
  assert.equal((await told(() => true)).cursor, cursor);
  const answers = await page.evaluate(() => [...window.heard, ...window.frames[1].heard].map(({ id }) => id));
  assert.ok(!answers.includes("other") && !answers.includes("own"), answers.join());
});

test("an id that cannot be sent back is left out of the answer", async (t) => {
  const { page, origin } = await asking(t);
  await page.evaluate((origin) => {
    const { port1 } = new MessageChannel();
    const request = { tilescope: 1, id: port1, do: "step", by: 3, unit: "event" };
    document.getElementById("frame").contentWindow.postMessage(request, origin, [port1]);
  }, origin);
  const refused = await heard(page, (message) => message.ok === false);
  assert.equal("id" in refused, false);
  assert.match(refused.error, /3/);
});

test("while a lost display is replaced, requests are told to come again", async (t) => {
  const { page, frame, told } = await asking(t, "&display=webgl");
  const own = new URL(page.url()).origin;
  await frame.evaluate((origin) => {
    const canvas = document.getElementById("canvas");
    // After the page has taken its leave of the program, and before the next one runs.
    canvas.addEventListener("webglcontextlost", () => {
      const data = { tilescope: 1, id: "meanwhile", do: "state" };
      window.dispatchEvent(new MessageEvent("message", { data, origin, source: window.parent }));
    });
    canvas.getContext("webgl2").getExtension("WEBGL_lose_context").loseContext();
  }, own);
  const meanwhile = await heard(page, ({ id }) => id === "meanwhile");
  assert.equal(meanwhile.ok, false);
  assert.match(meanwhile.error, /being replaced; ask again/);
  const after = await told((state) => state?.ready && state.notice !== null);
  assert.match(after.notice, /lost/);
  await shows(page, WITHIN);
  assert.equal((await page.evaluate(() => window.heard)).filter(({ event }) => event === "ready").length, 1);
});

/** Where the run is seen on the example page. */
const LECTURE = { x: 350, y: 320, width: 500, height: 300 };

/** Opens the example page, and returns how to wait for what it says. */
async function example(t, query = "", wishes = {}) {
  const { page } = await openedAt(t, `example/lecture.html${query}`, { settings: { viewport: { width: 1200, height: 900 } }, ...wishes });
  const said = (pattern) =>
    until(`"${pattern}"`, async () => pattern.test((await page.textContent("#sentence")) ?? ""));
  return { page, said };
}

test("the example page works", async (t) => {
  const { page, said } = await example(t);
  await said(/^Finish/);
  await shows(page, LECTURE);
  await page.click("#load");
  await said(/^Finish: 7/);
  await page.click("#eliminate");
  await said(/^Tile/);
  await page.click("#step");
  await said(/^(?!Tile)/);
  const log = await page.textContent("#log");
  assert.ok(log.includes('"ok":true') && !log.includes('"ok":false'), log);
  await shows(page, LECTURE);
});

test("the example page shows a player of this machine, and of no other place", async (t) => {
  const other = await serve();
  t.after(other.stop);
  const near = await example(t, `?player=${encodeURIComponent(other.address)}`, { origins: [other.address] });
  await near.said(/^Finish/);
  await shows(near.page, LECTURE);
  assert.equal(await near.page.isEnabled("#step"), true);
  const far = await example(t, `?player=${encodeURIComponent("https://other.example/")}`);
  await far.said(/not https:\/\/other\.example/);
  assert.equal(await far.page.getAttribute("iframe", "src"), null);
  assert.equal(await far.page.isEnabled("#step"), false);
});

test("the example page says why its player has failed", async (t) => {
  const { page, said } = await example(t, "", {
    prepare: (context) => context.route(/sheets-/, (route) => route.abort()),
    expected: [/Failed to load resource/],
  });
  await said(/^A part of the page cannot be loaded/);
  assert.equal(await page.isEnabled("#step"), false);
  await shows(page, LECTURE);
});

test("a canvas alone shows the run and none of the controls", async (t) => {
  const { page } = await openedAt(t, "?embed=canvas&engine=cpu#v=1&radius=0.02", {
    settings: { viewport: { width: 800, height: 600 } },
  });
  await ready(page, { x: 100, y: 450, width: 600, height: 130 });
});

test("a frame may begin hidden, as on a slide that is not shown yet", async (t) => {
  const { address } = await host();
  const html = `<!doctype html><title>Slides</title><link rel="icon" href="data:,">
<script>window.heard = []; addEventListener("message", ({ data }) => heard.push(data));</script>
<iframe src="${address}/?embed=player&engine=cpu&origin=ORIGIN" width="600" height="400" style="display:none"></iframe>`;
  const own = await lecture(t, (own) => html.replace("ORIGIN", encodeURIComponent(own)));
  const { context } = await contextOf(t, { settings: { viewport: { width: 800, height: 600 } }, origins: [own] });
  const slide = await context.newPage();
  await slide.goto(own);
  await heard(slide, ({ event }) => event === "ready");
  let id = 0;
  const asked = async (request) => {
    id += 1;
    const message = { tilescope: 1, id, ...request };
    const post = ([message, origin]) => document.querySelector("iframe").contentWindow.postMessage(message, origin);
    await slide.evaluate(post, [message, address]);
    return heard(slide, (message) => message.id === id);
  };
  // A run is made there, too, though nothing is drawn that would notice.
  assert.equal((await asked({ do: "load", parameters: { seed: 9, radius: 0.02 } })).ok, true);
  await until("a run made out of sight", async () => {
    const { state } = await asked({ do: "state" });
    return state.ready && state.seed === 9;
  });
  await slide.evaluate(() => (document.querySelector("iframe").style.display = "block"));
  await shows(slide, { x: 100, y: 60, width: 400, height: 200 });
});

test("Tab leads into a frame, with a ring, and Escape and then Tab lead out of it", async (t) => {
  const { page, frame } = await asking(t);
  const at = () => page.evaluate(() => document.activeElement?.id);
  assert.notEqual(await at(), "frame", "it takes the focus from the page");
  // The left edge of the frame.
  const edge = { x: 8, y: 100, width: 6, height: 200 };
  const before = await page.screenshot({ clip: edge });
  await page.keyboard.press("Tab");
  assert.equal(await at(), "frame");
  assert.equal(await frame.evaluate(() => document.activeElement?.id), "canvas");
  await changed(page, before, edge);
  for (let k = 0; k < 3; k += 1) {
    await page.keyboard.press("Tab");
  }
  assert.equal(await at(), "frame", "Tab goes round within");
  await page.keyboard.press("Escape");
  await page.keyboard.press("Shift+Tab");
  assert.notEqual(await at(), "frame");
});
