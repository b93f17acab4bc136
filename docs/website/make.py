"""Builds the documentation site into build/site: ./run docs

Documents, notebooks and examples are put together in build/site-source, with the references of Python and C++ made from
docstrings and headers; Sphinx makes pages of them (conf.py). A link that leads nowhere, a page that no list of contents
has and a public name without its place end it with an error.
"""

import argparse
import re
import shutil
import subprocess
import sys
from pathlib import Path

import cpp_reference
import example_pages
import links
import notebook_pages
import python_reference

ROOT = Path(__file__).resolve().parents[2]

GUIDE = {
    "Describe": ["bodies", "systems", "mechanisms", "functions", "systems_of_equations", "conventions"],
    "Run": ["plan", "accuracy", "events", "many", "files", "command_line"],
    "Look": ["pictures", "cost", "effects", "verification"],
}
FOLDERS = {
    "docs/decisions/": "[decisions](decisions/index.md)",
    "docs/notebooks/": "[notebooks](notebooks/1_hoop.md)",
    "examples/": "[examples](examples/index.md)",
}
BACKGROUND = ["numerical_methods", "promises", "errata", "benchmarks", "peers", "installing", "compiling"]


def title_of(page: Path) -> str:
    """The first heading of a page, short."""
    return page.read_text().partition("\n")[0].removeprefix("# ").partition(":")[0]


def adapted(text: str, up: str) -> str:
    """A document with what is named in it by its path in the project as links; `up`: to where the documents are."""
    text = re.sub(r"(?<!\[)`docs/([\w/-]+\.md)`(?!\])", rf"[\1]({up}\1)", text)
    for folder, link in FOLDERS.items():
        text = text.replace(f"`{folder}`", link.replace("](", f"]({up}"))
    return text.replace("](docs/", f"]({up}")


def contents(title: str, files: list[str]) -> str:
    """A list of contents for the column at the side."""
    caption = f":caption: {title}\n" if title else ""
    return "\n\n```{toctree}\n:hidden:\n" + caption + "\n".join(files) + "\n```\n"


def compose(source: Path, python: str) -> None:
    """Puts all pages together, the first one with the contents."""
    shutil.rmtree(source, ignore_errors=True)
    shutil.copytree(ROOT / "docs", source, ignore=shutil.ignore_patterns("notebooks", "website"))
    shutil.copy(ROOT / "README.md", source / "index.md")
    shutil.copy(ROOT / "CHANGELOG.md", source / "changelog.md")
    for page in source.rglob("*.md"):
        up = "" if page.parent == source else "../"  # decisions are a folder below the others
        page.write_text(adapted(page.read_text(), up))

    def section(folder: str, pages: list[tuple[str, str]]) -> list[str]:
        return [f"{folder}/{file}" for _, file in pages]

    decisions = sorted((source / "decisions").glob("*.md"), key=lambda path: int(path.name.partition("-")[0]))
    overview = ["# Decisions", "", "Why it is built as it is.", ""]
    overview += [f"* [{title_of(path)}]({path.name})" for path in decisions]
    (source / "decisions" / "index.md").write_text(
        "\n".join(overview) + contents("", [path.name for path in decisions])
    )
    sections = {task: [f"{name}.md" for name in names] for task, names in GUIDE.items()}
    sections["Notebooks"] = section(
        "notebooks", notebook_pages.write_pages(ROOT / "docs" / "notebooks", source / "notebooks")
    )
    folded = {
        "examples": example_pages.write_pages(ROOT / "examples", source / "examples", python),
        "python": python_reference.write_pages(source / "python"),
        "cpp": cpp_reference.write_pages(ROOT / "cpp" / "include", source / "cpp"),
    }
    for folder, ((_, first), *others) in folded.items():
        with (source / folder / first).open("a") as index:
            index.write(contents("", [file for _, file in others]))
    sections["Reference"] = [f"{folder}/index.md" for folder in folded]
    sections["Background"] = [*(f"{name}.md" for name in BACKGROUND), "decisions/index.md", "changelog.md"]
    with (source / "index.md").open("a") as index:
        index.write("".join(contents(title, files) for title, files in sections.items()))


def main() -> None:
    parser = argparse.ArgumentParser(description="Builds the documentation site.")
    parser.add_argument("--python", default=sys.executable, help="which Python runs the examples")
    parser.add_argument("--output", type=Path, default=ROOT / "build" / "site")
    arguments = parser.parse_args()
    output: Path = arguments.output.resolve()
    source = output.with_name(output.name + "-source")
    compose(source, arguments.python)
    shutil.rmtree(output, ignore_errors=True)
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-c", ROOT / "docs" / "website"]
    built = subprocess.run([*command, "-d", source.with_name(source.name + "-cache"), source, output])
    if built.returncode:
        raise SystemExit(built.returncode)

    problems = links.broken(output)
    places = {name for page in (output / "python").glob("*.html") for name in links.places_of(page)}
    names = [name for subject in python_reference.SUBJECTS.values() for name in subject]
    missing = [name for name in names if not {f"rbdyn.{name}", f"module-rbdyn.{name}"} & places]
    problems += [f"the reference has no place for rbdyn.{name}" for name in missing]
    if problems:
        raise SystemExit("\n".join(problems))
    pages = len(list(output.rglob("*.html")))
    print(f"{pages} pages, {len(names)} public names of Python: {output / 'index.html'}")


if __name__ == "__main__":
    main()
