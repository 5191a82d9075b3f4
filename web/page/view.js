// @ts-check
// Whether a frame is in view. Browsers keep only some displays at a time (Chrome sixteen of WebGL), so on a page with many
// frames those out of view leave theirs to the others.

/** A frame whose browser says nothing in so long is hidden altogether, as on the slide after the next. */
const SILENT_MS = 500;

let isSeen = true;
/** @type {(() => void)[]} */
let waiting = [];
/** @type {Promise<void> | undefined} */
let told;

/** Looks from now on. @returns {Promise<void>} */
function look() {
  return new Promise((resolve) => {
    const observer = new IntersectionObserver((entries) => {
      const { isIntersecting, boundingClientRect: place } = entries[entries.length - 1];
      // What has no size cannot come into view by scrolling.
      isSeen = isIntersecting || place.width * place.height === 0;
      if (isSeen) {
        goOn();
      }
      resolve();
    });
    observer.observe(document.documentElement);
  });
}

/** Ends the wait of a frame that is out of view: it was asked for something. */
export function goOn() {
  for (const resolve of waiting) {
    resolve();
  }
  waiting = [];
}

/** Returns whether the frame is in view, as far as is known. */
export function inView() {
  return isSeen;
}

/** Waits until the frame is in view or is asked for something. */
export async function comesIntoView() {
  told ??= look();
  await Promise.race([told, new Promise((resolve) => setTimeout(resolve, SILENT_MS))]);
  if (!isSeen) {
    await new Promise((resolve) => waiting.push(() => resolve(undefined)));
  }
}
