"""The errata: each number has its row and a run, in which the corrected form holds and the printed one does not.

That the runs do what they show is tested with all documents (test_documents.py).
"""

import re

import numpy as np
import pytest
from test_documents import blocks_of

NUMBERS = {*map(str, range(1, 34)), "25b"}


@pytest.fixture(scope="module")
def text(root):
    return (root / "docs" / "errata.md").read_text()


def test_each_number_has_one_row_and_a_run(text):
    rows = re.findall(r"^\| (\d+b?) \|", text, re.MULTILINE)
    assert len(rows) == len(NUMBERS) == 34 and set(rows) == NUMBERS
    shown = {number for block, _ in blocks_of(text) for number in re.findall(r'shows\(\s*"(\d+b?)"', block)}
    assert shown == NUMBERS
    outputs = [output for _, output in blocks_of(text) if output]
    assert {
        found for output in outputs for found in re.findall(r"^ *(\d+b?)  0\.0000000", output, re.MULTILINE)
    } == NUMBERS


def test_a_row_fails_where_the_printed_form_holds_or_the_corrected_one_does_not(text, capsys):
    names = {"np": np}
    exec(blocks_of(text)[0][0], names)
    shows = names["shows"]
    shows("0", [1e-12, -1e-10], [0.0, -2.0])
    assert capsys.readouterr().out == "  0  0.0000000  2\n"
    for corrected, printed in [(0.0, 0.0), (0.0, 1e-9), (1.0, 1.0), (np.nan, 1.0), (0.0, np.nan), ([0.0, 1e-3], 1.0)]:
        with pytest.raises(AssertionError):
            shows("0", corrected, printed)
