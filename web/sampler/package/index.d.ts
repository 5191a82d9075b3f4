/** How a domain ends: opposite sides are joined, or the border is closed and covered. */
export type Boundary = "periodic" | "bounded";

/** What a tiling is made from. Lengths are in user units, but for `leaf` and `patternSide`, which are in radii. */
export interface TilingSettings {
  /** The smallest distance between two samples, and the largest from any place to its nearest sample. */
  radius?: number;
  /** A whole number below 2^64: a number up to 2^53, or a bigint. 1 if it is not given. */
  seed?: number | bigint;
  /** The shortest edge of a block, from 6 on; 30 if it is not given. */
  leaf?: number;
  /** The side of the pattern, from 10 on; if it is not given 100, and of exact tilings by the size of the set. */
  patternSide?: number;
  patternSeed?: number | bigint;
  patternBoundary?: Boundary;
  /** Whether blocks turn and mirror the pattern. */
  dihedral?: boolean;
  order?: "index" | "random" | "own-block-first" | "phase-group";
  insertion?: "circumcentre" | "uniform";
  search?: "complete" | "two-radii";
}

/** What a set is made from: a radius or a count. */
export interface SetSettings extends TilingSettings {
  /** Choose the radius so that so many samples result, to within 1%; with the method "kdrt". */
  count?: number;
  /** The sides of the domain, 1 if they are not given. */
  width?: number;
  height?: number;
  boundary?: Boundary;
  /** Randomized tiling, tiling without bias at seams, or dart throwing from scratch. "kdrt" if it is not given. */
  method?: "kdrt" | "exact" | "reference";
}

/** What a plane is made from. */
export interface PlaneSettings extends TilingSettings {
  radius: number;
  method?: "kdrt" | "exact";
  /** The side of the square after which the plane repeats; 65,000 radii if it is not given. */
  period?: number;
}

/** A set: conflict-free and maximal. */
export interface SampledSet {
  /** The radius that was given, or that was found for a count. */
  radius: number;
  /** x and y of each sample, in canonical order: those of `tilescope sample`, bit for bit. */
  points: Float64Array;
}

/** Left, bottom, right and top: `left <= x < right` and `bottom <= y < top`. */
export type Rectangle = readonly [left: number, bottom: number, right: number, top: number];

/** A plane of samples without end, of which any window can be asked for. */
export interface Plane {
  /** Returns x and y of each sample in a rectangle, of at most a period a side. */
  window(rectangle: Rectangle): Float64Array;
  /** Returns those in `to` that are not in `from`: what comes into view when a viewer moves. */
  gained(from: Rectangle, to: Rectangle): Float64Array;
  /** Frees the plane's memory. One of exact tiling keeps a part of it as long as its sampler. */
  free(): void;
}

/** The sampler. Each one has a memory of its own; a worker can load one. */
export interface Sampler {
  /**
   * Makes a set.
   * @throws {RangeError} that names the value and the limit
   */
  sample(settings: SetSettings): SampledSet;
  /**
   * Makes a plane, which takes some milliseconds; with the method "exact" some seconds.
   * @throws {RangeError} that names the value and the limit
   */
  plane(settings: PlaneSettings): Plane;
}

/** Where the module is: an address, what a fetch answered, its bytes, or compiled. */
export type Source = URL | string | BufferSource | WebAssembly.Module | Response | Promise<Response>;

/** Loads the module: from the file beside this one, or from `source`. */
export function load(source?: Source): Promise<Sampler>;
