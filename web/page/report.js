// @ts-check
// Sends answers to a record store that the address of the page names, by xAPI: `?endpoint=https://...`, with the keys of launch
// links of learning systems (`auth`, `actor`, `registration`). Nothing is sent before the reader has agreed, and nothing but
// what was answered since the page was opened. The page's policy must allow the store (`web/build --xapi`).

import { announce, element } from "./{{asset:sheets.js}}";
import { wordsOf } from "./{{asset:words.js}}";

const VERSION = "1.0.3";
/** What a store answers if it has another statement of the same id. It then takes none of those that were sent with it. */
const CONFLICT = 409;
/** The name of learners without a name, in statements. */
const ANONYMOUS = "anonymous";

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
    throw new Error("actor= in the address is no JSON, so that the statements would have no actor.");
  }
  if (actor !== null && !isAgent(actor)) {
    throw new Error("actor= in the address is no agent of xAPI: an object whose fields are texts, with an account of texts.");
  }
  const address = `${url.origin}${url.pathname.replace(/\/?$/, "/")}statements`;
  return { address, host: url.host, auth: asked.get("auth") ?? "", actor, registration: asked.get("registration") ?? "" };
}

/** Returns whether a value is written as xAPI writes agents. @param {any} value @returns {boolean} */
function isAgent(value) {
  const isObject = (/** @type {any} */ one) => typeof one === "object" && one !== null && !Array.isArray(one);
  const isText = (/** @type {any} */ one) => typeof one === "string";
  return isObject(value) && Object.entries(value).every(([key, one]) =>
    key === "account" ? isObject(one) && Object.values(one).every(isText) : isText(one));
}

/** Returns what tells an answer from others: unlike its id it stays the same when the learner's name changes. @param {any} statement */
function answerOf({ object, result, timestamp }) {
  return JSON.stringify([object, result, timestamp]);
}

/**
 * Makes what follows the answers of a reader.
 * @param {Store} store
 * @param {() => any[]} statements returns the statements of all answers that the program keeps
 */
export function makeReporter(store, statements) {
  // What was answered before the page was opened with this store is not sent to it.
  const known = new Set(statements().map(answerOf));
  /** Whether the reader has agreed; null before the question. @type {boolean | null} */
  let agrees = null;
  /** The name that the reader has seen. */
  let agreedName = "";
  let isBusy = false;

  const waiting = () => statements().filter((statement) => !known.has(answerOf(statement)));
  /** The name under which a statement is sent. @param {any} statement */
  const nameFor = (statement) => nameOf(store.actor ?? statement.actor);

  /** Asks the reader about the next statement. @param {string} refusal */
  async function askAbout(refusal) {
    agreedName = nameFor(waiting()[0]);
    agrees = await asks(store.host, agreedName, refusal);
  }

  /** Sends what waits; asks first where the reader has not agreed to this name. */
  async function sendAll() {
    // While it is sent, or while the reader reads, more may be answered.
    while (agrees !== false && waiting().length > 0) {
      const sent = waiting();
      if (agrees === null || nameFor(sent[0]) !== agreedName) {
        await askAbout("");
        continue;
      }

      const refusal = await send(store, sent);
      if (refusal) {
        await askAbout(refusal);
      } else {
        sent.forEach((statement) => known.add(answerOf(statement)));
        announce((await wordsOf(language()))("Sent to {=host}.", { host: store.host }));
      }
    }
  }

  /** Sends new answers, once at a time. */
  async function follow() {
    if (isBusy) {
      return;
    }
    isBusy = true;
    try {
      await sendAll();
    } finally {
      isBusy = false;
    }
  }
  return follow;
}

/** The language of the controls. */
const language = () => element("tree").lang || "en";

/**
 * Sends statements, one by one if one of them is in conflict. Returns why they were not taken, or an empty text.
 * @param {Store} store
 * @param {any[]} statements
 * @returns {Promise<string>}
 */
async function send(store, statements) {
  const status = await post(store, statements);
  if (status !== CONFLICT) {
    return typeof status === "string" ? status : "";
  }
  // The store keeps its own statement of this id, whatever is sent: to ask again would not change that.
  if (statements.length === 1) {
    return "";
  }
  for (const statement of statements) {
    const refusal = await send(store, [statement]);
    if (refusal) {
      return refusal;
    }
  }
  return "";
}

/**
 * Posts statements. Returns nothing if they were taken, the number of a conflict, or why they were not taken.
 * @param {Store} store
 * @param {any[]} statements
 * @returns {Promise<undefined | number | string>}
 */
async function post({ address, auth, actor, registration }, statements) {
  const inContext = statements.map((statement) => ({
    ...statement,
    ...(actor && { actor }),
    ...(registration && { context: { registration } }),
  }));
  const headers = { "Content-Type": "application/json", "X-Experience-API-Version": VERSION, ...(auth && { Authorization: auth }) };
  try {
    // Without cookies: who the reader is elsewhere is no part of an answer.
    const response = await fetch(address, { method: "POST", headers, body: JSON.stringify(inContext), credentials: "omit" });
    if (response.ok) {
      return undefined;
    }
    return response.status === CONFLICT ? CONFLICT : `${response.status}`;
  } catch (error) {
    return error instanceof Error ? error.message : String(error);
  }
}

/**
 * Asks whether answers may be sent. Escape means no.
 * @param {string} host
 * @param {string} name the name under which they are sent, empty without one
 * @param {string} refusal why the store did not take them, if it was tried
 * @returns {Promise<boolean>}
 */
async function asks(host, name, refusal) {
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
    add("p", name ? `${words("They are sent under this name:")} ${name}` : words("They are sent without a name."));
  }
  const yes = /** @type {HTMLButtonElement} */ (add("button", refusal ? words("Try again") : words("Send")));
  const no = /** @type {HTMLButtonElement} */ (add("button", words("Do not send")));
  yes.type = no.type = "button";
  no.className = "quiet";
  // The dialog opens by itself, perhaps while the reader presses Enter for the next step: that must not agree.
  no.autofocus = true;

  const before = document.activeElement;
  document.body.append(dialog);
  dialog.showModal();
  const agreed = await new Promise((resolve) => {
    yes.onclick = () => resolve(true);
    no.onclick = () => resolve(false);
    dialog.oncancel = () => resolve(false);
  });
  dialog.remove();
  focusAfter(before);
  return agreed;
}

/** Returns the focus to where it was, or to the lesson or the canvas if that is gone. @param {Element | null} before */
function focusAfter(before) {
  if (before instanceof HTMLElement && before.isConnected && before !== document.body) {
    before.focus();
    return;
  }
  const lesson = element("lesson");
  const heading = lesson.hidden ? null : /** @type {HTMLElement | null} */ (lesson.querySelector("h1, h2"));
  if (heading) {
    heading.tabIndex = -1;
  }
  (heading ?? element("canvas")).focus();
}

/** Returns everything by which a store would know a learner; an empty text if it is nothing. @param {any} actor @returns {string} */
function nameOf({ name, mbox, mbox_sha1sum, openid, account }) {
  const inAccount = account?.name === ANONYMOUS ? "" : account?.name;
  const all = [name, mbox?.replace(/^mailto:/, ""), inAccount, openid, mbox_sha1sum];
  return all.filter(Boolean).join(", ");
}
