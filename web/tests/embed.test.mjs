// A page of another origin embeds the program in a frame and exchanges messages with it; a page that is not allowed
// gets no messages.

import assert from "node:assert/strict";
import { createServer } from "node:http";
import { once } from "node:events";
import { after, test } from "node:test";
import { PATIENCE_MS, changed, nothingElse, ready, serve, shows, slowTest, state, until } from "./harness.mjs";
import { contextOf, host, makeContext, opened as openedAt } from "./shared.mjs";

/** Serves one page on its own origin, which the page may contain. Returns the origin and a function that ends the server. */
async function lecture(html) {
  const server = createServer((request, response) => {
    response.setHeader("Content-Type", "text/html; charset=utf-8");
    response.end(html(`http://${request.headers.host}`));
  });
  server.listen(0, "127.0.0.1");
  await once(server, "listening");
  return { own: `http://127.0.0.1:${server.address().port}`, stop: () => server.close() };
}

/** The source of a page that stores the messages it receives, and sends requests by `ask`. */
const PAGE = (frame) => `<!doctype html><title>Lecture</title><link rel="icon" href="data:,">
<style>a { position: fixed; top: 650px; } #after { left: 200px; }</style>
<a id="before" href="#">Before</a>
<iframe id="frame" src="${frame}" width="900" height="600"></iframe>
<a id="after" href="#">After</a>
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

/** The part of that page that shows the run. */
const WITHIN = { x: 100, y: 60, width: 600, height: 350 };

/** Browser settings for that page. */
const SETTINGS = { viewport: { width: 1000, height: 700 }, hasTouch: true };
const named = (own) => `&origin=${encodeURIComponent(own)}`;

/** Serves that page; `query` is the end of the frame's query, given the page's own origin. */
async function player(query) {
  const { address: origin } = await host();
  const frame = (own) => `${origin}/?embed=player&engine=cpu${query(own)}#v=1&radius=0.02`;
  return { origin, ...(await lecture((own) => PAGE(frame(own)))) };
}

/** Opens that page in a context. */
async function openIn(context, { own, origin }) {
  const page = await context.newPage();
  await page.goto(own);
  return { page, frame: page.frames().find((frame) => frame.url().startsWith(origin)), origin };
}

/** Opens that page in its own context. */
async function opened(t, query, wishes = {}) {
  const served = await player(query);
  t.after(served.stop);
  const { context } = await contextOf(t, { settings: SETTINGS, origins: [served.own], ...wishes });
  return openIn(context, served);
}

/** Waits until a page has received a certain message. @param {(message: any) => boolean} wanted */
function heard(page, wanted) {
  return until("a message", async () => (await page.evaluate(() => window.heard)).find(wanted));
}

/** Asks from the page and returns the answer. */
async function answer(page, request, origin) {
  const id = await page.evaluate(([request, origin]) => window.ask(request, origin), [request, origin]);
  return heard(page, (message) => message.id === id);
}

/** Returns functions with which a page sends requests and waits for a state. */
function speaking({ page, frame, origin }) {
  const told = (wished) =>
    until("a state as wished", async () => {
      const { state } = await answer(page, { do: "state" }, origin);
      return wished(state) && state;
    });
  const done = async (request) => assert.equal((await answer(page, request, origin)).ok, true, JSON.stringify(request));
  return { page, frame, origin, told, done };
}

const focused = (page) => page.evaluate(() => document.activeElement?.id);
const isMade = (state) => state?.ready && state.verified !== null;

/** As `opened`, once the run is finished; also returns functions to send requests and to wait for a state. */
async function asking(made) {
  const speaks = speaking(made);
  await heard(made.page, ({ event }) => event === "ready");
  const fresh = await speaks.told(isMade);
  await shows(made.page, WITHIN);
  assert.notEqual(await focused(made.page), "frame", "it takes the focus from the page");
  return { ...speaks, fresh };
}

/** The page that most tests share, if it is open. */
let kept;
after(() => kept?.then(({ stop }) => stop()));

async function openKept() {
  const served = await player(named);
  const { context, wrong } = await makeContext({ settings: SETTINGS, origins: [served.own] });
  return { ...(await asking(await openIn(context, served))), stop: served.stop, context, wrong };
}

/**
 * Returns the page that most tests share: without messages yet, and with the program in its frame in the state in which
 * it was opened. After a failed test the page is opened again.
 */
async function reused(t) {
  const made = await (kept ??= openKept());
  t.after(async () => {
    if (!t.passed) {
      kept = undefined;
      await made.context.close();
      made.stop();
    }
    nothingElse(made.wrong.splice(0), []);
  });
  await made.done({ do: "load", link: made.fresh.link });
  // The last answer to a question stays in the state.
  const state = await made.told(isMade);
  assert.deepEqual({ ...state, answered: null }, made.fresh);
  await made.page.evaluate(() => {
    document.activeElement?.blur();
    window.heard.length = 0;
  });
  return made;
}

test("a page of another origin opens a lesson, answers, and is told of the answer", async (t) => {
  const { page, frame, origin, told, done } = await reused(t);
  await done({ do: "lesson", open: "survivors", step: "one-of-two" });
  const asked = await told((state) => state.lesson?.question);
  const [{ items }] = asked.lesson.question.controls;
  assert.equal(items.length, 3);
  // Two of the shuffled options name a sample; the larger number is eliminated.
  const named = items.map((item) => Number(item.text.at(-1).text.match(/\d+$/)?.[0]));
  const present = named.filter((number) => !Number.isNaN(number));
  assert.equal(present.length, 2);
  const [smaller, larger] = [named.indexOf(Math.min(...present)), named.indexOf(Math.max(...present))];
  await done({ do: "answer", value: smaller });
  const wrong = await heard(page, ({ event }) => event === "answered");
  assert.deepEqual([wrong.lesson, wrong.gate, wrong.score, wrong.done], ["survivors", "one-of-two", 0, false]);
  await done({ do: "answer", value: larger });
  const right = await heard(page, ({ event, tries }) => event === "answered" && tries === 2);
  assert.deepEqual([right.score, right.done], [1, true]);
  // The page around may bring its own text.
  assert.equal(await frame.evaluate(() => document.getElementById("lesson").hidden), false);
  await done({ do: "lesson", act: "leave" });
});

test("a page of another origin loads, steps, seeks and asks", async (t) => {
  const { page, origin, told, done } = await reused(t);
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

slowTest("a page of another origin opens a link, plays and pauses", async (t) => {
  const { page, origin, told, done } = await reused(t);
  const { ok, dropped } = await answer(page, { do: "load", link: "v=1&seed=22&radius=0.03&at=900&clock=event&hologram=yes" }, origin);
  assert.equal(ok, true);
  assert.match(dropped.join(), /hologram/);
  await told((state) => state.ready && state.seed === 22 && state.cursor === 900 && !state.playing);
  await shows(page, WITHIN);
  const before = await page.screenshot({ clip: WITHIN });
  await done({ do: "play", speed: 2 });
  const playing = await told((state) => state.cursor > 900);
  assert.equal(playing.playing, true);
  await changed(page, before, WITHIN);
  await done({ do: "pause" });
  const paused = await told((state) => !state.playing);
  assert.ok(paused.cursor < paused.events, "it played to the end");
  // If the run still played, the cursor would be further on.
  await done({ do: "step", by: 1, unit: "event" });
  await told((state) => state.cursor === paused.cursor + 1);
});

/** Waits until messages sent before, to the frame and from it, have arrived. */
async function flush(page, frame) {
  await page.evaluate(() => document.getElementById("frame").contentWindow.postMessage("flush", "*"));
  await frame.waitForFunction(() => window.flushed);
  await frame.evaluate(() => parent.postMessage({ flushed: true }, "*"));
  await heard(page, ({ flushed }) => flushed);
}

/** Makes a frame count the messages that have arrived. */
const listen = (frame) =>
  frame.evaluate(() => addEventListener("message", ({ data }) => (window.flushed ||= data === "flush")));

for (const [name, query] of [
  ["that is not named", () => ""],
  ["other than the one that is named", () => `&origin=${encodeURIComponent("https://other.example")}`],
]) {
  test(`a page of an origin ${name} hears nothing`, async (t) => {
    const { page, frame, origin } = await opened(t, query, { expected: [/Tilescope answers .*, not http/] });
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
  const { page, frame, origin, told } = await reused(t);
  const { cursor } = await told(() => true);
  await listen(frame);
  // It has the named origin, and can reach the frame through the page that contains both.
  await page.evaluate((origin) => {
    const other = document.createElement("iframe");
    document.body.append(other);
    other.contentWindow.eval(`
      window.heard = [];
      addEventListener("message", ({ data }) => heard.push(data));
      parent.frames[0].postMessage({ tilescope: 1, id: "other", do: "seek", event: 100 }, "${origin}");
    `);
  }, origin);
  // Nor is the frame its own parent.
  await frame.evaluate((origin) => window.postMessage({ tilescope: 1, id: "own", do: "seek", event: 100 }, origin), origin);
  await flush(page, frame);
  assert.equal((await told(() => true)).cursor, cursor);
  const answers = await page.evaluate(() => [...window.heard, ...window.frames[1].heard].map(({ id }) => id));
  assert.ok(!answers.includes("other") && !answers.includes("own"), answers.join());
  await page.evaluate(() => document.querySelectorAll("iframe")[1].remove());
});

test("an id that cannot be sent back is left out of the answer", async (t) => {
  const { page, origin } = await reused(t);
  await page.evaluate((origin) => {
    const { port1 } = new MessageChannel();
    const request = { tilescope: 1, id: port1, do: "step", by: 3, unit: "event" };
    document.getElementById("frame").contentWindow.postMessage(request, origin, [port1]);
  }, origin);
  const refused = await heard(page, (message) => message.ok === false);
  assert.equal("id" in refused, false);
  assert.match(refused.error, /3/);
});

test("while a lost display is replaced, requests are refused with the advice to ask again", async (t) => {
  const { page, frame, told } = await asking(await opened(t, (own) => `${named(own)}&display=webgl`));
  const own = new URL(page.url()).origin;
  await frame.evaluate((origin) => {
    const canvas = document.getElementById("canvas");
    // After the page has ended the program, and before the next one runs.
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

/** The part of the example page that shows the run. */
const LECTURE = { x: 350, y: 320, width: 500, height: 300 };

/** Opens the example page. Also returns a function that waits for a sentence on it. */
async function example(t, query = "", wishes = {}) {
  const { page } = await openedAt(t, `example/lecture.html${query}`, { settings: { viewport: { width: 1200, height: 900 } }, ...wishes });
  const said = (pattern) =>
    until(`"${pattern}"`, async () => pattern.test((await page.textContent("#sentence")) ?? ""));
  return { page, said };
}

test("the example page works", async (t) => {
  const { page, said } = await example(t, `?player=${encodeURIComponent("../?engine=cpu")}`);
  await said(/^Finish/);
  await shows(page, LECTURE);
  await page.click("#load");
  await said(/^Finish: .* = 7/);
  await page.click("#eliminate");
  await said(/^Tile/);
  await page.click("#step");
  await said(/^(?!Tile)/);
  const log = await page.textContent("#log");
  assert.ok(log.includes('"ok":true') && !log.includes('"ok":false'), log);
  await shows(page, LECTURE);
});

slowTest("the example page shows a player of this machine, and of no other place", async (t) => {
  const other = await serve();
  t.after(other.stop);
  const near = await example(t, `?player=${encodeURIComponent(`${other.address}/?engine=cpu`)}`, { origins: [other.address] });
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
  const { own, stop } = await lecture((own) => html.replace("ORIGIN", encodeURIComponent(own)));
  t.after(stop);
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
  // Runs are made although no frames are drawn.
  assert.equal((await asked({ do: "load", parameters: { seed: 9, radius: 0.02 } })).ok, true);
  await until("a run made out of sight", async () => {
    const { state } = await asked({ do: "state" });
    return state.ready && state.seed === 9;
  });
  await slide.evaluate(() => (document.querySelector("iframe").style.display = "block"));
  await shows(slide, { x: 100, y: 60, width: 400, height: 200 });
});

slowTest("Tab leads through a frame, with a ring, and out of it", async (t) => {
  const { page, frame } = await reused(t);
  await page.focus("#before");
  const press = async (key) => {
    const said = await frame.textContent("#announcer");
    await page.keyboard.press(key);
    const at = await focused(page);
    if (at === "frame") {
      await until("what has the focus now", async () => (await frame.textContent("#announcer")) !== said);
      // Wait for a frame, since the announcement may have been another one, and two presses in one frame would move the
      // focus once.
      await frame.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
    }
    return at;
  };
  // The left edge of the frame.
  const edge = { x: 8, y: 100, width: 6, height: 200 };
  const before = await page.screenshot({ clip: edge });
  assert.equal(await press("Tab"), "frame");
  assert.equal(await frame.evaluate(() => document.activeElement?.id), "canvas");
  assert.match(await frame.textContent("#announcer"), /^Canvas of samples, picture/);
  await changed(page, before, edge);
  const through = async (key) => {
    let count = 1;
    while ((await press(key)) === "frame") {
      count += 1;
      assert.ok(count < 40, `${key} does not lead out`);
    }
    return count;
  };
  const count = await through("Tab");
  assert.ok(count > 6, `${count} stops`);
  assert.equal(await focused(page), "after");
  // It is entered where it was left, and that has been announced.
  const enter = async (key) => {
    await page.keyboard.press(key);
    assert.equal(await focused(page), "frame");
  };
  await enter("Shift+Tab");
  assert.equal(await through("Shift+Tab"), count);
  assert.equal(await focused(page), "before");
  // After Escape, Tab leaves from anywhere.
  await enter("Tab");
  await press("Tab");
  await page.keyboard.press("Escape");
  await page.keyboard.press("Shift+Tab");
  assert.notEqual(await focused(page), "frame");
});

slowTest("the page around a frame scrolls by the wheel and by one finger; with Ctrl and by two fingers the run is zoomed", async (t) => {
  const { page, told } = await reused(t);
  await page.evaluate(() => (document.body.style.height = "3000px"));
  const scroll = () => page.evaluate(() => scrollY);
  const scale = async () => Number(new URLSearchParams((await told(() => true)).link).get("camera")?.split(",")[2] ?? 0);
  await page.mouse.move(400, 200);
  await page.mouse.wheel(0, 120);
  await until("a page that has scrolled", async () => (await scroll()) > 60);
  assert.equal(await scale(), 0, "the run stays as it was");
  await page.keyboard.down("Control");
  const before = await scroll();
  await page.mouse.wheel(0, -240);
  await until("a run that is nearer", async () => (await scale()) > 0);
  await page.keyboard.up("Control");
  assert.equal(await scroll(), before);
  // Fingers, by the browser's own input.
  const session = await page.context().newCDPSession(page);
  const fingers = async (tracks) => {
    const at = (k) => tracks.map(([[x, y], [dx, dy]], id) => ({ x: x + k * dx, y: y + k * dy, id }));
    await session.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: at(0) });
    for (let k = 1; k <= 8; k += 1) {
      await session.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: at(k) });
    }
    await session.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
  };
  const nearer = await scale();
  await fingers([[[400, 250], [0, -15]]]);
  await until("a page that has scrolled on", async () => (await scroll()) > before + 50);
  assert.equal(await scale(), nearer);
  const now = await scroll();
  await fingers([
    [[380, 150], [-12, 0]],
    [[420, 150], [12, 0]],
  ]);
  await until("a run that is nearer still", async () => (await scale()) > 1.5 * nearer);
  assert.equal(await scroll(), now);
  // On the timeline one finger belongs to the program.
  const { y } = await page.locator("#frame").boundingBox();
  const { cursor } = await told(() => true);
  await fingers([[[700, y + 560], [-20, 0]]]);
  await told((state) => state.cursor < cursor);
  await page.evaluate(() => (document.body.style.height = ""));
});

slowTest("frames out of view begin when they are asked or come into view, and so they do after a loss", async (t) => {
  const { address } = await host();
  const frames = [0, 3_000, 6_000].map(
    (top) => `<iframe src="${address}/?embed=player&engine=cpu&display=webgl&origin=ORIGIN#v=1&radius=0.04"
      style="position:absolute;top:${top}px;width:600px;height:400px"></iframe>`,
  );
  const html = `<!doctype html><title>Many</title><link rel="icon" href="data:,">
<script>
  window.heard = [];
  addEventListener("message", ({ data, source }) => heard.push({ from: [0, 1, 2].find((k) => frames[k] === source), ...data }));
</script>${frames.join("")}`;
  const { own, stop } = await lecture((own) => html.replaceAll("ORIGIN", encodeURIComponent(own)));
  t.after(stop);
  const { context } = await contextOf(t, { settings: { viewport: { width: 700, height: 500 } }, origins: [own] });
  const page = await context.newPage();
  await page.goto(own);
  const ready = (k) => heard(page, ({ event, from }) => event === "ready" && from === k);
  await ready(0);
  const loads = (frame) =>
    frame.evaluate(() => performance.getEntriesByType("resource").some(({ name }) => name.endsWith(".wasm")));
  const [, first, second, third] = page.frames();
  assert.deepEqual(await Promise.all([first, second, third].map(loads)), [true, false, false]);
  await page.evaluate((origin) => window.frames[1].postMessage({ tilescope: 1, id: 1, do: "state" }, origin), address);
  await ready(1);
  assert.equal(await loads(third), false);
  await page.evaluate(() => scrollTo(0, 6_000));
  await ready(2);
  await state(third, (told) => told.ready);
  await page.evaluate(() => scrollTo(0, 0));
  // Observations are delivered in order.
  await third.evaluate(
    () =>
      new Promise((resolve) => {
        const observer = new IntersectionObserver(([{ isIntersecting }]) => isIntersecting || resolve());
        observer.observe(document.documentElement);
      }),
  );
  await third.evaluate(() => {
    window.lost = window.tilescope;
    document.getElementById("canvas").getContext("webgl2").getExtension("WEBGL_lose_context").loseContext();
  });
  await page.evaluate(() => scrollTo(0, 6_000));
  await third.waitForFunction(() => window.tilescope !== window.lost, null, { timeout: PATIENCE_MS });
  const { notice } = await state(third, (told) => told.ready);
  assert.equal(notice, null, "nothing was lost that the link does not hold");
});
