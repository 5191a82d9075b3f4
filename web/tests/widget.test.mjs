// The front end of the Python package's notebook widget, without a browser: links, the page as one document, and how the
// shared state and the player follow each other. `notebook.test.mjs` shows it in JupyterLab.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { test } from "node:test";

const SOURCE = new URL("../../crates/python/python/tilescope/_widget.js", import.meta.url);
// The package is no folder of Node.js modules, so that the ending alone does not tell what the file is.
const widget = await import(`data:text/javascript,${encodeURIComponent(await readFile(SOURCE, "utf8"))}`);
const { assembled, follower, nearest, pickedIn, picking, startOf } = widget;

/** A state as Python shares it, which records what is sent to Python. */
function modelOf(values) {
  const state = { _link: "v=1&seed=7", _digest: "d", _picked: null, cursor: null, moment: "finish", ...values };
  let saved = 0;
  return {
    state,
    saves: () => saved,
    get: (name) => state[name],
    set: (name, value) => (state[name] = value),
    save_changes: () => (saved += 1),
  };
}

/** What a player tells of a run of 900 events. */
function told(values = {}) {
  const end = { cursor: 900, events: 900, stage: "finish", sentence: "Finish." };
  return { event: "state", state: { ready: true, positions_digest: "d", ...end, link: "v=1&seed=7", ...values } };
}

test("the selected sample is read from links and written into them", () => {
  assert.equal(pickedIn("v=1&select=sample:12&look=light"), 12);
  assert.equal(pickedIn("v=1&select=place:1,2"), null);
  assert.equal(pickedIn("v=1"), null);
  assert.equal(picking("v=1&select=place:1,2&break=a%3Bb", 4), "v=1&break=a%3Bb&select=sample:4");
  assert.equal(picking("v=1&select=sample:4", null), "v=1");
});

test("a view begins at the moment and the selection of the state", () => {
  assert.equal(startOf(modelOf({})), "v=1&seed=7");
  assert.equal(startOf(modelOf({ cursor: 5, moment: "tile", _picked: 3 })), "v=1&seed=7&at=5&select=sample:3");
  assert.equal(startOf(modelOf({ moment: "tile" })), "v=1&seed=7&stage=tile");
});

test("the nearest point is found, and none that is too far", () => {
  assert.equal(nearest([0, 0, 1, 1, 2, 2], 1.2, 1.1, 0.5), 1);
  assert.equal(nearest([0, 0, 1, 1], 5, 5, 0.5), null);
});

const INDEX = `<meta content="default-src 'none'; script-src 'self' 'wasm-unsafe-eval'" />
<link id="program-style" rel="stylesheet" media="not all" href="style-000000000001.css" />
<template id="program"><main></main></template>`;
/** The files of a page, of which two use a third. */
const pageFiles = () =>
  new Map([
    ["index.html", INDEX],
    ["main-000000000002.js", 'import "./a-000000000003.js"; import "./b-000000000004.js"; location.search'],
    ["a-000000000003.js", 'import "./b-000000000004.js"'],
    ["b-000000000004.js", "let b"],
    ["style-000000000001.css", "main {}"],
  ]);

test("the page becomes one document whose files are stored once each", () => {
  const stored = [];
  const addressOf = (content, type) => `blob:${stored.push({ content, type }) - 1}`;
  const page = assembled(pageFiles(), addressOf);
  assert.deepEqual(
    stored.map(({ content }) => content),
    ["main {}", "let b", 'import "blob:1"', 'import "blob:2"; import "blob:1"; "?embed=player"'],
  );
  assert.match(page, /script-src blob: 'wasm-unsafe-eval'/);
  assert.match(page, /src="blob:3"/);
});

test("a page that lacks a file, or is of another kind, is refused", () => {
  const lacking = pageFiles();
  lacking.delete("b-000000000004.js");
  assert.throws(() => assembled(lacking, () => "blob:"), /no b-000000000004\.js/);
  const other = pageFiles().set("index.html", "<p>Another page</p>");
  assert.throws(() => assembled(other, () => "blob:"), /another version/);
});

test("what the player shows comes into the state", () => {
  const model = modelOf();
  const { hear } = follower(model, assert.fail);
  hear(told({ ready: false, cursor: 1 }));
  assert.equal(model.saves(), 0, "a run that is being made has no moment");
  hear(told({ cursor: 30, stage: "tile", link: "v=1&seed=7&select=sample:8" }));
  const { cursor, moment, events, _picked, sentence } = model.state;
  assert.deepEqual([cursor, moment, events, _picked, sentence], [30, "tile", 900, 8, "Finish."]);
});

test("what is set before the run is there is asked of the player then", () => {
  const [model, posted] = [modelOf(), []];
  const { hear, changes } = follower(model, (request) => posted.push(request));
  Object.assign(model.state, { cursor: 10, _picked: 4 });
  changes.cursor();
  changes._picked();
  hear(told({ ready: false }));
  assert.deepEqual(posted, [], "before the run is made nothing can be asked");
  hear(told());
  assert.deepEqual(posted, [
    { tilescope: 1, id: 1, do: "seek", event: 10 },
    { tilescope: 1, id: 2, do: "load", link: "v=1&seed=7&select=sample:4" },
  ]);
  assert.equal(model.state.cursor, 10);
});

test("a stage that is set before the run is there is sought then", () => {
  const [model, posted] = [modelOf(), []];
  const { hear, changes } = follower(model, (request) => posted.push(request));
  Object.assign(model.state, { cursor: null, moment: "tile" });
  changes.moment();
  hear(told());
  assert.deepEqual(posted, [{ tilescope: 1, id: 1, do: "seek", stage: "tile" }]);
});

test("what the state says is asked of the player, and nothing that it shows already", () => {
  const [model, posted] = [modelOf(), []];
  const { hear, changes } = follower(model, (request) => posted.push(request));
  hear(told());
  assert.deepEqual(model.state.cursor, 900);
  changes.cursor();
  changes.moment();
  changes._picked();
  assert.deepEqual(posted, []);
  Object.assign(model.state, { cursor: 10, _picked: 4 });
  changes.cursor();
  changes._picked();
  assert.deepEqual(posted, [
    { tilescope: 1, id: 1, do: "seek", event: 10 },
    { tilescope: 1, id: 2, do: "load", link: "v=1&seed=7&select=sample:4" },
  ]);
});

test("a stage is sought by its name, and a moment of another view by its event", () => {
  const [model, posted] = [modelOf(), []];
  const { hear, changes } = follower(model, (request) => posted.push(request));
  hear(told());
  Object.assign(model.state, { cursor: 10, moment: "tile" });
  changes.moment();
  assert.deepEqual(posted, []);
  model.state.cursor = 900;
  changes.moment();
  assert.deepEqual(posted, [{ tilescope: 1, id: 1, do: "seek", stage: "tile" }]);
});

test("a state of before a request does not undo it", () => {
  const [model, posted] = [modelOf(), []];
  const { hear, changes } = follower(model, (request) => posted.push(request));
  hear(told());
  model.state.cursor = 10;
  changes.cursor();
  hear(told({ cursor: 899 }));
  assert.equal(model.state.cursor, 10);
  // Once the player has done it, it is asked where it is.
  hear({ id: 1, ok: true });
  assert.deepEqual(posted.at(-1), { tilescope: 1, id: 2, do: "state" });
  hear({ id: 2, ok: true, state: told({ cursor: 10 }).state });
  assert.equal(model.state.cursor, 10);
  assert.equal(posted.length, 2);
});

test("a refusal is noted, and the state is the player's again", () => {
  const model = modelOf();
  const { hear, changes } = follower(model, () => {});
  hear(told());
  model.state.cursor = 5000;
  changes.cursor();
  hear({ id: 1, ok: false, error: "Event 5000 is beyond the last one." });
  assert.equal(model.state.note, "Event 5000 is beyond the last one.");
  assert.equal(model.state.cursor, 900);
});

test("another run than that of the set is named and not followed", () => {
  const [model, posted] = [modelOf(), []];
  const { hear, changes } = follower(model, (request) => posted.push(request));
  hear(told({ positions_digest: "e", cursor: 3 }));
  assert.match(model.state.note, /another run/);
  assert.equal(model.state.cursor, null);
  model.state.cursor = 10;
  changes.cursor();
  assert.deepEqual(posted, []);
});
