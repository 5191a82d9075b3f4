// @ts-check
// Messages between this page and the page that embeds it in a frame. Only messages of that page are accepted, and only
// from an allowed origin: this page's own, and the one given by `?origin=` in its address.

/** The version of the envelope. */
const VERSION = 1;
/** The longest request, as JSON. A request may carry parameters and a link, not data. */
const MOST_CHARACTERS = 65_536;

/**
 * Returns the origin that an address names, as browsers write it. An invalid one is reported in the console, since the
 * page around would get no answers.
 * @param {string | null} text
 * @returns {string | null}
 */
export function namedOrigin(text) {
  if (text === null) {
    return null;
  }

  try {
    const { href, origin, protocol } = new URL(text);
    // Only a slash may follow the port, and "null", the origin of files and sandboxes, is not accepted.
    if (["https:", "http:"].includes(protocol) && href === `${origin}/`) {
      return origin;
    }
  } catch {
    // Reported below.
  }

  console.warn(
    `Tilescope: origin=${text} names no origin, so that the page around gets no answers unless it is of ${location.origin}. ` +
      "An origin is scheme, host and port, as https://lecture.example.",
  );
  return null;
}

/**
 * Returns the origin to which events are sent: the parent's, if it is allowed.
 * @param {string[]} allowed
 * @returns {string | undefined}
 */
function listener(allowed) {
  const ancestors = location.ancestorOrigins;
  if (ancestors && ancestors.length > 0) {
    return allowed.find((origin) => origin === ancestors[0]);
  }
  // If the browser does not report the parent's origin, use the named one; the browser delivers to no other origin.
  return allowed[allowed.length - 1];
}

/**
 * Answers one message's data.
 * @param {any} data
 * @param {(request: string) => string} ask
 * @returns {any}
 */
function answer(data, ask) {
  const refuse = (/** @type {string} */ error) => ({ ok: false, error });
  if (data.tilescope !== VERSION) {
    return refuse(`"tilescope" must be ${VERSION}, the version of the interface.`);
  }

  const { tilescope, id, ...request } = data;
  let text;
  try {
    text = JSON.stringify(request);
  } catch {
    return refuse("The request must be plain data that JSON can hold.");
  }

  if (text.length > MOST_CHARACTERS) {
    return refuse(`The request has ${text.length} characters; at most ${MOST_CHARACTERS} are read.`);
  }

  try {
    return JSON.parse(ask(text));
  } catch (error) {
    return refuse(`The program did not answer: ${error}`);
  }
}

/**
 * Listens to the page that embeds this one. Returns functions that send it events.
 * @param {string | null} origin the origin named by the address
 * @param {(request: string) => string} ask
 */
export function bridge(origin, ask) {
  const allowed = [location.origin, ...(origin ? [origin] : [])];
  const hears = window.parent === window ? undefined : listener(allowed);

  /** @type {Set<string>} */
  const refused = new Set();

  window.addEventListener("message", (message) => {
    const { data, source } = message;
    const isRequest = typeof data === "object" && data !== null && "tilescope" in data;
    if (window.parent === window || source !== window.parent || !isRequest) {
      return;
    }

    // Reported once for each origin, as a page may send many messages.
    if (!allowed.includes(message.origin)) {
      if (!refused.has(message.origin)) {
        refused.add(message.origin);
        console.warn(`Tilescope answers ${allowed.join(" and ")}, not ${message.origin}: the frame's address names the origin by origin=.`);
      }
      return;
    }

    const reply = { tilescope: VERSION, ...answer(data, ask) };
    try {
      window.parent.postMessage({ id: data.id, ...reply }, message.origin);
    } catch {
      // Transferred objects, such as ports, cannot be sent back.
      window.parent.postMessage(reply, message.origin);
    }
  });

  const tell = (/** @type {object} */ event) => {
    if (hears) {
      window.parent.postMessage({ tilescope: VERSION, ...event }, hears);
    }
  };

  let isReady = false;
  let answers = 0;
  /** @type {number | undefined} */
  let height;
  return {
    /** Sent once, even if the program restarts. */
    ready: () => {
      if (!isReady) {
        isReady = true;
        tell({ event: "ready" });
      }
    },
    /** Sent when it changes. @param {number | undefined} wished in pixels, with a lesson */
    height: (wished) => {
      if (wished && wished !== height) {
        height = wished;
        tell({ event: "height", height });
      }
    },
    /** @param {string} error */
    failed: (error) => tell({ event: "failed", error }),
    /** @param {any} told */
    state: (told) => {
      tell({ event: "state", state: told });
      // The number of answers begins at 0 when the program restarts.
      const { answered } = told;
      if (answered && answered.number !== answers) {
        tell({ event: "answered", ...answered });
      }
      answers = answered?.number ?? answers;
    },
  };
}
