// The pages that can be read before any program is there: the first one, and those of lessons.

import assert from "node:assert/strict";
import { readdirSync } from "node:fs";
import { test } from "node:test";
import { contextOf } from "./shared.mjs";

/** The pages that are looked at: the first one, a lesson's, and a German one with spectra among its options. */
const PAGES = ["", "lesson/survivors/", "lesson/spectrum/de/"];

/** How many lessons there are: each has a German translation. The two tests have no pages. */
const LESSONS = readdirSync(new URL("../../assets/lessons", import.meta.url)).filter((name) => /^(?!before|after).*\.de\.md$/.test(name)).length;

/** Opens a page. @param {import("node:test").TestContext} t @param {string} path @param {import("./shared.mjs").Wishes} wishes */
async function read(t, path, wishes = {}) {
  const { server, context } = await contextOf(t, wishes);
  const page = await context.newPage();
  /** @type {string[]} */
  const asked = [];
  page.on("request", (request) => asked.push(new URL(request.url()).pathname));
  await page.goto(`${server.address}/${path}`);
  return { server, context, page, asked };
}

test("the first page loads nothing of the program, and all that it leads to is there", async (t) => {
  const { page, asked } = await read(t, "");
  assert.match(await page.textContent("h1"), /blue noise/);
  assert.ok(LESSONS > 9, `${LESSONS} lessons`);
  assert.equal(await page.locator(".card").count(), LESSONS);
  assert.deepEqual(asked.filter((path) => /wasm|main-|tilescope-|worker-|lessons-/.test(path)), []);
  const links = await page.evaluate(() => [...document.links].map((link) => link.href));
  const own = [...new Set(links.filter((link) => new URL(link).origin === new URL(page.url()).origin))];
  // The lessons in two languages, the two pages for lecturers, and links into the program.
  assert.ok(own.length >= 2 * LESSONS + 4, `${own.length} links`);
  for (const link of own) {
    const status = await page.evaluate(async (link) => (await fetch(link)).status, link);
    assert.equal(status, 200, link);
  }
});

test("addresses that lead into the program start it, others do not", async (t) => {
  const { server, page } = await read(t, "");
  for (const [query, starts] of [
    ["?utm_source=mail", false],
    ["?playful", false],
    ["?play", true],
    ["?x=1&engine=cpu", true],
    ["#lesson=survivors", true],
    ["?utm_source=mail#v=1&seed=7", true],
    ["#card", true],
  ]) {
    await page.goto("about:blank");
    await page.goto(`${server.address}/${query}`);
    await page.waitForSelector(starts ? "#canvas, #card" : ".hero", { state: "attached" });
    assert.equal(await page.locator("#site").count(), starts ? 0 : 1, query);
    assert.equal(new URL(page.url()).search, new URL(query, server.address).search, "the address stays");
  }
  // A fragment that is typed behind the first page's address.
  await page.goto(`${server.address}/`);
  await page.click("text=A voting card");
  await page.waitForSelector("#card");
});

for (const [path, language, begin] of [
  ["lesson/survivors/", "en", "#lesson=survivors"],
  ["lesson/survivors/de/", "de", "#lesson=survivors&language=de"],
]) {
  test(`${path} says what it is, to readers and to catalogues`, async (t) => {
    const { server, page } = await read(t, path);
    const about = await page.evaluate(() => ({
      language: document.documentElement.lang,
      title: document.title,
      heading: document.querySelector("h1").textContent,
      description: document.querySelector("meta[name=description]").content,
      data: JSON.parse(document.querySelector("script[type='application/ld+json']").textContent),
      languages: [...document.querySelectorAll("link[hreflang]")].map((link) => link.hreflang),
      canonical: document.querySelector("link[rel=canonical]"),
      preview: document.querySelector("meta[property='og:image']").content,
      begin: document.querySelector(".button").href,
    }));
    assert.equal(about.language, language);
    assert.equal(about.title, `${about.heading} – Tilescope`);
    assert.deepEqual([about.data["@type"], about.data.name], ["LearningResource", about.heading]);
    assert.deepEqual([about.data.description, about.data.inLanguage], [about.description, language]);
    assert.match(about.data.timeRequired, /^PT\d+M$/);
    assert.deepEqual(about.languages, ["en", "de", "x-default"]);
    // This build has no public address.
    assert.equal(about.canonical, null);
    assert.equal((await page.request.get(`${server.address}/${about.preview}`)).status(), 200);
    assert.equal(about.begin, `${server.address}/${begin}`);
    assert.equal(await page.locator(".steps section").count(), 5);
    assert.match(await page.textContent(".options"), /291|318/);
  });
}

test("a snippet of a question has this server's address, and is copied", async (t) => {
  const { server, context, page } = await read(t, "lesson/survivors/");
  await context.grantPermissions(["clipboard-read", "clipboard-write"]);
  await page.click("summary");
  const script = page.locator("pre").first();
  assert.ok((await script.textContent()).includes(`origin !== "${server.address}"`));
  const question = page.locator("pre").nth(1);
  await question.locator("+ button").click();
  const copied = await page.evaluate(() => navigator.clipboard.readText());
  const address = `${server.address}/?embed=player&amp;origin=https://course.example#lesson=survivors&amp;step=one-of-two`;
  assert.ok(copied.includes(`src="${address}"`), copied);
  assert.equal(await question.locator("+ button").textContent(), "Copied");
});

test("pages can be read without scripts", async (t) => {
  const { page } = await read(t, "lesson/survivors/", { settings: { javaScriptEnabled: false } });
  assert.match(await page.textContent(".steps"), /It eliminates every sample with a later turn/);
  assert.equal(await page.isVisible("noscript p"), true);
});

/** The most bytes over the network before a page can be painted: itself, its style and its first script, compressed. */
const MAX_BEFORE_PAINT = 16_000;

/** Records the parts of a page that move after they were painted. */
function recordShifts() {
  globalThis.shifts = [];
  new PerformanceObserver((list) => globalThis.shifts.push(...list.getEntries().map(({ value }) => value))).observe({ type: "layout-shift", buffered: true });
}

for (const path of PAGES) {
  test(`/${path} is painted from few bytes, and nothing in it moves`, async (t) => {
    const { server, context } = await contextOf(t);
    await context.addInitScript(recordShifts);
    const page = await context.newPage();
    const network = await context.newCDPSession(page);
    await network.send("Network.enable");
    const kinds = new Map();
    let bytes = 0;
    network.on("Network.responseReceived", ({ requestId, type, response }) => kinds.set(requestId, type === "Stylesheet" && response.url.includes("/style-") ? "Other" : type));
    network.on("Network.loadingFinished", ({ requestId, encodedDataLength }) => {
      // The program's style is loaded last, and modules wait until the page is there.
      const isBefore = ["Document", "Stylesheet"].includes(kinds.get(requestId)) || kinds.get(requestId) === "Script";
      bytes += isBefore ? encodedDataLength : 0;
    });
    await page.goto(`${server.address}/${path}`, { waitUntil: "networkidle" });
    assert.ok(bytes > 2_000 && bytes <= MAX_BEFORE_PAINT, `${bytes} bytes`);

    // Pictures have their places before they are loaded.
    const height = await page.evaluate(() => document.documentElement.scrollHeight);
    for (let top = 0; top < height; top += 700) {
      await page.evaluate((top) => scrollTo(0, top), top);
      await page.waitForLoadState("networkidle");
    }
    assert.deepEqual(await page.evaluate(() => globalThis.shifts), []);
    // Control: what pushes the text down is seen.
    await page.evaluate(() => scrollTo(0, 0));
    await page.evaluate(() => document.querySelector("main").prepend(Object.assign(document.createElement("div"), { style: "height: 300px" })));
    await page.waitForFunction(() => globalThis.shifts.length > 0);
  });
}

/** Returns what can be tapped and is lower or narrower than 44 px, apart from links within a sentence or a list of words. */
function smallTargets() {
  const isInText = (link) => link.parentElement.closest("p, li, figcaption")?.textContent.trim() !== link.textContent.trim();
  return [...document.querySelectorAll("a, button, summary")]
    .filter((one) => one.checkVisibility() && !(one.matches("a") && isInText(one) && !one.closest(".row, nav")))
    .filter((one) => !one.matches(".whole"))
    .map((one) => [one.textContent.trim(), Math.round(one.getBoundingClientRect().width), Math.round(one.getBoundingClientRect().height)])
    .filter(([, width, height]) => Math.min(width, height) < 44);
}

/** Returns what is wrong with the structure of a page. */
function faults() {
  const found = [];
  const levels = [...document.querySelectorAll("h1, h2, h3")].map((heading) => Number(heading.tagName[1]));
  if (levels[0] !== 1 || levels.filter((level) => level === 1).length !== 1) {
    found.push(`headings ${levels}`);
  }
  levels.forEach((level, index) => level > (levels[index - 1] ?? 0) + 1 && found.push(`heading ${index} skips a level`));
  for (const landmark of ["main", "header", "footer"]) {
    if (document.querySelectorAll(`body ${landmark}`).length !== 1) {
      found.push(`landmark ${landmark}`);
    }
  }
  for (const image of document.images) {
    if (!image.hasAttribute("alt")) {
      found.push(`picture ${image.src}`);
    }
  }
  for (const control of document.querySelectorAll("a, button, summary")) {
    if (!control.textContent.trim()) {
      found.push(`no name: ${control.outerHTML}`);
    }
  }
  const ids = [...document.querySelectorAll("[id]")].map(({ id }) => id);
  if (new Set(ids).size < ids.length) {
    found.push("an id is there twice");
  }
  return found;
}

/** Returns the lowest contrast of the texts of a page to what is behind them, and where it is. */
function lowestContrast() {
  const numbers = (colour) => colour.match(/[\d.]+/g).map(Number);
  const light = ([red, green, blue]) => {
    const [r, g, b] = [red, green, blue].map((part) => {
      const share = part / 255;
      return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
    });
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  let lowest = { ratio: Infinity, text: "" };
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const { parentElement: element, textContent } = walker.currentNode;
    if (!textContent.trim() || !element.checkVisibility() || element.closest("svg, noscript, template")) {
      continue;
    }
    let behind = element;
    while (behind.parentElement && numbers(getComputedStyle(behind).backgroundColor)[3] === 0) {
      behind = behind.parentElement;
    }
    const pair = [getComputedStyle(element).color, getComputedStyle(behind).backgroundColor].map((colour) => light(numbers(colour)));
    const ratio = (Math.max(...pair) + 0.05) / (Math.min(...pair) + 0.05);
    if (ratio < lowest.ratio) {
      lowest = { ratio, text: textContent.trim() };
    }
  }
  return lowest;
}

for (const path of PAGES) {
  test(`/${path} has a structure, enough contrast, and room in narrow windows`, async (t) => {
    const { page } = await read(t, path);
    await page.evaluate(() => document.querySelectorAll("details").forEach((details) => (details.open = true)));
    assert.deepEqual(await page.evaluate(faults), []);
    assert.deepEqual(await page.evaluate(smallTargets), []);
    for (const colorScheme of ["dark", "light"]) {
      await page.emulateMedia({ colorScheme });
      const { ratio, text } = await page.evaluate(lowestContrast);
      assert.ok(ratio >= 4.5 && ratio < 22, `${colorScheme}: ${ratio} of "${text}"`);
    }
    // Controls: what is looked for can be found.
    await page.evaluate(() => {
      document.querySelector("h1").insertAdjacentHTML("afterend", '<h3>x</h3><img src="">');
      Object.assign(document.querySelector("h3").style, { color: "#888", background: "#777" });
    });
    assert.equal((await page.evaluate(faults)).length, 2);
    assert.ok((await page.evaluate(lowestContrast)).ratio < 2);
    for (const [width, size] of [[320, "100%"], [640, "200%"]]) {
      await page.setViewportSize({ width, height: 800 });
      await page.evaluate((size) => (document.documentElement.style.fontSize = size), size);
      for (const direction of ["ltr", "rtl"]) {
        await page.evaluate((direction) => (document.documentElement.dir = direction), direction);
        const needed = await page.evaluate(() => document.documentElement.scrollWidth);
        assert.ok(needed <= width, `${needed} of ${width} pixels, ${direction}`);
      }
    }
  });
}
