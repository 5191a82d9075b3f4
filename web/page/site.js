// @ts-check
// Snippets of a lesson's page: they get this site's own address, and a button that copies them.

/** The address that snippets have where the site's own was not known when the page was made. */
const SOME_ADDRESS = "https://example.org/tilescope/";

const site = new URL("./", import.meta.url);

for (const origin of document.querySelectorAll("[data-origin]")) {
  origin.textContent = site.origin;
}

for (const code of document.querySelectorAll("[data-snippet]")) {
  code.textContent = (code.textContent ?? "").replace(SOME_ADDRESS, site.href);
  // Without https browsers have no clipboard for pages.
  if (navigator.clipboard) {
    code.parentElement?.after(copyButton(code));
  }
}

/** Returns a button that copies the text of an element. @param {Element} code */
function copyButton(code) {
  const isGerman = document.documentElement.lang === "de";
  const [copy, copied] = isGerman ? ["Kopieren", "Kopiert"] : ["Copy", "Copied"];
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = copy;
  // The new name of the button is read out.
  button.setAttribute("aria-live", "polite");
  button.addEventListener("click", async () => {
    await navigator.clipboard.writeText(code.textContent ?? "");
    button.textContent = copied;
  });
  return button;
}
