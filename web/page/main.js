// @ts-check
// Starts the program on the canvas and keeps the address, the frame around the page and the screen reader in the
// picture. What is shown is the program's; what it needs from the browser is looked for in `missing.js`.

import { bridge, namedOrigin } from "./{{asset:embed.js}}";
import { load } from "./{{asset:load.js}}";
import { missing, showMissing } from "./{{asset:missing.js}}";
import { keepOffline } from "./{{asset:offline.js}}";
import { comesIntoView, goOn, inView } from "./{{asset:view.js}}";
import { announce, element, failure, hasFailed, loaded, loading, progress } from "./{{asset:sheets.js}}";

const WORKER = new URL("./{{asset:worker.js}}", import.meta.url).href;
const BINDINGS = new URL("./{{asset:tilescope.js}}", import.meta.url).href;

/** A display that is lost so soon after it was replaced would be lost again. */
const SOON_MS = 10_000;

/** What the address asks for. */
const asked = new URLSearchParams(location.search);
const embed = oneOf(asked.get("embed"), ["canvas", "player"]);

/** The address changes at most once in so long: some browsers allow but a hundred changes in half a minute. */
const LINK_MS = 400;

/** What takes in text is called so while no field does. */
const FIELD = "Text for Tilescope";

/** Whether the system wishes that nothing moves by itself. */
const still = matchMedia("(prefers-reduced-motion: reduce)");

/** @type {any} The running program. */
let app = null;
/** @type {string | null} The link that the address is to hold. */
let nextLink = null;
/** @type {ReturnType<typeof setTimeout> | undefined} */
let linkTimer;
/** Whether the next Tab leaves the program. */
let leaves = false;
/** Whether the touch at hand began where one finger scrolls the page around. */
let scrolls = false;
/** @type {WebAssembly.Module | undefined} */
let module;
/** When a lost display was replaced last. */
let restarted_ms = -Infinity;
/** Why the program does not run, if it has failed. */
let failed = "";

const frame = embed ? bridge(namedOrigin(asked.get("origin")), ask) : null;

/** @param {string | null} value @param {string[]} known @returns {string | null} */
function oneOf(value, known) {
  return value !== null && known.includes(value) ? value : null;
}

/** Returns the field beside the canvas that the program has made to take in text. */
function textField() {
  return document.querySelector("main > input");
}

/** Returns the fragment of the address, without its mark. */
function fragment() {
  return location.hash.slice(1);
}

/** Answers a request of the embedding interface, both as JSON. @param {string} request @returns {string} */
function ask(request) {
  if (failed) {
    return JSON.stringify({ ok: false, error: failed });
  }
  if (!app) {
    goOn();
    const isReplaced = restarted_ms > -Infinity;
    const error = isReplaced
      ? "The display was lost and is being replaced; ask again in a moment."
      : 'The program is still loading; wait for the event "ready".';
    return JSON.stringify({ ok: false, error });
  }
  return app.ask(request);
}

/** Has the address hold a link, without a step of history. @param {string} link */
function keepLink(link) {
  nextLink = link;
  if (linkTimer === undefined) {
    writeLink();
  }
}

function writeLink() {
  linkTimer = undefined;
  if (nextLink === null) {
    return;
  }
  let wait = LINK_MS;
  try {
    history.replaceState(history.state, "", nextLink ? `#${nextLink}` : location.pathname + location.search);
    nextLink = null;
  } catch {
    // There were too many changes in too short a time.
    wait = 10 * LINK_MS;
  }
  linkTimer = setTimeout(writeLink, wait);
}

/**
 * The program's own keys are not the browser's. Escape and then Tab lead out of it; out of a frame Tab leads by itself,
 * behind the last control.
 * @param {KeyboardEvent} event
 */
function takeKey(event) {
  const isTab = event.key === "Tab" && !(event.ctrlKey || event.metaKey || event.altKey);
  if (isTab && (leaves || (embed && app?.leaves_by_tab(event.shiftKey)))) {
    leaves = false;
    event.stopImmediatePropagation();
    return;
  }
  leaves = event.key === "Escape" || (leaves && event.key === "Shift");
  if (app?.takes_key(event.key, event.ctrlKey || event.metaKey, event.shiftKey, event.altKey)) {
    event.preventDefault();
  }
}

/**
 * In a frame one finger on the run is left to the page around, which scrolls; two are the program's.
 * @param {TouchEvent} event
 */
function shareTouch({ type, touches, cancelable }) {
  if (type === "touchstart" && touches.length === 1) {
    scrolls = app?.scrolls_at(touches[0].clientX, touches[0].clientY) ?? true;
  }
  // A scroll that is under way takes the rest of the touch; the end of a tap is kept from becoming that of a mouse, too.
  app?.yield_touch(!cancelable || (scrolls && touches.length === 1 && type !== "touchend"));
}

/**
 * Has Tab lead into the first control of a frame, and backwards into the last one, as in any other page. While the focus is
 * within, nothing else of the page takes it.
 */
function joinTabs() {
  const main = element("canvas").parentElement;
  const ends = [false, true].map((isLast) => {
    const end = document.createElement("span");
    end.className = "unseen";
    end.tabIndex = 0;
    end.addEventListener("focus", () => {
      element("canvas").focus();
      app?.enter_by_tab(isLast);
    });
    return end;
  });
  main?.prepend(ends[0]);
  main?.append(ends[1]);
  const reach = (/** @type {number} */ tabIndex) => () => ends.forEach((end) => (end.tabIndex = tabIndex));
  main?.addEventListener("focusin", reach(-1));
  main?.addEventListener("focusout", reach(0));
}

/** Puts a text on the clipboard, or has the program say that it could not. @param {string} text */
async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // Pages that do not come by https or from this machine have no clipboard but the old one.
    if (!copyAsOfOld(text)) {
      app?.copy_failed();
    }
  }
}

/** Copies what is selected in a field made for it. @param {string} text @returns {boolean} Whether the browser did. */
function copyAsOfOld(text) {
  const field = document.createElement("textarea");
  field.className = "unseen";
  field.value = text;
  document.body.append(field);
  field.select();
  const isCopied = document.execCommand("copy");
  field.remove();
  element("canvas").focus();
  return isCopied;
}

/** Shows the page on the full screen, or no longer. */
async function turnFullScreen() {
  try {
    await (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen());
  } catch (error) {
    console.warn("Tilescope cannot have the full screen:", error);
  }
}

/** What the program tells the page. */
const hooks = {
  announce,
  // What takes in text is one element for all fields, so its name is that of the field.
  /** @param {string} name */
  field: (name) => textField()?.setAttribute("aria-label", name || FIELD),
  // Like what is lost: a moment later, when the program no longer holds its own state.
  /** @param {string} text */
  copy: (text) => setTimeout(() => copy(text)),
  full_screen: turnFullScreen,
  link: keepLink,
  /** @param {string} json */
  state: (json) => (frame ? frame.state(json) : entitle(JSON.parse(json))),
  // The program calls this while it holds its own state, so it is ended a moment later.
  /** @param {string} reason */
  lost: (reason) => setTimeout(() => restart(reason)),
  // For whoever measures how long it takes.
  drawn: () => performance.mark("tilescope: first frame"),
  failed: fail,
};

/** Tells tabs and bookmarks apart. @param {any} told */
function entitle({ parameters: { seed, radius } }) {
  document.title = `Seed ${seed}, r ${radius} \u2013 Tilescope`;
}

/** Shows and tells why the program does not run. @param {string} reason */
function fail(reason) {
  failed ||= reason;
  failure(reason);
  frame?.failed(failed);
}

/** Has the focus stay where it is: in a frame the program would take it from whoever reads beside. @param {boolean} stays */
function keepFocus(stays) {
  const fields = HTMLInputElement.prototype;
  if (stays) {
    fields.focus = () => {};
  } else {
    Reflect.deleteProperty(fields, "focus");
  }
}

/** Starts the program. @param {string} display @param {string} reason */
async function begin(display, reason) {
  const link = fragment();
  const options = {
    link,
    embed,
    display,
    engine: asked.get("engine") ?? "auto",
    reason,
    reduced_motion: still.matches,
    full_screen: document.fullscreenEnabled === true,
    worker: WORKER,
    bindings: BINDINGS,
  };
  const canvas = element("canvas");
  // WebGPU tells the program that it is lost, WebGL the canvas.
  canvas.addEventListener("webglcontextlost", () => canvas.isConnected && restart("WebGL's context was lost."), { once: true });
  const { start } = await import("./{{asset:tilescope.js}}");
  // A ring around all of it is for those who come by keyboard, not for when it has the focus back from a field of text.
  canvas.focus = (how) => HTMLElement.prototype.focus.call(canvas, /** @type {any} */ ({ ...how, focusVisible: false }));
  keepFocus(embed !== null);
  try {
    app = await start(canvas, JSON.stringify(options), { ...hooks, module });
  } finally {
    keepFocus(false);
  }
  // A link that was followed meanwhile.
  if (fragment() !== link) {
    app.open_link(fragment());
  }
  // For whoever looks from the browser's console.
  /** @type {any} */ (window).tilescope = app;
  // What takes in text is beside the canvas; Tab does not stop there.
  const field = textField();
  if (field) {
    field.tabIndex = -1;
    field.setAttribute("aria-label", FIELD);
  }
  loaded();
  if (!embed) {
    // Keys are the program's from the start.
    canvas.focus();
  }
  frame?.ready();
}

/** Goes on after the display's device was lost, with the other kind of display. @param {string} reason */
async function restart(reason) {
  const ended = app;
  app = null;
  if (hasFailed()) {
    return;
  }
  // Out of view it was taken for others, as may be expected; in view it would be taken again at once.
  const isExpected = embed !== null && !inView();
  if (!ended || (!isExpected && performance.now() < restarted_ms + SOON_MS)) {
    fail(`The display was lost and could not be replaced: ${reason}`);
    return;
  }
  restarted_ms = performance.now();
  writeLink();
  try {
    const lacking = ended.left_out();
    const again = lacking ? ` What the address cannot hold has to be opened again: ${lacking}.` : "";
    renewCanvas();
    ended.destroy();
    if (isExpected) {
      await comesIntoView();
      restarted_ms = performance.now();
    } else {
      announce("The display was lost; starting again.");
    }
    await begin("webgl", isExpected && !lacking ? "" : `The display's device was lost: ${reason}${again}`);
  } catch (error) {
    fail(`The display was lost, and the program did not start again: ${told(error)}`);
  }
}

/** A canvas keeps the kind of display that it had first. */
function renewCanvas() {
  const canvas = element("canvas");
  canvas.replaceWith(canvas.cloneNode(false));
}

/** @param {unknown} error @returns {string} */
function told(error) {
  const text = error instanceof Error ? error.message : String(error);
  // Errors of the browser that the program has passed on.
  return text.replace(/JsValue\(\w+: ([^\n)]*)[^)]*\)/, "$1");
}

/** A program that has trapped cannot go on, wherever that was noticed. @param {unknown} error */
function noticeTrap(error) {
  if (typeof WebAssembly === "object" && error instanceof WebAssembly.RuntimeError) {
    fail(`The program broke: ${error.message}`);
  }
}

/**
 * Has the canvas sized by the screen's density where the browser tells another size, as for screens that its developer
 * tools pretend to have.
 */
async function mendSizes() {
  const seen = new Promise((resolve) => {
    const observer = new ResizeObserver(([entry]) => {
      observer.disconnect();
      const told = entry.devicePixelContentBoxSize?.[0].inlineSize;
      if (told !== undefined && Math.abs(told - entry.contentBoxSize[0].inlineSize * devicePixelRatio) > 2) {
        delete (/** @type {any} */ (ResizeObserverEntry.prototype).devicePixelContentBoxSize);
      }
      resolve(undefined);
    });
    observer.observe(element("canvas"));
  });
  // A frame that is hidden, as on the slide after the next, has no sizes yet.
  await Promise.race([seen, new Promise((resolve) => setTimeout(resolve, 500))]);
}

/** Starts the program; by WebGL where whatever is best does not start. @param {string} display */
async function beginAnyhow(display) {
  try {
    await begin(display, "");
  } catch (error) {
    if (display !== "auto") {
      throw error;
    }
    renewCanvas();
    await begin("webgl", `WebGPU did not start, so that WebGL 2 draws: ${told(error)}.`);
  }
}

async function main() {
  document.documentElement.setAttribute("data-runs", "");
  if (embed) {
    await comesIntoView();
  }
  const lacks = await missing();
  if (lacks.length > 0) {
    showMissing(lacks);
    failed = `This browser cannot run Tilescope. ${lacks.join(" ")}`;
    frame?.failed(failed);
    return;
  }
  try {
    module = await load(progress);
    loading("Starting");
    await mendSizes();
    const { default: init } = await import("./{{asset:tilescope.js}}");
    await init({ module_or_path: module });
    await beginAnyhow(oneOf(asked.get("display"), ["webgpu", "webgl"]) ?? "auto");
  } catch (error) {
    fail(`Tilescope could not start: ${told(error)}`);
    return;
  }
  // Not before the start: it would share the network with what is waited for. A frame keeps nothing.
  if (!embed) {
    keepOffline();
  }
}

window.addEventListener("keydown", takeKey, { capture: true });
if (embed) {
  document.documentElement.setAttribute("data-embed", embed);
  element("canvas").setAttribute("aria-label", "Tilescope: a run of maximal Poisson-disk sampling. Tab leads through it.");
  joinTabs();
  for (const type of /** @type {const} */ (["touchstart", "touchmove", "touchend"])) {
    window.addEventListener(type, shareTouch, { capture: true, passive: true });
  }
}
window.addEventListener("hashchange", () => {
  nextLink = null;
  app?.open_link(fragment());
});
still.addEventListener("change", () => app?.prefer_reduced_motion(still.matches));
// The canvas takes what is dropped on it. Beside it the browser would show the file in place of the page.
for (const type of ["dragover", "drop"]) {
  window.addEventListener(type, (event) => event.preventDefault());
}
window.addEventListener("error", (event) => noticeTrap(event.error));
window.addEventListener("unhandledrejection", (event) => noticeTrap(event.reason));
main();
