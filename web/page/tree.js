// @ts-check
// The controls that the program draws on the canvas, as elements: screen readers explore them, voice control names them,
// magnifiers follow them. The program reports what has changed (`tree.rs` of `web/app`), and only that is changed here.
// The elements cannot be seen and leave the pointer to the canvas. They are not in the Tab order, which is the program's:
// the canvas has the keys, until something gives the focus to an element. From then on the elements have them, and pass on
// those that they do not use themselves; the focus then moves with that of the program.

import { announceNew } from "./{{asset:sheets.js}}";

/**
 * An element as `tree.rs` describes it.
 * @typedef {object} Described
 * @property {string} role
 * @property {string} [name]
 * @property {number[]} [labels]
 * @property {string} [description]
 * @property {string} [value]
 * @property {string} [hint]
 * @property {number} [number]
 * @property {number} [least]
 * @property {number} [most]
 * @property {string} [on]
 * @property {boolean} [expanded]
 * @property {string} [opens]
 * @property {boolean} [disabled]
 * @property {boolean} [fixed]
 * @property {boolean} [focusable]
 * @property {boolean} [steps] whether it has actions for the next value and the one before
 * @property {boolean} [live]
 * @property {number[]} [place] left, top, width and height in pixels, from the parent's corner
 * @property {number} [active]
 * @property {number[]} [children]
 * @property {number[]} [size] the rows and columns of a table
 * @property {number} [index] of a row or cell, from 1
 */

/**
 * Changes of the tree.
 * @typedef {object} Changes
 * @property {boolean} all whether what was there is dropped
 * @property {string} language
 * @property {number[]} [top]
 * @property {[number, Described][]} elements
 * @property {number[]} gone
 * @property {number} focus
 */

/** The tags of roles that have one of their own, and types of inputs. All others are a `div` with the role. @type {Record<string, string>} */
const TAGS = {
  button: "button", link: "a", menuitem: "button", menuitemcheckbox: "button", combobox: "button", area: "textarea", label: "span", heading: "h2",
  checkbox: "input", radio: "input", range: "input", number: "input", text: "input",
};

/** Roles with elements that bring them along. */
const OWN = ["button", "area", "label", "heading", "checkbox", "radio", "range", "number", "text"];

/** Roles whose name is their text. */
const NAMED_BY_TEXT = ["button", "link", "menuitem", "menuitemcheckbox", "option", "heading", "cell", "gridcell", "columnheader", "rowheader"];

/** Roles that never have the focus. */
const STILL = [
  "label", "heading", "img", "group", "menu", "listbox", "dialog", "tooltip", "progressbar", "table", "grid", "row", "cell", "gridcell", "columnheader",
  "rowheader",
];

/** Elements that Enter and Space press. */
const PRESSED = "button, a, [role=option], [role=row], input[type=checkbox], input[type=radio]";

/** Elements in which text is typed. */
const TYPED = "textarea, input[type=text], input[type=number]";

/** Keys that edit a line of text everywhere. All others are the program's. */
const EDITING = /^(.|Backspace|Delete|Home|End|ArrowLeft|ArrowRight|Unidentified|Process|Dead)$/;

/** So long after something was typed the program may still report what the field had before. */
const SETTLES_MS = 700;

/** As many elements that had the focus are remembered, to return to when others are gone. */
const MAX_TRAIL = 8;

/**
 * Mirrors the program's controls within an element.
 * @param {HTMLElement} root
 * @param {() => any} program returns the running program, if there is one
 */
export function mirror(root, program) {
  /** The elements by number. @type {Map<number, HTMLElement>} */
  const shown = new Map();
  /** What they show. @type {WeakMap<HTMLElement, Described>} */
  const described = new WeakMap();
  /** When text was last typed into a field. @type {WeakMap<HTMLElement, number>} */
  const typed = new WeakMap();
  /** The elements that had the focus, the last one first. @type {number[]} */
  let trail = [];
  /** The element with the program's focus, or 0. */
  let focus = 0;
  /** Whether the focus is being moved here, and not by the reader. */
  let moves = false;

  const holds = () => root.contains(document.activeElement);
  const numberOf = (/** @type {EventTarget | null} */ target) =>
    target instanceof HTMLElement && target !== root ? Number(target.id.slice(1)) : 0;
  const ask = (/** @type {number} */ number, /** @type {string} */ action, /** @type {string} */ text = "") =>
    program()?.ask_control(number, action, text);

  /** Moves the focus of the page. @param {HTMLElement} element */
  function move(element) {
    moves = true;
    element.focus({ preventScroll: true });
    moves = false;
  }

  /** Takes changes from the program. @param {Changes} changes */
  function change({ all, language, top, elements, gone, focus: now }) {
    const held = holds();
    if (all) {
      root.replaceChildren();
      shown.clear();
      // Another program gives the same numbers to other elements.
      trail = [];
      focus = 0;
    }
    if (root.lang !== language) {
      root.lang = language;
    }

    // Labels may come after what they name, so that all elements are there before any is described.
    for (const [number, description] of elements) {
      make(number, description.role);
    }
    for (const number of gone) {
      shown.get(number)?.remove();
      shown.delete(number);
    }
    for (const [number, description] of elements) {
      describe(number, description, !all);
    }
    if (top) {
      order(root, top);
    }

    follow(now, held);
  }

  /** Makes the element of a number, in the place of one with another role. @param {number} number @param {string} role */
  function make(number, role) {
    const before = shown.get(number);
    if (before && described.get(before)?.role === role) {
      return;
    }
    const element = document.createElement(TAGS[role] ?? "div");
    element.id = `t${number}`;
    if (element instanceof HTMLInputElement) {
      element.type = role;
    }
    if (element instanceof HTMLButtonElement) {
      element.type = "button";
    }
    if (!OWN.includes(role)) {
      element.setAttribute("role", role);
    }
    before?.replaceWith(element);
    shown.set(number, element);
  }

  /** Shows what has changed of an element. @param {number} number @param {Described} now @param {boolean} isLater */
  function describe(number, now, isLater) {
    const element = /** @type {HTMLElement} */ (shown.get(number));
    const before = described.get(element);
    described.set(element, now);

    const had = before ? attributes(before) : {};
    for (const [name, value] of Object.entries(attributes(now))) {
      if (value !== had[name]) {
        value === undefined ? element.removeAttribute(name) : element.setAttribute(name, value);
      }
    }
    now.place?.forEach((pixels, side) => {
      if (pixels !== before?.place?.[side]) {
        element.style.setProperty(["left", "top", "width", "height"][side], `${pixels}px`);
      }
    });

    if (element instanceof HTMLInputElement || element instanceof HTMLTextAreaElement) {
      fill(element, now);
    } else if (!now.children) {
      const text = (NAMED_BY_TEXT.includes(now.role) ? now.name : now.value) ?? "";
      if (element.textContent !== text) {
        element.textContent = text;
      }
    }
    if (now.children || before?.children) {
      order(element, now.children ?? []);
    }

    if (now.live && isLater && now.value && now.value !== before?.value) {
      announceNew(now.value);
    }
  }

  /** Shows the value of a field, unless the reader is typing. @param {HTMLInputElement | HTMLTextAreaElement} field @param {Described} now */
  function fill(field, now) {
    if (field instanceof HTMLInputElement && ["checkbox", "radio"].includes(field.type)) {
      field.checked = now.on === "true";
      field.indeterminate = now.on === "mixed";
      return;
    }
    const typed_ms = typed.get(field);
    if (typed_ms !== undefined && performance.now() < typed_ms + SETTLES_MS) {
      return;
    }
    const value = String(field.matches("[type=range], [type=number]") ? now.number : (now.value ?? ""));
    if (field.value !== value) {
      field.value = value;
    }
  }

  /** Puts the elements of numbers into an element, and leaves alone those that are in their places. @param {HTMLElement} parent @param {number[]} numbers */
  function order(parent, numbers) {
    let next = parent.firstElementChild;
    for (const number of numbers) {
      const element = shown.get(number);
      if (element === next) {
        next = next?.nextElementSibling ?? null;
      } else if (element) {
        parent.insertBefore(element, next);
      }
    }
  }

  /** Returns whether an element was scrolled out of the window, as in a long list. @param {HTMLElement} element */
  function isOutside(element) {
    const [place, window] = [element.getBoundingClientRect(), root.getBoundingClientRect()];
    return place.bottom <= window.top || place.top >= window.bottom || place.right <= window.left || place.left >= window.right;
  }

  /** Lets the page's focus follow the program's while it is here. @param {number} now @param {boolean} held whether it was here before the changes */
  function follow(now, held) {
    const has_moved = now !== focus;
    focus = now;
    if (!held) {
      return;
    }

    trail = trail.filter((number) => shown.has(number));
    const target = shown.get(now);
    if (target && (has_moved || !holds())) {
      move(target);
    } else if (!holds()) {
      // The element with the focus is gone, as with a closed menu: it returns to where it was before.
      const last = shown.get(trail[0]);
      move(last ?? root);
      if (last) {
        // Deferred: changes come while the program's state is borrowed, and a request would then be lost.
        const number = trail[0];
        setTimeout(() => ask(number, "focus"));
      }
    }
  }

  root.addEventListener("focusin", ({ target }) => {
    program()?.hold_focus(true);
    const number = numberOf(target);
    if (!number) {
      return;
    }
    trail = [number, ...trail.filter((other) => other !== number)].slice(0, MAX_TRAIL);
    if (!moves) {
      ask(number, "focus");
      if (isOutside(/** @type {HTMLElement} */ (target))) {
        ask(number, "show");
      }
    }
  });

  root.addEventListener("focusout", ({ relatedTarget }) => {
    if (!(relatedTarget instanceof Node && root.contains(relatedTarget))) {
      program()?.hold_focus(false);
    }
  });

  root.addEventListener("click", (event) => {
    // The program says later whether a box is checked.
    event.preventDefault();
    // A row of a table is pressed by any of its cells.
    const pressed = event.target instanceof Element ? (event.target.closest("[role=row]") ?? event.target) : event.target;
    const number = numberOf(pressed);
    if (number && event.target instanceof HTMLElement && event.target.getAttribute("aria-disabled") !== "true") {
      ask(number, "click");
    }
  });

  root.addEventListener("input", ({ target }) => {
    if (target instanceof HTMLInputElement || target instanceof HTMLTextAreaElement) {
      typed.set(target, performance.now());
      ask(numberOf(target), target.matches("[type=range], [type=number]") ? "number" : "text", target.value);
      // What the program made of it is shown once nothing more is typed.
      setTimeout(() => {
        const now = described.get(target);
        if (now && target.isConnected) {
          fill(target, now);
        }
      }, SETTLES_MS + 1);
    }
  });

  root.addEventListener("keydown", (event) => {
    const { target, key, ctrlKey, metaKey, altKey, shiftKey } = event;
    const isPlain = !(ctrlKey || metaKey || altKey);
    if (!(target instanceof HTMLElement) || event.isComposing || ["Control", "Shift", "Alt", "Meta"].includes(key)) {
      return;
    }

    const number = numberOf(target);
    const isTyped = target.matches(TYPED);
    const isArea = target instanceof HTMLTextAreaElement;
    const steps = isPlain && described.get(target)?.steps && step(key, target);
    if (steps) {
      ask(number, steps);
    } else if (isPlain && (key === "Enter" || key === " ") && target.matches(PRESSED)) {
      ask(number, "click");
    } else if (isTyped && (event.defaultPrevented ? false : !isPlain || EDITING.test(key) || (isArea && /^(Enter|Arrow|Page)/.test(key)))) {
      return;
    } else {
      program()?.press_key(key, event.code, ctrlKey || metaKey, shiftKey, altKey);
    }
    // Keys with Ctrl and function keys that the program does not take are the browser's.
    if (isPlain && !/^F\d/.test(key)) {
      event.preventDefault();
    }
  });

  // Some browsers press a button when the blank is released.
  root.addEventListener("keyup", (event) => {
    if (event.key === " " && event.target instanceof HTMLElement && event.target.matches(PRESSED)) {
      event.preventDefault();
    }
  });

  return { change, holds };
}

/** Returns how a key changes a number. @param {string} key @param {HTMLElement} target */
function step(key, target) {
  const isRange = target.matches("[type=range]");
  if (key === "ArrowUp" || (isRange && key === "ArrowRight")) {
    return "increment";
  }
  return key === "ArrowDown" || (isRange && key === "ArrowLeft") ? "decrement" : undefined;
}

/** Returns the attributes that show a description. @param {Described} of @returns {Record<string, string | undefined>} */
function attributes({ role, name, labels, description, value, hint, number, least, most, on, expanded, opens, disabled, fixed, focusable, active, size, index }) {
  const isNumber = number !== undefined && ["range", "number", "progressbar"].includes(role);
  const isInput = role === "range" || role === "number";
  const text = (/** @type {unknown} */ value) => (value === undefined ? undefined : String(value));
  return {
    // Also of what cannot be used: buttons and fields without it would stand in the Tab order of the page.
    tabindex: focusable || !STILL.includes(role) ? "-1" : undefined,
    "aria-label": (!NAMED_BY_TEXT.includes(role) && name) || undefined,
    "aria-labelledby": labels?.map((label) => `t${label}`).join(" "),
    "aria-description": description || undefined,
    "aria-disabled": disabled ? "true" : undefined,
    "aria-readonly": fixed ? "true" : undefined,
    "aria-expanded": text(expanded),
    "aria-haspopup": opens || undefined,
    "aria-checked": role === "menuitemcheckbox" ? on || "false" : undefined,
    "aria-selected": role === "option" ? on || "false" : role === "row" ? on || undefined : undefined,
    "aria-rowcount": text(size?.[0]),
    "aria-colcount": text(size?.[1]),
    "aria-rowindex": role === "row" ? text(index) : undefined,
    "aria-colindex": role === "row" ? undefined : text(index),
    "aria-pressed": role === "button" ? on || undefined : undefined,
    "aria-activedescendant": active && `t${active}`,
    "aria-valuetext": isNumber ? value : undefined,
    "aria-valuenow": isNumber && !isInput ? text(number) : undefined,
    min: isInput ? text(least) : undefined,
    max: isInput ? text(most) : undefined,
    step: isInput ? "any" : undefined,
    placeholder: hint || undefined,
    readonly: fixed && ["text", "area", "number"].includes(role) ? "" : undefined,
  };
}
