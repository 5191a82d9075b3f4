// @ts-check
// Checks the program's requirements before it is loaded, and shows what is missing.

import { element, loaded } from "./{{asset:sheets.js}}";

/** A module with one function that returns a vector. */
const VECTORS = Uint8Array.of(
  0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11,
);

/** Returns a sentence for each thing that is missing. @returns {Promise<string[]>} */
export async function missing() {
  const found = [];
  if (typeof WebAssembly !== "object") {
    found.push("It has no WebAssembly. Some browsers switch it off in their strictest mode.");
  }
  if (typeof WebAssembly === "object" && !WebAssembly.validate(VECTORS)) {
    found.push("Its WebAssembly has no vector instructions (SIMD). Newer versions have them.");
  }
  if (!hasWebGl() && !(await hasWebGpu())) {
    found.push("It has neither WebGL 2 nor WebGPU to draw with. Hardware acceleration may be switched off.");
  }
  return found;
}

/** @returns {boolean} */
function hasWebGl() {
  try {
    const context = document.createElement("canvas").getContext("webgl2");
    // Browsers limit the number of contexts.
    context?.getExtension("WEBGL_lose_context")?.loseContext();
    return context !== null;
  } catch {
    return false;
  }
}

/** @returns {Promise<boolean>} */
async function hasWebGpu() {
  try {
    // The interface may exist without an adapter.
    const gpu = /** @type {any} */ (navigator).gpu;
    return Boolean(await gpu?.requestAdapter());
  } catch {
    return false;
  }
}

/** Shows what is missing instead of the program. @param {string[]} sentences */
export function showMissing(sentences) {
  const items = sentences.map((sentence) => {
    const item = document.createElement("li");
    item.textContent = sentence;
    return item;
  });
  element("missing-list").replaceChildren(...items);
  element("canvas").hidden = true;
  loaded();
  element("missing").hidden = false;
}
