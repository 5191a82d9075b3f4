// Same parameters, same points, bit for bit: compares both engines of the page with the native program. Also tests a
// GPU that computes wrong points, and one that is lost.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import path from "node:path";
import { test } from "node:test";
import { IS_SLOW, ask, folder, load, native, shows, slowTest, state } from "./harness.mjs";
import { opened, reused } from "./shared.mjs";

/**
 * The parameter sets, as a link to the page and as arguments of the native program. The first three have both boundaries,
 * both insertions, a seed that a number of JavaScript cannot hold, and an order that is drawn; the others are for slow runs.
 */
const SETS = [
  { radius: 0.025, seed: 18446744073709551615n, boundary: "bounded", leaf: 10 },
  { radius: 0.022, seed: 3, order: "random", dihedral: true, leaf: 8 },
  { radius: 0.026, seed: 4, insertion: "uniform", order: "phase-group", leaf: 9 },
  { radius: 0.023, seed: 1 },
  { radius: 0.021, seed: 7, width: 1.5, height: 0.75, leaf: 12 },
  { radius: 0.019, seed: 5, leaf: 20, order: "index" },
].slice(0, IS_SLOW ? 6 : 3);

/** Returns the digest of the positions that the native program computes. */
async function nativeDigest(set, into) {
  const file = path.join(into, "set.csv");
  const flags = Object.entries(set).flatMap(([name, value]) => (value === true ? [`--${name}`] : [`--${name}`, String(value)]));
  await native("sample", ...flags, "--out", file);
  const certificate = JSON.parse(await readFile(`${file}.certificate.json`, "utf8"));
  return certificate.positions_digest;
}

/** Returns the link for a set. */
function link(set) {
  const pairs = Object.entries(set).map(([name, value]) => `${name}=${value === true ? "yes" : value}`);
  return `v=1&${pairs.join("&")}`;
}

/** The longest buffer, in bytes, of a device that has to compute the runs of its self-test in several windows. */
const SHORT = 230_000;

/**
 * Records devices, so that a test can destroy them, and the share of the domain of each window that they compute. The
 * length of buffers can be limited, and one point in the middle of the first window can be moved by one unit.
 */
function watchDevices({ longest, spoils } = {}) {
  for (const limit of longest ? ["maxBufferSize", "maxStorageBufferBindingSize"] : []) {
    const { get } = Object.getOwnPropertyDescriptor(GPUSupportedLimits.prototype, limit);
    Object.defineProperty(GPUSupportedLimits.prototype, limit, {
      get() {
        return Math.min(get.call(this), longest);
      },
    });
  }
  window.shares = [];
  const { writeBuffer } = GPUQueue.prototype;
  GPUQueue.prototype.writeBuffer = function (buffer, at, data, ...rest) {
    if (buffer.label === "frame") {
      // As `Frame` in the GPU engine has them: the window's corners, and the sides of the domain.
      const words = new Int32Array(data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength));
      const [minX, minY, maxX, maxY, , , width, height] = words.slice(6);
      window.shares.push(((maxX - minX) / width) * ((maxY - minY) / height));
    }
    return writeBuffer.call(this, buffer, at, data, ...rest);
  };
  window.devices = [];
  const { requestDevice } = GPUAdapter.prototype;
  GPUAdapter.prototype.requestDevice = async function (...options) {
    const device = await requestDevice.apply(this, options);
    window.devices.push(device);
    return device;
  };
  let spoilt = null;
  const { copyBufferToBuffer } = GPUCommandEncoder.prototype;
  GPUCommandEncoder.prototype.copyBufferToBuffer = function (from, ...rest) {
    if (spoils && from.label === "result") {
      spoilt ??= rest.find((given) => given instanceof GPUBuffer);
    }
    return copyBufferToBuffer.call(this, from, ...rest);
  };
  const { getMappedRange } = GPUBuffer.prototype;
  GPUBuffer.prototype.getMappedRange = function (...given) {
    const range = getMappedRange.apply(this, given);
    if (this === spoilt) {
      const words = new Int32Array(range);
      words[2 * Math.floor(words.length / 4)] += 1;
    }
    return range;
  };
}

/** Settings with so little to draw that software renderers have time to compute. */
const SMALL = {
  clip: { x: 50, y: 30, width: 200, height: 140 },
  settings: { viewport: { width: 300, height: 200 } },
  prepare: (context) => context.addInitScript(watchDevices),
};

/** Returns a page that samples with an engine; if that is the GPU, once it has passed its test. */
async function sampling(t, engine) {
  const { page } = await reused(t, `?embed=canvas&display=webgl&engine=${engine}`, SMALL);
  return page;
}

for (const engine of ["cpu", "gpu"]) {
  test(`parameter sets by the ${engine} of the page are those of the native program`, async (t) => {
    const made = await folder(t);
    const page = await sampling(t, engine);
    const seen = new Set();
    // Software computes as a GPU slowly.
    const sets = engine === "gpu" && !IS_SLOW ? SETS.slice(0, 2) : SETS;
    for (const set of sets) {
      const told = await load(page, link(set));
      assert.equal(told.parameters.radius, set.radius);
      assert.equal(told.verified, true);
      assert.match(told.engine, engine === "gpu" ? /^GPU.*webgpu/ : /^CPU/);
      assert.ok(told.events > 0, "the run has its events");
      assert.equal(told.positions_digest, await nativeDigest(set, made), link(set));
      seen.add(told.positions_digest);
    }
    // If all digests were equal, the comparison would prove nothing.
    assert.equal(seen.size, sets.length);
    await shows(page, SMALL.clip);
  });
}

test("a GPU with long buffers computes each run in one window", async (t) => {
  const page = await sampling(t, "gpu");
  const shares = await page.evaluate(() => window.shares);
  assert.ok(shares.length >= 4 && shares.every((share) => share > 0.99), `${shares}`);
});

/** Opens the page with a recorded GPU. Returns the verdict of its self-test and the windows that it computed. */
async function tested(t, given) {
  const { page } = await opened(t, "?embed=canvas&engine=gpu&display=webgl#v=1&radius=0.03", {
    ...SMALL,
    prepare: (context) => context.addInitScript(watchDevices, given),
  });
  const told = await state(page, (told) => !["unknown", "testing"].includes(told.gpu));
  return { ...told, shares: await page.evaluate(() => window.shares) };
}

/** Joins the windows of whole runs; that the page compares them is tested below, in every run. */
const joined = async (t) => {
  const { gpu, chosen, shares } = await tested(t, { longest: SHORT });
  assert.equal(gpu, "ready", chosen);
  const parts = shares.filter((share) => share < 0.5);
  assert.ok(parts.length >= 2 * 4, `two runs of windows are expected among ${shares}`);
};
slowTest("windows that the GPU of the page joins give the points of the CPU", joined);

test("one point of the GPU that is moved by one unit is found by the page", async (t) => {
  const { gpu, chosen } = await tested(t, { longest: SHORT, spoils: true });
  assert.equal(gpu, "refused");
  const place = "\\((-?\\d+), (-?\\d+)\\)";
  const [, ...found] = chosen.match(new RegExp(`self-test failed.*is ${place} on the device and ${place} on the CPU`));
  const [gpuX, gpuY, cpuX, cpuY] = found.map(Number);
  assert.deepEqual([gpuX - cpuX, gpuY - cpuY], [1, 0]);
});

// This must be the last test of its page, since it destroys the device.
test("after the loss of a computing device the CPU makes the run, and a notice says so", async (t) => {
  const page = await sampling(t, "gpu");
  const by = await load(page, "v=1&radius=0.03&seed=9");
  assert.match(by.engine, /^GPU/);
  assert.equal(by.seed, 9);
  await page.evaluate(() => window.devices.forEach((device) => device.destroy()));
  await ask(page, { do: "load", parameters: { seed: 10, radius: 0.02 } });
  const after = await state(page, (told) => told.ready && told.seed === 10 && told.verified !== null);
  assert.match(after.engine, /^CPU/);
  assert.equal(after.verified, true);
  assert.match(after.notice, /CPU engine made this session instead/);
  await shows(page, SMALL.clip);
});
