"""Judges public samplers by `tilescope verify` and writes CONFORMANCE.md.

`conformance`, beside this file, prepares and runs it: conformance.py PROGRAM PEERS PYTHON NODE_FOLDER, the program
that judges, the one with the samplers of Rust, the Python that has the samplers of Python, and the folder whose
node_modules has those of JavaScript.
"""

import datetime
import json
import platform
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent
RADIUS = 0.01
# In the unit cube, which then has about 5,900 samples.
SPACE_RADIUS = 0.05
SEEDS = (1, 2, 3)
# A sampler that takes longer for one set of about 7,000 samples, or 6,000 in space, is named as too slow.
PATIENCE_S = 600


@dataclass
class Sampler:
    """A sampler: its name where it is published, the registry, and how its domain ends."""

    name: str
    registry: str
    boundary: str = "bounded"
    # How the sampler is called in samplers.py, samplers.mjs or main.rs, if not by its name.
    call: str = ""
    takes_seed: bool = True
    # The side of its square, of which r is a hundredth.
    side: int = 1
    words: str = ""
    in_space: bool = False

    @property
    def key(self):
        return self.call or self.name


SAMPLERS = [
    Sampler("tilescope", "this", "periodic", "tilescope, leaf 40 r", words="randomized tiling, leaf 40 r"),
    Sampler("tilescope", "this", "bounded", "tilescope, bounded", words="randomized tiling, leaf 40 r"),
    Sampler("tilescope", "this", "periodic", "tilescope reference", words="dart throwing from scratch"),
    Sampler("fast_poisson", "crates.io"),
    Sampler("faster_poisson", "crates.io", call="faster_poisson, dart", words="darts"),
    Sampler("faster_poisson", "crates.io", call="faster_poisson, Bridson", words="Bridson"),
    Sampler("poisson", "crates.io", "periodic", "poisson, Ebeida", words="Ebeida"),
    Sampler("poisson-diskus", "crates.io", "periodic", "poisson_diskus (unseeded)", takes_seed=False),
    Sampler("scipy", "PyPI", words="stats.qmc.PoissonDisk"),
    Sampler("poisson_disc", "PyPI"),
    Sampler("bridson", "PyPI"),
    Sampler("blue-noise", "PyPI"),
    Sampler("poisson-d", "PyPI", side=100),
    Sampler("poisson-disk-sampling", "npm"),
    Sampler("fast-2d-poisson-disk-sampling", "npm"),
    Sampler("poisson-disc-sampler", "npm", takes_seed=False),
]

SPACE_SAMPLERS = [
    Sampler("tilescope", "this", "periodic", "tilescope, periodic", in_space=True),
    Sampler("tilescope", "this", "bounded", "tilescope, bounded", in_space=True),
    Sampler("fast_poisson", "crates.io", in_space=True),
    Sampler("faster_poisson", "crates.io", call="faster_poisson, dart", words="darts", in_space=True),
    Sampler("faster_poisson", "crates.io", call="faster_poisson, Bridson", words="Bridson", in_space=True),
    Sampler("poisson", "crates.io", "periodic", "poisson, Ebeida", words="Ebeida", in_space=True),
    Sampler("poisson-diskus", "crates.io", "periodic", "poisson_diskus (unseeded)", takes_seed=False, in_space=True),
    Sampler("scipy", "PyPI", call="scipy, space", words="stats.qmc.PoissonDisk", in_space=True),
    Sampler("poisson_disc", "PyPI", call="poisson_disc, space", in_space=True),
    Sampler("poisson-disk-sampling", "npm", call="poisson-disk-sampling, space", in_space=True),
]

# What was looked at and is not judged, with the reason.
LEFT_OUT = [
    ("poissonDiskSampling 1.0.0", "PyPI", "its wheel holds no module"),
    ("poisson-2d", "PyPI", "the registry has its name and no file"),
    ("polydisc 0.4.0", "PyPI", "it needs Python 3.13"),
    ("bsb-native 8.0.2", "PyPI", "it samples space, not the plane; it was not tested there"),
    ("SimpleMPS (Ebeida 2012) in space", "its paper", "no code of it is public"),
    ("@tsparticles/plugin-poisson-disc 4.3.2", "npm", "it is a plugin of an engine of animations"),
]

PAGE = """# Samplers, judged

<!-- Made by tests/peers/conformance on {day}. Changes are lost when it is made again. -->

Each sampler made {sets} sets in the unit square with r = {radius}, each in a process of its own, and `tilescope verify` judged the
files. Versions are those of {day}.

| sampler | border | samples | N r²/area | conflicts | smallest distance / r | gaps | covering radius / r | samples/s | equal seeds, equal points |
|---|---|---|---|---|---|---|---|---|---|
{rows}

## In space

In the same way {sets} sets of the unit cube with r = {space_radius}, judged by cubes and covered circles of spheres:

| sampler | border | samples | N r³/volume | conflicts | smallest distance / r | gaps | covering radius / r | samples/s | equal seeds, equal points |
|---|---|---|---|---|---|---|---|---|---|
{space_rows}

## What is compared

A *maximal Poisson-disk set* has no two samples closer than r and no place of its domain farther than r from all samples. Both are
statements about positions, and are judged from the files alone, by two judges that share no code with any sampler, this project's
included: Delaunay triangulation and covered circles, which must agree.

- **Conflicts** are pairs closer than r, **gaps** are uncovered places, each the largest number among the sets. The smallest distance and the
  covering radius are the worst, too; samples and density are means. A covering radius up to 1.0000305 counts as maximal, since this
  project's positions are rounded to a lattice.
- **Few claim more than they do.** Most of these samplers are Bridson's: they try some places around each sample (30, 300 or 5, as they come) and
  promise no conflicts, not maximality. Gaps are then no fault. They are what a user of such a set has to reckon with.
- **Border.** Most bounded samplers leave the border to chance: their widest gaps are mostly there. Periodic ones have no border. Compare like with
  like.
- **Samples a second** are of one thread and of seconds of the processor, the best of the sets, without loading: of one set after a small one in
  Python and JavaScript, of the same set for half a second in Rust. They are orders of magnitude: what else the machine did shows a little, the
  languages much, and rates of sets with other densities are of other work. The pattern of randomized tiling, which is made once and kept, is not counted.
- **Equal seeds**: the set of the first seed was made again in another process, and all bits compared. Where a sampler takes a generator instead
  of a seed, it got one with a seed. Of another machine nothing is known but for this project's own samplers, whose digests are pinned.

Settings are those that a caller gets who names domain and radius alone. Machine: {machine}, Python {python}, Node.js {node}.

## Not judged

{left_out}

`tests/peers/conformance` makes this page again, with the newest versions from the registries.
"""


def output(command, **options):
    return subprocess.run(command, check=True, capture_output=True, text=True, timeout=PATIENCE_S, **options).stdout


class Judge:
    """Makes sets by samplers, and judges them."""

    def __init__(self, program, peers, python, node_folder):
        self.program, self.peers, self.python, self.node_folder = program, peers, python, node_folder

    def make(self, sampler, seed, path):
        """Writes a set, and returns the seconds that it took."""
        arguments = [sampler.key, str(SPACE_RADIUS if sampler.in_space else RADIUS), str(seed), str(path)]
        if sampler.registry == "PyPI":
            return float(output([self.python, HERE / "samplers.py", *arguments]))
        if sampler.registry == "npm":
            return float(output(["node", HERE / "samplers.mjs", *arguments], cwd=self.node_folder))
        return float(output([self.peers, "--make-space" if sampler.in_space else "--make", *arguments]))

    def version(self, sampler):
        if sampler.registry == "PyPI":
            code = f"from importlib.metadata import version; print(version({sampler.name!r}))"
            return output([self.python, "-c", code]).strip()
        if sampler.registry == "npm":
            manifest = Path(self.node_folder) / "node_modules" / sampler.name / "package.json"
            return json.loads(manifest.read_text())["version"]
        lock = (HERE / "../../Cargo.lock").read_text()
        name = "tilescope-core" if sampler.registry == "this" else sampler.name
        return re.search(rf'name = "{name}"\nversion = "([^"]+)"', lock).group(1)

    def verdict(self, path, sampler):
        """Returns what `tilescope verify` says of a set of a sampler, by name."""
        sides = ["--width", str(sampler.side), "--height", str(sampler.side), "--boundary", sampler.boundary]
        radius = RADIUS * sampler.side
        if sampler.in_space:
            sides, radius = [*sides, "--depth", "1"], SPACE_RADIUS
        command = [self.program, "verify", path, "--radius", str(radius), *sides]
        verdict = subprocess.run(command, capture_output=True, text=True, check=False, timeout=PATIENCE_S)
        number = r"([0-9.]+(?:e-?[0-9]+)?)"
        found = {
            "samples": re.search(r"^samples +([0-9,]+)", verdict.stdout, re.M),
            "density": re.search(rf"^density +{number}", verdict.stdout, re.M),
            "conflicts": re.search(r"^conflict-free +(?:yes|NO, ([0-9,]+))", verdict.stdout, re.M),
            "distance": re.search(rf"min distance {number} r", verdict.stdout),
            "gaps": re.search(r"^maximal +(?:yes|NO, ([0-9,]+))", verdict.stdout, re.M),
            "covering": re.search(rf"covering radius {number} r", verdict.stdout),
        }
        # Code 1 is the verdict "not valid"; anything else is no verdict.
        if verdict.returncode not in (0, 1) or None in found.values():
            raise ValueError((verdict.stderr or verdict.stdout).strip().splitlines()[0])
        return {name: float((match.group(1) or "0").replace(",", "")) for name, match in found.items()}

    def row(self, sampler, folder):
        """Returns the row of a sampler."""
        ending = "npy" if sampler.registry == "PyPI" else "csv"
        verdicts, rates, files = [], [], []
        for seed in SEEDS:
            path = Path(folder) / f"{len(list(Path(folder).iterdir()))}.{ending}"
            spent = self.make(sampler, seed, path)
            verdicts.append(self.verdict(path, sampler))
            rates.append(verdicts[-1]["samples"] / spent)
            files.append(path.read_bytes())

        again = Path(folder) / f"again.{ending}"
        self.make(sampler, SEEDS[0], again)
        is_equal = again.read_bytes() == files[0]
        again.unlink()
        # A sampler that does not look at its seed makes the same set for all of them.
        equal = ("yes" if is_equal and files[0] != files[1] else "no") if sampler.takes_seed else "takes none"

        def each(name):
            return [verdict[name] for verdict in verdicts]

        words = f", {sampler.words}" if sampler.words else ""
        where = "" if sampler.registry == "this" else f" ({sampler.registry})"
        return (
            f"| `{sampler.name}` {self.version(sampler)}{where}{words} | {sampler.boundary} "
            f"| {sum(each('samples')) / len(SEEDS):,.0f} | {sum(each('density')) / len(SEEDS):.3f} "
            f"| {max(each('conflicts')):.0f} | {min(each('distance')):.6f} | {max(each('gaps')):,.0f} "
            f"| {max(each('covering')):.4f} | {float(f'{max(rates):.2g}'):,.0f} | {equal} |"
        )


def main():
    judge = Judge(*sys.argv[1:])
    rows, space_rows = [], []
    left_out = [f"- `{name}` ({where}): {why}." for name, where, why in LEFT_OUT]
    with tempfile.TemporaryDirectory() as folder:
        for sampler in SAMPLERS + SPACE_SAMPLERS:
            try:
                row = judge.row(sampler, folder)
                (space_rows if sampler.in_space else rows).append(row)
                print(row, flush=True)
            except subprocess.TimeoutExpired:
                left_out.append(f"- `{sampler.name}` ({sampler.registry}): it took more than {PATIENCE_S} s for a set.")
                print(left_out[-1], flush=True)
            except (subprocess.SubprocessError, ValueError, OSError) as error:
                why = ((getattr(error, "stderr", "") or "").strip() or str(error)).splitlines()[-1]
                left_out.append(f"- `{sampler.name}` ({sampler.registry}): it failed: {why}.")
                print(left_out[-1], flush=True)
    machine = f"one thread of a shared server, {platform.machine()}"
    page = PAGE.format(
        day=datetime.date.today().isoformat(), sets=len(SEEDS), radius=RADIUS, rows="\n".join(rows), left_out="\n".join(left_out),
        space_radius=SPACE_RADIUS, space_rows="\n".join(space_rows),
        machine=machine, python=platform.python_version(), node=output(["node", "--version"]).strip(),
    )  # fmt: skip
    made = HERE / "CONFORMANCE.md.tmp"
    made.write_text(page)
    made.replace(HERE / "CONFORMANCE.md")


if __name__ == "__main__":
    main()
