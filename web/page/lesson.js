// @ts-check The lesson beside the canvas, as elements of the page: headings, buttons, a live region. All texts are set
// as text, never as HTML. The program holds the lesson; this module shows its state (`lesson`) and sends the learner's
// actions.

import { element } from "./{{asset:sheets.js}}";

const SVG = "http://www.w3.org/2000/svg";
/** The highest frequency in 1/r and the highest power that plots show, and their size. */
const REACH = { frequency: 3, power: 3, width: 320, height: 80 };
/** The elements of styles in texts. */
const STYLES = { plain: "span", emphasis: "em", strong: "strong", code: "code" };

/** @typedef {Array<{ text: string, style: keyof typeof STYLES }>} Spans */

/** @type {(request: object) => void} */
let send = () => {};
/** The content of each part, as JSON, so that only changed parts are made again. @type {Map<string, string>} */
const shown = new Map();
/** @type {Record<string, string>} */
let words = {};

/**
 * Makes an element. `id` lets the focus return to it when it is made again.
 * @param {string} tag
 * @param {Record<string, any>} settings
 * @param {(Node | string)[]} children
 */
function make(tag, settings = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(settings)) {
    if (name === "onclick" || name === "oninput" || name === "onkeydown" || name === "onchange") {
      made.addEventListener(name.slice(2), value);
    } else if (value !== undefined && value !== null && value !== false) {
      made.setAttribute(name, value === true ? "" : String(value));
    }
  }
  made.append(...children);
  return made;
}

/** @param {Spans} spans @returns {Node[]} */
function set(spans) {
  return spans.map(({ text, style }) => (style === "plain" ? document.createTextNode(text) : make(STYLES[style], {}, text)));
}

/** @param {string} id @param {string | Node[]} name @param {() => void} onclick @param {Record<string, any>} more */
function button(id, name, onclick, more = {}) {
  return make("button", { type: "button", id, onclick, ...more }, ...(typeof name === "string" ? [name] : name));
}

/** Paragraphs; those that begin with a dash are items of lists. @param {Spans[]} paragraphs */
function paragraphs(paragraphs) {
  /** @type {HTMLElement[]} */
  const made = [];

  for (const spans of paragraphs) {
    if (!spans[0]?.text.startsWith("- ")) {
      made.push(make("p", {}, ...set(spans)));
      continue;
    }

    let list = made.at(-1);
    if (list?.tagName !== "UL") {
      list = make("ul");
      made.push(list);
    }
    list.append(make("li", {}, ...set([{ ...spans[0], text: spans[0].text.slice(2) }, ...spans.slice(1)])));
  }

  return made;
}

/** A plot of spectra. @param {[number, number][][]} curves */
function plot(curves) {
  const { frequency, power, width, height } = REACH;
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", `0 0 ${width} ${height + 14}`);
  svg.setAttribute("aria-hidden", "true");

  const place = (/** @type {number} */ x, /** @type {number} */ y) =>
    `${((x / frequency) * width).toFixed(1)},${(height * (1 - Math.min(y / power, 1))).toFixed(1)}`;
  const line = (/** @type {string} */ points, /** @type {string} */ name) => {
    const made = document.createElementNS(SVG, "polyline");
    made.setAttribute("points", points);
    made.setAttribute("class", name);
    svg.append(made);
  };

  // A power of 1 is that of independent random samples.
  line(`${place(0, 0)} ${place(frequency, 0)}`, "axis");
  line(`${place(0, 1)} ${place(frequency, 1)}`, "axis");

  for (const tick of [0.5, 1, 1.5, 2, 2.5]) {
    const label = document.createElementNS(SVG, "text");
    label.setAttribute("x", String((tick / frequency) * width));
    label.setAttribute("y", String(height + 12));
    const number = decimals(tick, tick % 1 === 0 ? 0 : 1);
    label.textContent = tick === 2.5 ? `${number} / r` : number;
    svg.append(label);
  }

  curves.forEach((curve, index) => {
    const inside = curve.filter(([x]) => x <= frequency);
    line(inside.map(([x, y]) => place(x, y)).join(" "), `curve-${index}`);
  });

  return svg;
}

/** Returns a number with so many decimals, as the language of the lesson writes it. @param {number} number @param {number} digits */
function decimals(number, digits) {
  return number.toLocaleString(element("lesson").lang, { minimumFractionDigits: digits, maximumFractionDigits: digits, useGrouping: false });
}

/** Gives up to nine elements the keys 1 to 9. @param {HTMLElement[]} elements */
function keyed(elements) {
  elements.slice(0, 9).forEach((made, index) => made.setAttribute("data-key", String(index + 1)));
  return elements;
}

const draft = (/** @type {object} */ change) => send({ do: "answer", draft: change });

/** The elements of a control with which a learner answers. @param {any} control @param {any} question @returns {Node[]} */
function answers(control, question) {
  const disabled = !question.open;
  const choice = (/** @type {any} */ { id, chosen, change }, /** @type {string | Node[]} */ name, /** @type {string} */ look) =>
    button(`lesson-${id}`, name, () => draft(change), { class: look, disabled, "aria-pressed": String(chosen) });

  switch (control.control) {
    case "line":
      return [make("p", { class: "small" }, control.text)];

    case "list": {
      const items = control.items.map((/** @type {any} */ item) => {
        const mark = item.mark === null ? [] : [make("b", {}, `${item.mark} `)];
        return choice(item, [...mark, ...set(item.text)], "option");
      });
      keyed(items);
      return items.flatMap((/** @type {HTMLElement} */ made, /** @type {number} */ index) => {
        const { curve } = control.items[index];
        return curve ? [made, plot([curve])] : [made];
      });
    }

    case "chips": {
      const items = control.items.map((/** @type {any} */ item) => choice(item, set(item.text), "chip"));
      return [make("div", { class: "chips" }, ...keyed(items))];
    }

    case "rows":
      return control.rows.map((/** @type {any} */ row) => {
        const made = row.words.map((/** @type {any} */ word) => choice(word, word.text, "chip"));
        return row.name === null
          ? make("div", { class: "chips" }, ...made)
          : make("div", { class: "row", role: "group", "aria-label": row.name }, make("span", { class: "band" }, row.name), ...made);
      });

    case "field": {
      const field = make("input", {
        id: "lesson-number",
        type: "text",
        inputmode: "decimal",
        autocomplete: "off",
        maxlength: 40,
        disabled,
        "aria-label": control.unit ? `${control.label} (${control.unit})` : control.label,
        oninput: (/** @type {any} */ event) => draft({ type: event.target.value }),
        onkeydown: (/** @type {KeyboardEvent} */ event) => event.key === "Enter" && send({ do: "answer" }),
      });

      // A panel that is made again gets the text back from the program.
      const typed = question.draft.find((/** @type {any} */ change) => "type" in change);
      /** @type {HTMLInputElement} */ (field).value = typed?.type ?? "";
      return [make("div", { class: "row" }, field, make("span", {}, control.unit))];
    }

    case "plot":
      return [plot(control.curves)];
    default:
      return [];
  }
}

/** The list of lessons and the learner's results. @param {any} list */
function listed(list) {
  const entry = (/** @type {any} */ lesson, /** @type {number} */ index) => {
    // The first lesson and the forms have no number.
    const number = make("span", {}, index === 0 || lesson.form ? "" : `${index}. `);
    const title = make("span", {}, lesson.title);
    const done = lesson.done > 0 ? ` \u2013 ${lesson.done} ${words.of} ${lesson.gates} ${words.answered}` : "";

    // The blank does not break, so that no line begins with "min)".
    const objective = `${lesson.objective} (${lesson.minutes}\u00a0min)${done}`;
    return make(
      "li",
      {},
      button(`lesson-open-${lesson.name}`, [number, title], () => send({ do: "lesson", open: lesson.name }), { class: "link" }),
      make("p", { class: "small" }, objective),
    );
  };

  const entries = list.lessons.filter((/** @type {any} */ lesson) => !lesson.form).map(entry);
  const forms = list.lessons.filter((/** @type {any} */ lesson) => lesson.form).map(entry);
  const share = list.share.toLocaleString(element("lesson").lang, { style: "percent" });
  const results = list.answered === 0 ? words.no_results : words.some_results.replace("{count}", list.answered).replace("{share}", share);

  const made = [
    make("p", {}, words.intro),
    ...(entries.length ? [make("ol", { class: "lessons" }, ...entries)] : [make("p", {}, "\u2026")]),
    button("lesson-tour", words.tour, () => send({ do: "lesson", act: "tour" }), { class: "quiet" }),
    make("p", { class: "small" }, words.own),
    ...(forms.length ? [make("h2", {}, words.forms), make("p", {}, words.forms_intro), make("ol", { class: "lessons" }, ...forms)] : []),
    make("h2", {}, words.results),
    make("p", { class: "small" }, results),
  ];

  // The votes of a class are saved too.
  if (list.answered > 0 || list.votes > 0) {
    const field = make("input", {
      id: "lesson-learner",
      type: "text",
      maxlength: 80,
      onchange: (/** @type {any} */ event) => send({ do: "lesson", learner: event.target.value }),
    });
    /** @type {HTMLInputElement} */ (field).value = list.learner;

    const clear = button("lesson-clear", words.clear, () => send({ do: "lesson", act: "clear" }), { class: "quiet" });
    const save = (/** @type {string} */ format, /** @type {string} */ name) =>
      button(`lesson-save-${format}`, name, () => send({ do: "lesson", save: format }), { class: "quiet" });
    made.push(
      make("label", { class: "row" }, `${words.name} `, field),
      make(
        "div",
        { class: "row" },
        save("json", `${words.save} JSON`),
        save("csv", "CSV"),
        save("xapi", "xAPI"),
        ...(list.asked_to_clear ? [] : [clear]),
      ),
    );

    if (list.asked_to_clear) {
      made.push(
        make("p", { role: "alert" }, words.clear_all),
        make("div", { class: "row" }, clear, button("lesson-keep", words.keep, () => send({ do: "lesson", act: "keep" }), { class: "quiet" })),
      );
    }
  }

  return made;
}

/** Makes a part again if its content or the language has changed. @param {string} part @param {any} value @param {() => Node[]} content */
function renew(part, value, content) {
  // The language's own words tell whether it has changed: its table may arrive after the list is shown.
  const json = JSON.stringify([value ?? null, words.other_language]);
  if (shown.get(part) === json) {
    return;
  }

  shown.set(part, json);
  const place = element(`lesson-${part}`);
  const focused = document.activeElement instanceof HTMLElement && place.contains(document.activeElement) ? document.activeElement.id : "";

  place.replaceChildren(...content());
  if (focused) {
    const again = document.getElementById(focused);
    // The element with the focus may be gone, as "Answer" is once the question is answered; the focus then stays in the
    // part.
    (again && !again.hasAttribute("disabled") ? again : place).focus({ preventScroll: true });
  }
}

/** The key of the answer that is being put together, in the store of this tab. */
const DRAFT = "draft";

/** The question of a lesson's step. @param {any} lesson */
const questionOf = ({ lesson, step, practice, question }) => JSON.stringify([lesson, step, practice, question.at]);

/** The answer that waits for its question, which may come after its run is made. @type { { of: string, made: object[] } | null} */
let waiting = null;

/** Keeps the answer that is being put together, as the page or its display may be lost. @param {any} lesson */
function keepDraft(lesson) {
  if (!lesson.question?.open) {
    return;
  }

  const of = questionOf(lesson);
  const lost = waiting;
  waiting = null;
  if (lost?.of === of) {
    // Deferred: the program calls this while its state is borrowed.
    setTimeout(() => lost.made.forEach((change) => draft(change)));
    return;
  }

  try {
    sessionStorage.setItem(DRAFT, JSON.stringify({ of, made: lesson.question.draft }));
  } catch {
    // The browser denies the store; the answer is then kept nowhere.
  }
}

/** Puts together again the answer that was lost with the page or its display, once its question is shown. */
export function restoreDraft() {
  try {
    waiting = JSON.parse(sessionStorage.getItem(DRAFT) ?? "null");
  } catch {
    waiting = null;
  }
}

/** Shows the state of the lesson, which is null if none is open. @param {any} lesson */
export function showLesson(lesson) {
  const panel = element("lesson");
  const root = document.documentElement;
  panel.hidden = !lesson;
  root.toggleAttribute("data-lesson", Boolean(lesson));

  if (!lesson) {
    shown.clear();
    return;
  }

  words = lesson.labels;
  panel.lang = lesson.language || "en";
  // What the author wrote may be in another language than the words around it.
  for (const part of ["steps", "text", "question"]) {
    element(`lesson-${part}`).lang = lesson.text_language;
  }

  const { list, question } = lesson;
  renew("head", list ? 0 : lesson.title, () => head(lesson));
  renew("steps", [lesson.steps, lesson.index], () => (list ? [] : steps(lesson)));
  renew("text", list ? [list] : [lesson.heading, lesson.text, lesson.fault, lesson.waits], () => (list ? listed(list) : text(lesson)));

  // What is typed stands in the field already, which would lose its cursor if it were made again.
  const { draft: _, ...asked } = question ?? {};
  renew("question", [lesson.step, list ? 0 : question && asked], () => (list || !question ? [] : asks(question)));

  renew("feedback", [lesson.lacking, lesson.verdict, lesson.sentence, lesson.answers, list ? 0 : 1], () => (list ? [] : feedback(lesson)));
  const { tries: __, controls: ___, ...state } = asked;
  renew("actions", [lesson.step, lesson.hint, lesson.asked_to_give_up, lesson.after, list ? 0 : state], () => (list || !question ? [] : actions(lesson)));
  renew("walk", [lesson.index, lesson.may_go_on, list ? 0 : 1], () => (list ? [] : walk(lesson)));

  keepDraft(lesson);
}

/** @param {any} lesson */
function head(lesson) {
  const other = lesson.next_language;
  const list = make("div", { class: "row" });

  if (!lesson.list) {

    list.append(button("lesson-list", words.lessons, () => send({ do: "lesson", act: "list" }), { class: "quiet" }));
    if (!new URLSearchParams(location.search).has("embed")) {
      list.append(button("lesson-present", words.present, () => send({ do: "lesson", act: "present" }), { class: "quiet" }));
    }
  }
  list.append(
    button("lesson-language", words.other_language, () => send({ do: "lesson", language: other }), { class: "quiet", lang: other }),
    button("lesson-close", "\u00d7", () => send({ do: "lesson", act: lesson.list ? "list" : "leave" }), {
      class: "quiet",
      "aria-label": lesson.list ? words.close_list : words.close,
    }),
  );

  return [lesson.list ? make("h2", {}, words.lessons) : make("span", { class: "small" }, lesson.title), list];
}

/** @param {any} lesson */
function steps(lesson) {
  return lesson.steps.map((/** @type {any} */ step, /** @type {number} */ index) =>
    button(`lesson-step-${index}`, String(index + 1), () => send({ do: "lesson", go: step.name }), {
      class: "step",
      "aria-label": `${words.step} ${index + 1}: ${step.title}`,
      "aria-current": index === lesson.index ? "step" : null,
      "data-score": step.score === null ? null : step.score > 0.999 ? "right" : "partly",
      title: step.title,
    }),
  );
}

/** @param {any} lesson */
function text(lesson) {
  const made = [make("h2", { id: "lesson-heading", tabindex: -1 }, lesson.heading), ...paragraphs(lesson.text)];
  if (lesson.fault) {
    made.push(make("p", { class: "fault" }, `${words.cannot_show} ${lesson.fault}`));
  } else if (lesson.waits) {
    made.push(make("p", { class: "small" }, words.makes_run));
  }
  return made;
}

/** @param {any} question */
function asks(question) {
  const at = question.steps ? [make("p", { class: "small" }, `${words.step} ${question.at} ${words.of} ${question.steps}`)] : [];
  const asked = make("h3", { id: "lesson-ask" }, ...set(question.ask));
  const controls = question.controls.flatMap((/** @type {any} */ control) => answers(control, question));
  const group = make("div", { role: "group", "aria-labelledby": "lesson-ask" }, ...controls);

  // Above the feedback, whose coming and going would else move the button from under the pointer.
  const answer = question.open ? [button("lesson-answer", words.answer, () => send({ do: "answer" }), { class: "whole" })] : [];
  return [...at, asked, group, ...answer];
}

/** @param {any} lesson */
function feedback({ lacking, verdict, sentence }) {
  const made = [];
  if (lacking) {
    made.push(make("p", {}, lacking));
  }
  if (verdict) {
    made.push(make("p", {}, make("strong", {}, verdict)));
  }
  if (sentence) {
    made.push(make("p", {}, ...set(sentence)));
  }
  return made;
}

/** @param {any} lesson */
function actions({ question, form, hint, asked_to_give_up, after, reasons }) {
  if (question.open) {
    const row = make("div", { class: "row" });
    if (question.hint) {
      row.append(button("lesson-hint", words.hint, () => send({ do: "lesson", act: "hint" }), { class: "quiet" }));
    }

    // The second press shows the answer, or goes on in a form.
    const sure = form ? words.skip : words.show_answer;
    const give_up = asked_to_give_up ? sure : words.give_up;
    row.append(button("lesson-give-up", give_up, () => send({ do: "lesson", act: "give-up" }), { class: "quiet" }));
    if (asked_to_give_up) {
      row.append(make("span", { class: "small" }, words.sure));
    }

    const said = hint ? [make("p", { class: "small", role: "status" }, ...set(hint))] : [];
    return [row, ...said];
  }

  const made = [];
  if (question.key) {
    made.push(make("p", {}, `${words.the_answer} ${question.key}`));
  }
  made.push(...paragraphs(after ?? []));
  if (reasons.length) {
    made.push(make("details", {}, make("summary", {}, words.why), make("ul", {}, ...reasons.map((/** @type {string} */ reason) => make("li", { class: "small" }, reason)))));
  }
  if (question.practice) {
    const again = () => send({ do: "lesson", act: "again", practice: Math.floor(Math.random() * 100_003) });
    made.push(button("lesson-again", words.again, again, { class: "quiet" }));
  }
  return made;
}

/** @param {any} lesson */
function walk(lesson) {
  const isLast = lesson.index + 1 === lesson.steps.length;
  const next = isLast
    ? button("lesson-more", words.more, () => send({ do: "lesson", act: "list" }), { class: "quiet" })
    : button("lesson-next", words.next, () => send({ do: "lesson", go: "next" }), {
        class: lesson.may_go_on ? null : "quiet",
        disabled: !lesson.may_go_on,
        title: lesson.may_go_on ? null : words.waits,
      });
  return [button("lesson-back", words.back, () => send({ do: "lesson", go: "back" }), { class: "quiet", disabled: lesson.index === 0 }), next];
}

/**
 * Returns how high a frame has to be so that the lesson in it is read without scrolling, in pixels; undefined without a lesson.
 * @returns {number | undefined}
 */
export function wishedHeight() {
  const panel = element("lesson");
  if (panel.hidden) {
    return undefined;
  }

  const { top, width } = panel.getBoundingClientRect();
  const ends = [...panel.children].map((part) => part.getBoundingClientRect().bottom);
  // Its border and padding stand around its parts.
  const text = Math.max(...ends) - top + panel.scrollTop + 17;
  // Below the canvas a frame gives it 46% of the height, and all but 480 pixels where that is more (style.css).
  const isBelow = width === innerWidth;
  return Math.ceil(isBelow ? Math.min(text / 0.46, text + 480) : Math.max(text, 480));
}

/**
 * Connects the panel to the program. Digits choose answers; PageDown and PageUp go on and back.
 * @param {(request: object) => any} ask
 */
export function connectLesson(ask) {
  send = (request) => {
    const step = shown.get("walk");
    const { ok, lesson, error } = ask(request);

    if (!ok) {
      element("lesson-feedback").replaceChildren(make("p", {}, error));
      return;
    }

    showLesson(lesson);
    if (request.do === "answer" && !request.draft) {
      // On a phone the verdict would be below what is seen of the panel.
      element("lesson-feedback").scrollIntoView({ block: "nearest" });
    }
    // A new step begins at its heading: it scrolls there and moves the focus.
    if (lesson && shown.get("walk") !== step && "go" in request) {
      element("lesson").scrollTop = 0;
      document.getElementById("lesson-heading")?.focus({ preventScroll: true });
    }
  };

  element("lesson").addEventListener("keydown", (event) => {
    const isText = event.target instanceof HTMLInputElement;
    if (event.ctrlKey || event.metaKey || event.altKey || (isText && event.key.length === 1)) {
      return;
    }

    const to = { PageDown: "lesson-next", PageUp: "lesson-back" }[event.key];
    const chosen = to ? document.getElementById(to) : element("lesson-question").querySelector(`[data-key="${CSS.escape(event.key)}"]`);
    if (chosen instanceof HTMLElement) {
      event.preventDefault();
      chosen.click();
    }
  });
}
