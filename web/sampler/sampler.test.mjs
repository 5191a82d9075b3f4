// The package as it is installed, in Node.js: its sets and windows are those of the native program, bit for bit.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import path from "node:path";
import { before, test } from "node:test";
import { PACKAGE, digest, native } from "./native.mjs";

let sampler;
before(async () => {
  const { load } = await import(path.join(PACKAGE, "index.js"));
  sampler = await load();
});

for (const [settings, words] of [
  [{ radius: 0.02, seed: 7 }, "--radius 0.02 --seed 7"],
  [
    { count: 5000, boundary: "bounded", width: 2, leaf: 12, order: "random" },
    "--count 5000 --boundary bounded --width 2 --leaf 12 --order random",
  ],
  [
    { radius: 0.03, insertion: "uniform", dihedral: true, seed: 2n ** 64n - 1n },
    `--radius 0.03 --insertion uniform --dihedral --seed ${2n ** 64n - 1n}`,
  ],
  [
    { radius: 0.03, leaf: 8, patternSide: 30, patternSeed: 4, patternBoundary: "bounded" },
    "--radius 0.03 --leaf 8 --pattern-side 30 --pattern-seed 4 --pattern-boundary bounded",
  ],
  [{ radius: 0.02, method: "exact", seed: 5 }, "--radius 0.02 --method exact --seed 5"],
  [{ radius: 0.02, method: "reference", boundary: "bounded" }, "--radius 0.02 --method reference --boundary bounded"],
]) {
  test(`a set with ${words} is the native program's`, async () => {
    const { points } = sampler.sample(settings);
    const wanted = await native(words);
    assert.ok(wanted.length > 1000);
    assert.equal(points.length, wanted.length);
    assert.equal(digest(points), digest(wanted));
    // The digest would show one other bit.
    new Uint8Array(points.buffer, points.byteOffset)[0] ^= 1;
    assert.notEqual(digest(points), digest(wanted));
  });
}

for (const [method, period] of [
  ["kdrt", 1300],
  ["exact", 4],
]) {
  test(`a window of a plane with ${method} is the native program's`, async () => {
    const plane = sampler.plane({ radius: 0.02, seed: 11, method, period });
    const points = plane.window([0.25, 0.5, 1.25, 1.5]);
    const words = `--method ${method} --radius 0.02 --seed 11 --width ${period} --height ${period} --window 0.25 0.5 1.25 1.5`;
    assert.ok(points.length > 3000);
    assert.equal(digest(points), digest(await native(words)));
    plane.free();
    assert.throws(() => plane.window([0, 0, 1, 1]), /freed/);
  });
}

test("a plane has no end, and a move gains what was not in view", () => {
  const plane = sampler.plane({ radius: 1.5, seed: 7 });
  const [view, next] = [[-1e6, 0, -1e6 + 180, 180], [-1e6 + 3, 0, -1e6 + 183, 180]];
  const pairs = (points) => Array.from({ length: points.length / 2 }, (_, k) => `${points[2 * k]} ${points[2 * k + 1]}`);
  const before = new Set(pairs(plane.window(view)));
  const wanted = pairs(plane.window(next)).filter((pair) => !before.has(pair));
  assert.ok(before.size > 9000 && wanted.length > 50);
  assert.deepEqual(pairs(plane.gained(view, next)).sort(), wanted.sort());
});

test("wrong settings are refused with value and limit", () => {
  assert.throws(() => sampler.sample({ radius: -1 }), { name: "RangeError", message: /-1/ });
  assert.throws(() => sampler.sample({ raduis: 1 }), /raduis/);
  assert.throws(() => sampler.sample({ radius: 0.02, seed: -1n }), /seed is -1/);
  assert.throws(() => sampler.sample({ radius: 0.02, seed: 2 ** 60 }), /bigint/);
  assert.throws(() => sampler.sample({ radius: "0.02" }), /radius is "0.02"/);
  assert.throws(() => sampler.sample({ radius: 0.02, boundary: "torus" }), /periodic, bounded/);
  assert.throws(() => sampler.plane({ radius: 1, count: 5 }), /count/);
});

test("the module is taken from bytes and from a compiled module, too", async () => {
  const { load } = await import(path.join(PACKAGE, "index.js"));
  const bytes = await readFile(path.join(PACKAGE, "sampler.wasm"));
  const set = digest(sampler.sample({ radius: 0.05 }).points);
  for (const source of [bytes, await WebAssembly.compile(bytes), new Response(bytes)]) {
    assert.equal(digest((await load(source)).sample({ radius: 0.05 }).points), set);
  }
});
