"""Notebooks as pages: their text, code and outputs, as they were executed (docs/website/execute.py)."""

import base64
import json
from pathlib import Path
from typing import Any


def text_of(part: Any) -> str:
    return part if isinstance(part, str) else "".join(part)


def title_of(notebook: Path) -> str:
    """The first line of a notebook, its title."""
    first = json.loads(notebook.read_text())["cells"][0]
    return text_of(first["source"]).splitlines()[0].removeprefix("# ")


def write_pages(notebooks: Path, folder: Path) -> list[tuple[str, str]]:
    """Writes a page a notebook, pictures beside them; (title, file) of each."""
    folder.mkdir(parents=True)
    pages = []
    for notebook in sorted(notebooks.glob("*.ipynb")):
        parts = []
        for cell in json.loads(notebook.read_text())["cells"]:
            source = text_of(cell["source"])
            parts.append(source if cell["cell_type"] == "markdown" else f"```python\n{source}\n```")
            for output in cell.get("outputs", []):
                parts.append(shown(output, folder, f"{notebook.stem}_{len(parts)}"))
        (folder / f"{notebook.stem}.md").write_text("\n\n".join(parts) + "\n")
        pages.append((title_of(notebook), f"{notebook.stem}.md"))
    return pages


def shown(output: dict[str, Any], folder: Path, name: str) -> str:
    """An output as Markdown: a picture, HTML or text."""
    data = output.get("data", {})
    if "image/svg+xml" in data:
        (folder / f"{name}.svg").write_text(text_of(data["image/svg+xml"]))
        return f"![what the code above draws]({name}.svg)"
    if "image/png" in data:
        (folder / f"{name}.png").write_bytes(base64.b64decode(text_of(data["image/png"])))
        return f"![what the code above draws]({name}.png)"
    if "text/html" in data:
        return f'<div class="output">\n{text_of(data["text/html"]).strip()}\n</div>'
    return f"```\n{text_of(data.get('text/plain', output.get('text', ''))).rstrip()}\n```"
