// @ts-check The lecturer's notes in a window of their own. The window with the stage sends their content over a channel
// with a random name; this module sends back the lecturer's commands. Either window may be closed and opened again.

import { english, wantedLanguage, wordsOf } from "./{{asset:words.js}}";

/** The stage counts as closed after so long without an answer. */
const SILENT_MS = 5_000;

/** @param {string} tag @param {Record<string, string>} settings @param {(Node | string)[]} children */
function make(tag, settings = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(settings)) {
    made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

/** @param {Array<{ text: string, style: string }>} spans */
function set(spans) {
  const tags = /** @type {Record<string, string>} */ ({ emphasis: "em", strong: "strong", code: "code" });
  return spans.map(({ text, style }) => (tags[style] ? make(tags[style], {}, text) : document.createTextNode(text)));
}

/** Minutes and seconds. @param {number} secs */
function minutes(secs) {
  const whole = Math.max(0, Math.floor(secs));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

const ADVICE = /** @type {Record<string, string>} */ ({
  explain: "Few are right: give the hint or explain, then vote again.",
  discuss: "Between 30% and 70% are right: let neighbours convince each other, then vote again.",
  "go-on": "Most are right: reveal, and go on.",
});

/** The keys of presenter mode, with their commands. */
const KEYS = /** @type {Record<string, any>} */ ({
  PageDown: "next",
  ArrowRight: "next",
  PageUp: "previous",
  ArrowLeft: "previous",
  b: "blank",
  ".": "blank",
  F5: "first",
  Escape: "end",
  l: { tool: "laser" },
  p: { tool: "pen" },
  c: "next-color",
  u: "undo-stroke",
  x: "clear-strokes",
  q: "toggle-code",
});

/** Shows the notes instead of the program. @param {string} name The name of the channel. */
export function showNotes(name) {
  const channel = new BroadcastChannel(name);
  const send = (/** @type {any} */ command) => channel.postMessage({ command });
  /** @type {any} */
  let talk = null;
  /** @type {any} The state from which a stage can be opened again, once there was a talk. */
  let kept = null;
  let heard_ms = performance.now();
  let typed = "";
  /** The texts of the notes, and their language: the talk's, once there was one. */
  let words = english;
  let language = "";

  const bar = make("p", { class: "bar" });
  const tools = make("p", { class: "tools" });
  const here = make("section");
  const vote = /** @type {HTMLInputElement} */ (make("input", { type: "text", autocomplete: "off" }));
  const votes = make("section");
  const next = make("section");
  const root = make("div", { id: "notes" }, bar, tools, make("div", { class: "halves" }, make("div", {}, here, vote, votes), next));
  document.querySelector("main")?.replaceChildren(root);

  vote.addEventListener("keydown", (event) => {
    event.stopPropagation();
    if (event.key === "Enter" && vote.value.trim()) {
      typed = vote.value;
      send({ vote: typed });
      vote.value = "";
    }
  });

  const button = (/** @type {string} */ name, /** @type {() => void} */ act) => {
    const made = make("button", { type: "button", class: "quiet" }, name);
    made.addEventListener("click", act);
    return made;
  };

  /** Shows the notes in a language from now on. @param {string} wanted */
  async function speak(wanted) {
    if (wanted === language) {
      return;
    }
    language = wanted;

    const found = await wordsOf(wanted);
    // Meanwhile another may be wanted.
    if (language === wanted) {
      words = found;
      document.documentElement.lang = wanted;
      label();
      show();
    }
  }

  /** Names the parts of the page, which stay. */
  function label() {
    document.title = `${words("Notes")} \u2013 Tilescope`;
    here.setAttribute("aria-label", words("This step"));
    vote.setAttribute("aria-label", words("Votes"));
    vote.placeholder = words("A 12 B 30, or none, few, half, most");
    votes.setAttribute("aria-label", words("Votes"));
    next.setAttribute("aria-label", words("Next step"));
  }

  const openStage = () => window.open(`./?talk=${name}`, `stage-${name}`);

  function clock() {
    const time = new Date().toLocaleTimeString(language || [], { hour: "2-digit", minute: "2-digit" });
    const isSilent = performance.now() > heard_ms + SILENT_MS;

    if (isSilent || !talk) {
      const why = words(isSilent ? "The stage is closed." : "No talk is given.");
      bar.replaceChildren(make("b", {}, time), ` ${why} `, ...(kept ? [button(words("Open the stage again"), openStage)] : []));
      return;
    }

    const now = Date.now() / 1000;
    const elapsed = now - talk.begun;
    const { before, this: planned, all } = talk.planned;
    const late = elapsed - before - planned;

    const plan =
      late > 0
        ? words("{=late} behind the plan", { late: minutes(late) })
        : elapsed < before
          ? words("{=early} ahead of the plan", { early: minutes(before - elapsed) })
          : words("as planned");

    const place = { n: talk.step, steps: talk.steps, part: talk.part, parts: talk.parts, here: minutes(now - talk.step_begun), planned: minutes(planned) };
    const text =
      talk.parts > 1
        ? words("Step {#n} of {#steps} of lesson {#part} of {#parts}, {=here} here, {=planned} planned", place)
        : words("Step {#n} of {#steps}, {=here} here, {=planned} planned", place);

    bar.replaceChildren(
      make("b", {}, `${time} \u2003 ${minutes(elapsed)} / ${minutes(all)}`),
      make("span", late > 0 ? { class: "late" } : {}, plan),
      make("span", { class: "small" }, text),
    );
  }

  function show() {
    clock();

    if (!talk) {
      [tools, here, votes, next].forEach((part) => part.replaceChildren());
      return;
    }

    const on = talk.blank ? "Show again (PageDown)" : talk.waits ? (talk.voting ? "Reveal (PageDown)" : "Vote (PageDown)") : "Next (PageDown)";
    tools.replaceChildren(
      button(words("Back (PageUp)"), () => send("previous")),
      button(words(on), () => send("next")),
      button(words("Blank (B)"), () => send("blank")),
      button(words("Laser (L)"), () => send({ tool: "laser" })),
      button(words("Pen (P)"), () => send({ tool: "pen" })),
      button(words("Colour (C)"), () => send("next-color")),
      button(words("Undo line (U)"), () => send("undo-stroke")),
      button(words("Clear (X)"), () => send("clear-strokes")),
      button(words("Code (Q)"), () => send("toggle-code")),
      button(words("End (Esc)"), () => send("end")),
    );

    const paragraph = (/** @type {any} */ spans) => make("p", {}, ...set(spans));
    here.replaceChildren(make("h2", {}, talk.over ? words("The talk is over.") : talk.title), ...talk.notes.map(paragraph));
    if (talk.ask) {
      here.append(make("hr"), paragraph(talk.ask), make("p", { class: "answer" }, `${words("The answer:")} ${talk.answer ?? ""}`));
      if (talk.hint) {
        here.append(make("p", { class: "small" }, `${words("Hint")}: `, ...set(talk.hint)));
      }
    }

    // A step without a question has no vote.
    vote.hidden = !talk.ask;
    const said = talk.votes.map((/** @type {any} */ vote, /** @type {number} */ index) => {
      const counts = vote.counts?.map((/** @type {number} */ count, /** @type {number} */ k) => `${String.fromCharCode(65 + k)} ${count}`).join(", ");
      const text = counts ?? words(`${vote.right} right`);
      return make("p", {}, `${words(index === 0 ? "First vote:" : "Second vote:")} ${text}`);
    });
    votes.replaceChildren(...said);
    if (talk.votes.length > 0) {
      votes.append(button(words("Take back"), () => send("unvote")));
    }
    if (talk.votes.length === 1) {
      votes.append(make("p", { class: "small" }, words("The class sees both votes after the second one.")));
    }

    // A vote that was not understood can be mended in the field.
    if (talk.vote_fault) {
      votes.append(make("p", { class: "fault", role: "alert" }, talk.vote_fault));
      vote.value ||= typed;
    }
    if (talk.advice) {
      votes.append(make("p", { class: "advice" }, words(ADVICE[talk.advice])));
    }

    const title = talk.next ?? words("Nothing: this is the last step.");
    next.replaceChildren(make("p", { class: "small" }, words("Next")), make("h2", {}, title));
    if (talk.picture) {
      const alt = words("Picture of the next step: {=title}", { title });
      next.append(make("img", { alt, src: `data:image/svg+xml,${encodeURIComponent(talk.picture)}` }));
    }
  }

  channel.addEventListener("message", ({ data }) => {
    if (data.talk !== undefined || data.here) {
      heard_ms = performance.now();
    }

    if (data.talk !== undefined) {
      talk = data.talk;
      kept = talk?.kept ?? kept;
      show();
      if (talk) {
        speak(talk.language || "en");
      }
    }

    if (data.stage && kept) {
      // A new stage requests the state of the talk.
      send({ restore: JSON.stringify(kept) });
    }
  });

  window.addEventListener("keydown", (event) => {
    const command = KEYS[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (command && !event.ctrlKey && !event.metaKey && !event.altKey) {
      event.preventDefault();
      send(command);
    }
  });

  setInterval(() => {
    channel.postMessage({ ping: true });
    clock();
  }, 1000);

  channel.postMessage({ hello: true });
  label();
  show();
  speak(wantedLanguage());
}
