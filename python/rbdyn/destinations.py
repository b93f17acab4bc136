"""Where files are written: what is no path, no such folder or no such suffix, in one sentence."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from rbdyn.errors import InvalidInput
from rbdyn.shown import shown

PICTURES = (".png", ".svg", ".pdf", ".eps", ".jpg", ".jpeg", ".webp")
PAGES = (".html", ".htm")
ANIMATIONS = (".gif", ".mp4")


def place_of(path: Any, user: str, fix: str = "") -> Path:
    """The path as one. Raises TypeError for what is none; `fix` says what is given in its place, if that is known."""
    if not isinstance(path, (str, os.PathLike)):
        raise TypeError(f"{user}: path is {shown(path)}; it is a string or a path{f'; {fix}' if fix else ''}")
    text = os.fsdecode(path)
    if "\0" in text:
        raise InvalidInput(f"{user}: path is {text!r}; no path has a zero in it, give another")
    try:
        os.fsencode(text)
    except UnicodeEncodeError:
        raise InvalidInput(
            f"{user}: path is {text!r}, which has half a character (a surrogate) in it; give text that UTF-8 can write"
        ) from None
    return Path(text)


def require_place(path: str, option: str) -> None:
    """Raises InvalidInput where no file can be written, before time is spent on what would be in it."""
    folder = Path(path).parent
    if not folder.is_dir():
        raise InvalidInput(f"{option} {path}: there is no folder {str(folder)!r}; make it, or name another")
    if not os.access(folder, os.W_OK):
        raise InvalidInput(f"{option} {path}: the folder {str(folder)!r} may not be written to; name another")
    if Path(path).is_dir():
        raise InvalidInput(f"{option} {path}: it is a folder; name a file in it")


def write_figure(figure: Any, path: Any, user: str, fix: str = "", **options: Any) -> None:
    """Writes a figure of matplotlib's, if there is a path, or a file to write to. Raises as the functions above."""
    if path is None:
        return
    if not hasattr(path, "write"):
        kinds = sorted(figure.canvas.get_supported_filetypes())
        suffix = place_of(path, user, fix).suffix
        if suffix and suffix[1:].lower() not in kinds:
            raise InvalidInput(
                f"{user}: {os.fspath(path)!r} ends with {suffix!r}; a figure is a file that ends with "
                + ", ".join(f".{kind}" for kind in kinds)
            )
    try:
        figure.savefig(path, **options)
    except OSError as problem:
        where = repr(os.fspath(path)) if isinstance(path, (str, os.PathLike)) else repr(path)
        raise InvalidInput(f"{user}: {where} cannot be written: {problem.strerror or problem}") from None
