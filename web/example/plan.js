// @ts-check
// The plan of a lecture, in the language of its page. It opens the stage and the notes, follows the talk over their channel,
// and shows its step in a player. Copy it with plan.html, or plan.de.html, and lecture.css to the server that has Tilescope,
// and set its address.

/** The address of Tilescope: on the origin of this page, since a channel joins windows of one origin. */
const PLAYER = "../";
/** The language of the page, which stage and player get by their links. */
const LANGUAGE = document.documentElement.lang;

/** The channel's name is random, so that no other page can guess it; it stays in the address, so that a reload finds the talk. */
const name = /^#tilescope-[\w-]+$/.test(location.hash) ? location.hash.slice(1) : `tilescope-${crypto.randomUUID()}`;
history.replaceState(null, "", `#${name}`);
const channel = new BroadcastChannel(name);
const player = new URL(PLAYER, location.href);
player.searchParams.set("embed", "player");
player.hash = `language=${LANGUAGE}`;

const frame = /** @type {HTMLIFrameElement} */ (document.getElementById("tilescope"));
const now = /** @type {HTMLElement} */ (document.getElementById("now"));
const rows = [...document.querySelectorAll("#plan tr")];

/** The time until a request that was refused is sent again. */
const AGAIN_MS = 1_000;

/** The step that the player shows, as `lesson/step`. */
let shown = "";
let isReady = false;
/** @type {any} The talk, as its stage reported it last. */
let talk = null;

/** Shows the step of the talk in the player. */
function follow() {
  const step = talk?.kept.step;
  const lesson = talk?.kept.lesson[0];
  if (!isReady || !talk || shown === `${lesson}/${step}`) {
    return;
  }
  shown = `${lesson}/${step}`;
  frame.contentWindow?.postMessage({ tilescope: 1, id: 1, do: "lesson", open: lesson, step }, player.origin);
}

channel.addEventListener("message", ({ data }) => {
  if (data.stage && !talk) {
    // The stage that this page opened begins the lecture. Notes that are open go on with an earlier talk instead.
    channel.postMessage({ command: { restore: JSON.stringify({ is_lecture: true }) } });
  }
  if (data.talk === undefined) {
    return;
  }
  talk = data.talk;
  const lesson = talk?.kept.lesson[0];
  rows.forEach((row) => row.setAttribute("aria-current", String(row.getAttribute("data-lesson") === lesson)));
  const { step = "", over = "" } = now.dataset;
  now.textContent = talk ? step.replace(/\{(\w+)\}/g, (_, name) => String(talk[name])) : over;
  follow();
});

window.addEventListener("message", ({ source, origin, data }) => {
  if (source !== frame.contentWindow || origin !== player.origin) {
    return;
  }
  if (data?.event === "ready") {
    isReady = true;
    follow();
  }
  // The player refuses requests while it replaces a lost display.
  if (data?.ok === false) {
    shown = "";
    setTimeout(follow, AGAIN_MS);
  }
});

document.getElementById("stage")?.addEventListener("click", () => {
  window.open(`${PLAYER}?talk=${name}#language=${LANGUAGE}`, `stage-${name}`);
});
document.getElementById("notes")?.addEventListener("click", () => {
  window.open(`${PLAYER}#notes=${name}`, `notes-${name}`, "popup,width=1100,height=760");
});
frame.src = player.href;
channel.postMessage({ hello: true });
