// Makes one set by a sampler of JavaScript: samplers.mjs NAME RADIUS SEED FILE. Writes positions in the unit square or the unit cube, and prints
// the seconds of the processor that the set took. A first, small set is not counted: it loads and compiles.
// The folder with node_modules is the current one.

import { writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

const require = createRequire(path.join(process.cwd(), "here.js"));

/** Returns numbers from 0 to 1 by a seed (a linear congruential generator with the constants of Numerical Recipes). */
function generator(seed) {
  let state = seed >>> 0;
  return () => (state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 2 ** 32;
}

const SAMPLERS = {
  "poisson-disk-sampling": (radius, seed) => {
    const Sampling = require("poisson-disk-sampling");
    return new Sampling({ shape: [1, 1], minDistance: radius }, generator(seed)).fill();
  },
  "poisson-disk-sampling, space": (radius, seed) => {
    const Sampling = require("poisson-disk-sampling");
    return new Sampling({ shape: [1, 1, 1], minDistance: radius }, generator(seed)).fill();
  },
  "fast-2d-poisson-disk-sampling": (radius, seed) => {
    const Sampling = require("fast-2d-poisson-disk-sampling");
    return new Sampling({ shape: [1, 1], radius }, generator(seed)).fill();
  },
  // It takes no generator, and no seed.
  "poisson-disc-sampler": (radius) => {
    const next = require("poisson-disc-sampler")(1, 1, radius);
    const points = [];
    for (let point = next(); point; point = next()) {
      points.push(point);
    }
    return points;
  },
};

const [name, radius, seed, file] = process.argv.slice(2);
const make = SAMPLERS[name];
make(Math.min(10 * Number(radius), 0.3), 0);
const began = process.cpuUsage();
const points = make(Number(radius), Number(seed));
const { user, system } = process.cpuUsage(began);
const head = ["x", "y", "z"].slice(0, points[0].length).join(",");
writeFileSync(file, `${head}\n${points.map((point) => `${point.join(",")}\n`).join("")}`);
console.log((user + system) / 1e6);
