// The controls of the canvas as elements of the page: the program is used by roles and names alone, as a screen reader
// does, and what that costs is counted.

import assert from "node:assert/strict";
import { test } from "node:test";
import { controls, findings, nameless } from "./controls.mjs";
import { ask, state, until } from "./harness.mjs";
import { opened, reused, started } from "./shared.mjs";

/** Waits until the element with the page's focus has a name like this. @param {import("playwright-core").Page} page @param {RegExp} name */
async function focused(page, name) {
  await page.waitForFunction((name) => new RegExp(name).test(document.activeElement?.getAttribute("aria-label") ?? document.activeElement?.textContent ?? ""), name.source);
}

/** Presses an entry of the list of all actions. @param {import("playwright-core").Page} page @param {string} name */
async function act(page, name) {
  await page.focus("#canvas");
  await page.keyboard.press("Control+k");
  const list = controls(page).getByRole("dialog");
  await list.waitFor();
  await page.keyboard.type(name);
  // The list follows what is typed, a moment later.
  await until("the action", async () => (await list.getByRole("button").first().textContent()).startsWith(name));
  await page.keyboard.press("Enter");
  await until("the end of the list", async () => (await list.getByRole("textbox", { name: "Find an action" }).count()) === 0);
}

/** Counts changes of the elements from now on. @param {import("playwright-core").Page} page */
function count(page) {
  return page.evaluate(() => {
    window.changes = [];
    const observer = new MutationObserver((records) => window.changes.push(...records.map(({ target, attributeName, type }) => `${attributeName ?? type} of ${target.id}`)));
    observer.observe(document.getElementById("tree"), { attributes: true, characterData: true, childList: true, subtree: true });
  });
}

/** The changes since the last call. @param {import("playwright-core").Page} page @returns {Promise<string[]>} */
const changes = (page) => page.evaluate(() => window.changes.splice(0));

test("a run is changed, made, stepped through and judged by roles and names alone", async (t) => {
  const { page } = await reused(t);
  const tree = controls(page);
  const seed = tree.getByRole("textbox", { name: "Seed", exact: true });
  await seed.fill("7");
  await tree.getByRole("button", { name: "Run to apply" }).press("Enter");
  await state(page, (told) => told.seed === 7 && told.verified);
  await tree.getByRole("button", { name: "Verdict: verified" }).waitFor();
  // The verdict's panel has its parts.
  await tree.getByRole("group").filter({ hasText: "Conflict-free" }).filter({ hasText: "yes" }).waitFor();

  await tree.getByRole("button", { name: "First stage (Home)", disabled: false }).press("Enter");
  await state(page, (told) => told.cursor === 0);
  await tree.getByRole("button", { name: "Stage forward (Right)" }).press("Enter");
  const { cursor } = await state(page, (told) => told.cursor > 0);
  // A slider is set by its value, as by a swipe with a screen reader.
  const moment = tree.getByRole("slider", { name: "Moment" });
  await until("the moment on the slider", async () => Number(await moment.inputValue()) === cursor);
  await moment.fill("1000");
  await state(page, (told) => told.cursor === 1000);
  // The picture says what has happened.
  const { sentence } = await state(page);
  await until("the sentence", async () => (await tree.getByRole("img", { name: "Canvas of samples" }).getAttribute("aria-description")) === sentence);

  // A list opens, is chosen from, and closes.
  const boundary = tree.getByRole("combobox", { name: "Boundary", exact: true });
  assert.equal(await boundary.getAttribute("aria-expanded"), "false");
  await boundary.press("Enter");
  await tree.getByRole("option", { name: "bounded" }).press("Enter");
  await until("the choice", async () => (await boundary.textContent()) === "bounded");
  await until("the end of the list", async () => (await tree.getByRole("option", { name: "periodic" }).count()) === 0);
  await until("the focus on the list's button", () => boundary.evaluate((one) => one === document.activeElement));
});

test("each menu opens and closes, and leads to the export and to a lesson", async (t) => {
  const { page } = await started(t, "?engine=cpu#v=1&radius=0.02");
  const tree = controls(page);
  const menus = tree.locator("[aria-haspopup=menu]");
  const names = await menus.allTextContents();
  for (const name of ["File", "Edit", "View", "Go", "Debug", "Analyze", "Compare", "Help", "Presets"]) {
    assert.ok(names.includes(name), `${name} in ${names}`);
    const button = menus.getByText(name, { exact: true });
    await button.press("Enter");
    await tree.getByRole("menu").waitFor();
    assert.equal(await button.getAttribute("aria-expanded"), "true");
    assert.ok((await tree.getByRole("menuitem").or(tree.getByRole("menuitemcheckbox")).count()) > 1, name);
    assert.deepEqual(await nameless(page), []);
    await page.keyboard.press("Escape");
    await until("the end of the menu", async () => (await tree.getByRole("menu").count()) === 0);
    assert.equal(await button.getAttribute("aria-expanded"), "false");
    // The focus comes back to where it was.
    await focused(page, new RegExp(name));
    if (name === "File") {
      // So does the program's: Tab goes on from there.
      await page.keyboard.press("Tab");
      await focused(page, /Edit/);
    }
  }

  await tree.getByRole("button", { name: "File", exact: true }).press("Enter");
  await tree.getByRole("menuitem", { name: /^Export samples…/ }).press("Enter");
  const dialog = tree.getByRole("dialog", { name: "Export" });
  await dialog.getByRole("textbox", { name: "File name" }).waitFor();
  assert.deepEqual(await nameless(page), []);
  await dialog.getByRole("button", { name: "Close window" }).press("Enter");
  await until("the end of the sheet", async () => (await dialog.count()) === 0);

  await tree.getByRole("button", { name: "Help", exact: true }).press("Enter");
  await tree.getByRole("menuitem", { name: "Lessons…" }).press("Enter");
  const lesson = page.getByRole("complementary", { name: "Lesson" });
  await lesson.getByRole("button", { name: /Who survives/ }).click();
  await lesson.getByRole("button", { name: "Next" }).click();
  await lesson.getByRole("button", { name: /Sample \d+$/ }).first().click();
  await lesson.getByRole("button", { name: "Answer" }).click();
  await until("a verdict", async () => /\S/.test(await lesson.getByRole("status").first().textContent()));
});

test("a still frame changes no element, a step few, and a run that plays only texts and states", async (t) => {
  const { page } = await reused(t);
  const tree = controls(page);
  await count(page);
  const rest = () => until("elements at rest", async () => (await page.waitForTimeout(600), (await changes(page)).length === 0));
  await rest();
  /** Draws frames by moving the pointer where nothing is. */
  const draw = async () => {
    for (let step = 0; step < 10; step++) {
      await page.mouse.move(5 + (step % 2), 795);
      await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
    }
  };
  await draw();
  assert.deepEqual(await changes(page), []);

  // Negative control: a step is counted.
  const all = await tree.locator("*").count();
  await ask(page, { do: "seek", event: 1000 });
  await until("a change", () => page.evaluate(() => window.changes.length > 0));
  await rest();
  await ask(page, { do: "step", by: 1, unit: "event" });
  await until("a change", () => page.evaluate(() => window.changes.length > 0));
  await page.waitForTimeout(1000);
  const ofStep = await changes(page);
  assert.ok(ofStep.length < all / 4, `${ofStep.length} changes for a step, of ${all} elements`);

  await tree.getByRole("button", { name: /^Play/ }).press("Enter");
  await until("a run that plays", async () => (await state(page)).cursor > 1100);
  await changes(page);
  const before = await tree.locator("*").evaluateAll((elements) => elements.map((one) => one.id));
  await page.waitForTimeout(2000);
  const ofPlay = await changes(page);
  const after = await tree.locator("*").evaluateAll((elements) => elements.map((one) => one.id));
  t.diagnostic(`${ofStep.length} changes for a step, ${ofPlay.length} in two seconds of play, of ${all} elements`);
  assert.ok(ofPlay.length > 0 && ofPlay.length < all, `${ofPlay.length} changes in play`);
  // Texts change within their elements, which stay.
  assert.deepEqual(after, before);
  await page.keyboard.press("Space");
});

test("the focus of page and program follow each other, and keys stay the program's", async (t) => {
  const { page } = await reused(t);
  const tree = controls(page);
  // Elements follow the program within a quarter of a second.
  await tree.getByRole("button", { name: "First stage (Home)", disabled: false }).focus();
  await page.keyboard.press("Tab");
  // The order is the program's. What cannot be used is left out.
  await focused(page, /^Stage back/);
  await page.keyboard.press("Shift+Tab");
  await focused(page, /^First stage/);
  await page.keyboard.press("Home");
  await state(page, (told) => told.cursor === 0);
  await page.keyboard.press("Control+k");
  await focused(page, /^Find an action/);
  await page.keyboard.type("fit the");
  await tree.getByRole("dialog").getByRole("button", { name: "Fit the domain" }).waitFor();
  await page.keyboard.press("Escape");
  await until("the end of the list", async () => (await tree.getByRole("dialog").count()) === 0);
  // On the canvas the keys work as before, and the page's focus stays there.
  await page.focus("#canvas");
  await page.keyboard.press("End");
  await state(page, (told) => told.cursor === told.events);
  await page.keyboard.press("Tab");
  await page.waitForFunction(() => document.getElementById("announcer").textContent.length > 3);
  assert.equal(await page.evaluate(() => document.activeElement.id), "canvas");
  // Escape and then Tab lead out of the elements, too.
  await tree.getByRole("button", { name: "First stage (Home)", disabled: false }).focus();
  await page.keyboard.press("Escape");
  await page.keyboard.press("Tab");
  await page.waitForFunction(() => !document.getElementById("tree").contains(document.activeElement));
});

test("samples, gaps and blocks are explored and selected by a list", async (t) => {
  const { page } = await reused(t);
  const tree = controls(page);
  await ask(page, { do: "seek", stage: "eliminate" });
  const list = tree.getByRole("listbox", { name: "Canvas of samples: Objects in view" });
  for (const name of [/^Gap: area .* r², deepest .* r, at /, /^Sample \d+ (of|from the margin of) block \d+: /, /^Block \d+: /]) {
    await list.getByRole("option", { name }).first().waitFor();
  }
  await list.getByRole("option", { name: /^[\d,]+ more samples in view$/, disabled: true }).waitFor();
  const selected = list.getByRole("option", { selected: true });
  assert.equal(await selected.count(), 0);

  // What is pressed is selected in the program, and the inspector shows it.
  const sample = list.getByRole("option", { name: /^Sample / }).first();
  const number = (await sample.textContent()).match(/[\d,]+/)[0];
  await sample.press("Enter");
  await tree.getByRole("heading", { name: "Selected sample" }).waitFor();
  await tree.getByRole("group", { name: "Id", exact: true }).filter({ hasText: number }).waitFor();
  await until("the selection", async () => (await selected.count()) === 1 && (await selected.textContent()).startsWith(`Sample ${number} `));

  // Arrows choose the next one, and the focus stays with the list.
  await until("the focus on the list", () => list.evaluate((one) => one === document.activeElement));
  await page.keyboard.press("ArrowDown");
  await until("the next one", async () => (await selected.count()) === 1 && !(await selected.textContent()).startsWith(`Sample ${number} `));
  assert.equal(await list.getAttribute("aria-activedescendant"), await selected.getAttribute("id"));

  // An open question has answers, and no list that could give one away.
  await ask(page, { do: "lesson", open: "survivors", step: "one-of-two" });
  await state(page, (told) => told.ready && told.lesson?.question);
  await until("no list", async () => (await list.count()) === 0);
  await ask(page, { do: "lesson", act: "leave" });
});

test("a comparison is read as tables of heads, rows and cells, and a choice of buttons as a group", async (t) => {
  const { page } = await started(t, "?engine=cpu#v=1&radius=0.03");
  const tree = controls(page);
  await act(page, "Compare with the next seed");
  const parameters = tree.getByRole("table", { name: "What differs between A and B" });
  const seed = parameters.getByRole("row").filter({ has: page.getByRole("rowheader", { name: "seed", exact: true }) });
  await until("both seeds", async () => (await seed.getByRole("cell").allTextContents()).join() === "A 1,B 2");

  await act(page, "Show analysis");
  const numbers = tree.getByRole("table", { name: "Numbers of the sets" });
  const heads = numbers.getByRole("columnheader");
  await until("the heads", async () => (await heads.allTextContents()).slice(0, 4).join() === "number,A,B,B \u2212 A");
  const samples = numbers.getByRole("row").filter({ has: page.getByRole("rowheader", { name: "Samples", exact: true }) });
  const cells = samples.getByRole("cell");
  const number = (text) => Number(text.replaceAll(",", "").replace("\u2212", "-"));
  const [a, b, more] = await until("numbers", async () => {
    const found = (await cells.allTextContents()).map(number);
    return found.length >= 3 && found.slice(0, 3).every(Number.isFinite) && found;
  });
  assert.equal(more, b - a);
  assert.equal((await state(page)).samples, a);
  // The table says how many rows and columns it has, and each row and cell where it is.
  const columns = await heads.count();
  assert.equal(await numbers.getAttribute("aria-colcount"), String(columns));
  assert.equal(await samples.getAttribute("aria-rowindex"), "2");
  assert.deepEqual(await cells.evaluateAll((all) => all.map((one) => one.ariaColIndex)), [...Array(columns - 1).keys()].map((index) => String(index + 2)));

  await tree.getByRole("group", { name: "Layers", exact: true }).getByRole("checkbox", { name: "Blocks" }).waitFor();
  await act(page, "Export samples");
  const kinds = tree.getByRole("dialog", { name: "Export" }).getByRole("group", { name: "Kind of file" });
  await kinds.getByRole("button", { pressed: true }).waitFor();
  assert.ok((await kinds.getByRole("button").count()) > 2);
  assert.deepEqual(await nameless(page), []);
  assert.deepEqual(await findings(page), []);

  // Negative control: a row outside a table is found.
  await page.evaluate(() => document.getElementById("tree").append(document.querySelector("#tree [role=row]").cloneNode(true)));
  assert.match(String(await findings(page)), /aria-required-parent/);
});

test("at 400% all of the window comes into view by scrolling", async (t) => {
  const clip = { x: 20, y: 60, width: 280, height: 60 };
  const { page } = await started(t, "?engine=cpu#v=1&radius=0.03", { settings: { viewport: { width: 320, height: 256 }, deviceScaleFactor: 1 }, clip });
  const tree = controls(page);
  const isWithin = async (element) => {
    const { x, y, width, height } = await element.boundingBox();
    return x >= -1 && y >= -1 && x + width <= 321 && y + height <= 257;
  };
  const stage = tree.getByRole("button", { name: /^Finish/ });
  await until("the names of the stages, from the start on", () => isWithin(stage));

  // The control: the row of panels is below the edge at first.
  const panels = ["Parameters", "Layers", "Playback", "Inspector", "Pseudocode", "Statistics", "Verification", "Legend"];
  const tab = (name) => tree.getByRole("button", { name, exact: true });
  assert.equal(await isWithin(tab("Parameters")), false);
  for (const name of panels) {
    await tab(name).focus();
    await until(`the tab ${name}`, () => isWithin(tab(name)));
  }

  // What a panel shows is scrolled to as well.
  await tab("Parameters").press("Enter");
  for (const [role, name] of [["textbox", "Seed"], ["button", "Run"], ["button", "Close the panel"]]) {
    const control = tree.getByRole(role, { name, exact: true });
    await control.focus();
    await until(name, () => isWithin(control));
  }
});

test("elements lie over their pictures, where the pointer finds what is drawn", async (t) => {
  const { page } = await reused(t);
  const tree = controls(page);
  // The panels of a lesson that was left stay for another frame or two, and have the player elsewhere.
  await tree.getByRole("textbox", { name: "Seed", exact: true }).waitFor();
  await ask(page, { do: "seek", event: 1000 });
  const moment = tree.getByRole("slider", { name: "Moment" });
  await until("the moment on the slider", async () => (await moment.inputValue()) === "1000");
  // A click by the mouse at the middle of an element reaches the button that is drawn there.
  const { x, y, width, height } = await tree.getByRole("button", { name: "First stage (Home)", disabled: false }).boundingBox();
  await page.mouse.click(x + width / 2, y + height / 2);
  await state(page, (told) => told.cursor === 0);
  assert.equal(await page.evaluate(() => document.activeElement.id), "canvas");
});

test("the first screen is read in this order", async (t) => {
  const { page } = await reused(t);
  await controls(page).getByRole("button", { name: "Verdict: verified", exact: true }).waitFor();
  // Of each part the first element, and those that lead on.
  const read = (await controls(page).ariaSnapshot()).split("\n").map((line) => line.trim().replace(/^- '?/, "").replace(/'?:?$/, ""));
  const marks = ["text: Tilescope", 'button "File"', 'button "Help"', 'button "Verdict: verified"', 'button "Parameters" [pressed]', 'heading "Domain" [level=2]', 'textbox "Width"', 'textbox "Seed"', 'button "Run"', 'img "Canvas of samples"', 'button "Pseudocode" [pressed]', 'heading "Verification" [level=2]', 'button "Play (Space)"', 'slider "Moment"', 'button "Finish" [pressed]'];
  const order = marks.map((mark) => read.findIndex((line) => line.startsWith(mark)));
  assert.ok(!order.includes(-1), `${marks[order.indexOf(-1)]} in ${read.join("\n")}`);
  assert.deepEqual(order, [...order].sort((a, b) => a - b));
});

test("everything that can be used has a name, and axe-core finds nothing, in both looks", async (t) => {
  const { page } = await reused(t);
  for (const look of ["dark", "light"]) {
    await ask(page, { do: "load", link: `v=1&radius=0.02&look=${look}` });
    await state(page, (told) => told.ready && told.view.look === look);
    assert.deepEqual(await nameless(page), []);
    assert.deepEqual(await findings(page), [], look);
  }
  // Negative control: an element without a name is found by both.
  await page.evaluate(() => document.querySelector("#tree button").replaceChildren());
  assert.deepEqual(await nameless(page), ["button"]);
  assert.match(String(await findings(page)), /^button-name/);
  await page.reload();
});

test("axe-core finds nothing on the first page and on the page of a lesson", async (t) => {
  const { page, server } = await opened(t);
  for (const address of ["", "lesson/survivors/", "lesson/survivors/de/"]) {
    await page.goto(`${server.address}/${address}`);
    assert.deepEqual(await findings(page), [], address);
  }
});

test("a page in a frame has elements, too", async (t) => {
  const { page } = await started(t, "?engine=cpu&embed=player#v=1&radius=0.05", { clip: { x: 200, y: 100, width: 800, height: 500 } });
  await controls(page).getByRole("button", { name: /^Play/ }).waitFor({ state: "attached" });
  assert.deepEqual(await nameless(page), []);
  assert.deepEqual(await findings(page), []);
});
