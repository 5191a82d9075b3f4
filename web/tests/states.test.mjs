// axe-core finds nothing in any state of the program, in any look, magnified, in a narrow window, in forced colours and with
// reduced motion. The fast tests see each state in three of these surroundings, with the looks in turns; TILESCOPE_SLOW=1 sees all
// looks in all of them.

import assert from "node:assert/strict";
import { test } from "node:test";
import { controls, findings, nameless } from "./controls.mjs";
import { IS_SLOW, ask, slowTest, state, until } from "./harness.mjs";
import { started } from "./shared.mjs";

const LOOKS = ["dark", "light", "projector", "projector-dark"];

/** What surrounds the program, each with the part of the page that shows the run; `isBetween` if it lies between two others. */
const SURROUNDINGS = {
  "1280 px": { settings: {} },
  // Magnified, a page has as many pixels fewer.
  "200% of 1280 px": { isBetween: true, settings: { viewport: { width: 640, height: 400 } }, clip: { x: 60, y: 80, width: 500, height: 120 } },
  "400% of 1280 px": { settings: { viewport: { width: 320, height: 256 } }, clip: { x: 20, y: 60, width: 280, height: 60 } },
  "320 px": { isBetween: true, settings: { viewport: { width: 320, height: 568 } }, clip: { x: 20, y: 80, width: 280, height: 200 } },
  "forced colours, reduced motion": { settings: { forcedColors: "active", reducedMotion: "reduce" } },
};

/** The menus that stand in the bar of the window. @param {import("playwright-core").Page} page */
const menus = (page) => controls(page).locator("[aria-haspopup=menu]:not([aria-disabled=true])");

/** The list of all actions. @param {import("playwright-core").Page} page */
const finder = (page) => controls(page).getByRole("dialog").filter({ has: page.getByRole("textbox", { name: "Find an action" }) });

/** Presses an entry of the list of all actions. @param {import("playwright-core").Page} page @param {string} name */
async function act(page, name) {
  await page.focus("#canvas");
  await page.keyboard.press("Control+k");
  const list = finder(page);
  await list.waitFor();
  await page.keyboard.type(name);
  // The list follows what is typed, a moment later.
  await until("the action", async () => (await list.getByRole("button").first().textContent()).startsWith(name));
  await page.keyboard.press("Enter");
}

/** Closes what was opened, until nothing lies over the window. @param {import("playwright-core").Page} page */
async function close(page) {
  let looks = 0;
  await until("nothing over the window", async () => {
    const open = await controls(page).getByRole("dialog").or(controls(page).getByRole("menu")).count();
    // Elements follow the window a moment later: one look at nothing could be too early.
    looks = open === 0 ? looks + 1 : 0;
    if (open > 0) {
      await page.keyboard.press("Escape");
    }
    await page.waitForTimeout(300);
    return looks > 1;
  });
}

/** The states, each with what leads there and what leads back. @type {Record<string, (page: import("playwright-core").Page) => Promise<unknown>>} */
const STATES = {
  "a finished run": (page) => ask(page, { do: "seek", part: 1 }),
  "a moment within": (page) => ask(page, { do: "seek", event: 1000 }),
  "the list of actions": async (page) => {
    await page.focus("#canvas");
    await page.keyboard.press("Control+k");
    await finder(page).waitFor();
  },
  "the export": async (page) => {
    await act(page, "Export samples");
    await controls(page).getByRole("dialog", { name: "Export" }).waitFor();
  },
  "the help": async (page) => {
    await act(page, "About Tilescope");
    await until("the sheet alone", async () => (await finder(page).count()) === 0 && (await controls(page).getByRole("dialog").count()) === 1);
  },
};

/** Asserts that everything has a name, and that axe-core finds nothing. @param {import("playwright-core").Page} page @param {string} where */
async function isClean(page, where) {
  // Changes of the tree are sent four times a second.
  await page.waitForTimeout(300);
  assert.deepEqual(await nameless(page), [], where);
  assert.deepEqual(await findings(page), [], where);
}

for (const [surrounding, { settings, clip, isBetween }] of Object.entries(SURROUNDINGS)) {
  (isBetween ? slowTest : test)(`axe-core finds nothing in any state: ${surrounding}`, async (t) => {
    const { page } = await started(t, "?engine=cpu#v=1&radius=0.03", { settings, clip });
    const turn = Object.keys(SURROUNDINGS).indexOf(surrounding);
    for (const [index, [name, lead]] of Object.entries(STATES).entries()) {
      const looks = IS_SLOW ? LOOKS : [LOOKS[(turn + index) % LOOKS.length]];
      for (const look of looks) {
        await ask(page, { do: "view", look });
        await state(page, (told) => told.view.look === look);
        await lead(page);
        await isClean(page, `${name}, ${look}, ${surrounding}`);
        await close(page);
      }
    }

    // The projector's looks have no bar with menus.
    for (const look of IS_SLOW ? LOOKS.slice(0, 2) : [LOOKS[turn % 2]]) {
      await ask(page, { do: "view", look });
      await until("menus", async () => (await menus(page).count()) > 0);
      const names = await menus(page).evaluateAll((all) => all.map((one) => one.textContent || one.ariaLabel));
      for (const [index, name] of names.entries()) {
        await until("the menu", async () => {
          // On a busy machine the Escape that closed what was open before may arrive only now, and close the menu.
          const opened = await controls(page).getByRole("menu").count();
          await (opened === 0 && menus(page).nth(index).press("Enter"));
          await page.waitForTimeout(500);
          return opened > 0;
        });
        await isClean(page, `the menu ${name}, ${look}, ${surrounding}`);
        await close(page);
      }
      t.diagnostic(`${look}: ${names.join(", ")}`);
    }

    // The list of lessons, a lesson, and its question.
    for (const look of IS_SLOW ? LOOKS : [LOOKS[(turn + 3) % LOOKS.length]]) {
      await ask(page, { do: "view", look });
      await ask(page, { do: "lesson", act: "list" });
      await page.locator("#lesson li, #lesson button").first().waitFor();
      await isClean(page, `the list of lessons, ${look}, ${surrounding}`);
      await ask(page, { do: "lesson", open: "survivors", step: "one-of-two" });
      await state(page, (told) => told.lesson?.question);
      await isClean(page, `a question, ${look}, ${surrounding}`);
      await ask(page, { do: "lesson", act: "leave" });
      await state(page, (told) => !told.lesson);
    }

    // Negative control: an element without a name is found by both.
    await page.evaluate(() => document.getElementById("tree").append(document.createElement("button")));
    assert.deepEqual(await nameless(page), ["button"]);
    assert.match(String(await findings(page)), /^button-name/);
  });
}
