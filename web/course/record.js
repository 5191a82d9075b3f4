// @ts-check
// What a learner has done of a package's questions, and the score that counts. It does not depend on the course system.

/** A score above this is full marks: scores are sums of fractions, which are rounded. */
const FULL_MARKS = 0.999;
/** The version of the text that a course system keeps. */
const VERSION = 1;

/**
 * A question of the package, as the command wrote it.
 * @typedef {object} Question
 * @property {string} gate its name in the lesson
 * @property {string} id its name for course systems: letters, digits and hyphens
 * @property {string} step the name of its step
 * @property {string} title the title of its step
 * @property {number} seed the seed of its own run, not of practice
 * @property {boolean} traced whether it asks about one event after the other
 */

/**
 * An answer, as the program reports it to the page around its frame.
 * @typedef {{ gate: string, seed: number, score: number, tries: number, done: boolean, given_up: boolean }} Answered
 */

/**
 * The first answers to a question: one, or one for each event.
 * @typedef {object} Attempt
 * @property {number[]} marks their scores
 * @property {string[]} given the answers in words, those of this visit
 * @property {number} at the event that is asked about
 */

/**
 * A question that is done.
 * @typedef {object} Result
 * @property {Question} question
 * @property {boolean} isPractice whether its run was another one than the lesson's
 * @property {number} score that of the first answers, from 0 to 1
 * @property {string} given the first answers in words
 */

/** @param {number} number */
const rounded = (number) => Math.round(number * 10_000) / 10_000;

/** @param {number[]} numbers */
const mean = (numbers) => (numbers.length === 0 ? 0 : numbers.reduce((sum, number) => sum + number, 0) / numbers.length);

/**
 * Counts an answer. Returns the score of the question once it is done.
 * @param {Attempt} attempt
 * @param {Answered} answered
 * @param {string} given the answer in words
 * @param {boolean} traced
 */
function count(attempt, { score, tries, done, given_up }, given, traced) {
  // The question is asked anew, from its first event.
  if (tries <= 1) {
    attempt.at = 0;
  }

  if (!given_up) {
    // Only the first answer to an event counts. Earlier visits may have given it already.
    if (attempt.marks.length === attempt.at) {
      attempt.marks.push(rounded(score));
      attempt.given.push(given);
    }
    attempt.at += score > FULL_MARKS ? 1 : 0;
  }

  if (!done) {
    return null;
  }
  // As in the program's own results: a trace that is given up has no score, another question that of its first answer.
  return traced && given_up ? 0 : rounded(mean(attempt.marks));
}

/**
 * Makes the record of a learner. `kept` is the text of an earlier visit, or empty.
 * @param {Question[]} questions
 * @param {string} version of the lesson: what was kept of another one does not count
 * @param {string} kept
 */
export function makeRecord(questions, version, kept) {
  const gates = new Map(questions.map((question) => [question.gate, question]));
  /** @type {Map<string, number>} */
  const scores = new Map();
  /** @type {Map<string, Attempt>} */
  const begun = new Map();
  /** @type {Map<string, Attempt & { seed: number }>} */
  const practised = new Map();
  let place = "";

  /** @param {any} read */
  const take = (read) => {
    place = String(read.at ?? "");
    if (read.version !== VERSION || read.of !== version) {
      return;
    }
    for (const [gate, value] of Object.entries(read.done ?? {})) {
      if (gates.has(gate) && value >= 0 && value <= 1) {
        scores.set(gate, value);
      }
    }
    for (const [gate, marks] of Object.entries(read.begun ?? {})) {
      if (gates.has(gate) && Array.isArray(marks)) {
        begun.set(gate, { marks: marks.map(Number), given: [], at: 0 });
      }
    }
  };

  try {
    take(JSON.parse(kept || "{}"));
  } catch {
    // Another program's text, or one that was cut off: the lesson begins anew.
  }

  /** The attempt that an answer belongs to. @param {Answered} answered @param {boolean} isPractice @returns {Attempt} */
  const attemptOf = ({ gate, seed }, isPractice) => {
    const attempt = isPractice ? practised.get(gate) : begun.get(gate);
    if (attempt && (!isPractice || practised.get(gate)?.seed === seed)) {
      return attempt;
    }

    const made = { seed, marks: [], given: [], at: 0 };
    (isPractice ? practised : begun).set(gate, made);
    return made;
  };

  return {
    /** The step where the learner was; empty at the first visit. */
    place: () => place,
    /** @param {string} step */
    go: (step) => {
      place = step;
    },

    /**
     * Takes an answer. Returns the question's result if it is done and counts.
     * @param {Answered} answered
     * @param {string} given the answer in words
     * @returns {Result | null}
     */
    take: (answered, given) => {
      const question = gates.get(answered.gate);
      if (!question) {
        return null;
      }

      const isPractice = answered.seed !== question.seed;
      // The answer was shown, so that asking for it again measures nothing. Another run is a new question.
      if (!isPractice && scores.has(question.gate)) {
        return null;
      }

      const attempt = attemptOf(answered, isPractice);
      const score = count(attempt, answered, given, question.traced);
      if (score === null) {
        return null;
      }

      (isPractice ? practised : begun).delete(question.gate);
      // Practice improves a score, and never lowers it: otherwise nobody would practise.
      if (!isPractice || score > (scores.get(question.gate) ?? 0)) {
        scores.set(question.gate, score);
      }
      return { question, isPractice, score, given: attempt.given.filter(Boolean).join("; ") };
    },

    /** How many questions are done. */
    done: () => scores.size,
    /** How many there are. */
    count: () => questions.length,
    /** Whether all are done. */
    isComplete: () => scores.size === questions.length,
    /** The first question behind a step that is not done, or the first one of all. @param {string} step */
    open: (step) => {
      const behind = questions.findIndex((question) => question.step === step) + 1;
      const all = [...questions.slice(behind), ...questions.slice(0, behind)];
      return all.find(({ gate, step: own }) => !scores.has(gate) && own !== step) ?? null;
    },
    /** The mean score of all questions, those that are not done with 0. */
    score: () => rounded([...scores.values()].reduce((sum, score) => sum + score, 0) / Math.max(questions.length, 1)),

    /** What a course system keeps until the next visit: in SCORM 1.2 at most 4,096 characters, of which 40 questions take half. */
    text: () => {
      const open = [...begun].filter(([gate]) => !scores.has(gate));
      return JSON.stringify({
        version: VERSION,
        of: version,
        at: place,
        done: Object.fromEntries(scores),
        begun: Object.fromEntries(open.map(([gate, { marks }]) => [gate, marks])),
      });
    },
  };
}
