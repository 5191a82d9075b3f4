// Makes the README's pictures of the page: node web/tests/pictures.mjs FOLDER.

import path from "node:path";
import { argv, exit } from "node:process";
import { PATIENCE_MS, ask, launch, ready, serve, watch } from "./harness.mjs";

const into = argv[2];
if (!into) {
  console.error("usage: node web/tests/pictures.mjs FOLDER");
  exit(2);
}

const PHONE = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true };

/** The pictures: address, size, and the steps before each. */
const PICTURES = {
  "web-phone": [PHONE, "/?engine=cpu#v=1&seed=3&radius=0.02&leaf=12", async (page) => {
    await ready(page, { x: 20, y: 120, width: 350, height: 250 });
    await ask(page, { do: "seek", stage: "iterate-1" });
  }],
  "web-lecture": [{ viewport: { width: 1000, height: 880 } }, "/example/lecture.html", async (page) => {
    await page.frameLocator("iframe").locator("#loading[hidden]").waitFor({ state: "attached", timeout: PATIENCE_MS });
    const before = await page.textContent("#sentence");
    await page.click("#load");
    await page.waitForFunction((old) => document.getElementById("sentence").textContent !== old, before, { timeout: PATIENCE_MS });
    await page.click("#eliminate");
  }],
};

const server = await serve();
const browser = await launch();
for (const [name, [settings, query, prepare]] of Object.entries(PICTURES)) {
  const context = await browser.newContext({ ...settings, reducedMotion: "reduce" });
  context.setDefaultTimeout(PATIENCE_MS);
  const wrong = watch(context, [server.address]);
  const page = await context.newPage();
  await page.goto(server.address + query);
  await prepare(page);
  // Wait for the frame that shows the prepared state.
  await page.waitForTimeout(3_000);
  await page.screenshot({ path: path.join(into, `${name}.png`) });
  console.log(`${name}.png`, ...wrong);
  await context.close();
}
await browser.close();
await server.stop();
