// @ts-check
// Sends answers to a record store that the address of the page names, by xAPI: `?endpoint=https://...`, with the keys of launch
// links of learning systems (`auth`, `actor`, `registration`). Nothing is sent before the reader has agreed, and nothing but
// what was answered since the page was opened. The page's policy must allow the store (`web/build --xapi`).

import { announce, element } from "./{{asset:sheets.js}}";
import { wordsOf } from "./{{asset:words.js}}";

const VERSION = "1.0.3";
/** What a store answers to a statement that it has already. */
const KNOWN_ALREADY = 409;

/**
 * A store, and how it is used.
 * @typedef {object} Store
 * @property {string} address where statements go
 * @property {string} host
 * @property {string} auth
 * @property {any} actor whose answers these are, if the address says so
 * @property {string} registration
 */

/**
 * Returns the store that an address names; null if it names none.
 * @param {URLSearchParams} asked
 * @returns {Store | null}
 * @throws {Error} if it may not be used
 */
export function namedStore(asked) {
  const text = asked.get("endpoint");
  if (text === null) {
    return null;
  }

  const url = URL.canParse(text) ? new URL(text) : null;
  // What was answered is about a person: nobody on the way may read or change it.
  if (url?.protocol !== "https:" || url.username || url.password) {
    throw new Error(`endpoint=${text} names no record store: its address begins with https:// and holds no password.`);
  }

  let actor = null;
  try {
    actor = JSON.parse(asked.get("actor") ?? "null");
  } catch {
    throw new Error("actor= in the address is no JSON, so that a record store would not know whose answers these are.");
  }
  const address = `${url.origin}${url.pathname.replace(/\/?$/, "/")}statements`;
  return { address, host: url.host, auth: asked.get("auth") ?? "", actor, registration: asked.get("registration") ?? "" };
}

/**
 * Makes what follows the answers of a reader.
 * @param {Store} store
 * @param {() => any[]} statements returns the statements of all answers that the program keeps
 */
export function makeReporter(store, statements) {
  // What was answered before the page was opened with this store is not sent to it.
  const known = new Set(statements().map(({ id }) => id));
  /** Whether the reader has agreed; null before the question. @type {boolean | null} */
  let agrees = null;
  let isBusy = false;

  const waiting = () => statements().filter(({ id }) => !known.has(id));

  /** Sends what waits, or asks before. */
  async function follow() {
    if (isBusy || agrees === false || waiting().length === 0) {
      return;
    }

    isBusy = true;
    agrees ??= await asks(store, "");
    // While it is sent, or while the reader reads, more may be answered.
    while (agrees && waiting().length > 0) {
      const sent = waiting();
      const refusal = await send(store, sent);
      if (refusal) {
        agrees = await asks(store, refusal);
      } else {
        sent.forEach(({ id }) => known.add(id));
        announce((await wordsOf(language()))("Sent to {=host}.", { host: store.host }));
      }
    }
    isBusy = false;
  }
  return follow;
}

/** The language of the controls. */
const language = () => element("tree").lang || "en";

/** Sends statements; returns why they were not taken, or an empty text. @param {Store} store @param {any[]} statements */
async function send({ address, auth, actor, registration }, statements) {
  const inContext = statements.map((statement) => ({
    ...statement,
    ...(actor && { actor }),
    ...(registration && { context: { registration } }),
  }));
  const headers = { "Content-Type": "application/json", "X-Experience-API-Version": VERSION, ...(auth && { Authorization: auth }) };
  try {
    // Without cookies: who the reader is elsewhere is no part of an answer.
    const response = await fetch(address, { method: "POST", headers, body: JSON.stringify(inContext), credentials: "omit" });
    return response.ok || response.status === KNOWN_ALREADY ? "" : `${response.status}`;
  } catch (error) {
    return error instanceof Error ? error.message : String(error);
  }
}

/**
 * Asks whether answers may be sent. Escape means no.
 * @param {Store} store
 * @param {string} refusal why the store did not take them, if it was tried
 * @returns {Promise<boolean>}
 */
async function asks({ host, actor }, refusal) {
  const words = await wordsOf(language());
  const dialog = document.createElement("dialog");
  dialog.id = "report";
  dialog.lang = language();
  // In the look of the window, as the lesson is.
  dialog.dataset.look = element("lesson").dataset.look;
  const add = (/** @type {"h2" | "p" | "button"} */ tag, /** @type {string} */ text) => {
    const part = Object.assign(document.createElement(tag), { textContent: text });
    dialog.append(part);
    return part;
  };

  const heading = add("h2", refusal ? words("{=host} did not take your answers", { host }) : words("Send your answers to {=host}?", { host }));
  heading.id = "report-title";
  dialog.setAttribute("aria-labelledby", heading.id);
  if (refusal) {
    add("p", words("It answered: {=why}. The network may be away, or the policy of this page may not allow {=host}.", { why: refusal, host }));
  } else {
    add("p", words("The address of this page names this record store. It would get each answer, its score and its time, from now on."));
    add("p", `${actor ? words("They are sent under this name:") : words("They are sent without a name.")} ${actor ? nameOf(actor) : ""}`);
  }
  const yes = /** @type {HTMLButtonElement} */ (add("button", refusal ? words("Try again") : words("Send")));
  const no = /** @type {HTMLButtonElement} */ (add("button", words("Do not send")));
  yes.type = no.type = "button";
  no.className = "quiet";

  const before = document.activeElement;
  document.body.append(dialog);
  dialog.showModal();
  const agreed = await new Promise((resolve) => {
    yes.onclick = () => resolve(true);
    no.onclick = () => resolve(false);
    dialog.oncancel = () => resolve(false);
  });
  dialog.remove();
  if (before instanceof HTMLElement && before.isConnected) {
    before.focus();
  }
  return agreed;
}

/** Returns the name by which a store has a learner. @param {any} actor @returns {string} */
function nameOf({ name, mbox, account }) {
  return String(name ?? mbox?.replace(/^mailto:/, "") ?? account?.name ?? "?");
}
