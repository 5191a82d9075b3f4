// Measures pages as Lighthouse's phone sees them: node web/tests/lighthouse.mjs [PATH ...]. Of five visits each it prints the
// medians: largest contentful paint, total blocking time and the scores of the categories. It is no test: what it measures
// depends on the machine. Lighthouse has two hundred packages, which no test needs, and is installed apart:
//
//   cd web/tests && npm install --no-save --ignore-scripts lighthouse@12

import { once } from "node:events";
import { createServer } from "node:net";
import { launch, serve } from "./harness.mjs";

/** How often each page is visited. */
const VISITS = 5;
/** The pages: the first one, a lesson's, and the program's. */
const PATHS = ["", "lesson/survivors/", "?play"];
const CATEGORIES = ["performance", "accessibility", "best-practices", "seo"];

const lighthouse = await import("lighthouse").then(
  ({ default: measure }) => measure,
  () => {
    console.error("lighthouse.mjs: Lighthouse is missing; run: cd web/tests && npm install --no-save --ignore-scripts lighthouse@12");
    process.exit(1);
  },
);

/** @param {number[]} numbers */
const median = (numbers) => numbers.sort((a, b) => a - b)[Math.floor(numbers.length / 2)];

/** Returns a port that nothing listens at. */
async function freePort() {
  const probe = createServer().listen(0, "127.0.0.1");
  await once(probe, "listening");
  const { port } = probe.address();
  probe.close();
  await once(probe, "close");
  return port;
}

const server = await serve();
const port = await freePort();
const browser = await launch([`--remote-debugging-port=${port}`]);
try {
  console.log(["page", "LCP, s", "TBT, ms", ...CATEGORIES].join("\t"));
  const asked = process.argv.slice(2);
  for (const path of asked.length > 0 ? asked : PATHS) {
    const visits = [];
    for (let visit = 0; visit < VISITS; visit++) {
      // Its own defaults: a phone of 412 by 823 px whose processor is four times as slow, at 1.6 Mbit/s with 150 ms.
      const { lhr } = await lighthouse(`${server.address}/${path}`, { port, onlyCategories: CATEGORIES, logLevel: "error" });
      visits.push(lhr);
    }
    const medianOf = (value) => median(visits.map(value));
    const paint_s = medianOf(({ audits }) => audits["largest-contentful-paint"].numericValue ?? NaN) / 1000;
    const blocked_ms = medianOf(({ audits }) => audits["total-blocking-time"].numericValue ?? NaN);
    const scores = CATEGORIES.map((name) => medianOf(({ categories }) => Math.round(100 * (categories[name].score ?? NaN))));
    console.log([`/${path}`, paint_s.toFixed(2), blocked_ms.toFixed(0), ...scores].join("\t"));

    // What takes points from a score that should be whole.
    for (const name of ["accessibility", "seo", "best-practices"]) {
      const { categories, audits } = visits[0];
      const lacking = categories[name].auditRefs.map(({ id }) => audits[id]).filter(({ score }) => score !== null && score < 1);
      lacking.forEach(({ id, title }) => console.log(`  ${name}: ${id}: ${title}`));
    }
  }
} finally {
  await browser.close();
  await server.stop();
}
