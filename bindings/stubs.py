"""Writes the type stubs of rbdyn._core (python/rbdyn/_core.pyi) from the installed module: ./run stubs"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from stub_types import typed  # noqa: E402

STUBS = Path(__file__).resolve().parents[1] / "python" / "rbdyn" / "_core.pyi"


def generated() -> str:
    """The stubs of the installed rbdyn._core, without what depends on the machine or on numpy's release."""
    import rbdyn._core as module

    # a default that is a member of an enum is written as such; one that is any other object as `...`
    enums = [name for name, value in vars(module).items() if hasattr(value, "__members__")]
    options = [f"--enum-class-locations={name}:rbdyn._core" for name in sorted(enums)]
    options += [r"--ignore-invalid-expressions=<rbdyn\.[\w.]+ object at 0x[0-9a-f]+>", "--exit-code"]
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "pybind11_stubgen", *options, "--output-dir", folder, "rbdyn._core"]
        # a hash seed, so that nothing can depend on the order of a set
        environment = {**os.environ, "PYTHONHASHSEED": "0", "RBDYN_TYPES_IN_DOCSTRINGS": "1"}
        done = subprocess.run(command, capture_output=True, text=True, env=environment)
        if done.returncode:
            raise RuntimeError(
                "pybind11-stubgen cannot describe rbdyn._core; bind a type before what uses it, "
                f"and name a default it cannot read with py::arg_v:\n{done.stdout}{done.stderr}"
            )
        (written,) = Path(folder).rglob("_core*.pyi")
        text = written.read_text()
    # one spelling for what numpy's releases spell differently
    for pattern, one in (
        (r"\bnumpy\.(float|int|uint|complex)_\b", r"numpy.\g<1>64"),
        (r"\bnumpy\.bool_\b", "numpy.bool"),
        (r" at 0x[0-9a-fA-F]+", ""),
        (r"[ \t]+$", ""),
    ):
        text = re.sub(pattern, one, text, flags=re.MULTILINE)
    return typed(text).strip() + "\n"


if __name__ == "__main__":
    try:
        STUBS.write_text(generated())
    except RuntimeError as error:
        sys.exit(str(error))
    print(f"wrote {STUBS}")
