"""Scenes and runs as files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from rbdyn import _core
from rbdyn.errors import InvalidInput

if TYPE_CHECKING:
    from rbdyn._core import Scene, Trajectory

SCENES = (".json",)


def save(thing: Scene | Trajectory, path: str | os.PathLike[str]) -> None:
    """Writes a scene to a .json file, or a run to .npz or .h5, which needs h5py.

    What was there is replaced once all is written. Raises InvalidInput for a function that is called back, another
    suffix, and where the system refuses.
    """
    place = Path(path)
    if isinstance(thing, _core.Scene):
        _require(place, SCENES, "a scene")
        write(place, _core._scene_text(thing).encode())
        return
    raise InvalidInput(f"save: {thing!r} is neither a scene nor a run")


def load(path: str | os.PathLike[str]) -> Scene | Trajectory:
    """Reads what save() wrote: a scene, equal to what it was, or a run that answers as it did.

    Raises InvalidInput for what is none, with the place in the file.
    """
    place = Path(path)
    _require(place, SCENES, "a scene")
    try:
        text = read(place).decode()
    except UnicodeDecodeError as problem:
        raise InvalidInput(f"{place}: it is no text: {problem}") from None
    return _core._scene_from(text, str(place))


def read(place: Path) -> bytes:
    """All of a file."""
    try:
        return place.read_bytes()
    except OSError as problem:
        raise InvalidInput(f"load: {str(place)!r} cannot be read: {problem.strerror}") from None


def write(place: Path, content: bytes) -> None:
    """A file, whole or not at all: what was there stays until all of it is written."""
    part = place.with_name(place.name + ".part")
    try:
        part.write_bytes(content)
        part.replace(place)
    except OSError as problem:
        part.unlink(missing_ok=True)
        raise InvalidInput(f"save: {str(place)!r} cannot be written: {problem.strerror}") from None


def _require(place: Path, known: tuple[str, ...], what: str) -> None:
    if place.suffix.lower() not in known:
        raise InvalidInput(f"{str(place)!r} ends with {place.suffix!r}; {what} is a file that ends with {', '.join(known)}")
