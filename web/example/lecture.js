// @ts-check
// A lecture page that leads a run of Tilescope. Copy it; all that it needs to know is where the player lies.

/** Where Tilescope is served: `?player=` for another place than beside this page. */
const asked = new URLSearchParams(location.search).get("player");
const player = new URL(asked ?? "../", location.href);
if (!["http:", "https:"].includes(player.protocol)) {
  throw new Error(`the player's address must begin with http: or https:, not ${player.protocol}`);
}
player.searchParams.set("embed", "player");
// The player speaks with its own origin and with the one that is named here.
player.searchParams.set("origin", location.origin);

const frame = /** @type {HTMLIFrameElement} */ (document.getElementById("tilescope"));
const log = /** @type {HTMLElement} */ (document.getElementById("log"));
const sentence = /** @type {HTMLElement} */ (document.getElementById("sentence"));

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
    // To the player's origin alone, whatever has become of the frame.
    frame.contentWindow?.postMessage(message, player.origin);
  });
}

window.addEventListener("message", ({ source, origin, data }) => {
  if (source !== frame.contentWindow || origin !== player.origin || data?.tilescope !== 1) {
    return;
  }
  if (data.event === "state") {
    sentence.textContent = data.state.sentence ?? "";
    return;
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

frame.src = player.href;
