// What the tests of the package share: the package as npm has packed it, the native program, and a digest to compare the two by.

import { execFile } from "node:child_process";
import { createHash } from "node:crypto";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";

const run = promisify(execFile);
const here = path.dirname(fileURLToPath(import.meta.url));
const PROGRAM = process.env.TILESCOPE ?? path.join(here, "../../target/release/tilescope");
/** The package, unpacked as npm install does it. */
export const PACKAGE = path.join(here, "dist/package");

/** Returns the digest of positions. @param {Float64Array} points */
export function digest(points) {
  const bytes = new Uint8Array(points.buffer, points.byteOffset, points.byteLength);
  return createHash("sha256").update(bytes).digest("hex");
}

/** Returns the positions that the native program makes. @param {string} words its arguments */
export async function native(words) {
  const folder = await mkdtemp(path.join(tmpdir(), "tilescope-sampler-"));
  try {
    const file = path.join(folder, "set.npy");
    await run(PROGRAM, ["sample", ...words.split(" "), "--out", file]);
    const bytes = await readFile(file);
    // A header of version 1 has its length in two bytes, and the positions begin behind it.
    const begin = 10 + bytes.readUInt16LE(8);
    return new Float64Array(bytes.buffer.slice(bytes.byteOffset + begin, bytes.byteOffset + bytes.length));
  } finally {
    await rm(folder, { recursive: true });
  }
}
