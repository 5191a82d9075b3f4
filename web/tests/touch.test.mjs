// A phone: the layout fits 390 x 844, fingers move, pinch and select; a projector: 1920 x 1080 at its scale.

import assert from "node:assert/strict";
import { test } from "node:test";
import { changed, shows, state } from "./harness.mjs";
import { reused, started } from "./shared.mjs";

/** Within the canvas of the layout for phones. */
const PICTURE = { x: 20, y: 120, width: 350, height: 250 };

/** Browser settings of a phone. */
const phone = (density) => ({
  clip: PICTURE,
  settings: {
    viewport: { width: 390, height: 844 },
    deviceScaleFactor: density,
    hasTouch: true,
    isMobile: true,
    reducedMotion: "reduce",
  },
});

/** Gestures are tested at one pixel a point, because software renderers are slow. */
const touched = (t) => reused(t, "?engine=cpu&display=webgl", phone(1));

/**
 * Moves fingers by the browser's own input; each finger is a list of places, all of the same length. Moving begins with
 * the touch, so that a slow frame does not turn it into a long press, and each place is drawn before the next.
 */
async function fingers(context, page, tracks) {
  const session = await context.newCDPSession(page);
  const send = (type, touchPoints) => session.send("Input.dispatchTouchEvent", { type, touchPoints });
  const at = (k) => tracks.map((track, id) => ({ x: track[k][0], y: track[k][1], id }));
  await Promise.all([send("touchStart", at(0)), send("touchMove", at(1))]);
  for (let k = 2; k < tracks[0].length; k += 1) {
    await send("touchMove", at(k));
  }
  await send("touchEnd", []);
}

const camera = (told) => (new URLSearchParams(told.link).get("camera") ?? "").split(",").map(Number);
const line = (from, to, steps = 4) =>
  Array.from({ length: steps + 1 }, (_, k) => [0, 1].map((axis) => from[axis] + ((to[axis] - from[axis]) * k) / steps));

test("a phone shows the canvas, and a finger drags it", async (t) => {
  const { context, page } = await touched(t);
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
  const before = await page.screenshot({ clip: PICTURE });
  await fingers(context, page, [line([200, 250], [120, 250])]);
  const dragged = await state(page, (told) => camera(told).length === 3);
  await changed(page, before, PICTURE);
  const [x] = camera(dragged);
  await fingers(context, page, [line([200, 250], [280, 250])]);
  await state(page, (told) => camera(told).length === 3 && Math.abs(camera(told)[0] - x) > 1);
});

test("two fingers pinch about their middle", async (t) => {
  const { context, page } = await touched(t);
  await fingers(context, page, [line([240, 250], [180, 250])]);
  const before = camera(await state(page, (told) => camera(told).length === 3))[2];
  const picture = await page.screenshot({ clip: PICTURE });
  await fingers(context, page, [line([180, 250], [100, 250]), line([220, 250], [300, 250])]);
  const after = await state(page, (told) => camera(told)[2] > 1.5 * before);
  assert.ok(camera(after)[2] < 10 * before);
  assert.equal(new URLSearchParams(after.link).get("select"), null, "nothing was selected by pinching");
  await changed(page, picture, PICTURE);
});

test("a long press selects", async (t) => {
  const { context, page } = await touched(t);
  const session = await context.newCDPSession(page);
  const touchPoints = [{ x: 195, y: 240, id: 0 }];
  const before = await page.screenshot({ clip: PICTURE });
  await session.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints });
  // While the finger rests.
  const told = await state(page, (told) => new URLSearchParams(told.link).has("select"));
  await session.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
  assert.match(new URLSearchParams(told.link).get("select"), /^(sample|place):/);
  await changed(page, before, PICTURE);
});

test("high density is sharp: the canvas has a pixel for each of the screen's", async (t) => {
  const { page } = await started(t, "?engine=cpu&display=webgl#v=1&radius=0.02", phone(3));
  const size = await page.evaluate(() => {
    const canvas = document.getElementById("canvas");
    return [canvas.width, canvas.height, canvas.clientWidth, canvas.clientHeight];
  });
  assert.deepEqual(size, [1170, 2532, 390, 844]);
});

test("a projector of 1920 x 1080 shows the run in its look", async (t) => {
  const clip = { x: 200, y: 100, width: 1500, height: 600 };
  const { page } = await started(t, "?engine=cpu#v=1&look=projector", { clip, settings: { viewport: { width: 1920, height: 1080 }, deviceScaleFactor: 1 } });
  const mean = await shows(page, clip);
  assert.ok(mean > 100, `a projector needs a light ground; mean ${mean}`);
});
