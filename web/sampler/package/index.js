// @ts-check
// Loads the module and speaks with it: settings are written as numbers into its memory, positions or an error are read from
// there. Types and what callers may rely on are in index.d.ts.

/**
 * The functions of the module (`src/exports.rs`).
 * @typedef {{
 *   memory: WebAssembly.Memory,
 *   values: () => number,
 *   sample: (given: number) => number,
 *   plane: (given: number) => number,
 *   window: (plane: number, moves: boolean) => number,
 *   free: (plane: number) => number,
 *   result: () => number,
 *   error: () => number,
 * }} Exports
 */

/** @param {import("./index.d.ts").Source} [source] @returns {Promise<import("./index.d.ts").Sampler>} */
export async function load(source = new URL("./sampler.wasm", import.meta.url)) {
  return new Sampler(await instantiated(await source));
}

/** @param {URL | string | Response | BufferSource | WebAssembly.Module} source @returns {Promise<Exports>} */
async function instantiated(source) {
  const found = typeof source === "string" || source instanceof URL ? await fetched(new URL(source, import.meta.url)) : source;
  // A response is read as a whole: compiling it while it arrives asks for a content type that not every server sends.
  const bytes = typeof Response === "function" && found instanceof Response ? await found.arrayBuffer() : found;
  const module = bytes instanceof WebAssembly.Module ? bytes : await WebAssembly.compile(/** @type {BufferSource} */ (bytes));
  const { exports } = await WebAssembly.instantiate(module);
  return /** @type {any} */ (exports);
}

/** @param {URL} address @returns {Promise<Response | BufferSource>} */
async function fetched(address) {
  // Node.js fetches no files. Bundlers for browsers must not look for its modules.
  if (address.protocol === "file:") {
    const files = "node:fs/promises";
    return (await import(/* webpackIgnore: true */ /* @vite-ignore */ files)).readFile(address);
  }
  const response = await fetch(address);
  if (!response.ok) {
    throw new Error(`${address} was answered with ${response.status}`);
  }
  return response;
}

/** The names of choices, each by its number. */
const BOUNDARIES = ["periodic", "bounded"];
/**
 * How each setting becomes the 64 bits of a value, in the order of the module's values (`Settings` of `src/request.rs`).
 * @type {[string, "float" | "whole" | "flag" | string[]][]}
 */
const SETTINGS = [
  ["radius", "float"],
  ["count", "whole"],
  ["width", "float"],
  ["height", "float"],
  ["boundary", BOUNDARIES],
  ["seed", "whole"],
  ["method", ["kdrt", "exact", "reference"]],
  ["leaf", "float"],
  ["patternSide", "float"],
  ["patternSeed", "whole"],
  ["patternBoundary", BOUNDARIES],
  ["dihedral", "flag"],
  ["order", ["index", "random", "own-block-first", "phase-group"]],
  ["insertion", ["circumcentre", "uniform"]],
  ["search", ["complete", "two-radii"]],
];
const NAMES = SETTINGS.map(([name]) => name);

/** Returns a value as text, for errors. @param {unknown} value */
const shown = (value) => (typeof value === "string" ? JSON.stringify(value) : String(value));

/**
 * Returns the bits of a setting.
 * @param {string} name
 * @param {unknown} value
 * @param {"float" | "whole" | "flag" | string[]} kind
 * @returns {bigint}
 */
function bitsOf(name, value, kind) {
  if (Array.isArray(kind)) {
    const number = kind.indexOf(String(value));
    if (number < 0) {
      throw new RangeError(`${name} is ${shown(value)}; it must be one of ${kind.join(", ")}`);
    }
    return BigInt(number);
  }
  if (kind === "flag") {
    return value ? 1n : 0n;
  }
  if (kind === "whole") {
    const isWhole = typeof value === "bigint" || Number.isSafeInteger(value);
    const whole = isWhole ? BigInt(/** @type {bigint} */ (value)) : -1n;
    // Above 2^53 a number is rounded, so that a bigint is asked for.
    if (whole < 0n || whole >= 1n << 64n) {
      throw new RangeError(`${name} is ${shown(value)}; it must be a whole number from 0 to 2^53, or a bigint below 2^64`);
    }
    return whole;
  }
  return bitsOfFloat(name, value);
}

/** @param {string} name @param {unknown} value */
function bitsOfFloat(name, value) {
  if (typeof value !== "number") {
    throw new RangeError(`${name} is ${shown(value)}; it must be a number`);
  }
  return new BigUint64Array(new Float64Array([value]).buffer)[0];
}

class Sampler {
  /** @type {Exports} */
  #module;

  /** @param {Exports} module */
  constructor(module) {
    this.#module = module;
  }

  /** @param {import("./index.d.ts").SetSettings} settings @returns {import("./index.d.ts").SampledSet} */
  sample(settings) {
    const numbers = this.#numbers(this.#module.sample(this.#give(settings)));
    return { radius: numbers[0], points: numbers.slice(1) };
  }

  /** @param {import("./index.d.ts").PlaneSettings} settings @returns {import("./index.d.ts").Plane} */
  plane({ period, ...settings }) {
    const given = this.#give(period === undefined ? settings : { ...settings, width: period });
    const [number] = this.#numbers(this.#module.plane(given));
    return new Plane({
      window: (rectangles) => {
        for (const sides of rectangles) {
          if (sides.length !== 4) {
            throw new RangeError(`a rectangle has ${sides.length} sides; it must have 4: left, bottom, right, top`);
          }
        }
        rectangles.flat().forEach((side, k) => this.#put(k, bitsOfFloat("a side of the rectangle", side)));
        return this.#numbers(this.#module.window(number, rectangles.length > 1));
      },
      free: () => void this.#numbers(this.#module.free(number)),
    });
  }

  /** Writes settings where the module reads them. @param {object} settings @returns {number} which of them are given */
  #give(settings) {
    let given = 0;
    for (const [name, value] of Object.entries(settings)) {
      const index = NAMES.indexOf(name);
      if (index < 0) {
        throw new RangeError(`there is no setting ${shown(name)}; there are ${NAMES.join(", ")}`);
      }
      if (value !== undefined) {
        this.#put(index, bitsOf(name, value, SETTINGS[index][1]));
        given |= 1 << index;
      }
    }
    return given;
  }

  /** @param {number} index @param {bigint} bits */
  #put(index, bits) {
    // The memory is looked up each time, as it may have grown, which detaches its buffer.
    new BigUint64Array(this.#module.memory.buffer, this.#module.values() >>> 0)[index] = bits;
  }

  /** Returns what the module has made, or throws what it refused. @param {number} length @returns {Float64Array} */
  #numbers(length) {
    const { memory, result, error } = this.#module;
    if (length < 0) {
      throw new RangeError(new TextDecoder().decode(new Uint8Array(memory.buffer, error() >>> 0, -length)));
    }
    // Addresses beyond 2^31 come as negative numbers.
    return new Float64Array(memory.buffer, result() >>> 0, length).slice();
  }
}

class Plane {
  /** @type {{ window: (rectangles: import("./index.d.ts").Rectangle[]) => Float64Array, free: () => void }} */
  #module;

  /** @param {{ window: (rectangles: import("./index.d.ts").Rectangle[]) => Float64Array, free: () => void }} module */
  constructor(module) {
    this.#module = module;
  }

  /** @param {import("./index.d.ts").Rectangle} rectangle */
  window(rectangle) {
    return this.#module.window([rectangle]);
  }

  /** @param {import("./index.d.ts").Rectangle} from @param {import("./index.d.ts").Rectangle} to */
  gained(from, to) {
    return this.#module.window([to, from]);
  }

  free() {
    this.#module.free();
  }
}
