// Steps, breakpoints, seeking and going back, by the same keys as in the native program.

import assert from "node:assert/strict";
import { test } from "node:test";
import { MIDDLE, ask, load, pixels, shows, state, until } from "./harness.mjs";
import { reused } from "./shared.mjs";

test("steps go on and back by one event, line and stage", async (t) => {
  const { page } = await reused(t);
  const end = await state(page);
  assert.equal(end.cursor, end.events);
  await ask(page, { do: "seek", event: 1000 });
  assert.equal((await state(page)).cursor, 1000);
  await ask(page, { do: "step", by: 1, unit: "event" });
  assert.equal((await state(page)).cursor, 1001);
  await ask(page, { do: "step", by: -1, unit: "event" });
  assert.equal((await state(page)).cursor, 1000);
  await ask(page, { do: "step", by: 1, unit: "stage" });
  const later = await state(page);
  assert.ok(later.cursor > 1000);
  await ask(page, { do: "step", by: -1, unit: "line" });
  assert.ok((await state(page)).cursor < later.cursor);
  await shows(page);
});

test("keys step, and the picture follows", async (t) => {
  const { page } = await reused(t);
  await page.click("#canvas", { position: { x: 620, y: 400 } });
  const end = await state(page);
  const whole = await shows(page);
  await page.keyboard.press("Home");
  await state(page, (told) => told.cursor < end.cursor);
  // The picture is drawn after the state has changed.
  const changed = (from) =>
    until("another picture", async () => {
      const { mean } = await pixels(page, MIDDLE);
      return Math.abs(mean - from) < 0.5 ? undefined : mean;
    });
  const begun = await changed(whole);
  await page.keyboard.press("End");
  await state(page, (told) => told.cursor === end.cursor);
  assert.ok(Math.abs((await changed(begun)) - whole) < 0.5, "the same moment is the same picture");
});

test("a run stops at a breakpoint, forwards and backwards", async (t) => {
  const { page } = await reused(t);
  // The link has the breakpoint, and keys run to it, line by line.
  const told = await load(page, "v=1&radius=0.02&at=0&break=insert.1");
  assert.deepEqual([told.notice, told.cursor], [null, 0]);
  await page.click("#canvas", { position: { x: 620, y: 400 } });
  await page.keyboard.press("F8");
  const stopped = await state(page, (told) => told.cursor > 0);
  assert.ok(stopped.cursor < stopped.events, "it stopped before the end");
  await page.keyboard.press("F8");
  const next = await state(page, (told) => told.cursor > stopped.cursor);
  await page.keyboard.press("Shift+F8");
  const back = await state(page, (told) => told.cursor < next.cursor);
  assert.equal(back.cursor, stopped.cursor);
  await shows(page);
});

test("a screen reader hears each step", async (t) => {
  const { page } = await reused(t);
  await ask(page, { do: "seek", event: 5000 });
  await page.waitForFunction(() => document.getElementById("announcer").textContent.length > 10);
  const heard = await page.textContent("#announcer");
  await ask(page, { do: "step", by: 1, unit: "event" });
  await page.waitForFunction((old) => document.getElementById("announcer").textContent !== old, heard);
  assert.equal(await page.getAttribute("#announcer", "aria-live"), "polite");
});
