"""Samplers that Python offers, side by side: the same domain and radius, and one verifier.

python benchmarks/peers.py [--radius R] [--rounds N]

It needs scipy, and takes poisson_disc if it is installed. Seconds are those of the processor, on
one thread: so they do not depend on what else the machine does.
"""

import argparse
import platform
import time
from importlib.metadata import PackageNotFoundError, version

import numpy as np
from scipy.stats import qmc

import tilescope
from tilescope import qmc as ours

# Where a map might have its corner: eastings and northings in metres.
ORIGIN = np.array([500_000.0, 5_400_000.0])


def by_scipy(radius, low, high, seed):
    engine = qmc.PoissonDisk(2, radius=radius, l_bounds=low, u_bounds=high, rng=np.random.default_rng(seed))
    return engine.fill_space()


def by_engine(radius, low, high, seed):
    return ours.PoissonDisk(2, radius=radius, l_bounds=low, u_bounds=high, rng=seed).fill_space()


def by_poisson_disc(radius, low, high, seed):
    from poisson_disc import Bridson_sampling

    np.random.seed(seed)
    return Bridson_sampling(dims=high - low, radius=radius) + low


def by_tilescope(radius, low, high, seed):
    width, height = high - low
    points = tilescope.sample(radius=radius, width=width, height=height, boundary="bounded", seed=seed)
    return points.points + low


def by_darts(radius, low, high, seed):
    width, height = high - low
    made = {"width": width, "height": height, "boundary": "bounded", "method": "reference"}
    return tilescope.sample(radius=radius, seed=seed, **made).points + low


def measured(make, radius, low, high, rounds):
    """Returns the report on the last set, and its samples per second in the best of some rounds."""
    best = np.inf
    for seed in range(1, rounds + 1):
        began = time.process_time()
        points = make(radius, low, high, seed)
        best = min(best, time.process_time() - began)
    width, height = high - low
    # Samples on the border stay there, whatever the rounding of its coordinates.
    inside = np.clip(points - low, 0, high - low)
    report = tilescope.verify(inside, radius, width=width, height=height, boundary="bounded")
    return report, len(points) / best


def reach_of_first(engine_of, count, rounds):
    """Returns the largest distance from a place of the unit square to the first samples of an engine, on average."""
    reaches = []
    for seed in range(1, rounds + 1):
        first = engine_of(2, radius=0.02, rng=seed).random(count)
        reaches.append(tilescope.verify(first, 0.02, boundary="bounded").covering_radius)
    return np.mean(reaches)


def name_of(package):
    try:
        return f"{package} {version(package)}"
    except PackageNotFoundError:
        return None


def main():
    arguments = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    arguments.add_argument("--radius", type=float, default=0.01, help="radius in the unit square [default: 0.01]")
    arguments.add_argument("--rounds", type=int, default=3, help="sets of each sampler [default: 3]")
    given = arguments.parse_args()

    tilescope.set_threads(1)
    samplers = [
        ("tilescope.sample", by_tilescope),
        ("tilescope.sample, method='reference'", by_darts),
        ("tilescope.qmc.PoissonDisk", by_engine),
        (f"scipy.stats.qmc.PoissonDisk, {name_of('scipy')}", by_scipy),
    ]
    if name_of("poisson_disc"):
        samplers.append((name_of("poisson_disc"), by_poisson_disc))
    domains = [
        ("the unit square", given.radius, np.zeros(2), np.ones(2)),
        ("a square kilometre of a map", 1000 * given.radius, ORIGIN, ORIGIN + 1000),
    ]
    print(f"Python {platform.python_version()}, numpy {np.__version__}, one thread of {platform.machine()}\n")
    for domain, radius, low, high in domains:
        print(f"In {domain}, radius {radius:g}:\n")
        print("| sampler | samples | samples/s | smallest distance / r | covering radius / r | conflicts | gaps |")
        print("|---|---|---|---|---|---|---|")
        for name, make in samplers:
            # What is made once and kept is not counted.
            make(radius * 10, low, high, 0)
            report, rate = measured(make, radius, low, high, given.rounds)
            print(
                f"| {name} | {report.count} | {rate:,.0f} | {report.min_distance / radius:.6f} "
                f"| {report.covering_radius / radius:.4f} | {report.conflicts} | {report.gaps} |",
                flush=True,
            )
        print()
    print("Largest distance from a place of the unit square to the nearest of the first samples, radius 0.02:\n")
    print("| the first | tilescope.qmc.PoissonDisk | scipy.stats.qmc.PoissonDisk |")
    print("|---|---|---|")
    for count in (10, 30, 100, 300, 1000):
        reaches = (reach_of_first(engine, count, given.rounds) for engine in (ours.PoissonDisk, qmc.PoissonDisk))
        print(f"| {count} |" + "".join(f" {reach:.3f} |" for reach in reaches))


if __name__ == "__main__":
    main()
