// The controls of the canvas as a screen reader finds them, and the checks of axe-core.

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

/** The checks of axe-core, to be run on a page. */
const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

/** The region with the elements. @param {import("playwright-core").Page} page */
export const controls = (page) => page.getByRole("region", { name: "Controls of Tilescope" });

/** The names of the elements that can be used and have none, by their tags. @param {import("playwright-core").Page} page */
export async function nameless(page) {
  const client = await page.context().newCDPSession(page);
  const { nodes } = await client.send("Accessibility.getFullAXTree");
  await client.detach();
  const used = ["button", "checkbox", "radio", "slider", "spinbutton", "textbox", "combobox", "ComboBoxSelect", "link", "menuitem", "menuitemcheckbox", "listbox", "option", "image", "dialog"];
  const without = nodes.filter(({ ignored, role, name }) => !ignored && used.includes(role?.value) && !String(name?.value ?? "").trim());
  return without.map(({ role }) => role.value);
}

/** What axe-core finds on a page, each with its first place. @param {import("playwright-core").Page} page */
export async function findings(page) {
  if (!(await page.evaluate(() => "axe" in window))) {
    await page.evaluate(AXE);
  }
  const violations = await page.evaluate(async () => {
    // In forced colours axe-core 4.14 still takes the page's own colour of texts: of a heading that is painted black on white it
    // found #e6e9ee on white. All colours are the system's then.
    const isForced = matchMedia("(forced-colors: active)").matches;
    const rules = isForced ? { "color-contrast": { enabled: false } } : {};
    return (await window.axe.run(document, { rules })).violations;
  });
  return violations.map(({ id, nodes }) => `${id}: ${nodes[0].html}`);
}
