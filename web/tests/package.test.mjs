// Packages of lessons in course systems: scorm-again is the system of SCORM, a small record store that of cmi5.

import assert from "node:assert/strict";
import { once } from "node:events";
import { readFile, writeFile } from "node:fs/promises";
import { createServer } from "node:http";
import path from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { makeRecord } from "../course/record.js";
import { DIST, PATIENCE_MS, ask, folder, native, slowTest, state, typing, unpacked, until } from "./harness.mjs";
import { contextOf, opened } from "./shared.mjs";

/** A lesson of two questions, one right answer each, whose runs are small. */
const LESSON = `---
title: Counting & more
objective: You can count.
---
# First
\`\`\`run
radius: 0.1
leaf: 6
moment: end of tile
\`\`\`
\`\`\`gate first
type: choice
ask: What is right?
option: This one when: true
option: That one when: false => No.
\`\`\`
# Second
\`\`\`gate second
type: choice
ask: And now?
option: This one when: true
option: That one when: false => No.
\`\`\`
`;

/** The media types of a package's files. */
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm", ".json": "application/json" };

/** The page of a course system that has a SCORM package in a frame. It notes each call and its result. */
const SYSTEM = (version, values) => `<!doctype html><title>Course</title><link rel="icon" href="data:,">
<script src="/scorm-again/scorm${version === "1.2" ? "12" : "2004"}.min.js"></script>
<script>
  const system = new ${version === "1.2" ? "Scorm12API" : "Scorm2004API"}({ logLevel: 5, autocommit: false });
  system.loadFromFlattenedJSON(${JSON.stringify(values)}, "");
  window.calls = [];
  window.${version === "1.2" ? "API" : "API_1484_11"} = new Proxy(system, {
    get: (system, name) => (...values) => {
      const result = system[name](...values);
      calls.push([name.replace("LMS", ""), ...values, result]);
      return result;
    },
  });
</script>
<iframe id="lesson" src="/package/index.html" width="1000" height="650"></iframe>`;

/** The package's files, and what the store was sent. */
const course = { files: new Map(), statements: [], documents: new Map(), fetched: 0, wrong: [], launch: {}, visit: 0 };
/** The course system's server. */
const server = createServer((request, response) => answer(request, response).catch((error) => course.wrong.push(String(error))));

before(async () => {
  server.listen(0, "127.0.0.1");
  await once(server, "listening");
  course.address = `http://127.0.0.1:${server.address().port}`;
});
after(() => server.close());

/** Answers a request for a file of the package, for a page of the course system, or to the record store. */
async function answer(request, response) {
  const { pathname, searchParams } = new URL(request.url, course.address);
  const send = (body, type = "application/json", status = 200) => {
    response.writeHead(status, { "Content-Type": type });
    response.end(body);
  };
  if (pathname.startsWith("/package/")) {
    const bytes = course.files.get(decodeURIComponent(pathname.slice("/package/".length)));
    return send(bytes ?? "", TYPES[path.extname(pathname)] ?? "application/octet-stream", bytes ? 200 : 404);
  }
  if (pathname.startsWith("/scorm-again/")) {
    const file = fileURLToPath(import.meta.resolve("scorm-again")).replace(/dist.*/, `dist/${path.basename(pathname)}`);
    return send(await readFile(file), "text/javascript");
  }
  if (pathname === "/system") {
    return send(SYSTEM(searchParams.get("version"), JSON.parse(searchParams.get("values"))), "text/html");
  }
  if (pathname === "/left") {
    return send("<!doctype html><title>Left</title><link rel='icon' href='data:,'>", "text/html");
  }
  if (pathname === "/fetch") {
    course.fetched += 1;
    assert.equal(request.method, "POST");
    return send(JSON.stringify(course.fetched === 1 ? { "auth-token": "dG9rZW4=" } : { "error-code": "1", "error-text": "used already" }));
  }

  assert.equal(request.headers.authorization, "Basic dG9rZW4=");
  assert.match(request.headers["x-experience-api-version"], /^1\.0\.\d$/);
  const body = Buffer.concat(await request.toArray()).toString();
  if (pathname === "/store/statements") {
    course.statements.push(...[JSON.parse(body)].flat());
    return send("[]");
  }
  if (pathname === "/store/activities/state") {
    const id = searchParams.get("stateId");
    assert.equal(searchParams.get("registration"), "5c6a1a2e-0000-4000-8000-000000000001");
    if (request.method === "PUT") {
      course.documents.set(id, JSON.parse(body));
      return send("", "text/plain", 204);
    }
    const document = id === "LMS.LaunchData" ? course.launch : course.documents.get(id);
    // A browser's console reports a status of 404, so that an empty text stands for a document that is not there yet.
    return send(JSON.stringify(document ?? {}));
  }
  if (pathname === "/store/agents/profile") {
    return send(JSON.stringify({ languagePreference: "fr,en" }));
  }
  throw new Error(`no answer to ${request.method} ${request.url}`);
}

/** Makes a package and puts its files on the server. @param {import("node:test").TestContext} t @param {string[]} options */
async function published(t, lesson, ...options) {
  const at = await folder(t);
  const [file, out] = [path.join(at, "counting.md"), path.join(at, "out.zip")];
  await writeFile(file, LESSON);
  await native("lesson", "package", lesson ?? file, "--folder", DIST, "--out", out, ...options);
  course.files = new Map(unpacked(await readFile(out)).map(({ name, bytes }) => [name, bytes]));
}

/** Opens a page of the course system, and returns the lesson's page and the program in it. */
async function visit(context, address) {
  const page = await context.newPage();
  await page.goto(address);
  const named = (end) => until(end, async () => page.frames().find((frame) => new URL(frame.url(), course.address).pathname === end));
  const around = await named("/package/index.html");
  // After this the page's own script receives an answer first.
  await until("the page", () => around.evaluate(() => document.getElementById("progress")?.textContent));
  await around.evaluate(() => {
    window.answers = 0;
    addEventListener("message", ({ data }) => (window.answers += data?.event === "answered" ? 1 : 0));
  });
  return { page, around, program: await named("/package/program/index.html") };
}

/** Opens a SCORM package. @param {string} version @param {Record<string, any>} values what the system has of earlier visits */
function attempt(context, version, values = {}) {
  return visit(context, `${course.address}/system?${new URLSearchParams({ version, values: JSON.stringify(values) })}`);
}

/** The question that the program asks at a step. */
async function asked(program, step) {
  const told = await state(program, (told) => told.lesson?.step === step && told.lesson.question);
  return told.lesson.question;
}

/** Gives an answer by its text, once its question is open, and waits until the page around has taken it. */
async function give({ around, program }, step, text) {
  const answers = () => around.evaluate(() => window.answers);
  const before = await answers();
  const { controls } = await asked(program, step);
  const items = controls.flatMap((control) => control.items ?? []);
  const item = items.find((item) => item.text.map((span) => span.text).join("").includes(text));
  assert.equal((await ask(program, { do: "answer", value: item.change.choose })).ok, true);
  await until("the answer", async () => (await answers()) > before);
}

/** The calls of a SCORM package, or those of one name. */
const calls = (page, name) => page.evaluate((name) => window.calls.filter((call) => !name || call[0] === name), name);

/** The value that a package has set last, by its name. */
async function value(page, name) {
  const set = await calls(page, "SetValue");
  return set.filter((call) => call[1] === name).at(-1)?.[2];
}

/** Waits until a package has set a value. */
const settles = (page, name, wanted) => until(`${name} = ${wanted}`, async () => (await value(page, name)) === wanted);

/** The values that the system has refused, with their names. */
const refusedOf = (calls) => calls.filter(([name, , , result]) => name === "SetValue" && String(result) !== "true").map(([, name, value]) => [name, value]);

/** Leaves the lesson as a learner does who goes on in the course, and returns the calls of before. */
async function left(page) {
  await page.evaluate(() => document.getElementById("lesson").remove());
  await until("the end of the visit", async () => (await calls(page, "Finish")).concat(await calls(page, "Terminate")).length > 0);
  return calls(page);
}

const QUESTIONS = [
  { gate: "one", id: "one", step: "a", title: "A", seed: 1, traced: false },
  { gate: "two", id: "two", step: "b", title: "B", seed: 1, traced: true },
];
const answered = (more) => ({ gate: "one", seed: 1, score: 1, tries: 1, done: true, given_up: false, ...more });

test("the first answers count, also those of an earlier visit, and practice only improves a score", () => {
  const record = makeRecord(QUESTIONS, "v", "");
  assert.equal(record.take(answered({ score: 0.25, done: false }), "x"), null);
  const again = makeRecord(QUESTIONS, "v", record.text());
  const { score, given } = again.take(answered({}), "y");
  assert.deepEqual([score, given, again.done(), again.isComplete()], [0.25, "", 1, false]);
  // Its answer is known now; another run is a new question.
  assert.equal(again.take(answered({}), "y"), null);
  assert.equal(again.take(answered({ seed: 9 }), "y").isPractice, true);
  again.take(answered({ seed: 8, score: 0, tries: 0, given_up: true }), "");
  assert.equal(again.score(), 0.5);
  assert.equal(again.take(answered({ gate: "of another lesson" }), ""), null);
});

test("of a trace each event has its first answer, and a trace that is given up has no score", () => {
  const record = makeRecord(QUESTIONS, "v", "");
  const event = (more) => answered({ gate: "two", done: false, ...more });
  record.take(event({ score: 0 }), "up");
  record.take(event({ tries: 2 }), "down");
  // Begun anew after a break: the first event is known already.
  const again = makeRecord(QUESTIONS, "v", record.text());
  again.take(event({}), "down");
  const { score, given } = again.take(event({ tries: 2, done: true }), "same");
  assert.deepEqual([score, given], [0.5, "same"]);
  const gone = makeRecord(QUESTIONS, "v", record.text());
  assert.equal(gone.take(event({ tries: 1, done: true, given_up: true }), "").score, 0);
});

test("what was kept of another version of the lesson, or by another program, does not count", () => {
  const record = makeRecord(QUESTIONS, "v", "");
  record.go("b");
  record.take(answered({}), "x");
  assert.equal(makeRecord(QUESTIONS, "v", record.text()).done(), 1);
  const other = makeRecord(QUESTIONS, "w", record.text());
  assert.deepEqual([other.done(), other.place()], [0, "b"]);
  for (const text of ["", "{", "null", "17", '{"version":1,"of":"v","done":{"one":7}}']) {
    assert.equal(makeRecord(QUESTIONS, "v", text).done(), 0, text);
  }
});

/** Makes a package of the lesson that a page shows, by the list of actions, and returns its bytes and its name. */
async function packaged(page, kind) {
  const coming = page.waitForEvent("download", { timeout: PATIENCE_MS });
  await page.focus("#canvas");
  await page.keyboard.press("Control+k");
  await typing(page);
  await page.keyboard.type(`course system by ${kind}`);
  await page.keyboard.press("Enter");
  const download = await coming;
  return [await readFile(await download.path()), download.suggestedFilename()];
}

test("the page makes the packages that the command makes, byte for byte", async (t) => {
  const { page } = await opened(t, "?engine=cpu#lesson=gaps");
  await state(page, (told) => told.lesson?.lesson === "gaps");
  const at = await folder(t);
  const command = async (...options) => {
    const out = path.join(at, "out.zip");
    await native("lesson", "package", "gaps", "--folder", DIST, "--out", out, ...options);
    return readFile(out);
  };
  for (const [kind, name, ...options] of [["cmi5", "gaps-cmi5.zip", "--cmi5"], ["SCORM 1.2", "gaps-scorm-1.2.zip", "--scorm", "1.2"]]) {
    const [bytes, given] = await packaged(page, kind);
    assert.equal(given, name);
    assert.ok(bytes.equals(await command(...options)), `the package for ${kind} differs`);
    // The control: a package with another option is another one.
    assert.ok(!bytes.equals(await command(...options, "--pass", "60")));
  }
});

test("SCORM 1.2: answers and score are reported, a visit resumes at its place, and the lesson is completed at the end", async (t) => {
  await published(t, null, "--scorm", "1.2");
  const { context } = await contextOf(t, { origins: [course.address] });
  const first = await attempt(context, "1.2");
  await give(first, "first", "That one");
  await give(first, "first", "This one");
  await settles(first.page, "cmi.interactions.0.id", "first");
  assert.equal(await first.around.textContent("#progress"), "1 of 2 questions answered");
  assert.equal(await first.around.isHidden("#notice"), true);
  assert.equal(await value(first.page, "cmi.interactions.0.student_response"), "That one");
  assert.equal(await value(first.page, "cmi.interactions.0.result"), "wrong");
  assert.equal(await value(first.page, "cmi.core.lesson_status"), "incomplete");
  assert.equal((await ask(first.program, { do: "lesson", go: "next" })).ok, true);
  await settles(first.page, "cmi.core.lesson_location", "second");
  // The control: a value that no status has is refused.
  await first.page.evaluate(() => window.API.LMSSetValue("cmi.core.lesson_status", "finished"));
  const before = await left(first.page);
  // The system has refused no other, and what was kept last was committed before the end.
  assert.deepEqual(refusedOf(before), [["cmi.core.lesson_status", "finished"]]);
  assert.deepEqual(before.slice(-3).map(([name, value]) => [name, value]), [["SetValue", "cmi.core.exit"], ["Commit", ""], ["Finish", ""]]);

  const kept = { "cmi.suspend_data": await value(first.page, "cmi.suspend_data"), "cmi.core.lesson_status": "incomplete" };
  const second = await attempt(context, "1.2", kept);
  await give(second, "second", "This one");
  await settles(second.page, "cmi.core.lesson_status", "completed");
  assert.equal(await value(second.page, "cmi.core.score.raw"), "50");
  assert.match(await value(second.page, "cmi.core.session_time"), /^0000:00:\d\d$/);
  assert.equal(await second.around.textContent("#progress"), "All 2 questions are answered.");
});

test("SCORM 2004: scaled score, completion and success; a review reports nothing", async (t) => {
  await published(t, null, "--scorm", "2004", "--pass", "60", "--language", "en");
  const { context } = await contextOf(t, { origins: [course.address] });
  const visited = await attempt(context, "2004");
  const { page, around } = visited;
  await give(visited, "first", "This one");
  await settles(page, "cmi.progress_measure", "0.5");
  assert.deepEqual([await value(page, "cmi.score.scaled"), await value(page, "cmi.success_status")], [undefined, undefined]);
  // The button leads to what is open.
  await around.getByRole("button", { name: "Next open question" }).click();
  await give(visited, "second", "That one");
  await give(visited, "second", "This one");
  await settles(page, "cmi.completion_status", "completed");
  assert.deepEqual([await value(page, "cmi.score.scaled"), await value(page, "cmi.success_status")], ["0.5", "failed"]);
  assert.equal(await value(page, "cmi.interactions.1.learner_response"), "That one");
  const text = await value(page, "cmi.suspend_data");
  assert.deepEqual(refusedOf(await left(page)), []);

  const review = await attempt(context, "2004", { "cmi.mode": "review", "cmi.suspend_data": text });
  await asked(review.program, "second");
  assert.equal(await review.around.textContent("#notice"), "This is a review: nothing is reported.");
  await give(review, "second", "This one");
  const names = (await left(review.page)).map(([name]) => name);
  assert.deepEqual([names.includes("SetValue"), names.includes("Commit")], [false, false], names.join());
});

/** The address with which a system opens a package of cmi5. */
function launchAddress() {
  const query = new URLSearchParams({
    endpoint: `${course.address}/store`,
    // Each visit has one of its own.
    fetch: `${course.address}/fetch?visit=${course.visit}`,
    actor: JSON.stringify({ objectType: "Agent", account: { homePage: course.address, name: "17" } }),
    registration: "5c6a1a2e-0000-4000-8000-000000000001",
    activityId: `${course.address}/activities/1`,
  });
  return `${course.address}/package/index.html?${query}`;
}

/** What the course system tells the package. */
const launchData = () => ({
  launchMode: "Normal",
  masteryScore: 0.5,
  moveOn: "CompletedAndPassed",
  returnURL: `${course.address}/left`,
  contextTemplate: {
    extensions: { "https://w3id.org/xapi/cmi5/context/extensions/sessionid": "s" },
    contextActivities: { grouping: [{ id: "urn:tilescope:lesson:counting" }] },
  },
});

const verbs = () => course.statements.map(({ verb }) => verb.id.split("/").at(-1));
const categories = ({ context }) => context.contextActivities.category.map(({ id }) => id.split("/").at(-1));

/** Makes the store empty, and opens the package with the given launch data. */
function relaunched(context, launch) {
  Object.assign(course, { statements: [], documents: new Map(), fetched: 0, launch, visit: course.visit + 1 });
  return visit(context, launchAddress());
}

test("cmi5: statements come in order, in the given context, and the address for the token is used once", async (t) => {
  await published(t, null, "--cmi5", "--pass", "50");
  const { context } = await contextOf(t, { origins: [course.address] });
  const visited = await relaunched(context, launchData());
  const { page, program } = visited;
  await give(visited, "first", "This one");
  await until("the answer", () => verbs().includes("answered"));
  assert.equal((await ask(program, { do: "lesson", go: "next" })).ok, true);
  await give(visited, "second", "That one");
  await give(visited, "second", "This one");
  await until("the end of the lesson", () => verbs().includes("passed"));
  await page.getByRole("button", { name: "Finish" }).click();
  await page.waitForURL("**/left");
  await until("the end of the visit", () => verbs().includes("terminated"));

  assert.deepEqual(verbs(), ["initialized", "answered", "answered", "completed", "passed", "terminated"]);
  assert.equal(course.fetched, 1);
  const [initialized, first, second, completed, passed, terminated] = course.statements;
  for (const statement of course.statements) {
    assert.equal(statement.context.registration, "5c6a1a2e-0000-4000-8000-000000000001");
    assert.equal(statement.context.extensions["https://w3id.org/xapi/cmi5/context/extensions/sessionid"], "s");
    assert.equal(statement.context.contextActivities.grouping.length, 1);
    assert.match(statement.id, /^[0-9a-f]{8}-[0-9a-f]{4}-4[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}$/);
  }
  assert.equal(new Set(course.statements.map(({ id }) => id)).size, 6);
  assert.deepEqual([first, second].map(({ result }) => [result.score.scaled, result.response]), [[1, "This one"], [0, "That one"]]);
  assert.equal(second.object.id, "urn:tilescope:lesson:counting:second");
  // Only what cmi5 defines has its categories, and only verdicts that of moving on.
  assert.deepEqual([initialized, first, completed, passed, terminated].map(categories), [["cmi5"], [], ["cmi5", "moveon"], ["cmi5", "moveon"], ["cmi5"]]);
  assert.deepEqual([completed.result.completion, completed.result.score], [true, undefined]);
  assert.deepEqual(passed.result.score, { scaled: 0.5, raw: 50, min: 0, max: 100 });
  assert.equal(passed.context.extensions["https://w3id.org/xapi/cmi5/context/extensions/masteryscore"], 0.5);

  // The visit is over: its address shows the lesson and reports nothing more.
  await page.goto(launchAddress());
  await page.getByText("The course takes no more answers of this visit").waitFor();
  assert.deepEqual([course.fetched, course.statements.length, course.wrong], [1, 6, []]);
});

slowTest("cmi5: who has not passed fails at the end, a review is no more than begun and ended, and without a score to pass with there is one", async (t) => {
  await published(t, null, "--cmi5");
  const { context } = await contextOf(t, { origins: [course.address] });
  const answerAll = async (visited, first) => {
    await give(visited, "first", first);
    assert.equal((await ask(visited.program, { do: "lesson", go: "next" })).ok, true);
    await give(visited, "second", "This one");
  };
  const leave = async ({ page }) => {
    await page.goto(`${course.address}/left`);
    await until("the end of the visit", () => verbs().includes("terminated"));
    await page.close();
    return verbs();
  };

  const failing = await relaunched(context, { ...launchData(), masteryScore: 0.9 });
  await give(failing, "first", "That one");
  await answerAll(failing, "This one");
  assert.deepEqual(await leave(failing), ["initialized", "answered", "answered", "completed", "failed", "terminated"]);

  const { masteryScore, ...without } = launchData();
  assert.equal(masteryScore, 0.5);
  const judged = await relaunched(context, without);
  await answerAll(judged, "This one");
  assert.deepEqual(await leave(judged), ["initialized", "answered", "answered", "completed", "scored", "terminated"]);
  const scored = course.statements.find(({ verb }) => verb.id.endsWith("scored"));
  assert.deepEqual([scored.result.score.scaled, categories(scored)], [1, []]);

  const review = await relaunched(context, { ...launchData(), launchMode: "Review" });
  await answerAll(review, "This one");
  assert.deepEqual([await leave(review), course.documents.size, course.wrong], [["initialized", "terminated"], 0, []]);
});

slowTest("chosen steps of a lesson that comes with the program are all that its package has, in German", async (t) => {
  await published(t, "survivors", "--scorm", "1.2", "--steps", "too-close,chain", "--language", "de");
  const { context } = await contextOf(t, { origins: [course.address] });
  const { page, around, program } = await attempt(context, "1.2");
  const { lesson } = await state(program, (told) => told.lesson?.step === "too-close" && !told.lesson.waits);
  assert.deepEqual([lesson.steps.map(({ name }) => name), lesson.heading], [["too-close", "chain"], "Zu nah"]);
  assert.equal(await around.textContent("#progress"), "0 von 1 Fragen beantwortet");
  // A learner who closes the lesson comes back by the button.
  assert.equal((await ask(program, { do: "lesson", act: "leave" })).ok, true);
  await around.getByRole("button", { name: "Zurück zur Lektion" }).click();
  await state(program, (told) => told.lesson?.step === "too-close");
  for (const request of [{ go: "chain" }, { act: "give-up" }, { act: "give-up" }]) {
    await state(program, (told) => told.lesson && !told.lesson.waits);
    assert.equal((await ask(program, { do: "lesson", ...request })).ok, true);
  }
  await settles(page, "cmi.core.lesson_status", "completed");
  assert.equal(await value(page, "cmi.core.score.raw"), "0");
});
