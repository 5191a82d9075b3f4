// @ts-check
// The front end of `tilescope.widget`: the page's player in a frame, or the points of a set on a canvas. The state that it
// shares with Python is described in `_widget.py`, the messages of the player in `web/README.md`.

/** The version of the player's messages. */
const VERSION = 1;
/** After so long in view without a word of the player the points stay, and a note says why. */
const SILENT_MS = 60_000;
/** A click selects the sample nearest to it, if it is no farther than so many pixels. */
const NEAR = 16;
/** Where the pages of this window are kept, so that every cell has the same one. */
const KEPT = Symbol.for("tilescope.widget.pages");

/**
 * What anywidget hands over: the state that is shared with Python.
 * @typedef {{
 *   get: (name: string) => any,
 *   set: (name: string, value: any) => void,
 *   save_changes: () => void,
 *   on: (event: string, take: (...given: any[]) => void) => void,
 *   off: (event: string, take: (...given: any[]) => void) => void,
 *   send: (content: any) => void,
 * }} Model
 */

/** Returns the number of the sample that a link selects, or null. @param {string} link @returns {number | null} */
export function pickedIn(link) {
  const [kind, number] = (new URLSearchParams(link).get("select") ?? "").split(":");
  return kind === "sample" && /^\d+$/.test(number ?? "") ? Number(number) : null;
}

/** Returns a link that selects a sample by its number, or nothing. @param {string} link @param {number | null} number */
export function picking(link, number) {
  // The other parts stay as the program wrote them: their escapes are its own.
  const parts = link.split("&").filter((part) => part !== "" && !part.startsWith("select="));
  return [...parts, ...(number === null ? [] : [`select=sample:${number}`])].join("&");
}

/** Returns a link that begins at the moment and the selection of a state. @param {Model} model @returns {string} */
export function startOf(model) {
  const [link, cursor, moment] = ["_link", "cursor", "moment"].map(model.get.bind(model));
  // An event says more than its stage. A run ends with the stage "finish", and links name no end.
  const at = cursor !== null ? `&at=${cursor}` : moment !== "finish" ? `&stage=${moment}` : "";
  return picking(link + at, model.get("_picked"));
}

/**
 * Returns the page of the player as one document, whose modules are named by addresses of their own: a notebook's server does
 * not serve them, and it may be far away.
 * @param {Map<string, string | Uint8Array>} files texts, and the program
 * @param {(content: string | Uint8Array, type: string) => string} addressOf stores a content and returns its address
 * @returns {string}
 */
export function assembled(files, addressOf) {
  /** @type {Map<string, string>} */
  const stored = new Map();

  /** @param {string} name @returns {string} */
  function store(name) {
    const known = stored.get(name);
    if (known !== undefined) {
      return known;
    }

    const content = files.get(name);
    if (content === undefined) {
      throw new Error(`The page has no ${name}.`);
    }
    // Files cannot refer to each other in a circle (web/README.md), so that this ends.
    const address = addressOf(typeof content === "string" ? linked(content) : content, typeOf(name));
    stored.set(name, address);
    return address;
  }

  /** @param {string} text @returns {string} */
  function linked(text) {
    const named = text.replace(/\.\/([\w.-]+-[0-9a-f]{12}\.\w+)/g, (_, name) => store(name));
    // Such an address has no query.
    return named.replaceAll("location.search", '"?embed=player"');
  }

  const index = String(files.get("index.html"));
  const body = index.match(/<template id="program">([^]*?)<\/template>/)?.[1];
  const policy = index.match(/content="(default-src [^"]*)"/)?.[1];
  const style = index.match(/id="program-style"[^>]*href="([^"]+)"/)?.[1];
  const main = [...files.keys()].find((name) => /^main-[0-9a-f]{12}\.js$/.test(name));
  if (!body || !policy || !style || !main) {
    throw new Error("The page is of another version than this widget.");
  }
  return `<!doctype html>
<html lang="en"><head><meta charset="utf-8" />
<meta http-equiv="Content-Security-Policy" content="${policy.replaceAll("'self'", "blob:")}" />
<meta name="color-scheme" content="dark light" /><title>Tilescope</title>
<link rel="stylesheet" href="${store(style)}" /></head>
<body>${body}<script type="module" src="${store(main)}"></script></body></html>`;
}

/** @param {string} name @returns {string} */
function typeOf(name) {
  const types = { js: "text/javascript", css: "text/css", wasm: "application/wasm", json: "application/json" };
  const ending = /** @type {keyof types} */ (name.split(".").pop());
  return types[ending] ?? "text/plain";
}

/** Unpacks a file of the page, into text unless it is the program. @param {string} name @param {DataView} packed */
async function unpacked(name, packed) {
  const bytes = new Uint8Array(packed.buffer, packed.byteOffset, packed.byteLength);
  const stream = new Blob([/** @type {BlobPart} */ (bytes)]).stream().pipeThrough(new DecompressionStream("gzip"));
  const response = new Response(stream);
  return name.endsWith(".wasm") ? new Uint8Array(await response.arrayBuffer()) : response.text();
}

/**
 * Returns the address of the page in this window, whose files Python sends when they are first needed. That may take long: a
 * kernel answers when the cells before are done.
 * @param {Model} model
 * @returns {Promise<string>}
 */
async function pageOf(model) {
  /** @type {Map<string, string>} */
  const pages = (/** @type {any} */ (globalThis)[KEPT] ??= new Map());
  const version = model.get("_page");
  if (pages.has(version)) {
    return /** @type {string} */ (pages.get(version));
  }

  const { names, buffers } = await new Promise((resolve) => {
    const take = (/** @type {any} */ content, /** @type {DataView[]} */ buffers) => {
      if (content.kind === "page" && content.version === version) {
        model.off("msg:custom", take);
        resolve({ names: content.names, buffers });
      }
    };
    model.on("msg:custom", take);
    model.send({ kind: "page" });
  });

  const contents = await Promise.all(names.map((/** @type {string} */ name, /** @type {number} */ k) => unpacked(name, buffers[k])));
  const files = new Map(names.map((/** @type {string} */ name, /** @type {number} */ k) => [name, contents[k]]));
  const addressOf = (/** @type {any} */ content, /** @type {string} */ type) => URL.createObjectURL(new Blob([content], { type }));
  const address = addressOf(assembled(files, addressOf), "text/html");
  // Only what has come is kept: a kernel that was restarted answers no question of before.
  pages.set(version, address);
  return address;
}

/**
 * Keeps the shared state and the player in step. It is separate from frames and pages, so that tests can lead it.
 * @param {Model} model
 * @param {(request: any) => void} post sends the player a request
 */
export function follower(model, post) {
  /** @type {any} What the player has reported last. */
  let reported = null;
  let asks = 0;
  let answered = 0;
  /** What was set before the run was there, to be asked of the player then. @type {Set<"cursor" | "moment" | "_picked">} */
  const waiting = new Set();

  /** @param {any} request */
  function ask(request) {
    asks += 1;
    post({ tilescope: VERSION, id: asks, ...request });
  }

  /** @param {Record<string, any>} values */
  function save(values) {
    for (const [name, value] of Object.entries(values)) {
      model.set(name, value);
    }
    model.save_changes();
  }

  /** Takes what the player shows into the shared state. */
  function take() {
    // While a request of this view is under way, the state is of before it and would undo it.
    if (!reported?.ready || answered < asks) {
      return;
    }
    if (reported.positions_digest !== model.get("_digest")) {
      save({ note: "The player shows another run than that of the set." });
      return;
    }
    const { cursor, events, stage, sentence, link } = reported;
    // The name of a stage is null before the first one.
    save({ cursor, events, moment: stage ?? "pattern", sentence: sentence ?? "", _picked: pickedIn(link) });
  }

  const isReady = () => reported?.ready && reported.positions_digest === model.get("_digest");
  const changes = {
    cursor: () => {
      const cursor = model.get("cursor");
      if (!isReady()) {
        waiting.add("cursor");
      } else if (cursor !== null && cursor !== reported.cursor) {
        ask({ do: "seek", event: cursor });
      }
    },
    moment: () => {
      // Another view of the same state changes cursor and stage together: then the cursor says more.
      const isNamed = () => [null, reported.cursor].includes(model.get("cursor"));
      if (!isReady()) {
        waiting.add("moment");
      } else if (isNamed() && model.get("moment") !== (reported.stage ?? "pattern")) {
        ask({ do: "seek", stage: model.get("moment") });
      }
    },
    _picked: () => {
      const number = model.get("_picked");
      if (!isReady()) {
        waiting.add("_picked");
      } else if (number !== pickedIn(reported.link)) {
        ask({ do: "load", link: picking(reported.link, number) });
      }
    },
  };

  return {
    changes,
    ask,
    /** Takes a message of the player. @param {any} data */
    hear: (data) => {
      if (data.event === "state") {
        reported = data.state;
        if (isReady()) {
          const names = [...waiting];
          waiting.clear();
          names.forEach((name) => changes[name]());
        }
        take();
      } else if (typeof data.id === "number") {
        answered = Math.max(answered, data.id);
        if (data.ok === false) {
          save({ note: data.error });
          take();
        } else if (answered === asks) {
          // Once all is done, the player is asked where it is: it need not have drawn since.
          if (data.state) {
            reported = data.state;
            take();
          } else {
            ask({ do: "state" });
          }
        }
      }
    },
  };
}

/**
 * Draws the points, and selects the one nearest to a click.
 * @param {Model} model
 * @param {HTMLCanvasElement} canvas
 */
function pointsOn(model, canvas) {
  const [width, height] = model.get("_window");
  const points = wordsOf(model.get("_points"), Float32Array);
  const rows = wordsOf(model.get("_rows"), Uint32Array);
  /** Pixels for a unit of length. */
  let scale = 1;

  function draw() {
    const context = canvas.getContext("2d");
    const dense = devicePixelRatio || 1;
    const room = Math.min((canvas.parentElement?.clientWidth || 640) / width, model.get("height") / height);
    if (!context || !(room > 0)) {
      return;
    }

    scale = room;
    canvas.style.width = `${width * scale}px`;
    canvas.style.height = `${height * scale}px`;
    canvas.width = width * scale * dense;
    canvas.height = height * scale * dense;
    context.scale(dense, dense);
    context.fillStyle = getComputedStyle(canvas).color;

    // About a third of the distance between neighbours.
    const side = Math.min(4, Math.max(0.7, (scale * Math.sqrt((width * height) / Math.max(rows.length, 1))) / 3));
    for (let k = 0; k < rows.length; k += 1) {
      // y points up in the plane and down on the screen.
      context.fillRect(points[2 * k] * scale - side / 2, (height - points[2 * k + 1]) * scale - side / 2, side, side);
    }

    const chosen = rows.indexOf(model.get("selected") ?? -1);
    if (chosen >= 0) {
      context.strokeStyle = "#d33";
      context.lineWidth = 2;
      context.beginPath();
      context.arc(points[2 * chosen] * scale, (height - points[2 * chosen + 1]) * scale, side / 2 + 4, 0, 2 * Math.PI);
      context.stroke();
    }
  }

  canvas.addEventListener("click", ({ offsetX, offsetY }) => {
    const found = nearest(points, offsetX / scale, height - offsetY / scale, NEAR / scale);
    model.set("selected", found === null ? null : rows[found]);
    model.save_changes();
  });
  return draw;
}

/** Returns the bytes of the state as numbers. @template T @param {DataView} view @param {{new (buffer: ArrayBuffer): T}} Words */
function wordsOf(view, Words) {
  // A copy begins at a whole word, which a part of a message need not.
  return new Words(/** @type {ArrayBuffer} */ (view.buffer.slice(view.byteOffset, view.byteOffset + view.byteLength)));
}

/**
 * Returns the index of the point nearest to a place, or null if all are farther than `most`.
 * @param {ArrayLike<number>} points x and y of each
 * @param {number} x
 * @param {number} y
 * @param {number} most
 * @returns {number | null}
 */
export function nearest(points, x, y, most) {
  let [found, least] = [/** @type {number | null} */ (null), most * most];
  for (let k = 0; 2 * k < points.length; k += 1) {
    const squared = (points[2 * k] - x) ** 2 + (points[2 * k + 1] - y) ** 2;
    if (squared <= least) {
      [found, least] = [k, squared];
    }
  }
  return found;
}

/**
 * Shows the player above the points, once it is there. Returns a function that ends it.
 * @param {Model} model
 * @param {HTMLElement} el
 * @param {HTMLElement} below what is shown until then, and if it fails
 * @returns {() => void}
 */
function playerIn(model, el, below) {
  const frame = document.createElement("iframe");
  frame.title = "Tilescope: the run of this set";
  frame.allow = "clipboard-write; fullscreen";
  // Until the player is there, it takes no room. A frame without a size would not begin.
  Object.assign(frame.style, { border: "0", width: "100%", position: "absolute", inset: "0", opacity: "0", pointerEvents: "none" });

  let origin = location.origin;
  const follow = follower(model, (request) => frame.contentWindow?.postMessage(request, origin));
  const resize = () => (frame.style.height = `${model.get("height")}px`);
  resize();

  /** @param {string} reason */
  const fail = (reason) => {
    model.set("note", reason);
    model.save_changes();
    frame.remove();
    below.hidden = false;
  };

  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let silent;
  // A player begins when it comes into view.
  const seen = new IntersectionObserver(([{ isIntersecting }]) => {
    if (isIntersecting) {
      seen.disconnect();
      silent = setTimeout(() => fail("The player does not answer here; the points alone."), SILENT_MS);
    }
  });

  /** @param {MessageEvent} message */
  const hear = ({ source, origin: from, data }) => {
    if (source !== frame.contentWindow || from !== origin || data?.tilescope !== VERSION) {
      return;
    }
    clearTimeout(silent);
    if (data.event === "failed") {
      fail(data.error);
      return;
    }
    if (data.event === "ready") {
      below.hidden = true;
      Object.assign(frame.style, { position: "static", opacity: "1", pointerEvents: "auto" });
    }
    follow.hear(data);
  };
  const asked = (/** @type {any} */ content) => content.kind === "ask" && follow.ask(content.request);

  window.addEventListener("message", hear);
  model.on("msg:custom", asked);
  model.on("change:height", resize);
  const changes = Object.entries(follow.changes);
  changes.forEach(([name, change]) => model.on(`change:${name}`, change));

  const show = (/** @type {string} */ source) => {
    frame.src = source;
    el.append(frame);
    seen.observe(frame);
  };
  const address = model.get("_address");
  let isOver = false;
  if (address) {
    const player = new URL(address);
    player.searchParams.set("embed", "player");
    player.searchParams.set("origin", origin);
    player.hash = startOf(model);
    origin = player.origin;
    show(player.href);
  } else {
    // The cell may be gone when the page is there.
    const begin = (/** @type {string} */ page) => isOver || show(`${page}#${startOf(model)}`);
    pageOf(model).then(begin, (error) => fail(`The player cannot be made: ${error.message}`));
  }

  return () => {
    isOver = true;
    clearTimeout(silent);
    seen.disconnect();
    window.removeEventListener("message", hear);
    model.off("msg:custom", asked);
    model.off("change:height", resize);
    changes.forEach(([name, change]) => model.off(`change:${name}`, change));
    frame.remove();
  };
}

/** Shows the widget in a cell. Returns a function that ends it. @param {{ model: Model, el: HTMLElement }} given */
function render({ model, el }) {
  el.style.position = "relative";
  const below = document.createElement("div");
  const canvas = document.createElement("canvas");
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", `${model.get("_rows").byteLength / 4} points; a click selects one`);
  const note = document.createElement("p");
  note.setAttribute("role", "status");
  below.append(canvas);
  el.append(below, note);

  const draw = pointsOn(model, canvas);
  const say = () => (note.textContent = model.get("note"));
  const shown = new ResizeObserver(draw);
  // A cell has its width once it is in the page.
  shown.observe(el);
  say();
  model.on("change:selected", draw);
  model.on("change:height", draw);
  model.on("change:note", say);

  const end = model.get("_link") ? playerIn(model, el, below) : () => {};
  return () => {
    shown.disconnect();
    model.off("change:selected", draw);
    model.off("change:height", draw);
    model.off("change:note", say);
    end();
  };
}

export default { render };
