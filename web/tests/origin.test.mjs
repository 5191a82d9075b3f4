// Tests which origins an address may name for the page around it. Needs no browser.

import assert from "node:assert/strict";
import { test } from "node:test";

globalThis.location = /** @type {any} */ ({ origin: "https://player.example" });
const { namedOrigin } = await import("../page/embed.js");

test("an origin is read as browsers write it, and an invalid one is reported", (t) => {
  const said = t.mock.method(console, "warn", () => {});
  for (const [text, origin] of [
    [null, null],
    ["https://lecture.example", "https://lecture.example"],
    ["https://lecture.example/", "https://lecture.example"],
    ["https://LECTURE.example:443", "https://lecture.example"],
    ["http://127.0.0.1:8080/", "http://127.0.0.1:8080"],
  ]) {
    assert.equal(namedOrigin(text), origin, text);
  }
  assert.equal(said.mock.callCount(), 0);
  for (const text of ["", "*", "null", "lecture.example", "https://lecture.example/course", "https://a@lecture.example", "file:///"]) {
    said.mock.resetCalls();
    assert.equal(namedOrigin(text), null, text);
    assert.ok(said.mock.calls[0].arguments[0].includes(`origin=${text} names no origin`), text);
  }
});
