"""Examples in the documentation run, and types are what the stubs say."""

import ast
import copy
import doctest
import importlib
import inspect
import os
import re
import subprocess
import sys
from pathlib import Path

import nbclient
import nbformat
import pytest

import tilescope
from tilescope import _tilescope

MODULES = [
    "tilescope", "tilescope._point_set", "tilescope._progress", "tilescope._report", "tilescope._solid_set",
    "tilescope._spectrum", "tilescope._stipple", "tilescope.qmc",
]  # fmt: skip
README = Path(__file__).parents[1] / "README.md"
NOTEBOOK = Path(__file__).parents[3] / "assets/notebook/tilescope.ipynb"


def test_examples_of_docstrings_run(tmp_path):
    attempted = 0
    for name in MODULES:
        outcome = doctest.testmod(
            importlib.import_module(name),
            extraglobs={"tilescope": tilescope, "folder": tmp_path},
            optionflags=doctest.ELLIPSIS,
        )
        assert outcome.failed == 0, name
        attempted += outcome.attempted
    assert attempted > 25


def test_an_example_that_is_wrong_is_found():
    wrong = doctest.DocTestParser().get_doctest(">>> len(tilescope.sample(2000))\n7\n", vars(), "wrong", None, 0)
    outcome = doctest.DocTestRunner(verbose=False).run(wrong, out=lambda _: None)
    assert outcome.failed == 1


def test_examples_of_the_readme_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", README.read_text(), re.DOTALL)
    assert len(blocks) >= 3
    names = {}
    for block in blocks:
        exec(compile(block, str(README), "exec"), names)


def texts(notebook):
    """The text that each cell of a notebook shows, without pictures. What it prints may come in several parts."""
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    shown = ["".join(one.text if "text" in one else one.data["text/plain"] for one in cell.outputs) for cell in cells]
    return list(zip([cell.source for cell in cells], shown, strict=True))


# The kernel's and the client's own.
@pytest.mark.filterwarnings("default")
def test_the_notebook_runs_and_shows_what_is_stored():
    stored = nbformat.read(NOTEBOOK, as_version=4)
    made = copy.deepcopy(stored)
    nbclient.NotebookClient(made, timeout=120, kernel_name="python3", record_timing=False).execute()
    if os.environ.get("TILESCOPE_RENEW"):
        nbformat.write(made, NOTEBOOK)
        return
    assert texts(made) == texts(stored)
    shown = {name for cell in made.cells for output in cell.get("outputs", []) for name in output.get("data", [])}
    assert "image/png" in shown


def test_dir_has_the_public_names_only():
    code = "import tilescope; print(*dir(tilescope))"
    outcome = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    names = outcome.stdout.split()
    assert {name for name in names if not name.startswith("_")} == set(tilescope.__all__)
    assert "__version__" in names
    for module in ("tilescope", "tilescope.qmc", "tilescope.distributed"):
        found = importlib.import_module(module)
        shown = {name for name in dir(found) if not name.startswith("_")} - {"qmc", "distributed"}
        assert shown == set(found.__all__), module
        assert all(hasattr(found, name) for name in dir(found)), module


def public():
    for name in tilescope.__all__:
        yield name, getattr(tilescope, name)
        for inner, value in vars(getattr(tilescope, name)).items() if inspect.isclass(getattr(tilescope, name)) else []:
            if not inner.startswith("_") and (inspect.isfunction(value) or isinstance(value, property)):
                yield f"{name}.{inner}", value


@pytest.mark.parametrize("name", [name for name, _ in public()])
def test_everything_public_is_documented(name):
    documentation = inspect.getdoc(dict(public())[name])
    assert documentation and documentation.split("\n")[0].rstrip().endswith((".", ":")), name


def test_the_stubs_have_the_names_and_arguments_of_the_native_module():
    source = (Path(tilescope.__file__).parent / "_tilescope.pyi").read_text()
    stubs = {node.name: node for node in ast.parse(source).body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    native = {name for name in vars(_tilescope) if not name.startswith("_")}
    assert native == {name for name in stubs if not name.startswith("_")}
    for name in native:
        if isinstance(stubs[name], ast.FunctionDef):
            arguments = [one.arg for one in stubs[name].args.args + stubs[name].args.kwonlyargs]
            assert arguments == list(inspect.signature(getattr(_tilescope, name)).parameters), name
        else:
            methods = {one.name for one in stubs[name].body}
            assert {one for one in vars(getattr(_tilescope, name)) if not one.startswith("_")} <= methods, name


def test_types_are_right(tmp_path):
    package = Path(tilescope.__file__).parent
    assert (package / "py.typed").exists()
    good = tmp_path / "good.py"
    good.write_text(
        "import numpy as np, tilescope\n"
        "number: int = len(tilescope.sample(2000, boundary='bounded').points)\n"
        "made = tilescope.sample(np.int64(2000), seed=np.int64(4), pattern_seed=np.uint8(1))\n"
        "made.save('set.npy', shuffle=np.int64(3))\n"
        "tilescope.Plane(radius=0.01, seed=np.int64(4))\n"
        "tilescope.set_threads(np.int64(1))\n"
        "same: bool = made.spectrum() == made.spectrum()\n"
        "ramp = tilescope.sample(radius=lambda x, y: 0.01 + 0.04 * x, extent=(0, 0, 1, 1))\n"
        "ramp.save('ramp.geojson', format='geojson')\n"
        "dense = tilescope.sample(100, density=np.ones((3, 3)), mask=np.ones((3, 3), dtype=bool))\n"
        "passed: bool = tilescope.verify('ramp.geojson', lambda x, y: 0.01 + 0.04 * x).passed\n"
        "stipple = tilescope.stipple(np.zeros((9, 9), dtype=np.uint8), dots=20, dot_size='darkness')\n"
        "factor: float | None = stipple.prefix(9).verify().covering_factor\n"
        "kept: int = stipple.made + stipple.runs\n"
        "disks = tilescope.sample(size=(5, 5, 5), radius=1).slice(z=2).radii.max()\n"
    )
    bad = tmp_path / "bad.py"
    bad.write_text("import tilescope\ntilescope.sample(2000, boundary='torus')\n")

    def mypy(*words):
        # What it knows of other packages is kept where MYPY_CACHE_DIR says, otherwise in the folder.
        command = [sys.executable, "-m", "mypy", "--strict", *words]
        return subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)

    checked = mypy("-p", "tilescope")
    assert checked.returncode == 0, checked.stdout + checked.stderr
    checked = mypy(good)
    assert checked.returncode == 0, checked.stdout
    checked = mypy(bad)
    assert checked.returncode == 1
    assert 'No overload variant of "sample" matches argument types "int", "str"' in checked.stdout
