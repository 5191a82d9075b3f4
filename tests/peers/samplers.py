"""Makes one set by a sampler of Python: samplers.py NAME RADIUS SEED FILE.

Writes positions in the unit square or the unit cube, or in the square of 100 x 100 with a hundred times the radius, and prints the seconds of the processor that the set took. The first set,
which is small, is not counted: it loads and compiles.
"""

import random
import sys
import time

import numpy as np


def by_scipy(radius, seed):
    from scipy.stats import qmc

    return qmc.PoissonDisk(2, radius=radius, rng=np.random.default_rng(seed)).fill_space()


def by_scipy_in_space(radius, seed):
    from scipy.stats import qmc

    return qmc.PoissonDisk(3, radius=radius, rng=np.random.default_rng(seed)).fill_space()


def by_poisson_disc_in_space(radius, seed):
    from poisson_disc import Bridson_sampling

    np.random.seed(seed)
    return Bridson_sampling(dims=np.array([1.0, 1.0, 1.0]), radius=radius)


def by_poisson_disc(radius, seed):
    from poisson_disc import Bridson_sampling

    np.random.seed(seed)
    return Bridson_sampling(dims=np.array([1.0, 1.0]), radius=radius)


def by_bridson(radius, seed):
    from bridson import poisson_disc_samples

    return poisson_disc_samples(1.0, 1.0, radius, random=random.Random(seed).random)


def by_blue_noise(radius, seed):
    from blue_noise import FastPoissonDisk

    random.seed(seed)
    return FastPoissonDisk(1.0, 1.0, radius).samples()


def by_poisson_d(radius, seed):
    from poisson_d import poisson_d as module

    # It prints what it does, and its domain has whole sides.
    module.console.quiet = True
    random.seed(seed)
    made = module.poisson_d(SIDE, SIDE, radius * SIDE, max_points=10**9)
    return [(point.x, point.y) for point in made]


# The square of samplers whose domain has whole sides. Positions stay in it, as scaled ones would be rounded again.
SIDE = 100

SAMPLERS = {
    "scipy": by_scipy,
    "scipy, space": by_scipy_in_space,
    "poisson_disc, space": by_poisson_disc_in_space,
    "poisson_disc": by_poisson_disc,
    "bridson": by_bridson,
    "blue-noise": by_blue_noise,
    "poisson-d": by_poisson_d,
}


def main():
    name, radius, seed, path = sys.argv[1:]
    make = SAMPLERS[name]
    make(min(10 * float(radius), 0.3), 0)
    began = time.process_time()
    points = make(float(radius), int(seed))
    spent = time.process_time() - began
    np.save(path, np.asarray(points, dtype=float).reshape(len(points), -1))
    print(spent)


if __name__ == "__main__":
    main()
