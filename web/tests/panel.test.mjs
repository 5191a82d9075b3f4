// The lesson's panel, the elements of controls, and what main.js does around the program, with a program that only
// records: its state is given by the test. It needs neither web/build nor the native program.

import assert from "node:assert/strict";
import { once } from "node:events";
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import path from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { PATIENCE_MS, launch } from "./harness.mjs";

const here = path.dirname(fileURLToPath(import.meta.url));
const assets = path.join(here, "../../assets");
/** The texts of a language's table, by the English ones. */
const table = (language) =>
  new Map(readFileSync(path.join(assets, `words/${language}.txt`), "utf8").split("\n").flatMap((line, at, lines) => (line.startsWith("    ") ? [[lines[at - 1], line.slice(4)]] : [])));
const GERMAN = table("de");
const SPANISH = table("es");
const ENGLISH_LABELS = JSON.parse(readFileSync(path.join(assets, "lesson-labels.json"), "utf8"));
const translated = (words) => Object.fromEntries(Object.entries(ENGLISH_LABELS).map(([name, text]) => [name, words.get(text)]));
const LABELS = { en: ENGLISH_LABELS, de: translated(GERMAN), es: translated(SPANISH) };
/** The language behind another one, and that of lessons where the window is in it. */
const NEXT = { en: "de", de: "es", es: "en" };
const textLanguage = (language) => (language === "de" ? "de" : "en");
const TYPES = { ".txt": "text/plain", ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm", ".webmanifest": "application/json" };

/** Stands for the program: it records what it is asked and told, and shows the state that `show` is given. */
const PROGRAM = `
export default async function init() {}
export function load_later_with() {}
export async function start(canvas, options, hooks) {
  const calls = (window.calls ??= []);
  window.options = JSON.parse(options);
  window.change = (changes) => hooks.tree(JSON.stringify({ all: false, language: "en", elements: [], gone: [], focus: 0, ...changes }));
  window.show = (lesson) => hooks.state(JSON.stringify({ parameters: { seed: 1, radius: 0.02 }, view: { look: "dark" }, lesson }));
  return {
    ask: (request) => { calls.push(JSON.parse(request)); return JSON.stringify({ ok: true, lesson: window.lesson ?? null }); },
    takes_key: () => false, leaves_by_tab: () => false, open_link: () => {}, destroy: () => {}, left_out: () => "",
    keep: () => calls.push("keep"),
    ask_control: (...asked) => calls.push(asked),
    press_key: (...pressed) => calls.push(["press", ...pressed]),
    hold_focus: (holds) => calls.push(holds ? "held" : "left"),
    take_results: (stored) => calls.push(["results", stored]),
  };
}`;

/** A step with a question, in a language. */
function lesson(language = "en", changes = {}) {
  const labels = LABELS[language];
  const text = (words) => [{ text: words, style: "plain" }];
  const options = ["Sample 118, which has the smaller number of the two", "Sample 374"];
  const items = options.map((words, at) => ({ id: `option-${at + 1}`, mark: "AB"[at], text: text(words), curve: null, chosen: false, change: { choose: at } }));
  const question = {
    type: "choice", open: true, ask: text("Which of the two samples is eliminated?"), draft: [], hint: true, practice: true, reasons: [],
    controls: [{ control: "list", items }],
  };
  return {
    lesson: "survivors", title: "Elimination and who survives it", language, text_language: textLanguage(language), next_language: NEXT[language], step: "chain", index: 1, heading: "A chain of conflicts",
    steps: ["Too close", "A chain of conflicts", "Six turns", "One", "Two", "Three", "Four"].map((title, at) => ({ name: `step-${at}`, title, score: at === 0 ? 1 : null })),
    text: [text("Three samples are joined.")], waits: false, practice: null, question, answers: 0, may_go_on: false, reasons: [], labels, ...changes,
  };
}

/** The question of that step with a chosen option. */
function chosen(index) {
  const { question } = lesson();
  const items = question.controls[0].items.map((item, at) => ({ ...item, chosen: at === index }));
  return { ...question, draft: [{ choose: index }], controls: [{ control: "list", items }] };
}

/** The list of lessons with results. */
function list(changes = {}) {
  const entry = { name: "welcome", title: "What is this?", objective: "You see what maximal means.", minutes: 4, gates: 3, done: 1 };
  return { language: "en", text_language: "en", next_language: "de", labels: LABELS.en, list: { lessons: [entry], answered: 1, share: 1, learner: "", asked_to_clear: false, ...changes } };
}

let server;
let browser;
let address;
before(async () => {
  server = createServer((request, response) => {
    const name = new URL(request.url, "http://localhost").pathname.slice(1) || "index.html";
    const type = TYPES[path.extname(name)];
    response.setHeader("Content-Type", type ?? "application/octet-stream");
    if (name === "tilescope.js") {
      response.end(PROGRAM);
    } else if (name === "tilescope_bg.wasm") {
      response.end(Buffer.from([0, 97, 115, 109, 1, 0, 0, 0]));
    } else if (!/^[\w.-]+$/.test(name) || name === "sw.js") {
      response.writeHead(404).end();
    } else {
      const bytes = readFileSync(/^[a-z]{2}\.txt$/.test(name) ? path.join(assets, "words", name) : path.join(here, "../page", name));
      const text = bytes.toString().replace(/\{\{(?:asset|size|address):?(.*?)\}\}/g, "$1");
      // What the build writes there: a text would end the head, and the program's style would stand in the body.
      response.end(!type ? bytes : name === "index.html" ? text.replace(/\[\[.*?\]\]/g, "") : text);
    }
  });
  server.listen(0, "127.0.0.1");
  await once(server, "listening");
  address = `http://127.0.0.1:${server.address().port}/`;
  browser = await launch();
});
after(async () => {
  await browser?.close();
  server?.close();
});

/** Opens the page with a state of the lesson. */
async function shown(t, state, settings = {}, css = "") {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...settings });
  t.after(() => context.close());
  context.setDefaultTimeout(PATIENCE_MS);
  const page = await context.newPage();
  await page.goto(`${address}?play`);
  await page.waitForFunction(() => "show" in window);
  if (css) {
    await page.evaluate((css) => {
      const sheet = new CSSStyleSheet();
      sheet.replaceSync(css);
      document.adoptedStyleSheets = [sheet];
    }, css);
  }
  await show(page, state);
  return page;
}

/** Gives the page a state of the lesson. */
function show(page, state) {
  return page.evaluate((state) => {
    window.lesson = state;
    window.show(state);
  }, state);
}

/** What sticks out of the panel or the window at one side. */
function outside(page) {
  return page.evaluate(() => {
    const panel = document.getElementById("lesson");
    const far = [...panel.querySelectorAll("button, p, h2, h3, input")].filter((one) => {
      const { left, right } = one.getBoundingClientRect();
      return left < 0 || right > innerWidth;
    });
    return [...far.map((one) => one.id || one.textContent), ...(panel.scrollWidth > panel.clientWidth ? ["the panel scrolls sideways"] : [])];
  });
}

const PHONE = { width: 390, height: 844 };
for (const [name, settings, css] of [
  ["at 1280 px", {}, ""],
  ["at 320 px", { viewport: { width: 320, height: 568 } }, ""],
  ["on a phone with text of 200%", { viewport: PHONE }, ":root { font-size: 200% }"],
]) {
  test(`${name} nothing of the lesson is outside, in any language, from left to right or from right to left`, async (t) => {
    const page = await shown(t, lesson(), settings, css);
    for (const language of Object.keys(LABELS)) {
      for (const direction of ["ltr", "rtl"]) {
        await page.evaluate((direction) => (document.documentElement.dir = direction), direction);
        for (const state of [lesson(language), { ...list({ asked_to_clear: true }), language, labels: LABELS[language] }]) {
          await show(page, state);
          assert.deepEqual(await outside(page), [], `${language}, ${direction}`);
        }
      }
    }
    // Negative control: a header that does not wrap sticks out where there is no room.
    for (const direction of ["ltr", "rtl"]) {
      await page.evaluate((direction) => (document.documentElement.dir = direction), direction);
      await page.evaluate(() => document.getElementById("lesson-head").prepend(Object.assign(document.createElement("button"), { style: "min-width: 120rem" })));
      assert.notDeepEqual(await outside(page), []);
    }
  });
}

test("on a phone the canvas has at least half of the height, and targets have 44 px", async (t) => {
  const page = await shown(t, lesson(), { viewport: PHONE, hasTouch: true, isMobile: true });
  const canvas = await page.locator("#canvas").boundingBox();
  const panel = await page.locator("#lesson").boundingBox();
  assert.ok(canvas.height >= PHONE.height / 2, JSON.stringify(canvas));
  assert.ok(panel.y >= canvas.y + canvas.height - 1, "the panel stands below the canvas");
  const small = () =>
    page.locator("#lesson :is(button, input)").evaluateAll((all) => all.filter((one) => Math.min(one.offsetWidth, one.offsetHeight) < 44).map((one) => one.id));
  assert.deepEqual(await small(), []);
  await show(page, list());
  assert.deepEqual(await small(), []);
});

for (const [name, width] of [["beside", 900], ["below", 390]]) {
  test(`a frame tells the height in which a lesson ${name} the canvas is read without scrolling`, async (t) => {
    const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
    t.after(() => context.close());
    const around = await context.newPage();
    await around.route(`${address}around`, (route) =>
      route.fulfill({ contentType: "text/html", body: `<iframe src="./?embed=player" width="${width}" height="300"></iframe>` }));
    await around.goto(`${address}around`);
    await around.evaluate(() => {
      window.heights = [];
      window.addEventListener("message", ({ data }) => {
        if (data.event === "height") {
          window.heights.push(data.height);
          document.querySelector("iframe").style.height = `${data.height}px`;
        }
      });
    });
    const frame = around.frames()[1];
    await frame.waitForFunction(() => "show" in window);
    const text = Array.from({ length: 12 }, () => [{ text: "Three samples are joined, each closer than one radius to the next.", style: "plain" }]);
    for (const state of [lesson(), lesson("en", { text })]) {
      const before = await around.evaluate(() => window.heights.length);
      await frame.evaluate((state) => window.show(state), state);
      await around.waitForFunction((before) => window.heights.length > before, before);
      await frame.waitForFunction(() => document.getElementById("lesson").scrollHeight <= document.getElementById("lesson").clientHeight);
      // What is left below the lesson is less than a line of text, but where the picture needs the height.
      const { bottom, panel, height } = await frame.locator("#lesson").evaluate((one) => ({
        bottom: Math.max(...[...one.children].map((part) => part.getBoundingClientRect().bottom)), panel: one.getBoundingClientRect().bottom, height: innerHeight,
      }));
      assert.ok(panel - bottom < 24 || height === 480, `${panel - bottom} pixels of ${height} are empty`);
    }
    // Control: in the height of before the longer lesson is not seen whole.
    await around.evaluate(() => (document.querySelector("iframe").style.height = `${window.heights[0]}px`));
    await frame.waitForFunction(() => document.getElementById("lesson").scrollHeight > document.getElementById("lesson").clientHeight);
  });
}

test("buttons are renewed with the language, and each says what is written on it", async (t) => {
  const page = await shown(t, lesson("en"));
  assert.equal(await page.textContent("#lesson-back"), LABELS.en.back);
  assert.equal(await page.textContent("#lesson-language"), "Deutsch");
  for (const language of ["es", "de"]) {
    await show(page, lesson(language));
    for (const [id, label] of [["back", "back"], ["next", "next"], ["answer", "answer"], ["hint", "hint"], ["list", "lessons"], ["language", "other_language"]]) {
      assert.equal(await page.textContent(`#lesson-${id}`), LABELS[language][label], id);
    }
    // Lessons that are not translated stay English, and are read out as such.
    const spoken = await page.evaluate(() => ["lesson", "lesson-text", "lesson-language"].map((id) => document.getElementById(id).lang));
    assert.deepEqual(spoken, [language, textLanguage(language), NEXT[language]]);
  }
  const hidden = () =>
    page.locator("#lesson button[aria-label]").evaluateAll((all) =>
      all.filter((one) => /\w/.test(one.textContent) && !one.getAttribute("aria-label").includes(one.textContent)).map((one) => one.id),
    );
  assert.deepEqual(await hidden(), []);
  // No level of headings is left out.
  await show(page, list());
  const levels = await page.locator(":is(h1, h2, h3):visible").evaluateAll((all) => all.map((one) => Number(one.tagName[1])));
  assert.ok(levels.every((level, at) => at === 0 || level <= levels[at - 1] + 1), String(levels));
});

test("the title of tab and bookmark is the lesson's", async (t) => {
  const page = await shown(t, lesson());
  assert.equal(await page.title(), "A chain of conflicts, Elimination and who survives it \u2013 Tilescope");
  await show(page, list());
  assert.equal(await page.title(), "Lessons \u2013 Tilescope");
  await show(page, null);
  assert.equal(await page.title(), "Seed 1, r 0.02 \u2013 Tilescope");
});

test("in forced colours the chosen answer differs from the others", async (t) => {
  const page = await shown(t, lesson("en", { question: chosen(1) }), { forcedColors: "active" });
  const look = (id) => page.locator(id).evaluate((one) => ["backgroundColor", "color", "borderColor"].map((name) => getComputedStyle(one)[name]).join());
  const other = await look("#lesson-option-1");
  assert.notEqual(await look("#lesson-option-2"), other);
  assert.notEqual(await look("#lesson-step-1"), await look("#lesson-step-2"));
});

test("the system's preference for light is passed on, and the page's own sheets follow it", async (t) => {
  const shade = (page) => page.locator("#failure .card").evaluate((one) => getComputedStyle(one).backgroundColor);
  const light = await shown(t, null, { colorScheme: "light" });
  const dark = await shown(t, null, { colorScheme: "dark" });
  for (const [page, is] of [[light, true], [dark, false]]) {
    assert.equal(await page.evaluate(() => window.options.light), is);
  }
  assert.notEqual(await shade(light), await shade(dark));
});

test("on paper the lesson is dark on white, whole, below the picture", async (t) => {
  const page = await shown(t, lesson("en", { text: Array.from({ length: 60 }, () => [{ text: "A line of text.", style: "plain" }]) }));
  await page.emulateMedia({ media: "print" });
  const panel = await page.locator("#lesson").evaluate((one) => {
    const { color, backgroundColor, position } = getComputedStyle(one);
    return { color, backgroundColor, position, hides: one.scrollHeight > one.clientHeight + 1 };
  });
  assert.deepEqual(panel, { color: "rgb(0, 0, 0)", backgroundColor: "rgb(255, 255, 255)", position: "static", hides: false });
});

test("an answer that is put together stays when the page is reloaded", async (t) => {
  const answered = lesson("en", { question: chosen(1) });
  const page = await shown(t, answered);
  const drafts = () => page.evaluate(() => window.calls.filter((call) => call.draft).map((call) => call.draft));
  assert.deepEqual(await drafts(), []);
  await page.reload();
  await page.waitForFunction(() => "show" in window);
  // The question comes once its run is made.
  await show(page, lesson("en", { question: null }));
  await show(page, lesson());
  await page.waitForFunction(() => window.calls.some((call) => call.draft));
  assert.deepEqual(await drafts(), [{ choose: 1 }]);
  // Another question does not get it.
  await show(page, answered);
  await page.reload();
  await page.waitForFunction(() => "show" in window);
  await show(page, lesson("en", { step: "other" }));
  await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 0)));
  assert.deepEqual(await drafts(), []);
});

test("the program is asked to store when the page is hidden, and gets what another tab stores", async (t) => {
  const page = await shown(t, lesson());
  const other = await page.context().newPage();
  await other.goto(address);
  await other.evaluate(() => {
    localStorage.setItem("look", "[]");
    localStorage.setItem("lessons", "results");
  });
  await page.waitForFunction(() => window.calls.some((call) => call[0] === "results"));
  const calls = await page.evaluate(() => {
    window.dispatchEvent(new Event("pagehide"));
    return window.calls;
  });
  assert.deepEqual(calls, [["results", "results"], "keep"]);
});

test("clearing the results is asked once more", async (t) => {
  const page = await shown(t, list());
  assert.equal(await page.locator("#lesson-keep").count(), 0);
  await page.click("#lesson-clear");
  await show(page, list({ asked_to_clear: true }));
  assert.equal(await page.getByRole("alert").textContent(), LABELS.en.clear_all);
  await page.click("#lesson-keep");
  assert.deepEqual(await page.evaluate(() => window.calls.map((call) => call.act)), ["clear", "keep"]);
});

test("on a phone the verdict is seen after the answer", async (t) => {
  const long = Array.from({ length: 12 }, () => [{ text: "Three samples are joined, each closer than one radius to the next.", style: "plain" }]);
  const page = await shown(t, lesson("en", { text: long }), { viewport: PHONE, hasTouch: true, isMobile: true });
  const inView = () =>
    page.locator("#lesson-feedback").evaluate((one) => {
      const { top, bottom } = one.getBoundingClientRect();
      return top >= document.getElementById("lesson").getBoundingClientRect().top && bottom <= innerHeight && bottom > top;
    });
  const after = [{ text: "What follows the answer.", style: "plain" }];
  const answered = lesson("en", { text: long, verdict: "Right.", after: long.concat([after]), question: { ...lesson().question, open: false } });
  assert.equal(await inView(), false);
  await page.evaluate((answered) => (window.lesson = answered), answered);
  await page.click("#lesson-answer");
  assert.equal(await page.textContent("#lesson-feedback"), "Right.");
  assert.equal(await inView(), true);
});

/** The texts of the page, also those that only screen readers read. */
function texts(page) {
  return page.evaluate(() => {
    const labels = ["aria-label", "alt", "placeholder", "title"].flatMap((name) => [...document.querySelectorAll(`main [${name}]`)].map((one) => one.getAttribute(name)));
    const found = [document.title];
    const walker = document.createTreeWalker(document.querySelector("main"), NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
      found.push(walker.currentNode.data);
    }
    return [...found, ...labels].map((text) => text.trim());
  });
}

/** The texts with words that a German page shares with an English one. A laser has one name in both. */
function shared(german, english) {
  return german.filter((text) => /[a-z]{3}/i.test(text) && text !== "Laser (L)" && english.includes(text));
}

/** Opens a page without the program, for a browser of a language. */
async function other(t, fragment, locale) {
  const context = await browser.newContext({ locale });
  t.after(() => context.close());
  const page = await context.newPage();
  await page.goto(`${address}#${fragment}`);
  return page;
}

test("the voting card speaks the language of its link, or the browser's", async (t) => {
  const said = [];
  for (const [fragment, locale] of [["card", "en-GB"], ["card", "de-AT"], ["card&language=de", "en-GB"], ["card&language=en", "de-DE"], ["card", "es-MX"]]) {
    const page = await other(t, fragment, locale);
    await page.locator("#card button").last().waitFor();
    said.push({ lang: await page.getAttribute("html", "lang"), texts: await texts(page) });
  }
  const [english, german, linked, back, spanish] = said;
  assert.deepEqual(shared(german.texts, english.texts), []);
  assert.ok(german.texts.includes("B, Quadrat"), german.texts.join("; "));
  assert.equal(spanish.lang, "es");
  assert.deepEqual(shared(spanish.texts, english.texts), []);
  assert.deepEqual(linked, { ...german, lang: "de" });
  assert.deepEqual(back, { ...english, lang: "en" });
  // Negative control: a page that is not translated shares its texts.
  assert.ok(shared(back.texts, english.texts).length > 2);
});

/** What a stage tells the notes. */
function talk(changes = {}) {
  const text = (words) => [{ text: words, style: "plain" }];
  const seconds = Date.now() / 1000;
  return {
    title: "1", notes: [text("2")], ask: text("3"), answer: "4", hint: text("5"), votes: [{ counts: [3, 4] }], vote_fault: null, advice: "discuss", next: "6",
    picture: "<svg xmlns='http://www.w3.org/2000/svg'/>", step: 1, steps: 5, part: 1, parts: 1, begun: seconds, step_begun: seconds, waits: true, voting: false,
    blank: false, over: false, planned: { before: 10, this: 10, all: 60 }, kept: { lesson: ["welcome"] }, ...changes,
  };
}

test("the notes of a talk speak the language of the talk", async (t) => {
  // Between them these have every text of the notes.
  const states = [
    {},
    { parts: 8, advice: "explain", voting: true, votes: [{ right: "few" }, { right: "most" }], planned: { before: 0, this: 10, all: 60 } },
    { begun: Date.now() / 1000 - 40, advice: "go-on", waits: false, next: null, picture: null },
    { blank: true, over: true, ask: null, votes: [] },
  ];
  const said = [];
  for (const [language, locale] of [["en", "de"], ["de", "en-GB"]]) {
    const page = await other(t, "notes=tilescope-test", locale);
    await page.locator("#notes").waitFor();
    const stage = await page.context().newPage();
    await stage.goto(`${address}#card`);
    // Before the first state of a talk the notes have the browser's language.
    const found = await texts(page);
    assert.ok(found.includes(locale === "de" ? GERMAN.get("No talk is given.") : "No talk is given."), found.join("; "));
    const of_language = [];
    for (const [index, changes] of states.entries()) {
      await stage.evaluate((talk) => new BroadcastChannel("tilescope-test").postMessage({ talk }), talk({ language, step: index + 1, ...changes }));
      await page.getByText(`${language === "de" ? "Schritt" : "Step"} ${index + 1} `).waitFor();
      of_language.push(...(await texts(page)));
    }
    said.push(of_language);
  }
  const [english, german] = said;
  assert.deepEqual(shared(german, english), []);
  assert.ok(german.includes("Erste Abstimmung: A 3, B 4"), german.join("; "));
});

test("numbers of a plot have the decimal sign of the lesson's language", async (t) => {
  const controls = [{ control: "plot", curves: [[[0, 1]]] }];
  for (const [language, expected] of [["en", "2.5 / r"], ["de", "2,5 / r"]]) {
    const state = lesson(language);
    const page = await shown(t, { ...state, question: { ...state.question, controls } });
    const said = await page.textContent("#lesson-question");
    assert.ok(said.includes(expected), `${language}: ${expected} in ${said}`);
  }
});

test("the example pages have a main landmark that holds all", async (t) => {
  const context = await browser.newContext();
  t.after(() => context.close());
  const page = await context.newPage();
  for (const name of ["plan.html", "plan.de.html", "lecture.html"]) {
    await page.setContent(readFileSync(path.join(here, "../example", name), "utf8").replace(/<(script|link)[^>]*>/g, ""));
    assert.equal(await page.getByRole("main").count(), 1, name);
    assert.equal(await page.locator("body > :not(main)").count(), 0, name);
  }
});

/** The entries of the list whose minutes are broken at some width of the panel. */
function broken(page) {
  return page.evaluate(() => {
    const panel = document.getElementById("lesson");
    const found = new Set();
    for (let width = 260; width <= 420; width += 4) {
      panel.style.width = `${width}px`;
      for (const objective of panel.querySelectorAll(".lessons p")) {
        const [text, at] = [objective.firstChild, objective.textContent.lastIndexOf("(")];
        const minutes = document.createRange();
        minutes.setStart(text, at);
        minutes.setEnd(text, objective.textContent.indexOf(")", at) + 1);
        const lines = new Set([...minutes.getClientRects()].map((line) => Math.round(line.top)));
        if (lines.size > 1) {
          found.add(objective.textContent);
        }
      }
    }
    return [...found];
  });
}

test("in the list no line breaks within the minutes, and lines begin at one edge", async (t) => {
  const entry = (index) => ({
    name: `lesson-${index}`, title: "A title that is too long for one line of the panel beside the canvas", objective: "You see what maximal means.", minutes: 10, gates: 3, done: 0,
  });
  const long = list({ lessons: [0, 1, 2].map(entry) });
  const page = await shown(t, long);
  assert.equal(await page.getByRole("button", { name: `1. ${entry(1).title}`, exact: true }).count(), 1);
  assert.deepEqual(await broken(page), []);
  const edges = await page.locator(".lessons li").evaluateAll((all) =>
    all.map((one) => {
      const text = one.querySelector("p").firstChild;
      const objective = document.createRange();
      objective.selectNode(text);
      const title = document.createRange();
      title.selectNodeContents(one.querySelector(".link span:last-child"));
      return [title, objective].flatMap((range) => [...range.getClientRects()].map((line) => Math.round(line.left)));
    }),
  );
  assert.ok(edges.flat().length > 6, `${edges}: no title goes on in a second line`);
  assert.equal(new Set(edges.flat()).size, 1, String(edges));
  // A short title stands in the middle of its target.
  await show(page, list());
  const offset = await page.locator(".lessons .link").evaluate((link) => {
    const middle = ({ top, height }) => top + height / 2;
    const title = document.createRange();
    title.selectNodeContents(link.lastChild);
    return middle(link.getBoundingClientRect()) - middle(title.getBoundingClientRect());
  });
  assert.ok(Math.abs(offset) <= 1, `${offset}`);
  await show(page, long);
  // Negative control: with a blank that breaks, some width breaks the minutes.
  await page.locator(".lessons p").evaluateAll((all) => all.forEach((one) => (one.textContent = one.textContent.replaceAll("\u00a0", " "))));
  assert.notDeepEqual(await broken(page), []);
});

for (const [name, settings] of [["beside the canvas", {}], ["on a phone", { viewport: PHONE, hasTouch: true, isMobile: true }]]) {
  test(`a wrong answer puts no other button under the pointer, ${name}`, async (t) => {
    const question = chosen(0);
    const wrong = lesson("en", { verdict: LABELS.en.wrong, sentence: [{ text: "The other one has the larger number. ".repeat(4), style: "plain" }], answers: 1, question: { ...question, tries: 1 } });
    const last = { index: 6, step: "step-6" };
    const page = await shown(t, lesson("en", { question, ...last }), settings);
    const answer = page.locator("#lesson-answer");
    await answer.scrollIntoViewIfNeeded();
    const { x, y, width, height } = await answer.boundingBox();
    const [middleX, middleY] = [x + width / 2, y + height / 2];
    const under = () => page.evaluate(([x, y]) => document.elementFromPoint(x, y)?.closest("button")?.id ?? "", [middleX, middleY]);
    assert.equal(await under(), "lesson-answer");
    await page.evaluate((wrong) => (window.lesson = wrong), { ...wrong, ...last });
    await answer.click();
    assert.match(await page.textContent("#lesson-feedback"), /larger number/);
    assert.ok(["", "lesson-answer"].includes(await under()), await under());
    // The verdict goes when another answer is chosen; the button stays where it is.
    const before = await page.evaluate(() => document.getElementById("lesson-answer").offsetTop);
    await show(page, lesson("en", { question: chosen(1), ...last }));
    assert.equal(await page.textContent("#lesson-feedback"), "");
    assert.equal(await page.evaluate(() => document.getElementById("lesson-answer").offsetTop), before);
    // Negative control: a verdict above the button moves it.
    await show(page, { ...wrong, ...last });
    await page.evaluate(() => document.getElementById("lesson-question").before(document.getElementById("lesson-feedback")));
    assert.notEqual(await page.evaluate(() => document.getElementById("lesson-answer").offsetTop), before);
  });
}

test("the plan shows what the class sees without scrolling", async (t) => {
  // The policy of the page has no place for the style sheet of a test.
  const context = await browser.newContext({ viewport: { width: 1600, height: 900 }, bypassCSP: true });
  t.after(() => context.close());
  const page = await context.newPage();
  const [html, css] = ["plan.html", "lecture.css"].map((name) => readFileSync(path.join(here, "../example", name), "utf8"));
  await page.setContent(html.replace(/<(script|link)[^>]*>/g, ""));
  await page.addStyleTag({ content: css });
  const ends = () => page.locator("#tilescope, #now").evaluateAll((all) => all.map((one) => one.getBoundingClientRect().bottom));
  for (const end of await ends()) {
    assert.ok(end <= 900, `${end}`);
  }
  assert.ok((await page.locator("#tilescope").boundingBox()).width >= 560, "the player has its timeline beside the controls");
  // Negative control: below the plan it is not seen.
  await page.evaluate(() => document.body.classList.remove("plan"));
  assert.ok((await ends()).some((end) => end > 900));
});

/** A window with one element of each kind that the program describes. */
const PLACE = [100, 20, 50, 20];
const CONTROLS = [
  { role: "button", name: "Play", focusable: true, place: [10, 20, 80, 30] },
  { role: "button", name: "Lasso", on: "true", focusable: true },
  { role: "button", name: "File", opens: "menu", expanded: true, focusable: true },
  { role: "menu", children: [5, 6] },
  { role: "menuitem", name: "Export", focusable: true, place: [0, 0, 90, 30] },
  { role: "menuitemcheckbox", name: "Grid", on: "false", disabled: true, focusable: true },
  { role: "label", value: "Radius" },
  { role: "text", labels: [7], value: "0.02", focusable: true },
  { role: "number", name: "Event", steps: true, number: 7, least: 0, most: 99, value: "7", focusable: true },
  { role: "range", name: "Time", steps: true, number: 0.5, least: 0, most: 1, focusable: true },
  { role: "checkbox", name: "Live", on: "mixed", focusable: true },
  { role: "radio", name: "Periodic", on: "true", focusable: true },
  { role: "combobox", name: "Clock", value: "event", opens: "listbox", expanded: false, focusable: true },
  { role: "listbox", name: "Passes", children: [15], focusable: true },
  { role: "option", name: "Pass 1", on: "true", focusable: true },
  { role: "link", name: "The paper", focusable: true },
  { role: "heading", name: "Samples" },
  { role: "img", name: "Canvas A", description: "Sample 7", focusable: true },
  { role: "dialog", name: "Export", children: [20] },
  { role: "area", name: "Notes", value: "a", focusable: true },
  { role: "progressbar", name: "Sampling", number: 0.25, least: 0, most: 1 },
].map((element, at) => [at + 1, { place: PLACE, ...element }]);
/** Those at the top. */
const TOP = CONTROLS.map(([number]) => number).filter((number) => ![5, 6, 15, 20].includes(number));

/** Opens the page with those controls. */
async function controls(t) {
  const page = await shown(t, null);
  await page.evaluate((changes) => window.change(changes), { all: true, elements: CONTROLS, top: TOP });
  return page;
}

/** Counts what a change of the tree does to the elements. */
function operations(page, changes) {
  return page.evaluate((changes) => {
    const observer = new MutationObserver(() => {});
    observer.observe(document.getElementById("tree"), { attributes: true, characterData: true, childList: true, subtree: true });
    window.change(changes);
    return observer.takeRecords().map((record) => record.attributeName ?? record.type);
  }, changes);
}

test("controls of the canvas are elements with role, name, value and state, where they are drawn", async (t) => {
  const page = await controls(t);
  const snapshot = await page.locator("#tree").ariaSnapshot();
  assert.equal(
    snapshot,
    `- region "Controls of Tilescope":
  - button "Play"
  - button "Lasso" [pressed]
  - button "File" [expanded]
  - menu:
    - menuitem "Export"
    - menuitemcheckbox "Grid" [disabled]
  - text: Radius
  - textbox "Radius": "0.02"
  - spinbutton "Event": "7"
  - slider "Time": "0.5"
  - checkbox "Live" [checked=mixed]
  - radio "Periodic" [checked]
  - combobox "Clock": event
  - listbox "Passes":
    - option "Pass 1" [selected]
  - link "The paper"
  - heading "Samples" [level=2]
  - img "Canvas A"
  - dialog "Export":
    - textbox "Notes": a
  - progressbar "Sampling"`,
  );
  assert.deepEqual(await page.getByRole("button", { name: "Play" }).boundingBox(), { x: 10, y: 20, width: 80, height: 30 });
  // The pointer belongs to the canvas.
  assert.equal(await page.evaluate(() => document.elementFromPoint(30, 30).id), "canvas");
  // Tab does not lead through the elements: their order is the program's.
  const inTabOrder = () => page.locator("#tree *").evaluateAll((all) => all.filter((one) => one.tabIndex >= 0).length);
  assert.equal(await inTabOrder(), 0);
  // Negative control: a button is in the order by itself.
  await page.evaluate(() => document.getElementById("t1").removeAttribute("tabindex"));
  assert.equal(await inTabOrder(), 1);
});

test("a change touches what has changed and nothing else", async (t) => {
  const page = await controls(t);
  assert.deepEqual(await operations(page, {}), []);
  assert.deepEqual(await operations(page, { elements: CONTROLS }), []);
  assert.deepEqual(await operations(page, { elements: [[7, { role: "label", value: "Radius r" }]] }), ["childList"]);
  assert.deepEqual(await operations(page, { elements: [[1, { ...CONTROLS[0][1], place: [10, 21, 80, 30] }]] }), ["style"]);
  // An element that comes between others moves none of them.
  const top = [TOP[0], 30, ...TOP.slice(1)];
  assert.deepEqual(await operations(page, { elements: [[30, { role: "label", value: "New" }]], top }), ["childList"]);
  assert.deepEqual(await operations(page, { gone: [30], top: TOP }), ["childList"]);
});

test("what is done to an element is asked of the program", async (t) => {
  const page = await controls(t);
  const calls = async (act) => {
    await page.evaluate(() => (window.calls.length = 0));
    await act();
    return page.evaluate(() => window.calls.splice(0));
  };
  const role = (name, options) => page.getByRole(name, options);
  assert.deepEqual(await calls(() => role("button", { name: "Play" }).press("Enter")), ["held", [1, "focus", ""], [1, "click", ""]]);
  assert.deepEqual(await calls(() => role("checkbox").press("Space")), ["held", [11, "focus", ""], [11, "click", ""]]);
  // A click without a key is what screen readers and voice control send.
  assert.deepEqual(await calls(() => role("option").dispatchEvent("click")), [[15, "click", ""]]);
  assert.deepEqual(await calls(() => role("menuitemcheckbox").dispatchEvent("click")), [], "it is disabled");
  assert.deepEqual(await calls(() => role("slider").press("ArrowRight")), ["held", [10, "focus", ""], [10, "increment", ""]]);
  assert.deepEqual(await calls(() => role("spinbutton").press("ArrowDown")), ["held", [9, "focus", ""], [9, "decrement", ""]]);
  assert.deepEqual(await calls(() => role("spinbutton").fill("12")), [[9, "number", "12"]]);
  assert.deepEqual(await calls(() => role("textbox", { name: "Radius" }).press("End")), ["held", [8, "focus", ""]]);
  assert.deepEqual(await calls(() => page.keyboard.type("5")), [[8, "text", "0.025"]]);
  // All other keys are the program's.
  assert.deepEqual(await calls(() => page.keyboard.press("Enter")), [["press", "Enter", "Enter", false, false, false]]);
  assert.deepEqual(await calls(() => page.keyboard.press("Shift+Tab")), [["press", "Tab", "Tab", false, true, false]]);
  assert.deepEqual(await calls(() => role("img").press("ArrowUp")), ["held", [18, "focus", ""], ["press", "ArrowUp", "ArrowUp", false, false, false]]);
  assert.deepEqual(await calls(() => page.focus("#canvas")), ["left"]);
  // What was scrolled out of the window comes into view.
  await page.evaluate(() => (document.getElementById("t16").style.top = "2000px"));
  assert.deepEqual(await calls(() => role("link").focus()), ["held", [16, "focus", ""], [16, "show", ""]]);
});

test("the page's focus follows the program's while it is on an element, and outlives elements", async (t) => {
  const page = await controls(t);
  const focused = () => page.evaluate(() => document.activeElement.id);
  const change = (changes) => page.evaluate((changes) => window.change(changes), changes);
  await page.focus("#canvas");
  await change({ focus: 1 });
  assert.equal(await focused(), "canvas");
  await page.getByRole("button", { name: "File" }).focus();
  await change({ focus: 5 });
  assert.equal(await focused(), "t5");
  // The menu is closed: the focus returns to the button that had it before.
  await change({ gone: [4, 5, 6], top: TOP.filter((number) => number !== 4) });
  assert.equal(await focused(), "t3");
  assert.deepEqual(await page.evaluate(() => window.calls.at(-1)), [3, "focus", ""]);
  // An element whose kind changes keeps it, too.
  await change({ elements: [[3, { role: "text", name: "File", focusable: true }]], focus: 3 });
  assert.equal(await focused(), "t3");
  assert.equal(await page.evaluate(() => document.activeElement.tagName), "INPUT");
});

test("what is being typed is not replaced by what the program had before", async (t) => {
  const page = await controls(t);
  const field = page.getByRole("textbox", { name: "Radius" });
  await field.fill("0.0");
  await page.evaluate(() => window.change({ elements: [[8, { role: "text", labels: [7], value: "0", focusable: true }]] }));
  assert.equal(await field.inputValue(), "0.0");
  // Later the field shows what the program made of it.
  await page.waitForFunction(() => document.getElementById("t8").value === "0");
});

test("a live text is announced once", async (t) => {
  const page = await controls(t);
  const tell = (value) => page.evaluate((value) => window.change({ elements: [[40, { role: "label", value, live: true }]], top: [40] }), value);
  const said = () => page.textContent("#announcer");
  await tell("Event 1");
  assert.equal(await said(), "Event 1");
  await page.evaluate(() => (document.getElementById("announcer").textContent = "A verdict. Event 2"));
  await tell("Event 2");
  assert.equal(await said(), "A verdict. Event 2");
});
