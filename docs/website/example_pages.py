"""The examples as pages: what a program says of itself, its text, what it prints and the pictures it makes."""

import ast
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

PICTURES = {".svg", ".png", ".gif"}
LONGEST = 60  # lines of output


def write_pages(examples: Path, folder: Path, python: str) -> list[tuple[str, str]]:
    """Writes a page an example, each of the Python ones run by `python`; (title, file) of each, the index first."""
    folder.mkdir(parents=True)
    index, pages = ["# Examples", ""], [("All", "index.md")]
    for example in sorted(examples.glob("*.py")) + sorted(examples.glob("*.cpp")):
        text = example.read_text()
        if example.suffix == ".py":
            said = ast.get_docstring(ast.parse(text)) or example.name
            language, shown = "python", run(example, folder, python)
        else:
            comment = [line for line in text.partition("\n#include")[0].splitlines() if line.startswith("//")]
            said = " ".join(line.removeprefix("//").strip() for line in comment)
            language, shown = "cpp", []
        file = example.name.replace(".", "_") + ".md"
        parts = [f"# `{example.name}`", said, f"```{language}\n{text.strip()}\n```", *shown]
        (folder / file).write_text("\n\n".join(parts) + "\n")
        index.append(f"* [`{example.name}`]({file}): {' '.join(said.split())}")
        pages.append((example.name, file))
    (folder / "index.md").write_text("\n".join(index) + "\n")
    return pages


def run(example: Path, folder: Path, python: str) -> list[str]:
    """What a program prints and draws, as parts of its page; the pictures are put beside it."""
    with tempfile.TemporaryDirectory() as place:
        environment = {**os.environ, "MPLBACKEND": "Agg"}
        done = subprocess.run([python, example], cwd=place, env=environment, capture_output=True, text=True)
        if done.returncode:
            raise SystemExit(f"{example.name} does not run:\n{done.stderr}")
        lines = done.stdout.rstrip().splitlines()
        if len(lines) > LONGEST:
            lines = [*lines[:LONGEST], "..."]
        parts = ["It prints", "```\n" + "\n".join(lines) + "\n```"] if lines else []
        for picture in sorted(path for path in Path(place).iterdir() if path.suffix in PICTURES):
            name = f"{example.stem}_{picture.name}"
            shutil.copy(picture, folder / name)
            parts.append(f"![{picture.stem} of {example.name}]({name})")
        return parts
