// @ts-check
// Speaks with course systems by SCORM 1.2 and by SCORM 2004: an object of theirs, in a window around this one, that takes and
// gives values by their names.

import { LESSON } from "./lesson.js";

/** How many windows around this one are searched for the system's object. Systems nest two or three. */
const MAX_WINDOWS = 20;

/**
 * The names of one version.
 * @typedef {object} Names
 * @property {string} api the system's object
 * @property {Record<"begin" | "end" | "get" | "set" | "commit", string>} calls
 * @property {string} mode
 * @property {string} completion
 * @property {string} place
 * @property {string} score the prefix of scores
 * @property {string} time
 * @property {string} exit
 * @property {string} mastery the score from which on the system counts the lesson as passed
 * @property {number} full the value of that where all is right
 */

/** @type {Record<string, Names>} */
const VERSIONS = {
  "scorm-1.2": {
    api: "API",
    calls: { begin: "LMSInitialize", end: "LMSFinish", get: "LMSGetValue", set: "LMSSetValue", commit: "LMSCommit" },
    mode: "cmi.core.lesson_mode",
    completion: "cmi.core.lesson_status",
    place: "cmi.core.lesson_location",
    score: "cmi.core.score.",
    time: "cmi.core.session_time",
    exit: "cmi.core.exit",
    mastery: "cmi.student_data.mastery_score",
    full: 100,
  },
  "scorm-2004": {
    api: "API_1484_11",
    calls: { begin: "Initialize", end: "Terminate", get: "GetValue", set: "SetValue", commit: "Commit" },
    mode: "cmi.mode",
    completion: "cmi.completion_status",
    place: "cmi.location",
    score: "cmi.score.",
    time: "cmi.session_time",
    exit: "cmi.exit",
    mastery: "cmi.scaled_passing_score",
    full: 1,
  },
};

/** Returns the system's object: in a window around this one, or around the one that opened it. @param {string} name */
function find(name) {
  /** @type {(Window | null)[]} */
  const begins = [window, window.top?.opener ?? window.opener];
  for (const begin of begins) {
    let at = begin;
    for (let searched = 0; at && searched < MAX_WINDOWS; searched++) {
      try {
        const found = /** @type {any} */ (at)[name];
        if (found) {
          return found;
        }
      } catch {
        // A window of another origin shows nothing, but those around it may.
      }
      at = at.parent === at ? null : at.parent;
    }
  }
  return null;
}

const two = (/** @type {number} */ number) => String(number).padStart(2, "0");

/** Returns a time as a version writes it. @param {number} seconds @param {boolean} isOld */
function span(seconds, isOld) {
  const [hours, minutes, rest] = [Math.floor(seconds / 3600), Math.floor(seconds / 60) % 60, Math.floor(seconds) % 60];
  return isOld ? `${String(hours).padStart(4, "0")}:${two(minutes)}:${two(rest)}` : `PT${hours}H${minutes}M${rest}S`;
}

/** Returns how a version writes the result of an answer: in words where it is right or wrong, else as a number. @param {number} score @param {boolean} isOld */
function judged(score, isOld) {
  if (score > 0.999) {
    return "correct";
  }
  return score > 0 ? String(score) : isOld ? "wrong" : "incorrect";
}

/** A visit of a learner, as the course system's object takes it. */
class Visit {
  /** @param {any} api */
  constructor(api) {
    this.api = api;
    this.isOld = LESSON.system === "scorm-1.2";
    this.names = VERSIONS[LESSON.system];
    this.began = Date.now();
  }

  /** @param {"begin" | "end" | "get" | "set" | "commit"} call @param {string[]} values @returns {string} */
  #call(call, ...values) {
    return String(this.api[this.names.calls[call]](...values) ?? "");
  }

  /** @param {string} name */
  get(name) {
    return this.#call("get", name);
  }

  /** @param {string} name @param {string | number} value */
  set(name, value) {
    this.#call("set", name, String(value));
  }

  /** Returns whether the system begins a visit. */
  begin() {
    return this.#call("begin", "") === "true";
  }

  /** Returns whether the system has kept what was set. */
  commit() {
    return this.#call("commit", "") === "true";
  }

  end() {
    this.#call("end", "");
  }

  /** The share of the score to pass with: the system's own, or the package's; null if there is none. @returns {number | null} */
  mastery() {
    const wanted = this.get(this.names.mastery).trim();
    // An empty text is no score of 0.
    return wanted === "" || Number.isNaN(Number(wanted)) ? LESSON.mastery : Number(wanted) / this.names.full;
  }

  /** Sets how far the learner is. @param {import("./course.js").Report} report */
  report(report) {
    this.set(this.names.place, report.place);
    this.set("cmi.suspend_data", report.text);
    this.set(this.names.time, span((Date.now() - this.began) / 1000, this.isOld));
    if (report.done > 0) {
      this.#judge(report);
    }
  }

  /** Sets score, completion and success. @param {import("./course.js").Report} report */
  #judge({ done, count, score }) {
    const isComplete = done === count;
    this.set(`${this.names.score}min`, 0);
    this.set(`${this.names.score}max`, 100);
    this.set(`${this.names.score}raw`, Math.round(10_000 * score) / 100);

    const mastery = this.mastery();
    const success = mastery === null ? null : score >= mastery ? "passed" : "failed";
    if (this.isOld) {
      // Version 1.2 has one word for both: who has passed or failed is also done.
      this.set(this.names.completion, isComplete ? (success ?? "completed") : "incomplete");
      return;
    }

    this.set("cmi.progress_measure", Math.round((10_000 * done) / count) / 10_000);
    this.set(this.names.completion, isComplete ? "completed" : "incomplete");
    // Systems count a lesson as failed by its scaled score, so that it gets none before the end.
    if (isComplete) {
      this.set(`${this.names.score}scaled`, score);
      this.set("cmi.success_status", success ?? "unknown");
    }
  }

  /** Adds an answer to the list of answers. @param {import("./course.js").Answer} answer */
  list({ result, seconds }) {
    const at = `cmi.interactions.${Number(this.get("cmi.interactions._count")) || 0}.`;
    const { question, isPractice, score } = result;
    // Version 1.2 takes at most 255 characters.
    const given = result.given.slice(0, 250);
    const now = new Date();

    // First the name: without it a system takes nothing else of an answer.
    this.set(`${at}id`, isPractice ? `${question.id}-practice` : question.id);
    this.set(`${at}type`, this.isOld ? "performance" : "other");
    if (this.isOld) {
      this.set(`${at}time`, `${two(now.getHours())}:${two(now.getMinutes())}:${two(now.getSeconds())}`);
      this.set(`${at}student_response`, given);
    } else {
      // SCORM has the zone behind a fraction of the second alone, of two digits at most.
      this.set(`${at}timestamp`, now.toISOString().replace(/(\.\d\d)\d/, "$1"));
      this.set(`${at}learner_response`, given);
      this.set(`${at}description`, question.title.slice(0, 250));
    }
    this.set(`${at}result`, judged(score, this.isOld));
    this.set(`${at}latency`, span(seconds, this.isOld));
  }
}

/**
 * Begins a visit. Returns null if there is no course system.
 * @returns {Promise<import("./course.js").System | null>}
 */
export async function connect() {
  const api = find(VERSIONS[LESSON.system].api);
  if (!api) {
    return null;
  }

  const visit = new Visit(api);
  if (!visit.begin()) {
    return { mode: "ended", kept: "", back: null, answered: () => true, keep: () => {}, end: () => {} };
  }

  const { names } = visit;
  const told = visit.get(names.mode);
  const mode = told === "browse" || told === "review" ? told : "normal";
  const kept = visit.get("cmi.suspend_data");

  // Systems begin with "not attempted" or "unknown". What an earlier visit has reached stays.
  if (mode === "normal" && !["completed", "passed", "failed"].includes(visit.get(names.completion))) {
    visit.set(names.completion, "incomplete");
  }

  let isReported = mode === "normal";
  let isOver = false;
  /** @param {import("./course.js").Report} report @param {import("./course.js").Answer | null} answer */
  const take = (report, answer) => {
    if (!isReported) {
      return true;
    }
    if (answer) {
      visit.list(answer);
    }
    visit.report(report);
    return visit.commit();
  };

  return {
    mode,
    kept,
    back: null,
    answered: take,
    keep: (report) => take(report, null),
    end: (report) => {
      if (isOver) {
        return;
      }
      if (isReported) {
        visit.report(report);
        // Also when all is done: without it systems forget what was kept, and a learner who comes back begins anew.
        visit.set(names.exit, "suspend");
        visit.commit();
      }
      [isReported, isOver] = [false, true];
      visit.end();
    },
  };
}
