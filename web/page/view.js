// @ts-check Detects whether a frame is in view. Browsers keep only some displays at a time (Chrome sixteen of WebGL),
// so on a page with many frames those out of view have no display.

/** How long a frame must have no size, while nothing is observed, to count as hidden completely, as on a later slide. */
const HIDDEN_MS = 500;
/** Longest wait for an observation. */
const SILENT_MS = 10_000;

let isSeen = true;
/** @type {(() => void)[]} */
let waiting = [];
/** @type {Promise<void> | undefined} */
let told;

/** Observes the frame from now on. @returns {Promise<void>} */
function look() {
  return new Promise((resolve) => {
    const observer = new IntersectionObserver((entries) => {
      const { isIntersecting, boundingClientRect: place } = entries[entries.length - 1];
      // An element without a size cannot be scrolled into view.
      isSeen = isIntersecting || place.width * place.height === 0;
      if (isSeen) {
        goOn();
      }
      resolve();
    });
    observer.observe(document.documentElement);
  });
}

/** Starts a frame that is out of view, because a request arrived. */
export function goOn() {
  for (const resolve of waiting) {
    resolve();
  }
  waiting = [];
}

/** Returns whether the frame was in view when last observed. */
export function inView() {
  return isSeen;
}

/** Waits until the frame is in view or a request arrives. A frame that is hidden completely counts as in view. */
export async function comesIntoView() {
  /** @type {Promise<boolean>} */
  const asked = new Promise((resolve) => waiting.push(() => resolve(true)));

  told ??= look();
  const observed = told.then(() => true);
  /** @param {number} ms */
  const settledIn = (ms) => Promise.race([asked, observed, new Promise((resolve) => setTimeout(resolve, ms))]);

  // Nothing is observed in a tab in the background.
  if (!(await settledIn(HIDDEN_MS)) && innerWidth * innerHeight > 0 && !document.hidden) {
    // On a busy machine the first observation may come late.
    await settledIn(SILENT_MS);
  }

  if (!isSeen) {
    await asked;
  }
}
