"""The notebooks of the documents run, as plain Python in a process each, and print what they show.

HTML and figures are not compared: tables have times of machines in them, and both have tests of their own.
"""

import ast
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from test_documents import MARK, differs

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


def cells_of(notebook):
    cells = json.loads(notebook.read_text())["cells"]
    return [cell for cell in cells if cell["cell_type"] == "code"]


def text_of(part):
    return part if isinstance(part, str) else "".join(part)


def plain(source):
    """The code of a cell with its last expression printed, as notebooks do."""
    body = ast.parse(source).body
    if not body or not isinstance(body[-1], ast.Expr):
        return source
    lines = source.splitlines()
    last = body[-1]
    before, value = lines[: last.lineno - 1], "\n".join(lines[last.lineno - 1 : last.end_lineno])
    return "\n".join([*before, f"shown = ({value})", "if shown is not None: print(repr(shown))"])


def outputs_of(cell):
    """What a cell prints and its value, unless that is shown as a table or a figure."""
    told, value = "", None
    for output in cell["outputs"]:
        assert output["output_type"] != "error"
        if output["output_type"] == "stream":
            assert output["name"] == "stdout", text_of(output["text"])
            told += text_of(output["text"])
        elif output["output_type"] == "execute_result":
            value = text_of(output["data"]["text/plain"])
            told += "...\n" if "text/html" in output["data"] else value + "\n"
    return told


def test_there_are_six_small_ones_as_they_were_executed():
    assert [path.stem.split("_", 1)[1] for path in NOTEBOOKS] == [
        *("hoop", "top", "ladder", "two_masses", "linkage", "pendulum_fit"),
    ]
    assert sum(path.stat().st_size for path in FOLDER.iterdir()) < 300_000
    for notebook in NOTEBOOKS:
        cells = cells_of(notebook)
        assert [cell["execution_count"] for cell in cells] == list(range(1, len(cells) + 1))
        assert any("image/png" in output.get("data", {}) for cell in cells for output in cell["outputs"])
        outputs = json.dumps([cell["outputs"] for cell in cells])
        assert not re.search(r"/(home|root|tmp|work|usr|Users)\b|site-packages|\\\\Users", outputs)


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_prints_what_it_shows(notebook, tmp_path):
    cells = cells_of(notebook)
    program = tmp_path / "program.py"
    program.write_text(f"\nprint({MARK!r})\n".join(plain(text_of(cell["source"])) for cell in cells))
    done = subprocess.run(
        [sys.executable, "-W", "error", "-W", "ignore:FigureCanvasAgg", program],
        cwd=FOLDER,
        env={**os.environ, "MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    printed = done.stdout.split(MARK + "\n")
    assert len(printed) == len(cells)
    for cell, told in zip(cells, printed, strict=True):
        line = differs(outputs_of(cell), told)
        assert line is None, f"{line!r} is shown, and it prints\n{told}"
