// @ts-check
// Loads the program's module and compiles it while it arrives.

/** The module's address and its uncompressed size in bytes, since servers report the compressed size or none. */
const MODULE = new URL("./{{asset:tilescope_bg.wasm}}", import.meta.url);
const TOTAL = Number("{{size:tilescope_bg.wasm}}");

/**
 * Returns the compiled module and reports how much of it has arrived.
 * @param {(bytes: number, total: number) => void} progress
 * @returns {Promise<WebAssembly.Module>}
 */
export async function load(progress) {
  const response = await fetch(MODULE);
  if (!response.ok) {
    throw new Error(`the server answered ${response.status} when asked for the program`);
  }
  // Browsers cache the compiled code only of an original response, so the bytes for the progress bar are counted on a
  // clone.
  const counted = count(response.clone(), progress);
  const [module] = await Promise.all([compile(response), counted]);
  return module;
}

/** Compiles a module while it arrives. @param {Response} response @returns {Promise<WebAssembly.Module>} */
export async function compile(response) {
  const kind = response.headers.get("Content-Type") ?? "";
  // Streaming compilation requires this content type, which some servers do not send.
  if (kind.trim().toLowerCase() === "application/wasm") {
    return WebAssembly.compileStreaming(response);
  }
  return WebAssembly.compile(await response.arrayBuffer());
}

/** @param {Response} response @param {(bytes: number, total: number) => void} progress */
async function count(response, progress) {
  const reader = response.body?.getReader();
  let bytes = 0;
  for (;;) {
    const part = await reader?.read();
    if (!part || part.done) {
      return;
    }
    bytes += part.value.length;
    progress(bytes, TOTAL);
  }
}
