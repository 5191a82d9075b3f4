// A talk in the browser: the stage in one window, the notes in another, the voting card on a phone, and the plan of a lecture.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import path from "node:path";
import { test } from "node:test";
import { IS_SLOW, folder, native, slowTest, until } from "./harness.mjs";
import { contextOf } from "./shared.mjs";

/** Opens pages of one browser. */
async function browsing(t, settings) {
  const { server, context } = await contextOf(t, { settings });
  return { address: server.address, context };
}

/** Waits for the notes of a talk and returns functions that read them. */
async function notesOf(notes) {
  await notes.getByRole("heading", { level: 2 }).first().waitFor();
  const here = notes.getByRole("region", { name: "This step" });
  return { here, title: () => here.getByRole("heading").textContent(), next: notes.getByRole("button", { name: /PageDown/ }) };
}

slowTest("notes open beside the stage, lead it, and each may be closed and opened again", async (t) => {
  const { address, context } = await browsing(t);
  const stage = await context.newPage();
  await stage.goto(`${address}/?engine=cpu#lesson=survivors`);
  const opened = context.waitForEvent("page");
  await stage.getByRole("button", { name: "Present" }).click();
  const notes = await opened;
  const { here, title, next } = await notesOf(notes);
  assert.equal(await title(), "Too close");
  // The stage's page holds no text of the lesson, and no note.
  await until("the lesson's panel to go", async () => !(await stage.getByRole("complementary", { name: "Lesson" }).isVisible()));
  const note = await here.getByRole("paragraph").first().textContent();
  assert.ok(note.length > 10);
  assert.equal((await stage.content()).includes(note), false);
  await notes.getByRole("img", { name: /next step/ }).waitFor();
  // The clicker's keys work in either window.
  await notes.keyboard.press("PageDown");
  await until("the next step", async () => (await title()) === "One of two");
  await here.getByText("The answer:").waitFor();
  await stage.locator("#canvas").focus();
  await stage.keyboard.press("PageDown");
  await until("the vote", async () => (await next.textContent()).startsWith("Reveal"));
  const vote = notes.getByRole("textbox", { name: "Votes" });
  await vote.fill("A 3 Q 4");
  await vote.press("Enter");
  await notes.getByRole("alert").waitFor();
  await vote.fill("A 30 B 4");
  await vote.press("Enter");
  await notes.getByText("First vote: A 30, B 4, C 0").waitFor();
  await notes.getByText("give the hint or explain").or(notes.getByText("reveal, and go on")).first().waitFor();
  // The notes are opened again.
  const where = notes.url();
  await notes.close();
  const again = await context.newPage();
  await again.goto(where);
  const second = await notesOf(again);
  await until("the same step", async () => (await second.title()) === "One of two");
  await again.getByText("First vote: A 30, B 4, C 0").waitFor();
  // The stage is opened again, and goes on with the votes and the time.
  await stage.close();
  const reopened = context.waitForEvent("page");
  await again.getByRole("button", { name: "Open the stage again" }).click();
  const restage = await reopened;
  await until("the step on the stage", () => restage.url().includes("step=one-of-two"));
  await until("the step again", async () => (await second.title()) === "One of two" && (await second.next.isVisible()));
  await again.getByText("First vote: A 30, B 4, C 0").waitFor();
  await again.keyboard.press("Escape");
  await again.getByText("No talk is given.").waitFor();
  await until("the lesson", async () => restage.getByRole("complementary", { name: "Lesson" }).isVisible());
});

test("a phone is a voting card, without the program", async (t) => {
  const { address, context } = await browsing(t, { viewport: { width: 390, height: 844 } });
  const page = await context.newPage();
  const loaded = [];
  page.on("request", (request) => loaded.push(request.url()));
  await page.goto(`${address}/#card`);
  const letter = page.getByRole("button", { name: /^C, triangle/ });
  await letter.click();
  assert.equal(await page.getByRole("button").count(), 1);
  const box = await letter.boundingBox();
  assert.ok(box.width >= 380 && box.height >= 800, JSON.stringify(box));
  await letter.click();
  assert.equal(await page.getByRole("button").count(), 6);
  // It needs no network after this visit.
  await page.evaluate(() => navigator.serviceWorker.ready);
  assert.deepEqual(loaded.filter((url) => url.endsWith(".wasm")), [], "the program was loaded for a card");
  await context.setOffline(true);
  await page.reload();
  await page.getByRole("button", { name: /^A, circle/ }).waitFor();
});

test("the plan opens the stage, follows the talk, and shows its step", async (t) => {
  const { address, context } = await browsing(t);
  const plan = await context.newPage();
  await plan.goto(`${address}/example/plan.html`);
  const opened = context.waitForEvent("page");
  await plan.getByRole("button", { name: "Open the stage" }).click();
  const stage = await opened;
  await plan.getByText("Points that keep their distance: step 1 of 5.").waitFor();
  assert.equal(await plan.locator("tr[aria-current='true']").getAttribute("data-lesson"), "welcome");
  await stage.locator("#canvas").focus();
  await stage.keyboard.press("PageDown");
  await plan.getByText(/: step 2 of 5\./).waitFor();
  // Beside the stage the plan is in view; in a tab behind it a browser may draw nothing.
  await plan.bringToFront();
  const player = plan.frameLocator("#tilescope");
  await player.getByRole("heading", { name: "Not too close" }).waitFor();
});

test("handouts print on A4 and on Letter without a step that is cut", async (t) => {
  const { context } = await browsing(t);
  const made = path.join(await folder(t), "handout.html");
  // Slow runs print two more lessons.
  for (const lesson of ["survivors", ...(IS_SLOW ? ["spectrum", "tiling"] : [])]) {
    await native("lesson", "handout", lesson, "--out", made, "--answers", "--notes");
    const page = await context.newPage();
    // Millimetres of the paper without its margins of 15 mm, in CSS pixels.
    for (const [format, width, height] of [["A4", 210, 297], ["Letter", 215.9, 279.4]]) {
      const px = (mm) => Math.floor(((mm - 30) * 96) / 25.4);
      await page.setViewportSize({ width: px(width), height: px(height) });
      await page.emulateMedia({ media: "print" });
      await page.setContent(await readFile(made, "utf8"));
      const sections = await page.locator("section").evaluateAll((all) => all.map((one) => [one.getBoundingClientRect().height, getComputedStyle(one).breakInside]));
      assert.ok(sections.length >= 4);
      for (const [tall, breaks] of sections) {
        assert.ok(tall <= px(height), `${lesson}, ${format}: a step of ${tall} pixels on a page of ${px(height)}`);
        assert.equal(breaks, "avoid");
      }
      const pictures = await page.locator("img").evaluateAll((all) => all.map((one) => one.complete && one.naturalWidth > 0 && one.getBoundingClientRect().right <= innerWidth));
      assert.ok(pictures.length === sections.length && pictures.every(Boolean), `${pictures}`);
      const printed = await page.pdf({ format });
      const pages = printed.toString("latin1").match(/\/Type \/Page\b/g).length;
      assert.ok(pages >= 2 && pages <= sections.length, `${pages} pages`);
    }
    await page.close();
  }
});
