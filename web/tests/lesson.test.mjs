// A lesson is done by the accessibility tree alone: headings, texts and buttons, found by their roles and names.

import assert from "node:assert/strict";
import { test } from "node:test";
import { nothingElse, until } from "./harness.mjs";
import { host, makeContext } from "./shared.mjs";

/** Opens a lesson at a size of the window. */
async function opened(t, fragment, settings) {
  const { address } = await host();
  const { context, wrong } = await makeContext({ settings });
  t.after(async () => {
    await context.close();
    nothingElse(wrong, []);
  });
  const page = await context.newPage();
  await page.goto(`${address}/?engine=cpu#${fragment}`);
  const lesson = page.getByRole("complementary", { name: "Lesson" });
  await lesson.getByRole("heading", { level: 2 }).waitFor();
  return { page, lesson, button: (name) => lesson.getByRole("button", { name, exact: typeof name === "string" }) };
}

/** The samples that a sentence names. @param {string} sentence */
const numbers = (sentence) => [...sentence.matchAll(/\b\d+\b(?![.,]\d| r)/g)].map(([number]) => Number(number));

test("lesson 5 is done, from its first step to its last, by roles and names alone", async (t) => {
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
  assert.equal(numbers(answer).length, 1);
  // The ends of a chain stay, the middle goes.
  await button("Next").click();
  await until("the chain", async () => (await ask.textContent()).startsWith("Which samples of this chain"));
  const [first, , last] = numbers((await lesson.getByText("Three samples are joined").textContent()).replace("r apart", ""));
  for (const end of [first, last]) {
    await button(String(end)).click();
  }
  await button("Answer").click();
  await lesson.getByText("The first sample eliminates").waitFor();
  // Six samples take their turn; a wrong answer is given again, changed.
  await button("Next").click();
  const options = [/None$/, /One$/, /Two or more$/];
  const step = lesson.getByText(/^Step \d of 6$/);
  await step.waitFor();
  for (let turn = 1; turn <= 6; turn++) {
    for (const option of options) {
      await button(option).click();
      await button("Answer").click();
      const isDone = () => (turn < 6 ? step.textContent().then((text) => text === `Step ${turn + 1} of 6`) : lesson.getByText("That is all of elimination").isVisible());
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
