// Files are opened by dropping and saved by downloading; the native program verifies the downloads again.

import assert from "node:assert/strict";
import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { test } from "node:test";
import { controls } from "./controls.mjs";
import { PATIENCE_MS, ask, folder, load, native, shows, state, stored, typing } from "./harness.mjs";
import { reused } from "./shared.mjs";


/** Drops files on the middle of the canvas: texts, or bytes in base64. */
async function drop(page, files) {
  const transfer = await page.evaluateHandle((files) => {
    const transfer = new DataTransfer();
    for (const { name, text, base64 } of files) {
      const bytes = base64 && Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
      transfer.items.add(new File([bytes ?? text], name));
    }
    return transfer;
  }, files);
  for (const type of ["dragenter", "dragover", "drop"]) {
    await page.dispatchEvent("#canvas", type, { dataTransfer: transfer, clientX: 620, clientY: 400 });
  }
}

test("the result is downloaded with its certificate, and the native program verifies it", async (t) => {
  const made = await folder(t);
  const { page } = await reused(t);
  const told = await state(page);
  const coming = page.waitForEvent("download", { timeout: PATIENCE_MS });
  await page.keyboard.press("Control+e");
  await typing(page);
  await page.keyboard.press("Enter");
  const download = await coming;
  const archive = path.join(made, download.suggestedFilename());
  await download.saveAs(archive);
  assert.match(archive, /\.zip$/);
  const files = stored(await readFile(archive));
  assert.equal(files.length, 2, files.map((file) => file.name).join(", "));
  for (const { name, bytes } of files) {
    await writeFile(path.join(made, name), bytes);
  }
  const [set, certificate] = files;
  const verdict = JSON.parse(await native("verify", path.join(made, set.name), "--json"));
  assert.equal(JSON.parse(certificate.bytes.toString()).positions_digest, told.positions_digest);
  assert.equal(verdict.passed, true);
  assert.equal(verdict.certificate, true);
});

test("a session is saved, dropped and opened where it was left", async (t) => {
  const { page } = await reused(t);
  await ask(page, { do: "seek", event: 4321 });
  const left = await state(page, (told) => told.cursor === 4321);
  const coming = page.waitForEvent("download", { timeout: PATIENCE_MS });
  await page.keyboard.press("Control+s");
  await typing(page);
  await page.keyboard.press("Enter");
  const download = await coming;
  const text = await readFile(await download.path(), "utf8");
  assert.equal(JSON.parse(text).cursor, 4321);
  await load(page, "v=1&radius=0.03&seed=2");
  await drop(page, [{ name: "session.json", text }]);
  const back = await state(page, (told) => told.ready && told.cursor === 4321 && told.verified !== null);
  assert.equal(back.positions_digest, left.positions_digest);
  await shows(page);
});

test("a point set and its certificate are dropped as a pattern, and other bytes are refused in words", async (t) => {
  const made = await folder(t);
  const set = path.join(made, "pattern.csv");
  await native("sample", "--radius", "0.01", "--out", set);
  const { page } = await reused(t);
  await drop(page, [
    { name: "pattern.csv", text: await readFile(set, "utf8") },
    { name: "pattern.csv.certificate.json", text: await readFile(`${set}.certificate.json`, "utf8") },
  ]);
  const taken = await state(page, (told) => told.notice?.includes("pattern.csv"));
  assert.match(taken.notice, /next run clips from/);
  await drop(page, [{ name: "noise.csv", text: "\u0000\u0001no points here" }]);
  const refused = await state(page, (told) => told.notice?.includes("noise.csv"));
  assert.match(refused.notice, /^noise\.csv: .*no column is named x/);
});

/** A radius that is smallest at the centre. */
const FORMULA = "0.02 + 0.06*hypot(x - 0.5, y - 0.5)";

/** A polygon with a hole, at coordinates that cannot be degrees. */
const PARK = {
  type: "Polygon",
  coordinates: [
    [[200, 250], [201, 250], [201, 251], [200.5, 250.8], [200, 251], [200, 250]],
    [[200.3, 250.2], [200.7, 250.2], [200.5, 250.5], [200.3, 250.2]],
  ],
};

/** 16 by 8 pixels, from black on the left to white on the right. */
const GREY =
  "iVBORw0KGgoAAAANSUhEUgAAABAAAAAICAAAAADVHSBLAAAAHUlEQVR42mNgEFAwcAhIKGiYsGDDgQsPPjAMjAAAR2k8AZrih9sAAAAASUVORK5CYII=";

test("a set of a formula has the native program's points", async (t) => {
  const set = path.join(await folder(t), "field.csv");
  // Links begin with a periodic domain, and the command line with a bounded one.
  await native("sample", "--radius-expression", FORMULA, "--boundary", "periodic", "--out", set);
  const certificate = JSON.parse(await readFile(`${set}.certificate.json`, "utf8"));
  const { page } = await reused(t);
  const told = await load(page, `v=1&radius-expression=${encodeURIComponent(FORMULA)}`);
  assert.deepEqual([told.notice, told.verified], [null, true]);
  assert.equal(told.positions_digest, certificate.positions_digest);
  // Every dart is an event that can be visited.
  await ask(page, { do: "seek", event: 100 });
  assert.equal((await state(page)).cursor, 100);
  await shows(page);
});

test("a polygon and an image that are dropped become sets, and a damaged image is refused in words", async (t) => {
  const { page } = await reused(t);
  let before = (await state(page)).positions_digest;
  for (const file of [{ name: "park.geojson", text: JSON.stringify(PARK) }, { name: "grey.png", base64: GREY }]) {
    await drop(page, [file]);
    const told = await state(page, (told) => told.ready && told.verified !== null && told.positions_digest !== before);
    assert.equal(told.verified, true, file.name);
    before = told.positions_digest;
    await shows(page);
  }
  await drop(page, [{ name: "half.png", base64: GREY.slice(0, 60) }]);
  const refused = await state(page, (told) => told.notice?.includes("half.png"));
  assert.equal(refused.positions_digest, before);
});

test("a dropped image is stippled, and the native program has the same dots and verifies them", async (t) => {
  const made = await folder(t);
  const { page } = await reused(t);
  let before = (await state(page)).positions_digest;
  const settled = async () => {
    const told = await state(page, (told) => told.ready && told.verified !== null && told.positions_digest !== before);
    before = told.positions_digest;
    return told;
  };
  await drop(page, [{ name: "grey.png", base64: GREY }]);
  await settled();
  const tree = controls(page);
  await tree.getByRole("combobox", { name: "Radius by", exact: true }).press("Enter");
  await tree.getByRole("option", { name: "dots of an image" }).press("Enter");
  await tree.getByRole("textbox", { name: "Dots", exact: true }).fill("300");
  await tree.getByRole("button", { name: "Run to apply" }).press("Enter");
  const told = await settled();
  assert.equal(told.verified, true);

  const image = path.join(made, "grey.png");
  await writeFile(image, Buffer.from(GREY, "base64"));
  const stipple = JSON.parse(await native("stipple", image, "--dots", "300", "--json"));
  assert.equal(told.positions_digest, stipple.positions_digest);

  // What the page exports is judged with its image again.
  const coming = page.waitForEvent("download", { timeout: PATIENCE_MS });
  await page.keyboard.press("Control+e");
  await tree.getByRole("button", { name: "Download file and certificate" }).press("Enter");
  for (const { name, bytes } of stored(await readFile(await (await coming).path()))) {
    await writeFile(path.join(made, name), bytes);
  }
  const verdict = JSON.parse(await native("verify", path.join(made, "tilescope.csv"), "--density-image", image, "--json"));
  assert.deepEqual([verdict.passed, verdict.prefix.kept], [true, 300]);
});

test("a file dropped beside the canvas does not replace the page", async (t) => {
  const { page } = await reused(t);
  const goesOn = (type, at) =>
    page.evaluate(
      ([type, at]) => document.querySelector(at).dispatchEvent(new DragEvent(type, { bubbles: true, cancelable: true })),
      [type, at],
    );
  for (const at of ["#failure", "#notice", "body"]) {
    assert.equal(await goesOn("dragover", at), false, at);
    assert.equal(await goesOn("drop", at), false, at);
  }
});
