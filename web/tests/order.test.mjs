// What a screen reader finds on the program's page when it reads on from the top: roles, names, states and values, in their order.
// They stand in `order.txt`; TILESCOPE_RENEW=1 node --test ./order.test.mjs writes it anew, to be looked at with `git diff`.

import assert from "node:assert/strict";
import { readFile, writeFile } from "node:fs/promises";
import { test } from "node:test";
import { controls } from "./controls.mjs";
import { ask, state, until } from "./harness.mjs";
import { started } from "./shared.mjs";

const FILE = new URL("order.txt", import.meta.url);

/** The states that are read. @type {Record<string, (page: import("playwright-core").Page) => Promise<unknown>>} */
const STATES = {
  "the first screen, with a finished run": () => Promise.resolve(),
  "a moment within the run": (page) => ask(page, { do: "seek", event: 1000 }),
  "the menu Help": (page) => controls(page).getByRole("button", { name: "Help", exact: true }).press("Enter"),
  "a question of a lesson": async (page) => {
    await page.keyboard.press("Escape");
    await ask(page, { do: "lesson", open: "survivors", step: "one-of-two" });
    await state(page, (told) => told.ready && told.lesson?.question);
  },
};

/** Returns the order of a page, once it stays. @param {import("playwright-core").Page} page */
async function order(page) {
  let before = "";
  return until("an order that stays", async () => {
    // Changes of the tree are sent four times a second, and gaps are found a moment later.
    await page.waitForTimeout(1500);
    const now = plain(await page.locator("body").ariaSnapshot());
    const stays = now === before;
    before = now;
    return stays ? now : undefined;
  });
}

/** Returns an order without what differs from machine to machine: times, and what the machine has. @param {string} order */
function plain(order) {
  return order.replace(/\d+(\.\d+)? (ms|s)\b/g, "… $2").replace(/\d+ threads?/g, "… threads");
}

test("the page is read in the order of order.txt", async (t) => {
  const { page } = await started(t, "?engine=cpu#v=1&radius=0.05");
  const parts = [];
  for (const [name, lead] of Object.entries(STATES)) {
    await lead(page);
    parts.push(`# ${name}\n\n${await order(page)}\n`);
  }
  const now = parts.join("\n");
  if (process.env.TILESCOPE_RENEW) {
    await writeFile(FILE, now);
  }
  assert.equal(now, await readFile(FILE, "utf8"), "TILESCOPE_RENEW=1 node --test ./order.test.mjs writes it anew");

  // Negative control: another order, another name and another state are seen.
  for (const change of [
    () => document.querySelector("#tree").append(document.querySelector("#tree > *")),
    () => (document.querySelector("#tree button").textContent = "Other"),
    () => document.querySelector("#tree button").setAttribute("aria-expanded", "true"),
  ]) {
    const before = await page.locator("body").ariaSnapshot();
    await page.evaluate(change);
    assert.notEqual(await page.locator("body").ariaSnapshot(), before);
  }
});
