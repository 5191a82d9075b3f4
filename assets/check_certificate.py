#!/usr/bin/env python3
"""Checks a point set against its certificate: check_certificate.py SET.csv (or SET.npy)

Written from crates/formats/CERTIFICATE.md alone; it needs numpy. It measures the set again: digests, the smallest
distance, and the covering radius, by cutting the region into rectangles until none can hold a place that is farther.
Exit code 0: all is as stated, and the set is valid. 1: it is not. 2: this program cannot judge the set, and says why.
"""

import json
import sys

import numpy as np

ALLOWED = 1e-9  # relative difference between numbers of two programs
FIELDS = """format_version program program_version method parameters region radius covering_tolerance count
    min_distance covering_radius conflicts gaps density relative_radius valid judges file file_format precision scale
    shuffle_seed rounding positions_digest digest""".split()
UNJUDGED = "levels depth shape prefix thinned".split()
# BLAKE3's initial value, and the order of a block's words in the next round.
START = "6a09e667 bb67ae85 3c6ef372 a54ff53a 510e527f 9b05688c 1f83d9ab 5be0cd19"
START = np.array([[int(word, 16)] for word in START.split()], np.uint32)
ORDER = [2, 6, 3, 10, 7, 0, 4, 13, 1, 11, 12, 5, 9, 14, 15, 8]
TURNS = [[1, 2, 3, 0], [2, 3, 0, 1], [3, 0, 1, 2]]
CHUNK_START, CHUNK_END, PARENT, ROOT = 1, 2, 4, 8


class Unjudged(Exception):
    """The set or its certificate is of a kind that this program does not judge."""


def turned(words, by):
    return words >> np.uint32(by) | words << np.uint32(32 - by)


def compress(chained, blocks, counter, lengths, flags):
    """Compresses n blocks, (16, n), into n chained values, (8, n). Each of a, b, c, d is a row of four words."""
    a, b, c = chained[:4], chained[4:], START[:4]
    last = [np.broadcast_to(words, blocks.shape[1]) for words in (counter, 0, lengths, flags)]
    d = np.array(last).astype(np.uint32)
    for _ in range(7):
        for half, order in ((blocks[:8], TURNS), (blocks[8:], TURNS[::-1])):  # columns, then diagonals
            for words, right, left in ((half[::2], 16, 12), (half[1::2], 8, 7)):
                a = a + b + words
                d = turned(d ^ a, right)
                c = c + d
                b = turned(b ^ c, left)
            b, c, d = b[order[0]], c[order[1]], d[order[2]]
        blocks = blocks[ORDER]
    return np.vstack([a ^ c, b ^ d])


def blake3(data):
    """Compresses chunks of 1,024 bytes all at once, block by block, and then pairs of them until one is left."""
    n = max(1, -(-len(data) // 1024))
    blocks = np.frombuffer(data.ljust(n * 1024, b"\0"), "<u4").reshape(n, 16, 16)
    left = len(data) - 1024 * np.arange(n)
    nodes = np.repeat(START, n, axis=1)
    for i in range(16):
        is_last = (left <= 64 * (i + 1)) | (i == 15)
        flags = (i == 0) * CHUNK_START + is_last * (CHUNK_END + (n == 1) * ROOT)
        compressed = compress(nodes, blocks[:, i].T, np.arange(n), np.clip(left - 64 * i, 0, 64), flags)
        nodes = np.where((left > 64 * i) | (i == 0), compressed, nodes)  # a short chunk has fewer blocks
    while nodes.shape[1] > 1:
        pairs = nodes.shape[1] // 2
        both = np.vstack([nodes[:, 0 : 2 * pairs : 2], nodes[:, 1 : 2 * pairs : 2]])
        parents = compress(np.repeat(START, pairs, axis=1), both, 0, 64, PARENT + (nodes.shape[1] == 2) * ROOT)
        nodes = np.hstack([parents, nodes[:, 2 * pairs :]])  # one that is left over waits for the next level
    return "blake3:" + nodes[:, 0].astype("<u4").tobytes().hex()


class Grid:
    """Points in cells of side `reach`: those within `reach` of a place of the region are in 3 x 3 cells around it."""

    def __init__(self, points, sides, reach):
        self.reach, self.columns = reach, int(sides[0] / reach) + 5
        cells = self.cells(points)
        self.order = np.argsort(cells)
        self.points, rows = points[self.order], int(sides[1] / reach) + 5
        self.starts = np.searchsorted(cells[self.order], np.arange(self.columns * rows + 1))

    def cells(self, places):
        column, row = (np.floor(places / self.reach).astype(int) + 2).T  # copies of points lie at most `reach` outside
        return row * self.columns + column

    def nearest(self, places, but):
        """Distances to the nearest points, but for those of the numbers `but`; infinite beyond `reach`."""
        found, around = np.full(len(places), np.inf), self.cells(places)
        for cell in [around + dy * self.columns + dx for dy in (-1, 0, 1) for dx in (-1, 0, 1)]:
            for i in range((self.starts[cell + 1] - self.starts[cell]).max()):
                point = self.starts[cell] + i
                held = np.flatnonzero(point < self.starts[cell + 1])
                held = held[self.order[point[held]] != but[held]]
                found[held] = np.minimum(found[held], np.hypot(*(places[held] - self.points[point[held]]).T))
        return np.where(found <= self.reach, found, np.inf)


def measure(points, sides, periodic, reach):
    """Returns the smallest distance and the covering radius; infinite beyond `reach`."""
    copies = [int(np.ceil(reach / side)) if periodic else 0 for side in sides]
    columns, rows = (range(-n, n + 1) for n in copies)
    shifts = sorted(((x * sides[0], y * sides[1]) for x in columns for y in rows), key=lambda shift: shift != (0, 0))
    everywhere = np.vstack([points + shift for shift in shifts])  # the points themselves are the first
    near = ((everywhere >= -reach) & (everywhere <= np.add(sides, reach))).all(axis=1)
    grid = Grid(everywhere[near], sides, reach)
    smallest = grid.nearest(points, np.arange(len(points))).min()

    counts = np.ceil(np.divide(sides, reach / 4)).astype(int)
    half = np.divide(sides, 2 * counts)
    places = np.stack(np.meshgrid(*(np.arange(n) for n in counts)), axis=-1).reshape(-1, 2) * 2 * half + half
    farthest = 0.0
    while np.hypot(*half) > ALLOWED / 10 * reach:
        found = grid.nearest(places, np.full(len(places), -1))
        farthest = max(farthest, found.max())
        if not np.isfinite(farthest):
            break
        places = places[found + np.hypot(*half) > farthest]  # no place of the others is farther
        half = half / 4
        places = np.vstack([places + half * (x, y) for x in (-3, -1, 1, 3) for y in (-3, -1, 1, 3)])
    return smallest, farthest


def distinct(pairs):
    if len(pairs) != len(dict(pairs)):
        raise Unjudged("the certificate has a name twice")
    return dict(pairs)


def read(path):
    """Returns the bytes and the coordinates of a file, and its certificate."""
    with open(path, "rb") as data, open(path + ".certificate.json", "rb") as stated:
        data, stated = data.read(), json.load(stated, object_pairs_hook=distinct)
    if path.endswith(".csv"):
        return data, np.loadtxt(path, delimiter=",", skiprows=1, usecols=(0, 1), ndmin=2), stated
    if path.endswith(".npy"):
        return data, np.load(path, allow_pickle=False).astype(float), stated
    raise Unjudged(f"{path}: this program reads .csv and .npy")


def same(found, stated):
    return found is stated if None in (found, stated) else abs(found - stated) <= ALLOWED * abs(stated)


def check(data, held, stated):
    """Returns the names of the fields that are false."""
    if "depth" in stated:
        raise Unjudged("the certificate has `depth`: the set is one in space, and this program judges rectangles alone")
    part = next((name for name in UNJUDGED if name in stated), None)
    if part or isinstance(stated["radius"], dict):
        raise Unjudged(f"the certificate has `{part or 'radius'}`, and one radius in a rectangle is judged")
    version = 1 + ("origin" in stated)
    if sorted(stated) != sorted(FIELDS + ["origin"] * (version - 1)) or stated["format_version"] != version:
        raise Unjudged("the fields of the certificate are not those of its version")

    r, n, region = stated["radius"], len(held), stated["region"]
    sides, periodic = (region["width"], region["height"]), region["boundary"] == "periodic"
    origin = np.array(stated.get("origin", [0, 0]))
    end = origin + np.divide(sides, stated["scale"])
    if not (n and ((held >= origin) & ((held < end) if periodic else (held <= end))).all()):
        return ["region" if n else "count"]

    # A difference may be rounded beyond a side that the file's coordinate is not beyond.
    points = (held - origin) * stated["scale"]
    points = np.where(points >= sides, 0, points) if periodic else np.minimum(points, sides)
    limit = (1 + stated["covering_tolerance"]) * r
    reach = 1.01 * max(2 * limit, stated["covering_radius"])  # in a maximal set, the nearest point is within 2 r
    if reach > 20 * r:
        raise Unjudged(f"the covering radius is {stated['covering_radius']}; at most 19 times the radius is judged")
    smallest, covering = measure(points, sides, periodic, reach)
    area = sides[0] * sides[1]
    found = {
        "min_distance": smallest if np.isfinite(smallest) else None,
        "relative_radius": smallest / np.sqrt(2 * area / (np.sqrt(3) * n)) if np.isfinite(smallest) else None,
        "covering_radius": covering,
        "density": n * r**2 / area,
    }
    exact = {"digest": blake3(data), "positions_digest": blake3(held.astype("<f8").tobytes()), "count": n}
    exact |= {"valid": not (stated["conflicts"] or stated["gaps"])}
    claims = {"conflicts": smallest < r * (1 - ALLOWED), "gaps": covering > limit * (1 + ALLOWED)}
    false = [name for name, value in found.items() if not same(value, stated[name])]
    false += [name for name, value in exact.items() if value != stated[name]]
    false += [name for name, holds in claims.items() if holds != (stated[name] > 0)]
    again = {**region, "radius": r}
    repeated = stated["parameters"]
    return false + [f"parameters.{name}" for name in again if repeated.get(name, again[name]) != again[name]]


def main(path):
    try:
        data, held, stated = read(path)
        false = check(data, held, stated)
    except (OSError, ValueError, KeyError, TypeError, Unjudged) as reason:
        print(f"not judged: {reason}")
        return 2
    print("the certificate is " + ("false in: " + ", ".join(false) if false else "true"))
    print("the set is " + ("VALID" if stated["valid"] and not false else "NOT VALID"))
    return 0 if stated["valid"] and not false else 1


if __name__ == "__main__":
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    sys.exit(main(sys.argv[1]))
