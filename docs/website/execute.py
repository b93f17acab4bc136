"""Executes the notebooks of docs/notebooks anew, in place: ./run notebooks

Figures are kept small (a palette of 32 colours), and nothing of the machine is kept: no times of cells, no versions, no
paths.
"""

import base64
import io
import sys
from pathlib import Path
from typing import Any

import nbclient
import nbformat
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
SETTINGS = "%config InlineBackend.print_figure_kwargs = {'dpi': 72, 'bbox_inches': None}"


def smaller(picture: str) -> str:
    """A PNG, as notebooks hold it, with a palette."""
    image = Image.open(io.BytesIO(base64.b64decode(picture))).convert("RGB")
    with io.BytesIO() as out:
        image.quantize(32).save(out, "PNG", optimize=True)
        return base64.b64encode(out.getvalue()).decode()


def joined(outputs: list[Any]) -> list[Any]:
    """Outputs of a cell, what it prints in one piece: how a kernel cuts that depends on its time."""
    kept: list[Any] = []
    for output in outputs:
        before = kept[-1] if kept else None
        if before and output.output_type == "stream" == before.output_type and output.name == before.name:
            before.text += output.text
        else:
            kept.append(output)
    return kept


def execute(path: Path) -> None:
    notebook: Any = nbformat.read(path, 4)
    for cell in notebook.cells:
        cell.metadata = {}
    first = next(cell for cell in notebook.cells if cell.cell_type == "code")
    code = first.source
    first.source = f"{SETTINGS}\n{code}"
    nbclient.NotebookClient(
        notebook,
        timeout=120,
        kernel_name="python3",
        # errors alone, and not that the kernel's own sockets are plain ones
        extra_arguments=["--log-level=40"],
        resources={"metadata": {"path": path.parent}},
        record_timing=False,
    ).execute()
    first.source = code
    notebook.metadata = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    for cell in notebook.cells:
        if "outputs" in cell:
            cell.outputs = joined(cell.outputs)
        for output in cell.get("outputs", []):
            if "metadata" in output:
                output.metadata = {}
            data = output.get("data", {})
            if "image/png" in data:
                data["image/png"] = smaller(data["image/png"])
                data["text/plain"] = "a figure"
    nbformat.validate(notebook)
    nbformat.write(notebook, path)


if __name__ == "__main__":
    names = sys.argv[1:]
    for path in sorted((ROOT / "docs" / "notebooks").glob("*.ipynb")):
        if not names or path.stem in names:
            execute(path)
            print(f"{path.relative_to(ROOT)}: {path.stat().st_size / 1024:.0f} kB")
