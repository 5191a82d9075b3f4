// @ts-check
// A lecture page that controls a run of Tilescope. Copy it and set the address of the player.

/** The address of Tilescope: beside this page. Another origin must also be listed in `frame-src` of the page's policy. */
const PLAYER = "../";
/** `?player=` gives another address. */
const asked = new URLSearchParams(location.search).get("player");
const player = new URL(asked ?? PLAYER, location.href);
player.searchParams.set("embed", "player");
// The player answers its own origin and the one named here.
player.searchParams.set("origin", location.origin);

/** After so long without a message the page reports that the player does not answer. */
const SILENT_MS = 30_000;

const frame = /** @type {HTMLIFrameElement} */ (document.getElementById("tilescope"));
const log = /** @type {HTMLElement} */ (document.getElementById("log"));
const sentence = /** @type {HTMLElement} */ (document.getElementById("sentence"));
const controls = /** @type {HTMLFieldSetElement} */ (document.getElementById("controls"));

/** Returns whether the player may be shown. Anybody can make a link with `?player=`, and its content would look like this page's. */
function isTrusted() {
  const isOfWeb = ["http:", "https:"].includes(player.protocol);
  const isNear = player.origin === location.origin || ["localhost", "127.0.0.1"].includes(player.hostname);
  return isOfWeb && (asked === null || isNear);
}

/** Requests that wait for their answers, by id. @type {Map<number, (answer: any) => void>} */
const waiting = new Map();
let asks = 0;

/** @param {string} direction @param {any} message */
function note(direction, message) {
  const item = document.createElement("li");
  item.textContent = `${direction} ${JSON.stringify(message)}`;
  log.append(item);
  log.scrollTop = log.scrollHeight;
}

/** Sends a request and returns its answer. @param {object} request @returns {Promise<any>} */
function ask(request) {
  const message = { tilescope: 1, id: (asks += 1), ...request };
  note("asked", message);
  return new Promise((resolve) => {
    waiting.set(message.id, resolve);
    // Only to the player's origin, even if the frame now shows another page.
    frame.contentWindow?.postMessage(message, player.origin);
  });
}

const silent = setTimeout(() => {
  sentence.textContent = `Nothing was heard of a player at ${player.origin} yet.`;
}, SILENT_MS);

window.addEventListener("message", ({ source, origin, data }) => {
  if (source !== frame.contentWindow || origin !== player.origin || data?.tilescope !== 1) {
    return;
  }
  clearTimeout(silent);
  if (data.event === "state") {
    sentence.textContent = data.state.sentence ?? "";
    return;
  }
  if (data.event === "ready") {
    controls.disabled = false;
  } else if (data.event === "failed") {
    controls.disabled = true;
    sentence.textContent = data.error;
  }
  note(data.event ? "event" : "answer", data);
  waiting.get(data.id)?.(data);
  waiting.delete(data.id);
});

/** @param {string} id @param {object} request */
function button(id, request) {
  document.getElementById(id)?.addEventListener("click", async () => {
    const answer = await ask(request);
    if (!answer.ok) {
      sentence.textContent = answer.error;
    }
  });
}

button("load", { do: "load", parameters: { seed: 7, radius: 0.03, leaf: 10 } });
// The end of a stage is the beginning of the next one.
button("eliminate", { do: "seek", stage: "tile" });
button("step", { do: "step", by: 1, unit: "event" });
button("back", { do: "step", by: -1, unit: "event" });
button("play", { do: "play", speed: 2 });
button("pause", { do: "pause" });
button("state", { do: "state" });

if (isTrusted()) {
  frame.src = player.href;
} else {
  clearTimeout(silent);
  sentence.textContent = `This page shows players of its own server and of this machine, not ${player.href}`;
}
