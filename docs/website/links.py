"""Links within a built site, and where they lead."""

import re
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """The links of a page and the places in it that links can lead to."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: set[str] = set()
        self.places: set[str] = set()
        self.feed(path.read_text())

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        for name, value in attributes:
            if value and (name == "id" or (tag == "a" and name == "name")):
                self.places.add(value)
            if value and (name == "src" or (name == "href" and tag in ("a", "link"))):
                self.links.add(value)


def places_of(page: Path) -> set[str]:
    return Page(page).places


def broken(site: Path) -> list[str]:
    """What is wrong with the links of all pages, a sentence each; those to other sites are not followed."""
    pages = {path.resolve(): Page(path) for path in site.rglob("*.html")}
    problems = []
    for path, page in sorted(pages.items()):
        if path.name == "404.html":
            continue
        for link in sorted(page.links):
            parts = urlsplit(link)
            if parts.scheme or parts.netloc or re.match(r"javascript:", link):
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if target.is_dir():
                target /= "index.html"
            shown = f"{path.relative_to(site.resolve())}: {link}"
            if not target.exists():
                problems.append(f"{shown} leads nowhere")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].places:
                if not parts.fragment.startswith("__"):  # the theme's own, made in the browser
                    problems.append(f"{shown}: no such place in {target.name}")
    return problems
