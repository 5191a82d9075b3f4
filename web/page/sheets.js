// @ts-check
// The page's overlays: loading, failure, the notice of a new version. Also the announcements to screen readers.

/** @param {string} id @returns {HTMLElement} */
export function element(id) {
  const found = document.getElementById(id);
  if (!found) {
    throw new Error(`the page has no element "${id}"`);
  }
  return found;
}

/** Shows what is being loaded. @param {string} text */
export function loading(text) {
  element("loading-text").textContent = text;
  element("loading-size").textContent = "\u00a0";
  // A bar without a value shows that the duration is unknown.
  element("loading-bar").removeAttribute("value");
  element("loading").hidden = false;
}

/** Shows how much has arrived. @param {number} bytes @param {number} total */
export function progress(bytes, total) {
  const share = Math.min(bytes / total, 1);
  element("loading-bar").setAttribute("value", String(share));
  // No sizes are shown, since these are of uncompressed bytes, and fewer are downloaded.
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
  // The fragment, which holds the view, stays in the address.
  element("failure-reload").onclick = () => location.reload();
  sheet.hidden = false;
  // The stopped program must not be reachable by keyboard either.
  element("canvas").inert = true;
  element("tree").hidden = true;
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
  // Not by the announcer, whose text the program would soon replace.
  element("notice-said").textContent = element("notice-text").textContent;
}

/** The sentences to be announced. @type {string[]} */
let said = [];

/** Announces a sentence to screen readers; several of one moment are joined. @param {string} text */
export function announce(text) {
  said.push(text);
  if (said.length === 1) {
    queueMicrotask(() => {
      // What two sources say at one moment is said once.
      const [announcer, text] = [element("announcer"), [...new Set(said)].filter(Boolean).join(" ")];
      // A repeated sentence is announced only if the text differs.
      announcer.textContent = text && announcer.textContent === text ? `${text}\u00a0` : text;
      said = [];
    });
  }
}

/** Announces a sentence unless it was part of the last announcement. @param {string} text */
export function announceNew(text) {
  if (![...said, element("announcer").textContent].some((sentence) => sentence?.includes(text))) {
    announce(text);
  }
}
