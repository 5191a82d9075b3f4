// @ts-check
// The page of a lesson in a course system: the program in a frame, which reports each answer, and above it how far the learner
// is. `record.js` counts, `scorm.js` and `cmi5.js` speak with the system.

import { LESSON } from "./lesson.js";
import { makeRecord } from "./record.js";

/** The version of the messages with the frame. */
const VERSION = 1;
/** No lesson needs a higher frame than this, in pixels. */
const HIGHEST = 3_000;

/**
 * How far the learner is.
 * @typedef {{ place: string, text: string, done: number, count: number, score: number }} Report
 */

/**
 * A question that was done now, and how long it took.
 * @typedef {{ result: import("./record.js").Result, seconds: number }} Answer
 */

/**
 * A course system.
 * @typedef {object} System
 * @property {string} mode normal, browse, review, or ended if it takes nothing more
 * @property {string} kept what it has kept of the last visit
 * @property {string | null} back the address to go to at the end
 * @property {string} [languages] those that the learner has chosen there
 * @property {(report: Report, answer: Answer | null) => boolean} answered takes an answer; returns whether it did
 * @property {(report: Report) => void} keep keeps where the learner is
 * @property {(report: Report) => void} end ends the visit
 */

const ENGLISH = {
  some: "{done} of {count} questions answered",
  all: "All {count} questions are answered.",
  none: "This page was not opened by a course system, so that nothing is reported.",
  browse: "This is a preview: nothing is reported.",
  review: "This is a review: nothing is reported.",
  ended: "The course takes no more answers of this visit. Open the lesson from the course again.",
  lost: "The course system has not taken the last answer.",
  failed: "The lesson does not run: {reason}",
  refused: "The course system does not answer, so that nothing is reported: {reason}",
  open: "Next open question",
  return: "Back to the lesson",
  finish: "Finish",
};
const GERMAN = {
  some: "{done} von {count} Fragen beantwortet",
  all: "Alle {count} Fragen sind beantwortet.",
  none: "Diese Seite wurde nicht von einem Kurssystem geöffnet, deshalb wird nichts gemeldet.",
  browse: "Das ist eine Vorschau: Es wird nichts gemeldet.",
  review: "Das ist eine Durchsicht: Es wird nichts gemeldet.",
  ended: "Der Kurs nimmt von diesem Besuch keine Antworten mehr an. Öffne die Lektion im Kurs noch einmal.",
  lost: "Das Kurssystem hat die letzte Antwort nicht angenommen.",
  failed: "Die Lektion läuft nicht: {reason}",
  refused: "Das Kurssystem antwortet nicht, deshalb wird nichts gemeldet: {reason}",
  open: "Nächste offene Frage",
  return: "Zurück zur Lektion",
  finish: "Beenden",
};

const frame = /** @type {HTMLIFrameElement} */ (document.getElementById("tilescope"));
const progress = /** @type {HTMLElement} */ (document.getElementById("progress"));
const notice = /** @type {HTMLElement} */ (document.getElementById("notice"));
const onward = /** @type {HTMLButtonElement} */ (document.getElementById("onward"));
const finish = /** @type {HTMLButtonElement} */ (document.getElementById("finish"));

let language = LESSON.language;
/** The notice that is shown, by its key, with what fills it. @type {[keyof typeof ENGLISH, string] | null} */
let said = null;
/** What the frame shows of the lesson; null before that, and if the learner has closed the lesson. @type {any} */
let shown = null;
/** Whether the frame has shown the lesson. */
let hasBegun = false;
/** When the step that is shown came. */
let since = Date.now();
/** The answers that were put together last, in words, by question. @type {Map<string, string>} */
const drafts = new Map();

/** @param {keyof typeof ENGLISH} key @param {Record<string, string | number>} parts */
function words(key, parts = {}) {
  const table = language === "de" ? GERMAN : ENGLISH;
  return table[key].replace(/\{(\w+)\}/g, (_, name) => String(parts[name] ?? ""));
}

/** @param {any} spans @returns {string} */
const plain = (spans) => (typeof spans === "string" ? spans : spans.map((/** @type {any} */ span) => span.text).join(""));

/** Returns the answer that is put together in a question, in words. @param {any} question @returns {string} */
function inWords(question) {
  const chosen = question.controls.flatMap((/** @type {any} */ control) => {
    const rows = control.rows ?? [];
    const words = rows.map((/** @type {any} */ row) => [row.name, row.words.find((/** @type {any} */ word) => word.chosen)?.text]);
    const items = (control.items ?? []).filter((/** @type {any} */ item) => item.chosen).map((/** @type {any} */ item) => plain(item.text));
    return [...items, ...words.filter((/** @type {any} */ pair) => pair[1]).map((/** @type {any} */ pair) => pair.filter(Boolean).join(" "))];
  });
  if (chosen.length > 0) {
    return chosen.join(", ");
  }

  // What is typed, and places and lines on the canvas, stand in no list.
  const changes = question.draft.map((/** @type {any} */ change) => change.type ?? Object.values(change));
  return changes.flat(2).join(", ");
}

/** Sends a request to the frame. @param {object} request */
function ask(request) {
  // The frame is of this page's origin, whatever it shows meanwhile.
  frame.contentWindow?.postMessage({ tilescope: VERSION, id: 0, ...request }, location.origin);
}

/** Shows how far the learner is, and where a button leads. @param {ReturnType<typeof makeRecord>} record */
function show(record) {
  document.documentElement.lang = language;
  const [done, count] = [record.done(), record.count()];
  progress.textContent = words(record.isComplete() ? "all" : "some", { done, count });
  notice.textContent = said ? words(said[0], { reason: said[1] }) : "";
  notice.hidden = said === null;
  finish.textContent = words("finish");

  const isAway = shown?.lesson !== LESSON.name;
  const open = record.open(record.place());
  // A learner at an open question is not invited to pass over it.
  const isAsked = !isAway && shown?.question?.open;
  onward.hidden = !hasBegun || isAsked || (!isAway && !open);
  onward.textContent = words(isAway ? "return" : "open");
  onward.onclick = () => {
    const step = isAway ? record.place() : open?.step;
    ask(isAway ? { do: "lesson", open: LESSON.name, step } : { do: "lesson", go: step });
  };
}

/** Returns the language to begin with: that of the course system if the package has it, or the package's own. @param {string} wanted */
function firstLanguage(wanted) {
  const names = wanted.split(",").map((name) => name.trim().slice(0, 2).toLowerCase());
  return names.find((name) => LESSON.languages.includes(name)) ?? LESSON.language;
}

/** Opens the course system; without one, the page shows the lesson and reports nothing. @returns {Promise<System | null>} */
async function connected(/** @type {(isTaken: boolean) => void} */ tell) {
  try {
    const { connect } = await import(LESSON.system === "cmi5" ? "./cmi5.js" : "./scorm.js");
    return await connect(tell);
  } catch (error) {
    said = ["refused", error instanceof Error ? error.message : String(error)];
    return null;
  }
}

/** Follows the state of the frame. @param {any} lesson @param {ReturnType<typeof makeRecord>} record @returns {boolean} whether another step is shown */
function follow(lesson, record) {
  const before = shown;
  shown = lesson;
  if (lesson?.lesson !== LESSON.name) {
    return false;
  }

  hasBegun = true;
  language = LESSON.languages.includes(lesson.language) ? lesson.language : "en";
  const { question } = lesson;
  if (question?.open) {
    const given = inWords(question);
    if (given) {
      drafts.set(question.name, given);
    }
  }

  if (before?.lesson === lesson.lesson && before.step === lesson.step) {
    return false;
  }
  since = Date.now();
  record.go(lesson.step);
  return true;
}

/** Follows the frame and the page's own end, and reports to the course system. */
class Course {
  /** @param {System | null} system @param {ReturnType<typeof makeRecord>} record */
  constructor(system, record) {
    this.system = system;
    this.record = record;
  }

  /** @returns {Report} */
  #report() {
    const { record } = this;
    return { place: record.place(), text: record.text(), done: record.done(), count: record.count(), score: record.score() };
  }

  /** Takes an answer that the frame reports. @param {import("./record.js").Answered & { lesson: string }} answered */
  #take(answered) {
    if (answered.lesson !== LESSON.name) {
      return;
    }

    // After the last answer the program may show what comes next already.
    const question = shown?.question;
    const given = (question?.name === answered.gate && inWords(question)) || (drafts.get(answered.gate) ?? "");
    drafts.delete(answered.gate);

    const result = this.record.take(answered, given);
    const answer = result && { result, seconds: Math.round((Date.now() - since) / 1000) };
    // A tried answer is kept as well, so that a page that is loaded again is no second first try.
    const isTaken = this.system?.answered(this.#report(), answer) ?? true;
    if (!isTaken) {
      said = ["lost", ""];
    }
  }

  /** Takes a message of the frame. @param {any} data */
  receive(data) {
    switch (data.event) {
      case "answered":
        this.#take(data);
        break;
      case "failed":
        said = ["failed", String(data.error)];
        break;
      case "height":
        frame.style.minHeight = `${Math.min(data.height, HIGHEST)}px`;
        return;
      case "state": {
        const isLight = ["light", "projector"].includes(data.state.view.look);
        document.documentElement.dataset.look = isLight ? "light" : "dark";
        if (follow(data.state.lesson, this.record)) {
          this.keep();
        }
        break;
      }
      default:
        return;
    }
    show(this.record);
  }

  /** Keeps where the learner is. */
  keep() {
    this.system?.keep(this.#report());
  }

  /** Ends the visit. */
  end() {
    this.system?.end(this.#report());
  }
}

async function main() {
  /** @type {Course | undefined} */
  let course;
  // A course system may take later what it has not taken at once.
  const tell = (/** @type {boolean} */ isTaken) => {
    const isLost = said?.[0] === "lost";
    if (isTaken === isLost) {
      said = isTaken ? null : ["lost", ""];
      course && show(course.record);
    }
  };

  const system = await connected(tell);
  if (!system) {
    said ??= ["none", ""];
  } else if (system.mode !== "normal") {
    said = [/** @type {keyof typeof ENGLISH} */ (system.mode), ""];
  }
  const record = makeRecord(LESSON.questions, LESSON.hash, system?.kept ?? "");
  course = new Course(system, record);

  window.addEventListener("message", ({ source, origin, data }) => {
    if (source === frame.contentWindow && origin === location.origin && data?.tilescope === VERSION) {
      course.receive(data);
    }
  });

  // Browsers may end a hidden page without notice, so that what is there is kept at once.
  document.addEventListener("visibilitychange", () => document.hidden && course.keep());
  window.addEventListener("pagehide", () => course.end());
  // A page that comes back from the browser's memory belongs to a visit that has ended.
  window.addEventListener("pageshow", ({ persisted }) => persisted && location.reload());

  finish.hidden = !system?.back;
  finish.addEventListener("click", () => {
    course.end();
    location.assign(String(system?.back));
  });

  language = firstLanguage(system?.languages ?? "");
  const link = new URLSearchParams({ lesson: LESSON.name, language });
  if (record.place()) {
    link.set("step", record.place());
  }
  show(record);
  frame.src = `program/index.html?embed=player#${link}`;
}

main();
