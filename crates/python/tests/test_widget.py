"""The widget's state, without a browser. `web/tests` has the other half: `widget.test.mjs`, `notebook.test.mjs` in JupyterLab."""

import gzip
import subprocess
import sys

import numpy as np
import pytest
import traitlets

import tilescope

# Modules of the widget warn about their own past.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


@pytest.fixture
def page(tmp_path):
    """A folder that looks like a built page."""
    (tmp_path / "index.html").write_text("<template id=program></template>")
    for name in ("main-0123456789ab.js", "a-0123456789ab.wasm", "picture-0123456789ab.svg"):
        (tmp_path / f"{name}.gz").write_bytes(gzip.compress(b"content", mtime=0))
    return tmp_path


def sent(widget):
    """Records what a widget sends to its views."""
    messages = []
    widget.send = lambda content, buffers=None: messages.append((content, buffers))
    return messages


def test_a_link_leads_to_the_run_of_a_set():
    from tilescope._widget import link_of

    made = tilescope.sample(radius=0.02, seed=2**63, width=2, boundary="bounded", dihedral=True, search=2)
    link = dict(part.split("=") for part in link_of(made).split("&"))
    assert link["seed"] == str(2**63)
    assert (link["width"], link["radius"], link["boundary"]) == ("2.0", "0.02", "bounded")
    assert (link["dihedral"], link["search"], link["pattern"]) == ("yes", "two-radii", "100.0")
    assert "method" not in link
    assert "method=exact" in link_of(tilescope.sample(radius=0.03, method="exact"))


@pytest.mark.parametrize(
    ("made", "why"),
    [
        (lambda: tilescope.PointSet(np.zeros((1, 2)), 0.1), "no run"),
        (lambda: tilescope.sample(radius=0.05, method="reference"), "no run"),
        (lambda: tilescope.sample(radius=0.05, levels=2), "nested levels"),
        (lambda: tilescope.sample(radius_expression="0.05 + 0.05*x"), "no run"),
        (lambda: tilescope.sample(radius=0.05, pattern=tilescope.sample(radius=0.05)), "pattern of its own"),
        (lambda: tilescope.sample(radius=0.05, pattern_side=600), "at most 500 r"),
        (lambda: tilescope.sample(radius=0.0015), "at most 200000"),
    ],
)
def test_sets_without_a_run_to_play_are_shown_as_points(made, why, page):
    widget = tilescope.widget(made(), address=page)
    assert widget._link == ""
    assert why in widget.note
    with pytest.raises(ValueError, match="no player"):
        widget.play()


def test_a_sample_has_its_number_in_the_run_and_its_row_in_the_set(small, page):
    widget = tilescope.widget(small, address=page)
    assert widget.note == ""
    numbers = np.array(widget._numbers)
    # Each sample has a number of its own, and some numbers belong to eliminated samples.
    assert len(np.unique(numbers)) == len(small)
    assert numbers.max() >= len(small)
    # Inserted samples come after all of the tiled ones.
    inserted = small.provenance[:, 2] > 0
    assert numbers[inserted].min() > numbers[~inserted].max()

    widget.selected = 5
    assert widget._picked == numbers[5]
    widget._picked = int(numbers[7])
    assert widget.selected == 7
    gone = next(number for number in range(numbers.max()) if number not in set(numbers.tolist()))
    widget._picked = gone
    assert (widget.selected, widget._picked) == (None, gone)
    widget.selected = 0
    widget.selected = None
    assert widget._picked is None


def test_rows_keep_their_samples_in_another_order(small, page, tmp_path):
    path = tmp_path / "shuffled.npy"
    small.save(path, shuffle=3)
    shuffled = tilescope.read(path)
    numbers = tilescope.widget(small, address=page)._numbers
    number_of = dict(zip(map(tuple, small.points), numbers, strict=True))
    widget = tilescope.widget(shuffled, address=page)
    assert widget._numbers == [number_of[tuple(place)] for place in shuffled.points]
    assert widget._numbers != numbers


def test_positions_that_are_not_of_the_run_are_refused(small):
    from tilescope import _tilescope

    other = tilescope.sample(radius=0.02, seed=8)
    other._parameters = small._parameters
    with pytest.raises(ValueError, match="no sample of the run"):
        _tilescope.recorded_numbers(other, None)


def test_changes_are_observed_and_wrong_values_refused(small, page):
    widget = tilescope.widget(small, address=page, height=300)
    seen = []
    widget.observe(lambda change: seen.append(change["new"]), "cursor")
    # What a view reports comes as one change of several values.
    with widget.hold_trait_notifications():
        widget.events, widget.cursor, widget.moment = 900, 30, "tile"
    assert seen == [30]
    for name, value in [("cursor", 901), ("cursor", -1), ("selected", len(small)), ("moment", "Tile 1"), ("height", 9)]:
        with pytest.raises(traitlets.TraitError):
            setattr(widget, name, value)
    assert (widget.cursor, widget.selected, widget.moment, widget.height) == (30, None, "tile", 300)


def test_the_page_is_sent_when_a_view_asks_for_it(small, page):
    widget = tilescope.widget(small, address=page)
    messages = sent(widget)
    widget._answer(widget, {"kind": "other"}, [])
    assert messages == []
    widget._answer(widget, {"kind": "page"}, [])
    [(content, buffers)] = messages
    # Pictures are of no use to the player.
    assert content["names"] == ["index.html", "a-0123456789ab.wasm", "main-0123456789ab.js"]
    assert [gzip.decompress(one) for one in buffers][1:] == [b"content"] * 2
    assert content["version"] == widget._page != ""


def test_play_and_pause_are_asked_of_the_player(small):
    widget = tilescope.widget(small, address="http://127.0.0.1:8080/")
    assert (widget._address, widget._page, widget._files) == ("http://127.0.0.1:8080/", "", {})
    messages = sent(widget)
    widget.play(2)
    widget.pause()
    assert [content["request"] for content, _ in messages] == [{"do": "play", "speed": 2.0}, {"do": "pause"}]


def test_a_corner_of_a_large_set_has_its_rows(page):
    made = tilescope.sample(radius=0.0015)
    widget = tilescope.widget(made, address=page)
    rows = np.frombuffer(widget._rows, dtype="<u4")
    points = np.frombuffer(widget._points, dtype="<f4").reshape(-1, 2)
    assert 150_000 < len(rows) < len(made)
    assert np.array_equal(points, made.points[rows].astype("<f4"))
    assert f"a corner with {len(rows)}" in widget.note


def test_what_is_no_set_and_no_page_is_refused(small, tmp_path):
    with pytest.raises(TypeError, match="SolidSet"):
        tilescope.widget(tilescope.sample(200, size=(1, 1, 1)))
    with pytest.raises(FileNotFoundError, match="web/build"):
        tilescope.widget(small, address=tmp_path)
    if tilescope.widget(small).note:
        # Without a page in the package the points are shown, and what to do is said.
        assert "web/build" in tilescope.widget(small).note


def test_without_anywidget_it_says_how_to_install_it():
    code = "import sys; sys.modules['anywidget'] = None; import tilescope; tilescope.widget(tilescope.sample(200))"
    outcome = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "pip install 'tilescope[widget]'" in outcome.stderr
