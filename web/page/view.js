// @ts-check Detects whether a frame is in view. Browsers keep only some displays at a time (Chrome sixteen of WebGL),
// so on a page with many frames those out of view have no display.

/** If the browser reports nothing for so long, the frame is hidden completely, as on a later slide. */
const SILENT_MS = 500;

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

/** Waits until the frame is in view or a request arrives. */
export async function comesIntoView() {
  told ??= look();
  await Promise.race([told, new Promise((resolve) => setTimeout(resolve, SILENT_MS))]);
  if (!isSeen) {
    await new Promise((resolve) => waiting.push(() => resolve(undefined)));
  }
}
