// @ts-check
// Speaks with course systems by cmi5: statements to a record store over the network. The system's address of this page names the
// store, and an address that gives the right to write to it, once.

import { LESSON } from "./lesson.js";

const CMI5 = "https://w3id.org/xapi/cmi5/context/categories/cmi5";
const MOVE_ON = "https://w3id.org/xapi/cmi5/context/categories/moveon";
const MASTERY = "https://w3id.org/xapi/cmi5/context/extensions/masteryscore";
const VERBS = "http://adlnet.gov/expapi/verbs/";
/** The name under which the store keeps this page's own text. */
const STATE = "tilescope";
/** After so long a statement that did not arrive is sent again. */
const AGAIN_MS = 5_000;

/** Returns a random id of version 4. The browser's own function for it needs https, which a course system may lack. */
function uuid() {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  bytes[6] = (bytes[6] & 0x0f) | 0x40;
  bytes[8] = (bytes[8] & 0x3f) | 0x80;
  const digits = [...bytes].map((byte) => byte.toString(16).padStart(2, "0")).join("");
  return digits.replace(/^(.{8})(.{4})(.{4})(.{4})/, "$1-$2-$3-$4-");
}

/** @param {number} seconds */
const duration = (seconds) => `PT${Math.max(0, seconds).toFixed(2)}S`;

/** What this tab keeps of the visit, as the page may be loaded again. @param {string} key @returns {any} */
function remembered(key) {
  try {
    return JSON.parse(sessionStorage.getItem(key) ?? "{}");
  } catch {
    return {};
  }
}

/** @param {string} key @param {object} value */
function remember(key, value) {
  try {
    sessionStorage.setItem(key, JSON.stringify(value));
  } catch {
    // The browser denies the store: a page that is loaded again then has no right to write.
  }
}

/** Returns the right to write to the store. @param {string} address */
async function fetchToken(address) {
  const response = await fetch(address, { method: "POST" });
  const told = await response.json();
  if (!told["auth-token"]) {
    throw new Error(told["error-text"] ?? `the course system answered ${response.status}`);
  }
  return told["auth-token"];
}

/** The store, as this learner may use it. */
class Store {
  /** @param {URLSearchParams} asked @param {string} token */
  constructor(asked, token) {
    this.endpoint = `${asked.get("endpoint")}`.replace(/\/?$/, "/");
    this.activity = `${asked.get("activityId")}`;
    this.actor = JSON.parse(`${asked.get("actor")}`);
    this.registration = `${asked.get("registration")}`;
    this.headers = { Authorization: `Basic ${token}`, "X-Experience-API-Version": "1.0.3", "Content-Type": "application/json" };
  }

  /** @param {string} path @param {Record<string, string>} query @param {RequestInit} options */
  ask(path, query, options = {}) {
    const address = `${this.endpoint}${path}?${new URLSearchParams(query)}`;
    // The request goes on when the page is left.
    return fetch(address.replace(/\?$/, ""), { ...options, headers: this.headers, keepalive: options.method !== undefined });
  }

  /** @param {string} stateId */
  #of(stateId) {
    return { stateId, activityId: this.activity, agent: JSON.stringify(this.actor), registration: this.registration };
  }

  /** Returns a document of the store, null if there is none. @param {string} stateId @returns {Promise<any>} */
  async document(stateId) {
    const response = await this.ask("activities/state", this.#of(stateId));
    if (response.status === 404) {
      return null;
    }
    if (!response.ok) {
      throw new Error(`the course system answered ${response.status}`);
    }
    return response.json();
  }

  /** @param {string} stateId @param {object} document */
  put(stateId, document) {
    return this.ask("activities/state", this.#of(stateId), { method: "PUT", body: JSON.stringify(document) });
  }

  /** Returns the languages that the learner has chosen in the course system, the first one before others. @returns {Promise<string>} */
  async languages() {
    try {
      const query = { profileId: "cmi5LearnerPreferences", agent: JSON.stringify(this.actor) };
      const response = await this.ask("agents/profile", query);
      return response.ok ? String((await response.json()).languagePreference ?? "") : "";
    } catch {
      // Preferences are a courtesy: without them the package's language stays.
      return "";
    }
  }
}

/** Sends statements in their order, one after the other. @param {Store} store @param {(isTaken: boolean) => void} tell */
function makeQueue(store, tell) {
  /** @type {object[]} */
  let waiting = [];
  let isSending = false;

  const send = async () => {
    if (isSending || waiting.length === 0) {
      return;
    }

    isSending = true;
    const sent = waiting;
    waiting = [];
    let isTaken = false;
    try {
      isTaken = (await store.ask("statements", {}, { method: "POST", body: JSON.stringify(sent) })).ok;
    } catch {
      // The network is away.
    }
    isSending = false;

    tell(isTaken);
    if (!isTaken) {
      waiting = [...sent, ...waiting];
      setTimeout(send, AGAIN_MS);
    } else {
      send();
    }
  };

  return {
    /** @param {object} statement */
    add: (statement) => {
      waiting.push(statement);
      send();
    },
    /** Sends all that waits and the last statements, without waiting for what is on its way. @param {object[]} statements */
    end: (statements) => {
      const all = [...waiting, ...statements];
      waiting = [];
      store.ask("statements", {}, { method: "POST", body: JSON.stringify(all) }).catch(() => {});
    },
  };
}

/** The statements of a visit, in the context that the course system gave. */
class Statements {
  /** @param {Store} store @param {any} launch @param {number} began when the visit began */
  constructor(store, launch, began) {
    this.store = store;
    this.template = launch?.contextTemplate ?? {};
    /** The share of the score to pass with: the system's own, or the package's. @type {number | null} */
    this.mastery = launch?.masteryScore ?? LESSON.mastery;
    this.began = began;
  }

  /** @param {string} verb @param {string[]} categories @param {object} extensions @param {object} more */
  #make(verb, categories, extensions, more) {
    const { category = [], ...activities } = this.template.contextActivities ?? {};
    return {
      id: uuid(),
      actor: this.store.actor,
      verb: { id: `${VERBS}${verb}`, display: { en: verb } },
      object: this.unit(),
      timestamp: new Date().toISOString(),
      context: {
        ...this.template,
        registration: this.store.registration,
        contextActivities: { ...activities, category: [...category, ...categories.map((id) => ({ id }))] },
        extensions: { ...this.template.extensions, ...extensions },
      },
      ...more,
    };
  }

  /** The lesson. */
  unit() {
    return { objectType: "Activity", id: this.store.activity };
  }

  /** One of those that cmi5 defines. @param {string} verb @param {Record<string, any> | undefined} result */
  defined(verb, result = undefined) {
    const timed = result && { ...result, duration: duration((Date.now() - this.began) / 1000) };
    const isVerdict = Boolean(result && "success" in result);
    const decides = isVerdict || Boolean(result && "completion" in result);
    const extensions = isVerdict && this.mastery !== null ? { [MASTERY]: this.mastery } : {};
    return this.#make(verb, decides ? [CMI5, MOVE_ON] : [CMI5], extensions, { result: timed });
  }

  /** One with a verdict. @param {"passed" | "failed"} verb @param {number} score */
  verdict(verb, score) {
    return this.defined(verb, { success: verb === "passed", score: scored(score) });
  }

  /** The score where nothing says which one passes: what cmi5 defines has none then. @param {number} score */
  scored(score) {
    return this.#make("scored", [], {}, { result: { score: scored(score) } });
  }

  /** @param {import("./course.js").Answer} answer */
  answered({ result, seconds }) {
    const { question, score, isPractice, given } = result;
    const definition = {
      type: "http://adlnet.gov/expapi/activities/cmi.interaction",
      interactionType: "other",
      name: { [LESSON.language]: question.title },
    };
    // The same ids as in the results that the program saves.
    const id = `urn:tilescope:lesson:${encodeURIComponent(LESSON.name)}:${encodeURIComponent(question.gate)}`;
    const extensions = { "urn:tilescope:practice": isPractice };
    const told = { score: { scaled: score }, success: score > 0.999, response: given, duration: duration(seconds), extensions };
    return this.#make("answered", [], {}, { object: { objectType: "Activity", id, definition }, result: told });
  }
}

/** A score as verdicts have it. @param {number} score */
const scored = (score) => ({ scaled: score, raw: Math.round(100 * score), min: 0, max: 100 });

/** Begins a visit or goes on with it, as the page may be loaded again after a crash. @param {URLSearchParams} asked @param {string} address */
async function begun(asked, address) {
  const key = `tilescope ${address}`;
  const visit = { isOver: false, hasBegun: false, began: Date.now(), token: "", ...remembered(key) };
  const keep = () => remember(key, visit);
  if (!visit.isOver && !visit.token) {
    visit.token = await fetchToken(address);
    keep();
  }
  return { visit, keep, store: new Store(asked, visit.token) };
}

/**
 * Begins a visit. Returns null if the page was not opened by a course system.
 * @param {(isTaken: boolean) => void} tell whether the system has taken what was sent
 * @returns {Promise<import("./course.js").System | null>}
 */
export async function connect(tell) {
  const asked = new URLSearchParams(location.search);
  const address = asked.get("fetch");
  if (!address || !asked.get("endpoint")) {
    return null;
  }

  const { visit, keep, store } = await begun(asked, address);
  if (visit.isOver) {
    return { mode: "ended", kept: "", back: null, answered: () => true, keep: () => {}, end: () => {} };
  }

  const launch = await store.document("LMS.LaunchData");
  const own = (await store.document(STATE)) ?? {};
  const languages = await store.languages();
  const mode = { Browse: "browse", Review: "review" }[String(launch?.launchMode)] ?? "normal";
  const statements = new Statements(store, launch, visit.began);
  const queue = makeQueue(store, tell);

  /** @param {import("./course.js").Report} report @param {import("./course.js").Answer | null} answer */
  const take = ({ text, done, count, score }, answer) => {
    if (mode !== "normal" || visit.isOver) {
      return true;
    }
    if (answer) {
      queue.add(statements.answered(answer));
    }

    const { mastery } = statements;
    // Each of these is sent once in all visits of a learner.
    if (done === count && !own.completed) {
      own.completed = true;
      queue.add(statements.defined("completed", { completion: true }));
      if (mastery === null) {
        queue.add(statements.scored(score));
      }
    }
    if (done === count && mastery !== null && score >= mastery && !own.passed) {
      own.passed = true;
      queue.add(statements.verdict("passed", score));
    }

    own.text = text;
    store.put(STATE, own).then(
      ({ ok }) => tell(ok),
      () => tell(false),
    );
    return true;
  };

  if (!visit.hasBegun) {
    queue.add(statements.defined("initialized"));
    visit.hasBegun = true;
    keep();
  }

  return {
    mode,
    kept: String(own.text ?? ""),
    back: launch?.returnURL ?? null,
    languages,
    answered: take,
    keep: (report) => take(report, null),
    end: ({ text, done, count, score }) => {
      if (visit.isOver) {
        return;
      }
      visit.isOver = true;
      keep();

      const last = [];
      if (mode === "normal") {
        own.text = text;
        store.put(STATE, own).catch(() => {});
        // Only now: a visit may tell no more than one of both, and practice could still have led to the other.
        if (done === count && statements.mastery !== null && !own.passed) {
          last.push(statements.verdict("failed", score));
        }
      }
      queue.end([...last, statements.defined("terminated", {})]);
    },
  };
}
