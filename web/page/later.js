// @ts-check Loads the part of the program that the start does without, such as exports, measures and pictures
// (`web/pack/src/cut.rs`).

import { compile } from "./{{asset:load.js}}";

const MODULE = new URL("./{{asset:tilescope_later.wasm}}", import.meta.url);

/** What the page says and the program reports when that part cannot be had. */
export const NOT_THERE = "The rest of the program, which this needs, could not be loaded";

/** Whether the part is there. */
let isThere = false;

/** Fetches and compiles the part. @returns {Promise<WebAssembly.Module>} */
export async function fetchLater() {
  const response = await fetch(MODULE);
  if (!response.ok) {
    throw new Error(`the server answered ${response.status}`);
  }
  return compile(response);
}

/**
 * Fetches and compiles the part while everything else waits: the program needs it now.
 * @returns {WebAssembly.Module}
 */
export function fetchLaterNow() {
  const request = new XMLHttpRequest();
  request.open("GET", MODULE, false);
  // A document may not ask for bytes in this way. In this encoding the low byte of each character is the byte.
  request.overrideMimeType("text/plain; charset=x-user-defined");
  request.send();
  if (request.status !== 200) {
    throw new Error(`the server answered ${request.status}`);
  }

  const text = request.responseText;
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) {
    bytes[i] = text.charCodeAt(i);
  }
  return new WebAssembly.Module(bytes);
}

/**
 * Joins the part with the program while nothing waits for it: some browsers make instances of large modules on the page's thread
 * in this way alone. Should the program have loaded it meanwhile, the same slots are filled again.
 * @param {WebAssembly.Exports} program @param {WebAssembly.Module} module
 */
export async function joinSoon(program, module) {
  await WebAssembly.instantiate(module, { "": /** @type {any} */ (program) });
  isThere = true;
}

/**
 * Joins the part with the program, unless it is there already.
 * @param {WebAssembly.Exports} program @param {WebAssembly.Module} module
 */
export function join(program, module) {
  if (!isThere) {
    // It fills the program's table of slots, and exports nothing.
    new WebAssembly.Instance(module, { "": /** @type {any} */ (program) });
    isThere = true;
  }
}
