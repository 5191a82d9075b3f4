// Answers for a record store that the address names: nothing is sent before the reader agrees, and nothing but new answers. The
// store is one of https, answered by the test in the place of the network.

import assert from "node:assert/strict";
import { test } from "node:test";
import { findings } from "./controls.mjs";
import { ask, state, until } from "./harness.mjs";
import { contextOf } from "./shared.mjs";

const STORE = "https://store.example";
const ACTOR = { name: "Ada", mbox: "mailto:ada@school.example" };
const LAUNCH = new URLSearchParams({
  engine: "cpu", play: "", endpoint: `${STORE}/xapi`, auth: "Basic dG9rZW4=", actor: JSON.stringify(ACTOR), registration: "5c6a1a2e-0000-4000-8000-000000000001",
});
const LESSON = "#v=1&lesson=survivors&step=one-of-two";

/**
 * Opens the page at an address with a store. `policy` is what the page may connect to, as `web/build --xapi` writes it; `status` is
 * what the store answers, one after the other.
 */
async function launched(t, { query = LAUNCH, policy = `'self' ${STORE}`, status = [], expected = [] } = {}) {
  const { server, context } = await contextOf(t, { origins: [STORE], expected });
  const sent = [];
  await context.route(`${server.address}/?*`, async (route) => {
    const response = await route.fetch();
    const allow = (text) => text.replace("connect-src 'self'", `connect-src ${policy}`);
    const headers = response.headers();
    const body = allow(await response.text());
    await route.fulfill({ response, body, headers: { ...headers, "content-security-policy": allow(headers["content-security-policy"]) } });
  });
  await context.route(`${STORE}/**`, async (route) => {
    const request = route.request();
    const headers = { "access-control-allow-origin": "*", "access-control-allow-headers": "*" };
    if (request.method() === "OPTIONS") {
      return route.fulfill({ status: 204, headers });
    }
    const code = status.shift() ?? 200;
    if (code === 200) {
      sent.push({ url: request.url(), headers: await request.allHeaders(), statements: request.postDataJSON() });
    }
    return route.fulfill({ status: code, headers, json: [] });
  });
  const page = await context.newPage();
  await page.goto(`${server.address}/?${query}${LESSON}`);
  await state(page, (told) => told.ready && told.lesson?.question);
  return { page, sent, dialog: page.getByRole("dialog", { name: /store\.example/ }) };
}

/** Answers the open question until it is done: what is done makes a statement. @param {import("playwright-core").Page} page */
async function answer(page) {
  for (let choice = 1; ; choice++) {
    const { ok, error } = await ask(page, { do: "answer", value: choice });
    assert.ok(ok, error);
    if ((await state(page, (told) => told.answered)).answered.done) {
      return;
    }
  }
}

/** Answers the question of another run, until it is done. @param {import("playwright-core").Page} page */
async function answerNext(page) {
  await ask(page, { do: "lesson", go: "next" });
  await ask(page, { do: "lesson", open: "survivors", step: "one-of-two", practice: 5 });
  await state(page, (told) => told.ready && told.lesson?.question && told.answered.done && !told.lesson.feedback);
  await answer(page);
}

test("before the first statement the page names the host and asks, and then sends new answers alone", async (t) => {
  const { page, sent, dialog } = await launched(t);
  assert.equal(await dialog.count(), 0);
  await answer(page);
  await dialog.waitFor();
  assert.match(await dialog.textContent(), /Send your answers to store\.example\?.*under this name: Ada/);
  assert.deepEqual(await findings(page), []);
  assert.deepEqual(sent, []);
  await dialog.getByRole("button", { name: "Send", exact: true }).press("Enter");
  await until("statements", async () => sent.length > 0);

  const [{ url, headers, statements }] = sent;
  assert.equal(url, `${STORE}/xapi/statements`);
  assert.deepEqual([headers.authorization, headers["x-experience-api-version"], headers.cookie], ["Basic dG9rZW4=", "1.0.3", undefined]);
  assert.equal(statements.length, 1);
  const [{ actor, verb, object, context }] = statements;
  assert.deepEqual([actor, verb.id, context.registration], [ACTOR, "http://adlnet.gov/expapi/verbs/answered", LAUNCH.get("registration")]);
  assert.match(object.id, /^urn:tilescope:lesson:survivors:/);

  // It does not ask again, and sends the next answer alone.
  await answerNext(page);
  await until("the next statement", async () => sent.length === 2);
  assert.equal(await dialog.count(), 0);
  assert.equal(sent[1].statements.length, 1);
  assert.notEqual(sent[1].statements[0].id, statements[0].id);
});

test("after a no nothing is sent", async (t) => {
  const { page, sent, dialog } = await launched(t);
  await answer(page);
  await dialog.waitFor();
  // An Enter meant for the lesson must not agree.
  assert.equal(await page.evaluate(() => document.activeElement?.textContent), "Do not send");
  await page.keyboard.press("Escape");
  await until("the end of the question", async () => (await dialog.count()) === 0);
  assert.notEqual(await page.evaluate(() => document.activeElement?.tagName), "BODY");

  // Another answer neither asks again nor is sent.
  await answerNext(page);
  assert.equal(await dialog.count(), 0);
  assert.deepEqual(sent, []);
});

test("a name in the list of lessons is shown before it is sent, and a new one asked about again", async (t) => {
  const query = new URLSearchParams(LAUNCH);
  query.delete("actor");
  const { page, sent, dialog } = await launched(t, { query });
  await ask(page, { do: "lesson", learner: "Grace" });
  await answer(page);
  assert.match(await dialog.textContent(), /under this name: Grace/);
  await dialog.getByRole("button", { name: "Send", exact: true }).click();
  await until("statements", async () => sent.length === 1);
  assert.equal(sent[0].statements[0].actor.account.name, "Grace");

  await ask(page, { do: "lesson", learner: "Ada" });
  await answerNext(page);
  await dialog.waitFor();
  assert.match(await dialog.textContent(), /under this name: Ada/);
  await dialog.getByRole("button", { name: "Send", exact: true }).click();
  await until("the next statement", async () => sent.length === 2);
  // The first answer has another id by now, and is not sent again.
  assert.equal(sent[1].statements.length, 1);
});

test("a statement in conflict does not keep back the others", async (t) => {
  const { page, sent, dialog } = await launched(t, { status: [503, 409], expected: [/503/, /409/] });
  await answer(page);
  await dialog.getByRole("button", { name: "Send", exact: true }).click();
  const refused = page.getByRole("dialog", { name: "store.example did not take your answers" });
  await refused.waitFor();
  await answerNext(page);
  await refused.getByRole("button", { name: "Try again" }).click();
  // Both together are in conflict; one by one the store takes them.
  await until("statements", async () => sent.length === 2);
  assert.deepEqual(sent.map(({ statements }) => statements.length), [1, 1]);
});

test("a store that refuses is named, and tried again when asked", async (t) => {
  const { page, sent, dialog } = await launched(t, { status: [503], expected: [/503/] });
  await answer(page);
  await dialog.getByRole("button", { name: "Send", exact: true }).click();
  const refused = page.getByRole("dialog", { name: "store.example did not take your answers" });
  await refused.waitFor();
  assert.match(await refused.textContent(), /It answered: 503/);
  assert.deepEqual(sent, []);
  await refused.getByRole("button", { name: "Try again" }).click();
  await until("statements", async () => sent.length === 1);
});

test("a page whose policy names no store sends nothing", async (t) => {
  const { page, sent, dialog } = await launched(t, { policy: "'self'", expected: [/Content Security Policy/i] });
  await answer(page);
  await dialog.getByRole("button", { name: "Send", exact: true }).click();
  await page.getByRole("dialog", { name: "store.example did not take your answers" }).waitFor();
  assert.deepEqual(sent, []);
});

for (const endpoint of ["http://store.example/xapi", "https://a:b@store.example/", "store"]) {
  test(`${endpoint} is no store`, async (t) => {
    const query = new URLSearchParams({ engine: "cpu", play: "", endpoint });
    const { page, sent } = await launched(t, { query, expected: [/names no record store: its address begins with https/] });
    await answer(page);
    await answerNext(page);
    assert.equal(await page.locator("dialog").count(), 0);
    assert.deepEqual(sent, []);
  });
}
