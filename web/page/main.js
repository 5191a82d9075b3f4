// @ts-check
// Starts the program on the canvas, and connects it to the address, the page around a frame, and screen readers. The
// program's requirements are checked in `missing.js`.

import { bridge, namedOrigin } from "./{{asset:embed.js}}";
import { connectLesson, restoreDraft, showLesson, wishedHeight } from "./{{asset:lesson.js}}";
import { fetchLater, fetchLaterNow, join, joinSoon, NOT_THERE } from "./{{asset:later.js}}";
import { load } from "./{{asset:load.js}}";
import { missing, showMissing } from "./{{asset:missing.js}}";
import { keepOffline } from "./{{asset:offline.js}}";
import { comesIntoView, goOn, inView } from "./{{asset:view.js}}";
import { announce, element, failure, hasFailed, loaded, loading, progress } from "./{{asset:sheets.js}}";
import { mirror } from "./{{asset:tree.js}}";

const WORKER = new URL("./{{asset:worker.js}}", import.meta.url).href;
const LESSONS = new URL("./{{asset:lessons.json}}", import.meta.url).href;
const BINDINGS = new URL("./{{asset:tilescope.js}}", import.meta.url).href;

/** A display lost this soon after it was replaced is not replaced again. */
const SOON_MS = 10_000;

/** The parameters of the address. */
const asked = new URLSearchParams(location.search);
const embed = oneOf(asked.get("embed"), ["canvas", "player"]);

/** The longest that a browser usually takes to report the size of the canvas. */
const SIZED_MS = 1_000;

/** The rest of the program is asked for again after so long, if it did not come. */
const AGAIN_MS = 10_000;

/** The address changes at most once in so long, because some browsers allow only a hundred changes in half a minute. */
const LINK_MS = 400;

/** The label of the text input element while no field has the focus. */
const FIELD = "Text for Tilescope";

/** The system's preference for reduced motion. */
const still = matchMedia("(prefers-reduced-motion: reduce)");

/** Whether the page is the voting card or the notes of a talk, without the program. */
let isOther = false;
/** @type {any} The running program. */
let app = null;
/** @type {string | null} The link that will be written to the address. */
let nextLink = null;
/** @type {ReturnType<typeof setTimeout> | undefined} */
let linkTimer;
/** Whether the program has begun to draw. */
let draws = false;
/** Whether the next Tab leaves the program. */
let leaves = false;
/** Whether the current touch began where one finger scrolls the page around. */
let scrolls = false;
/** @type {WebAssembly.Module | undefined} */
let module;
/** The program's exports. @type {any} */
let exported;
/** The compiled later part of the program. @type {WebAssembly.Module | undefined} */
let later;
/** When a lost display was replaced last. */
let restarted_ms = -Infinity;
/** Why the program failed, if it did. */
let failed = "";

/** Whether the page shows the texts of lessons; in a frame the page around may bring its own. */
const hasText = asked.get("text") !== "none";

/** Sends what was answered to the record store that the address names, if it names one. @type {(() => void) | undefined} */
let follow;
/** The number of the last answer that was followed. @type {number | undefined} */
let lastAnswer;

/** The controls of the canvas as elements. */
const tree = mirror(element("tree"), () => app);
// Otherwise Shift and Tab would lead from the elements to the canvas, and on through the program.
element("tree").addEventListener("focusin", () => (element("canvas").tabIndex = -1));
element("tree").addEventListener("focusout", () => (element("canvas").tabIndex = 0));

const frame = embed ? bridge(namedOrigin(asked.get("origin")), ask) : null;

/** @param {string | null} value @param {string[]} known @returns {string | null} */
function oneOf(value, known) {
  return value !== null && known.includes(value) ? value : null;
}

/** Prepares to send answers to the record store that the address names. A frame reports to the page around instead. */
async function connectStore() {
  if (embed || !asked.has("endpoint") || follow) {
    return;
  }
  const { makeReporter, namedStore } = await import("./{{asset:report.js}}");
  try {
    const store = namedStore(asked);
    follow = store ? makeReporter(store, () => JSON.parse(app?.statements() ?? "[]")) : undefined;
  } catch (error) {
    console.warn(`Tilescope: ${told(error)}`);
    announce(told(error));
  }
}

/** Returns the text input element that the program has put beside the canvas. */
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

/** Writes a link to the address, without a history entry. @param {string} link */
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
    // The browser refused, since there were too many changes.
    wait = 10 * LINK_MS;
  }

  linkTimer = setTimeout(writeLink, wait);
}

/**
 * Prevents the browser from handling the program's keys. Escape and then Tab leave the program; in a frame Tab alone
 * leaves it after the last control.
 * @param {KeyboardEvent} event
 */
function takeKey(event) {
  if (isOther) {
    return;
  }

  // Keys in the lesson's text and in dialogs of the page do not go to the program.
  if (event.target instanceof Element && event.target.closest("#lesson, dialog")) {
    return;
  }

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
 * In a frame, one finger on the run scrolls the page around; two fingers belong to the program.
 * @param {TouchEvent} event
 */
function shareTouch({ type, touches, cancelable }) {
  if (type === "touchstart" && touches.length === 1) {
    scrolls = app?.scrolls_at(touches[0].clientX, touches[0].clientY) ?? true;
  }
  // Once scrolling has begun, the rest of the touch scrolls. The end of a tap stays with the program, so that it does
  // not also become a mouse event.
  app?.yield_touch(!cancelable || (scrolls && touches.length === 1 && type !== "touchend"));
}

/**
 * Makes Tab enter a frame at its first control, and backwards at the last one, as in any other page. While the focus is
 * inside, no other element of the page can get it.
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

/** Copies a text to the clipboard, or reports to the program that this failed. @param {string} text */
async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // Pages that are not served by https or from this machine have only the old clipboard interface.
    if (!copyAsOfOld(text)) {
      app?.copy_failed();
    }
  }
}

/** Copies by selecting the text in a temporary field. @param {string} text @returns {boolean} Whether the browser did. */
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

/** Enters or leaves full screen. */
async function turnFullScreen() {
  try {
    await (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen());
  } catch (error) {
    console.warn("Tilescope cannot have the full screen:", error);
  }
}

/** The functions that the program calls (`hooks.rs` of `web/app`). */
const hooks = {
  announce,
  // Where the focus is on an element, screen readers say what that is by themselves.
  /** @param {string} text */
  announce_focus: (text) => tree.holds() || announce(text),
  /** @param {string} json */
  tree: (json) => tree.change(JSON.parse(json)),
  // One element takes the text input of all fields, so it is labelled with the field's name.
  /** @param {string} name */
  field: (name) => textField()?.setAttribute("aria-label", name || FIELD),
  // Deferred, as in `lost`: the program's state is still borrowed.
  /** @param {string} text */
  copy: (text) => setTimeout(() => copy(text)),
  full_screen: turnFullScreen,
  link: keepLink,
  /** @param {string} json */
  state: (json) => {
    draws = true;
    const told = JSON.parse(json);
    if (hasText) {
      element("lesson").dataset.look = told.view.look;
      showLesson(told.lesson);
      frame?.height(wishedHeight());
    }
    frame ? frame.state(told) : entitle(told);
    // Deferred, as in `lost`.
    if (follow && told.answered?.number !== lastAnswer) {
      lastAnswer = told.answered?.number;
      setTimeout(follow);
    }
  },
  /** @param {string} json */
  talk: (json) => followTalk(JSON.parse(json)),
  // Deferred, as in `lost`.
  lessons: () => setTimeout(loadLessons),
  // The program calls this while its state is borrowed, so it is ended a moment later.
  /** @param {string} reason */
  lost: (reason) => setTimeout(() => restart(reason)),
  drawn: () => {
    // For measurements of the start time.
    performance.mark("tilescope: first frame");
    loadLater();
  },
  failed: fail,
};

/** The channel to the lecturer's notes, from the first talk on. @type {BroadcastChannel | undefined} */
let channel;
/** The talk that is given. @type {any} */
let talk = null;

/** Opens the channel to the notes. Its name is random, so that no other window can guess it. @param {string} name */
function openChannel(name) {
  channel = new BroadcastChannel(name);
  channel.addEventListener("message", ({ data }) => {
    if (data.command !== undefined) {
      app?.talk(JSON.stringify(data.command));
    }
    if (data.hello) {
      channel?.postMessage({ talk });
    } else if (data.ping) {
      channel?.postMessage({ here: true });
    }
  });
  return name;
}

/** Opens the window with the notes when the talk has them open, and sends it the talk. @param {any} told */
function followTalk(told) {
  const wants = Boolean(told?.wants_notes) && !talk?.wants_notes;
  talk = told;
  if (wants && !asked.get("talk")) {
    const name = channel?.name ?? openChannel(`tilescope-${crypto.randomUUID()}`);
    if (!window.open(`./#notes=${name}`, `notes-${name}`, "popup,width=1100,height=760")) {
      announce("The browser did not open the window with the notes. Allow this page to open windows, then press N twice.");
    }
  }
  channel?.postMessage({ talk });
}

/** Continues the talk that the notes keep. @param {string} name */
function rejoin(name) {
  openChannel(name);
  channel?.postMessage({ stage: true });
}

/** Loads the lessons that come with the program, when they are first needed. */
async function loadLessons() {
  try {
    const response = await fetch(LESSONS);
    if (!response.ok) {
      throw new Error(`the server answered ${response.status}`);
    }
    app?.take_lessons(await response.text());
  } catch (error) {
    app?.lessons_failed(told(error));
  }
}

/** Loads the rest of the program after the first frame. Without a network it is asked for again until it comes. */
async function loadLater() {
  while (!later) {
    try {
      const arrived = await fetchLater();
      await joinSoon(exported, arrived);
      take(arrived);
    } catch (error) {
      console.warn("The rest of the program did not come yet:", error);
      const given = new AbortController();
      await new Promise((resolve) => {
        setTimeout(resolve, AGAIN_MS);
        window.addEventListener("online", resolve, { signal: given.signal });
      });
      given.abort();
    }
  }
}

/** Joins the rest of the program with it, and sends it to the workers. @param {WebAssembly.Module} arrived */
function take(arrived) {
  if (later) {
    return;
  }
  join(exported, arrived);
  later = arrived;
  performance.mark("tilescope: all is there");
  // Deferred, as in `lost`.
  setTimeout(() => app?.take_later(arrived));
}

/** Loads the rest of the program while the program waits for it. The user may try again as often as they like. */
function loadLaterNow() {
  for (;;) {
    try {
      take(fetchLaterNow());
      return;
    } catch (error) {
      const reason = `${NOT_THERE}: ${told(error)}`;
      // Only a dialog of the browser waits. A frame of another origin may have none, and the answer is then no.
      if (!window.confirm(`${reason}. Is there a network? OK tries again.`)) {
        // What was answered is stored, and the address has the view.
        fail(`${reason}. Your results are kept, and this address leads back here.`);
        throw new Error(reason);
      }
    }
  }
}

/** Sets a title by which tabs and bookmarks can be distinguished. @param {any} told */
function entitle({ parameters: { seed, radius }, lesson }) {
  const ofLesson = lesson?.list ? lesson.labels.lessons : lesson && `${lesson.heading}, ${lesson.title}`;
  document.title = `${ofLesson || `Seed ${seed}, r ${radius}`} \u2013 Tilescope`;
}

/** Shows why the program does not run, and reports it to the page around. @param {string} reason */
function fail(reason) {
  failed ||= reason;
  failure(reason);
  frame?.failed(failed);
}

/** Keeps the focus where it is: in a frame the program must not take it from the page around. @param {boolean} stays */
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
    languages: [...navigator.languages],
    reduced_motion: still.matches,
    light: matchMedia("(prefers-color-scheme: light)").matches,
    full_screen: document.fullscreenEnabled === true,
    worker: WORKER,
    bindings: BINDINGS,
  };

  const canvas = element("canvas");
  // A loss of WebGPU is reported to the program, a loss of WebGL to the canvas.
  canvas.addEventListener("webglcontextlost", () => canvas.isConnected && restart("WebGL's context was lost."), { once: true });

  const { start } = await import("./{{asset:tilescope.js}}");
  // Show the focus ring only for keyboard users, not when the focus returns from a text field.
  canvas.focus = (how) => HTMLElement.prototype.focus.call(canvas, /** @type {any} */ ({ ...how, focusVisible: false }));

  keepFocus(embed !== null);
  draws = false;
  try {
    app = await start(canvas, JSON.stringify(options), { ...hooks, module, later });
  } finally {
    keepFocus(false);
  }

  awaitDrawing(canvas);
  // It may have come while the program started, and so missed the workers.
  if (later) {
    app.take_later(later);
  }
  // A link may have been followed meanwhile.
  if (fragment() !== link) {
    app.open_link(fragment());
  }

  // For use in the browser's console.
  /** @type {any} */ (window).tilescope = app;
  restoreDraft();

  // The text input element is beside the canvas; Tab must skip it.
  const field = textField();
  if (field) {
    field.tabIndex = -1;
    field.setAttribute("aria-label", FIELD);
  }

  await connectStore();
  loaded();
  if (!embed) {
    // The program gets keys from the start.
    canvas.focus();
  }
  frame?.ready();

  const name = asked.get("talk");
  if (name?.startsWith("tilescope-") && !channel) {
    rejoin(name);
  }
}

/** Restarts after the display's device was lost, with the other kind of display. @param {string} reason */
async function restart(reason) {
  const ended = app;
  app = null;

  if (hasFailed()) {
    return;
  }

  // Out of view the browser may have given the display to other frames, and the frame can wait; in view it would lose a
  // new one at once.
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

/** Replaces the canvas, since a canvas cannot change its kind of context. */
function renewCanvas() {
  const canvas = element("canvas");
  canvas.replaceWith(canvas.cloneNode(false));
}

/** @param {unknown} error @returns {string} */
function told(error) {
  const text = error instanceof Error ? error.message : String(error);
  // Unwrap browser errors that passed through the program.
  return text.replace(/JsValue\(\w+: ([^\n)]*)[^)]*\)/, "$1");
}

/** Handles a trap of the program, after which it cannot continue. @param {unknown} error */
function noticeTrap(error) {
  if (typeof WebAssembly === "object" && error instanceof WebAssembly.RuntimeError) {
    fail(`The program broke: ${error.message}`);
  }
}

/**
 * Sizes the canvas by the screen's pixel density where the browser reports another size, as for screens emulated by its
 * developer tools.
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
  // A hidden frame, as on a later slide, has no size yet.
  await Promise.race([seen, new Promise((resolve) => setTimeout(resolve, 500))]);
}

/**
 * Changes the size of a canvas by a pixel and back until the program draws. It waits for the browser to report the size, which
 * Chromium 156 at times never does when the tab goes behind another just then (in about one of 25 starts on a busy machine). A
 * change is reported.
 * @param {HTMLElement} canvas
 */
function awaitDrawing(canvas) {
  setTimeout(() => {
    canvas.style.maxWidth = draws || canvas.style.maxWidth ? "" : `${canvas.clientWidth - 1}px`;
    if (!draws && canvas.isConnected) {
      awaitDrawing(canvas);
    }
  }, SIZED_MS);
}

/** Starts the program; if the best display does not start, with WebGL. @param {string} display */
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

/** Shows the voting card or the notes of a talk instead of the program, if the address names them. Returns whether it did. */
async function showOther() {
  const notes = fragment().match(/^notes=(tilescope-[\w-]+)$/)?.[1];
  // What mail and chat programs put behind an address does not count.
  const card = fragment().match(/^card(?:&language=([a-z]+))?(?:[.,;:)>\]"']|%20|%22|%3E)*$/i);

  if (!card && !notes) {
    return false;
  }

  isOther = true;
  document.documentElement.setAttribute("data-runs", "");
  element("loading").hidden = true;

  if (notes) {
    const { showNotes } = await import("./{{asset:notes.js}}");
    showNotes(notes);
  } else {
    const { showCard } = await import("./{{asset:card.js}}");
    await showCard(card?.[1]);
    keepOffline();
  }

  return true;
}

async function main() {
  if (!embed && (await showOther())) {
    return;
  }

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
    const { default: init, load_later_with } = await import("./{{asset:tilescope.js}}");
    exported = await init({ module_or_path: module });
    load_later_with(loadLaterNow);
    await beginAnyhow(oneOf(asked.get("display"), ["webgpu", "webgl"]) ?? "auto");
  } catch (error) {
    fail(`Tilescope could not start: ${told(error)}`);
    return;
  }

  // Only after the start, so that it does not compete for the network. Frames do not install a service worker.
  if (!embed) {
    keepOffline();
  }
}

if (hasText) {
  connectLesson((request) => JSON.parse(ask(JSON.stringify(request))));
}

window.addEventListener("keydown", takeKey, { capture: true });

if (embed) {
  document.documentElement.setAttribute("data-embed", embed);
  element("canvas").setAttribute("aria-label", "Tilescope: a run of maximal Poisson-disk sampling. Tab leads through it.");
  joinTabs();
  for (const type of /** @type {const} */ (["touchstart", "touchmove", "touchend"])) {
    window.addEventListener(type, shareTouch, { capture: true, passive: true });
  }
  // In another width lines break elsewhere.
  window.addEventListener("resize", () => frame?.height(wishedHeight()));
}

window.addEventListener("hashchange", (event) => {
  // Not the address: the program may have written its own link there since the change.
  const link = new URL(event.newURL).hash.slice(1);
  if (/^card(&|$)/.test(link)) {
    location.hash = link;
    location.reload();
    return;
  }
  nextLink = null;
  app?.open_link(link);
});

// A browser may end a hidden page without notice.
document.addEventListener("visibilitychange", () => document.hidden && app?.keep());
window.addEventListener("pagehide", () => app?.keep());
// Another tab has stored results of lessons.
window.addEventListener("storage", ({ key, newValue }) => {
  if (key === "lessons" && newValue !== null) {
    app?.take_results(newValue);
  }
});

still.addEventListener("change", () => app?.prefer_reduced_motion(still.matches));

// The canvas handles files dropped on it. Elsewhere the browser would replace the page by the file.
for (const type of ["dragover", "drop"]) {
  window.addEventListener(type, (event) => event.preventDefault());
}

window.addEventListener("error", (event) => noticeTrap(event.error));
window.addEventListener("unhandledrejection", (event) => noticeTrap(event.reason));

main();
