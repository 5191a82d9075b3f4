// @ts-check The lecturer's notes in a window of their own. The window with the stage sends their content over a channel
// with a random name; this module sends back the lecturer's commands. Either window may be closed and opened again.

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
  document.title = "Notes \u2013 Tilescope";
  const channel = new BroadcastChannel(name);
  const send = (/** @type {any} */ command) => channel.postMessage({ command });
  /** @type {any} */
  let talk = null;
  /** @type {any} The state from which a stage can be opened again, once there was a talk. */
  let kept = null;
  let heard_ms = performance.now();
  let typed = "";

  const bar = make("p", { class: "bar" });
  const tools = make("p", { class: "tools" });
  const here = make("section", { "aria-label": "This step" });
  const vote = /** @type {HTMLInputElement} */ (
    make("input", { type: "text", placeholder: "A 12 B 30, or none, few, half, most", "aria-label": "Votes", autocomplete: "off" })
  );
  const votes = make("section", { "aria-label": "Votes" });
  const next = make("section", { "aria-label": "Next step" });
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
  const openStage = () => window.open(`./?talk=${name}`, `stage-${name}`);

  function clock() {
    const time = new Date().toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" });
    const isSilent = performance.now() > heard_ms + SILENT_MS;
    if (isSilent || !talk) {
      const why = isSilent ? "The stage is closed." : "No talk is given.";
      bar.replaceChildren(make("b", {}, time), ` ${why} `, ...(kept ? [button("Open the stage again", openStage)] : []));
      return;
    }
    const now = Date.now() / 1000;
    const elapsed = now - talk.begun;
    const { before, this: planned, all } = talk.planned;
    const late = elapsed - before - planned;
    const plan = late > 0 ? `${minutes(late)} behind the plan` : elapsed < before ? `${minutes(before - elapsed)} ahead of the plan` : "as planned";
    const part = talk.parts > 1 ? ` of lesson ${talk.part} of ${talk.parts}` : "";
    bar.replaceChildren(
      make("b", {}, `${time} \u2003 ${minutes(elapsed)} / ${minutes(all)}`),
      make("span", late > 0 ? { class: "late" } : {}, plan),
      make("span", { class: "small" }, `Step ${talk.step} of ${talk.steps}${part}, ${minutes(now - talk.step_begun)} here, ${minutes(planned)} planned`),
    );
  }

  function show() {
    clock();
    if (!talk) {
      [tools, here, votes, next].forEach((part) => part.replaceChildren());
      return;
    }
    const on = talk.blank ? "Show again" : talk.waits ? (talk.voting ? "Reveal" : "Vote") : "Next";
    tools.replaceChildren(
      button("Back (PageUp)", () => send("previous")),
      button(`${on} (PageDown)`, () => send("next")),
      button("Blank (B)", () => send("blank")),
      button("Laser (L)", () => send({ tool: "laser" })),
      button("Pen (P)", () => send({ tool: "pen" })),
      button("Colour (C)", () => send("next-color")),
      button("Undo line (U)", () => send("undo-stroke")),
      button("Clear (X)", () => send("clear-strokes")),
      button("Code (Q)", () => send("toggle-code")),
      button("End (Esc)", () => send("end")),
    );
    const paragraph = (/** @type {any} */ spans) => make("p", {}, ...set(spans));
    here.replaceChildren(make("h2", {}, talk.over ? "The talk is over." : talk.title), ...talk.notes.map(paragraph));
    if (talk.ask) {
      here.append(make("hr"), paragraph(talk.ask), make("p", { class: "answer" }, `The answer: ${talk.answer ?? ""}`));
      if (talk.hint) {
        here.append(make("p", { class: "small" }, "Hint: ", ...set(talk.hint)));
      }
    }
    vote.hidden = !talk.ask;
    const said = talk.votes.map((/** @type {any} */ vote, /** @type {number} */ index) => {
      const counts = vote.counts?.map((/** @type {number} */ count, /** @type {number} */ k) => `${String.fromCharCode(65 + k)} ${count}`).join(", ");
      return make("p", {}, `${index === 0 ? "First" : "Second"} vote: ${counts ?? `${vote.right} right`}`);
    });
    votes.replaceChildren(...said);
    if (talk.votes.length > 0) {
      votes.append(button("Take back", () => send("unvote")));
    }
    if (talk.votes.length === 1) {
      votes.append(make("p", { class: "small" }, "The class sees both votes after the second one."));
    }
    if (talk.vote_fault) {
      votes.append(make("p", { class: "fault", role: "alert" }, talk.vote_fault));
      vote.value ||= typed;
    }
    if (talk.advice) {
      votes.append(make("p", { class: "advice" }, ADVICE[talk.advice]));
    }
    next.replaceChildren(make("p", { class: "small" }, "Next"), make("h2", {}, talk.next ?? "Nothing: this is the last step."));
    if (talk.picture) {
      next.append(make("img", { alt: `Picture of the next step: ${talk.next}`, src: `data:image/svg+xml,${encodeURIComponent(talk.picture)}` }));
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
  show();
}
