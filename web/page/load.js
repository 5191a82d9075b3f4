// @ts-check
// The program's module, compiled while it arrives.

/** Where the module is, and its size in bytes, uncompressed: servers tell the compressed one, or none. */
const MODULE = new URL("./{{asset:tilescope_bg.wasm}}", import.meta.url);
const TOTAL = Number("{{size:tilescope_bg.wasm}}");

/**
 * Returns the compiled module and tells how much of it has come.
 * @param {(bytes: number, total: number) => void} progress
 * @returns {Promise<WebAssembly.Module>}
 */
export async function load(progress) {
  const response = await fetch(MODULE);
  if (!response.ok) {
    throw new Error(`the server answered ${response.status} when asked for the program`);
  }
  // Browsers keep what they compiled of a response that they fetched themselves, so the bar counts a copy.
  const counted = count(response.clone(), progress);
  const [module] = await Promise.all([compile(response), counted]);
  return module;
}

/** @param {Response} response @returns {Promise<WebAssembly.Module>} */
async function compile(response) {
  const kind = response.headers.get("Content-Type") ?? "";
  // Compiling while it arrives is refused for any other kind, and some servers do not know this one.
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
