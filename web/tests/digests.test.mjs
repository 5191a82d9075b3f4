// Same parameters, same points, bit for bit: both engines of the page against the native program.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import path from "node:path";
import { test } from "node:test";
import { ask, folder, native, shows, state } from "./harness.mjs";
import { started } from "./shared.mjs";

/** What is sampled: as the page is asked for it, and as the native program is. */
const SETS = [
  { radius: 0.02, seed: 1 },
  { radius: 0.025, seed: 18446744073709551615n, boundary: "bounded", leaf: 10 },
  { radius: 0.021, seed: 7, width: 1.5, height: 0.75, leaf: 12 },
  { radius: 0.022, seed: 3, order: "random", dihedral: true, leaf: 8 },
  { radius: 0.026, seed: 4, insertion: "uniform", order: "phase-group", leaf: 9 },
  { radius: 0.019, seed: 5, leaf: 20, order: "index" },
];

/** The digest of the positions that the native program makes. */
async function nativeDigest(set, into) {
  const file = path.join(into, "set.csv");
  const flags = Object.entries(set).flatMap(([name, value]) => (value === true ? [`--${name}`] : [`--${name}`, String(value)]));
  await native("sample", ...flags, "--out", file);
  const certificate = JSON.parse(await readFile(`${file}.certificate.json`, "utf8"));
  return certificate.positions_digest;
}

/** The link that asks for a set. */
function link(set) {
  const pairs = Object.entries(set).map(([name, value]) => `${name}=${value === true ? "yes" : value}`);
  return `v=1&${pairs.join("&")}`;
}

for (const engine of ["cpu", "gpu"]) {
  test(`six parameter sets by the ${engine} of the page are those of the native program`, async (t) => {
    const made = await folder(t);
    const { page } = await started(t, `?engine=${engine}`);
    if (engine === "gpu") {
      const { gpu, chosen } = await state(page, (told) => told.gpu !== "testing");
      assert.equal(gpu, "ready", `WebGPU was promised: ${chosen}`);
    }
    const seen = new Set();
    for (const set of SETS) {
      const { ok, dropped } = await ask(page, { do: "load", link: link(set) });
      assert.deepEqual([ok, dropped], [true, []]);
      const told = await state(page, (told) => told.ready && told.verified !== null && told.parameters.radius === set.radius);
      assert.equal(told.verified, true);
      assert.match(told.engine, engine === "gpu" ? /^GPU/ : /^CPU/);
      assert.ok(told.events > 0, "the run has its events");
      assert.equal(told.positions_digest, await nativeDigest(set, made), link(set));
      seen.add(told.positions_digest);
    }
    // Digests that are all alike would prove nothing.
    assert.equal(seen.size, SETS.length);
    await shows(page);
  });
}
