// A lesson is done by the accessibility tree alone: headings, texts and buttons, found by their roles and names.

import assert from "node:assert/strict";
import { test } from "node:test";
import { ask, slowTest, state, until } from "./harness.mjs";
import { contextOf } from "./shared.mjs";

/** Opens a lesson at a size of the window. */
async function opened(t, fragment, settings) {
  const { server, context } = await contextOf(t, { settings });
  const page = await context.newPage();
  await page.goto(`${server.address}/?engine=cpu#${fragment}`);
  const lesson = page.getByRole("complementary", { name: "Lesson" });
  // The list has one for each of its parts.
  await lesson.getByRole("heading", { level: 2 }).first().waitFor();
  return { page, lesson, button: (name) => lesson.getByRole("button", { name, exact: typeof name === "string" }) };
}

/** The samples that a sentence names. @param {string} sentence */
const numbers = (sentence) => [...sentence.matchAll(/\b\d+\b(?![.,]\d| r)/g)].map(([number]) => Number(number));

slowTest("lesson 5 is done, from its first step to its last, by roles and names alone", async (t) => {
  const { page, lesson, button } = await opened(t, "lesson=survivors");
  assert.equal(await lesson.getByRole("heading", { level: 2 }).textContent(), "Too close");
  await button("Next").click();
  const ask = lesson.getByRole("heading", { level: 3 });
  await ask.waitFor();
  assert.equal(await button("Next").isDisabled(), true);
  // The smaller number has its turn first, so the larger one is eliminated.
  const [a, b] = numbers(await ask.textContent());
  const [kept, lost] = [Math.min(a, b), Math.max(a, b)];
  const status = lesson.getByRole("status").first();
  await button(new RegExp(`Sample ${kept}$`)).click();
  await button("Answer").click();
  await until("an answer that is wrong", async () => (await status.textContent()).includes("Not so"));
  assert.ok((await status.textContent()).includes("smaller number"), "it says why");
  await button(new RegExp(`Sample ${lost}$`)).click();
  await button("Answer").click();
  await until("an answer that is right", async () => (await status.textContent()).includes("Right now"));
  // The next sample that is lost, from the list of numbers; giving up is asked once more.
  await button("Next").click();
  await until("the next question", async () => (await ask.textContent()).startsWith("Sample "));
  await button("Give up").click();
  await button("Give up: show the answer").click();
  const answer = await lesson.getByText("The answer:").textContent();
  assert.ok(numbers(answer).length >= 1, answer);
  await button("Next").click();
  await until("the three", async () => (await ask.textContent()).startsWith("Which of these three stay"));
  await button("Give up").click();
  await button("Give up: show the answer").click();
  await lesson.getByText("The answer:").waitFor();
  // Samples take their turn; a wrong answer is given again, changed.
  await button("Next").click();
  const options = [/None$/, /One$/, /Two or more$/];
  const step = lesson.getByText(/^Step \d of \d$/);
  await step.waitFor();
  const turns = Number((await step.textContent()).at(-1));
  assert.ok(turns >= 2, `${turns} turns`);
  for (let turn = 1; turn <= turns; turn++) {
    for (const option of options) {
      await button(option).click();
      await button("Answer").click();
      const isDone = () => (turn < turns ? step.textContent().then((text) => text === `Step ${turn + 1} of ${turns}`) : lesson.getByText("That is all of elimination").isVisible());
      await until("a verdict", async () => (await isDone()) || (await status.textContent()).includes("Not so"));
      if (await isDone()) {
        break;
      }
    }
  }
  await lesson.getByText("That is all of elimination").waitFor();
  assert.match(page.url(), /lesson=survivors&step=six-turns/);
  // In German, at the same step.
  await button("Deutsch").click();
  await until("German", async () => (await ask.textContent()).startsWith("Punkt "));
  assert.equal(await lesson.getByRole("button", { name: "Antworten" }).count(), 1);
});

slowTest("every lesson and form can be played to its last step, by its buttons", async (t) => {
  const { server, context } = await contextOf(t);
  const page = await context.newPage();
  await page.goto(`${server.address}/?engine=cpu#radius=0.05`);
  await state(page, (told) => told.ready);
  assert.equal((await ask(page, { do: "lesson", act: "list" })).ok, true);
  const { lessons } = (await state(page, (told) => told.lesson?.list?.lessons.length > 0)).lesson.list;
  assert.equal(lessons.length, 18);

  const button = (name) => page.getByRole("complementary", { name: "Lesson" }).getByRole("button", { name, exact: true });
  for (const { name, gates } of lessons) {
    assert.equal((await ask(page, { do: "lesson", open: name })).ok, true);
    let { lesson: told } = await state(page, (told) => told.lesson?.lesson === name && !told.lesson.waits);
    let asked = 0;
    for (;;) {
      assert.equal(told.fault, null, `${name}/${told.step}`);
      if (told.question?.open) {
        asked += 1;
        // Giving up is asked once more; a trace then goes on to its next question.
        const { labels } = told;
        const sure = told.form ? labels.skip : labels.show_answer;
        await button(told.asked_to_give_up ? sure : labels.give_up).click();
      } else if (told.index + 1 < told.steps.length) {
        await button(told.labels.next).click();
      } else {
        break;
      }
      const before = JSON.stringify(told);
      told = (await state(page, (now) => !now.lesson.waits && JSON.stringify(now.lesson) !== before)).lesson;
    }
    assert.ok(asked >= gates, `${name}: ${asked} of ${gates} questions`);
  }
});

test("on a phone a lesson stands below the canvas, and its list leads to others", async (t) => {
  const phone = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true };
  const { page, lesson, button } = await opened(t, "lesson=welcome", phone);
  const box = await lesson.boundingBox();
  assert.ok(box.y > 400 && box.width === 390, JSON.stringify(box));
  const small = await lesson.getByRole("button").evaluateAll((all) => all.filter((one) => Math.min(one.offsetWidth, one.offsetHeight) < 24).length);
  assert.equal(small, 0, "buttons for fingers");
  await button("Lessons").click();
  await button(/Why three samples/).click();
  await until("another lesson", async () => page.url().includes("lesson=gaps"));
  await button("Close the lesson").click();
  await lesson.waitFor({ state: "hidden" });
});

test("while a question is open neither the state nor a request tells what follows", async (t) => {
  const { page } = await opened(t, "lesson=survivors&step=one-of-two");
  const ask = (request) => page.evaluate((request) => JSON.parse(window.tilescope.ask(JSON.stringify(request))), request);
  await until("the question", async () => (await ask({ do: "state" })).state.lesson?.question);
  const { state } = await ask({ do: "state" });
  assert.equal(state.cursor, state.events);
  assert.equal(state.verified, null);
  assert.equal(state.lesson.after, null);
  assert.ok(!/seed|at=/.test(state.link), state.link);
  for (const request of [{ do: "load", link: "v=1" }, { do: "load", parameters: { seed: 2 } }, { do: "lesson", go: "next" }]) {
    assert.equal((await ask(request)).ok, false, JSON.stringify(request));
  }
  assert.equal((await ask({ do: "seek", event: state.events + 1 })).ok, false);
  const wrong = await ask({ do: "answer", value: 7 });
  assert.match(wrong.error, /index of an option, from 0 to 2/);
  assert.equal((await ask({ do: "lesson", act: "give-up" })).ok, true);
  assert.equal((await ask({ do: "lesson", act: "give-up" })).ok, true);
  const after = (await ask({ do: "state" })).state;
  assert.ok(after.events > state.events && after.answered.given_up);
});

/** The questions whose results the browser stores, as `lesson/question`. @param {import("playwright-core").Page} page */
function storedGates(page) {
  return page.evaluate(() => JSON.parse(localStorage.getItem("lessons") ?? '{"entries": []}').entries.map((entry) => `${entry.lesson}/${entry.gate}`));
}

/** Gives up the question of a page, which counts as an answer. */
async function giveUp(page) {
  const lesson = (await state(page, (told) => told.lesson?.question?.open)).lesson;
  for (let time = 0; time < 2; time++) {
    assert.equal((await ask(page, { do: "lesson", act: "give-up" })).ok, true);
  }
  const { answered } = await state(page, (told) => told.answered);
  assert.equal(answered.step, lesson.step);
  return `${answered.lesson}/${answered.gate}`;
}

/** All texts of a page's accessibility tree. @param {import("playwright-core").Page} page @returns {Promise<string[]>} */
async function readAloud(page) {
  const client = await page.context().newCDPSession(page);
  const { nodes } = await client.send("Accessibility.getFullAXTree");
  // Boxes are the lines of texts.
  const read = nodes.filter(({ ignored, role }) => !ignored && role.value !== "InlineTextBox");
  const of = ({ name, description, value }) => [name, description, value].map((text) => String(text?.value ?? "").trim());
  return [...new Set(read.flatMap(of))].filter(Boolean);
}

/** All texts within a value, the longest first. @param {any} value @returns {string[]} */
function textsOf(value) {
  const within = (part) => (typeof part === "object" && part !== null ? Object.values(part).flatMap(within) : [String(part).trim()]);
  return [...new Set(within(value))].filter((text) => text.length > 1 || text === "\u00d7").sort((a, b) => b.length - a.length);
}

/** The stages of a run, as its timeline names them. */
const STAGES = ["Pattern", "Blocks", "Tile", "Eliminate", "Iterate", "Finish"];

/** What is left of a text without the known ones, numbers, the unit r, letters of answers, and marks. @param {string} text @param {string[]} known */
function unknownPart(text, known) {
  const rest = known.reduce((rest, one) => rest.replaceAll(one, " "), text);
  return rest.replace(/\b[A-Zr]\b|[\d\s.,:;/()\u2013=\u2191\u2193%-]/g, "");
}

// The first question shows the most: a picture, options and names of samples.
for (const [k, [lesson, step]] of [["survivors", "one-of-two"], ["survivors", "next-lost"], ["maximal", "dart"], ["spectrum", "white-to-blue"]].entries()) {
  const declare = k === 0 ? test : slowTest;
  declare(`while ${lesson}/${step} is asked, a screen reader finds no text beside those that the program has for the frame`, async (t) => {
    const { server, context } = await contextOf(t);
    const page = await context.newPage();
    await page.goto(`${server.address}/?engine=cpu#radius=0.05`);
    await state(page, (told) => told.ready);
    // The elements of controls follow the program a moment later.
    await page.getByRole("slider", { name: "Moment" }).waitFor();
    const ofPage = await readAloud(page);
    assert.equal((await ask(page, { do: "lesson", open: lesson, step })).ok, true);
    const told = await state(page, (told) => told.lesson?.step === step && told.lesson.question?.open);
    await page.getByRole("heading", { name: told.lesson.heading, exact: true }).waitFor();
    // What the timeline draws is of the frame, too; a native test reads all texts of such frames.
    const timeline = ["To the end of stage", ...STAGES, "the question of the lesson", "samples", "events", "event"];
    const parts = ["Lesson", "Steps", "\u00d7", ...timeline];
    const known = textsOf([ofPage, parts, told.lesson, told.sentence, told.caption]);
    const beside = async () => (await readAloud(page)).filter((text) => unknownPart(text, known) !== "");
    // The run that was shown before may be announced still.
    await until("a page without other texts", async () => (await beside()).length === 0);
    // Negative control: a text that the page has by itself is found.
    await page.evaluate(() => document.querySelector("#lesson h2").after("Sample seven is eliminated"));
    assert.deepEqual(await beside(), ["Sample seven is eliminated"]);
  });
}

test("a hidden page opens a lesson that it is asked for, and reports it", async (t) => {
  const { server, context } = await contextOf(t);
  const page = await context.newPage();
  await page.goto(`${server.address}/?engine=cpu#radius=0.05`);
  await state(page, (told) => told.ready);
  await page.evaluate(() => {
    Object.defineProperty(document, "hidden", { get: () => true });
    document.dispatchEvent(new Event("visibilitychange"));
    window.requestAnimationFrame = () => 0;
  });
  assert.equal((await ask(page, { do: "lesson", open: "survivors", step: "chain" })).ok, true);
  await page.getByRole("heading", { name: "A chain of three" }).waitFor();
  assert.match(page.url(), /lesson=survivors&step=chain/);
});

test("an answer stays when the page is reloaded or closed at once", async (t) => {
  const { page } = await opened(t, "lesson=survivors&step=one-of-two");
  assert.deepEqual(await storedGates(page), []);
  const given = await giveUp(page);
  assert.deepEqual(await storedGates(page), [given]);
  await page.reload();
  const { lesson } = await state(page, (told) => told.lesson?.steps);
  assert.equal(lesson.steps[lesson.index].score, 0);
  const other = await page.context().newPage();
  await other.goto(page.url());
  await page.close();
  await state(other, (told) => told.lesson?.steps?.[told.lesson.index].score === 0);
});

test("two tabs add to each other's results instead of replacing them", async (t) => {
  const { page } = await opened(t, "lesson=survivors&step=one-of-two");
  await state(page, (told) => told.lesson?.question?.open);
  const other = await page.context().newPage();
  await other.goto(page.url().replace(/#.*/, "#lesson=survivors&step=chain"));
  const second = await giveUp(other);
  const first = await giveUp(page);
  // A tab that writes before it hears of the other's answer adds that answer when it does.
  const both = [first, second].sort().join();
  await until("both answers in the store", async () => (await storedGates(page)).sort().join() === both);
  // What the browser keeps at a later save is still of both, and each tab shows both.
  for (const tab of [page, other]) {
    await tab.evaluate(() => window.tilescope.keep());
    await ask(tab, { do: "lesson", act: "list" });
    await state(tab, (told) => told.lesson?.list?.answered === 2);
  }
  assert.deepEqual((await storedGates(page)).sort(), [first, second].sort());
});

test("a link names the language, which stays; without one it is the browser's", async (t) => {
  const { page, lesson } = await opened(t, "lesson=survivors&language=de");
  await lesson.getByRole("button", { name: "Weiter", exact: true }).waitFor();
  await until("the language in the store", () => page.evaluate(() => localStorage.getItem("language") === "de"));
  const other = await page.context().newPage();
  await other.goto(page.url().replace(/#.*/, "#lesson=welcome"));
  await state(other, (told) => told.lesson?.language === "de");
  const german = await opened(t, "lesson=welcome", { locale: "de-AT" });
  await german.lesson.getByRole("button", { name: "Weiter", exact: true }).waitFor();
});

test("a link to an unknown lesson shows the list beside the default run, and capitals do not count", async (t) => {
  const { page } = await opened(t, "lesson=survivor%26step%3Dchain");
  const told = await state(page, (told) => told.ready && told.lesson?.list);
  assert.match(told.notice, /There is no lesson "survivor"/);
  assert.equal(told.seed, 1);
  await page.goto(page.url().replace(/#.*/, "#lesson%3DSURVIVORS%26step%3Dchain"));
  await state(page, (told) => told.lesson?.step === "chain");
});
