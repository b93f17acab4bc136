"""What the documents show runs: the Python blocks of each, one after the other, in one process."""

import os
import re
import subprocess
import sys

import pytest

DOCUMENTS = ["README.md", "docs/accuracy.md", "docs/bodies.md", "docs/effects.md", "docs/functions.md", "docs/plan.md"]


@pytest.mark.parametrize("document", DOCUMENTS)
def test_the_python_in_a_document_runs(document, root, tmp_path):
    blocks = re.findall(r"^```python\n(.*?)^```", (root / document).read_text(), re.MULTILINE | re.DOTALL)
    assert blocks
    program = tmp_path / "program.py"
    program.write_text("import numpy as np\nimport rbdyn as rb\n" + "\n".join(blocks))
    (tmp_path / "figures").mkdir()
    environment = {**os.environ, "MPLBACKEND": "Agg"}
    done = subprocess.run(
        [sys.executable, "-W", "error", root / "tests" / "python" / "sizes.py", program],
        cwd=tmp_path / "figures",
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
