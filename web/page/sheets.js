// @ts-check
// What the page shows over the canvas: loading, failure, the notice of a new version; and what it reads aloud.

/** @param {string} id @returns {HTMLElement} */
export function element(id) {
  const found = document.getElementById(id);
  if (!found) {
    throw new Error(`the page has no element "${id}"`);
  }
  return found;
}

/** Says what is being waited for. @param {string} text */
export function loading(text) {
  element("loading-text").textContent = text;
  element("loading-size").textContent = "\u00a0";
  // Without a value the bar shows that there is no telling how long.
  element("loading-bar").removeAttribute("value");
  element("loading").hidden = false;
}

/** Shows how much has come. @param {number} bytes @param {number} total */
export function progress(bytes, total) {
  const share = Math.min(bytes / total, 1);
  element("loading-bar").setAttribute("value", String(share));
  // No sizes: less travels than is counted here, where it is unpacked.
  element("loading-size").textContent = `${Math.floor(100 * share)}%`;
}

export function loaded() {
  element("loading").hidden = true;
}

/** Shows why the program has stopped; the first reason stays, as others follow from it. @param {string} reason */
export function failure(reason) {
  loaded();
  const sheet = element("failure");
  if (!sheet.hidden) {
    return;
  }
  element("failure-text").textContent = reason;
  // The fragment, which says what was shown, stays in the address.
  element("failure-reload").onclick = () => location.reload();
  sheet.hidden = false;
  // What has stopped is not to be reached by keys either.
  element("canvas").inert = true;
  element("failure-reload").focus();
}

/** @returns {boolean} */
export function hasFailed() {
  return !element("failure").hidden;
}

/** Offers a new version. @param {() => void} accept */
export function offer(accept) {
  const notice = element("notice");
  element("notice-reload").onclick = accept;
  element("notice-dismiss").onclick = () => {
    notice.hidden = true;
    element("canvas").focus();
  };
  notice.hidden = false;
  // Not by the announcer: the program would soon speak in its place.
  element("notice-said").textContent = element("notice-text").textContent;
}

/** What is to be read out. @type {string[]} */
let said = [];

/** Has a sentence read out by screen readers; several of one moment together. @param {string} text */
export function announce(text) {
  said.push(text);
  if (said.length === 1) {
    queueMicrotask(() => {
      const [announcer, text] = [element("announcer"), said.filter(Boolean).join(" ")];
      // The same again is read out only if it differs.
      announcer.textContent = text && announcer.textContent === text ? `${text}\u00a0` : text;
      said = [];
    });
  }
}
