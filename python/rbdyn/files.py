"""Scenes and runs as files."""

from __future__ import annotations

import hashlib
import io
import json
import os
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rbdyn import _core
from rbdyn.destinations import place_of
from rbdyn.errors import InvalidInput
from rbdyn.shown import shown

if TYPE_CHECKING:
    import numpy.typing as npt

    from rbdyn._core import Scene, Trajectory

SCENES = (".json",)
RUNS = (".npz", ".h5", ".hdf5")
RUN_FORMAT, RUN_VERSION = "rbdyn run", 2
# what a file has beside `about`, and what the checksum of each version of the format is of
MEMBERS = (
    "scene",
    "plan",
    "statistics",
    "handles",
    "state",
    "t",
    "event_time",
    "event_kind",
    "event_name",
    "event_direction",
)
CHECKED = {1: ("scene", "handles", "state"), 2: MEMBERS}
CHANGED = "it was changed or cut short: its checksum is not that of what is in it"


def save(thing: Scene | Trajectory, path: str | os.PathLike[str]) -> None:
    """Writes a scene to a .json file, or a run to .npz or .h5, which needs h5py.

    A file that was there is replaced once all is written, and its mode stays; symbolic links are followed, and pipes
    and devices written into. Raises InvalidInput for a function that is called back, another suffix, and where the
    system refuses.
    """
    swapped = isinstance(path, (_core.Scene, _core.Trajectory))
    place = place_of(path, "save", "what is saved is given before it, as in save(scene, path)" if swapped else "")
    if isinstance(thing, _core.Scene):
        _require_suffix(place, SCENES, "a scene")
        _write(place, _core._scene_text(thing).encode())
    elif isinstance(thing, _core.Trajectory):
        _require_suffix(place, RUNS, "a run")
        content = io.BytesIO()
        (_save_npz if place.suffix.lower() == ".npz" else _save_h5)(content, _contents(thing))
        _write(place, content.getvalue())
    else:
        raise InvalidInput(f"save: {shown(thing)} is neither a scene nor a run")


def scene_schema() -> dict[str, Any]:
    """The JSON schema of scenes' files (draft 2020-12), made from what reads and writes them.

    It says which fields there are and of what form they are, for editors and for programs that write scenes; rules
    between numbers are checked when a scene is read.
    """
    schema: dict[str, Any] = json.loads(_core._scene_schema())
    return schema


def load(path: str | os.PathLike[str]) -> Any:
    """Reads what save() wrote: a scene, equal to what it was, or a run that answers as it did.

    The handles of a run's scene are good for the run that is read; a scene that is read has new ones, by name in its
    `handles`. Raises InvalidInput for what is none, with the place in the file.
    """
    place = place_of(path, "load")
    _require_suffix(place, SCENES + RUNS, "a scene or a run")
    try:
        content = place.read_bytes()
    except OSError as problem:
        raise InvalidInput(f"load: {str(place)!r} cannot be read: {problem.strerror}") from None
    if place.suffix.lower() in SCENES:
        try:
            text = content.decode()
        except UnicodeDecodeError as problem:
            raise InvalidInput(f"{place}: it is no text: {problem}") from None
        return _core._scene_from(text, str(place))
    read = _load_npz if place.suffix.lower() == ".npz" else _load_h5
    try:
        return _run_from(read(io.BytesIO(content)))
    except InvalidInput as problem:
        raise InvalidInput(f"{place}: {problem}") from None
    except ImportError:
        raise
    except Exception as problem:  # whatever libraries say of a file that was changed or cut short
        raise InvalidInput(f"{place}: it is no run that save() wrote: {type(problem).__name__}: {problem}") from None


def _contents(run: Trajectory) -> dict[str, Any]:
    """What a file has of a run: texts, and arrays. `scene`, `handles` and `state` are what it is read from."""
    try:
        scene, state = run.__getstate__()
        text, _, handles, *imported = scene.__getstate__()
        if imported:
            # a file has no functions of Python's: what can be recorded is, and the rest is refused
            text = _core._scene_text(scene)
    except TypeError as problem:
        raise InvalidInput(f"save: {problem}") from None
    about = {
        "format": RUN_FORMAT,
        "version": RUN_VERSION,
        "rbdyn": _core.__version__,
        "status": run.status,
        "start": run.start,
        "end": run.end,
        "certain_until": run.certain_until,
        "engine": run.engine,
        "error": run.error,
    }
    statistics = {
        name: getattr(run.statistics, name)
        for name in dir(run.statistics)
        if not name.startswith("_") and isinstance(getattr(run.statistics, name), (int, float))
    }
    members = {
        "scene": text,
        "plan": str(run.plan),
        "statistics": json.dumps(statistics),
        "handles": json.dumps(handles),
        "state": np.frombuffer(state, dtype=np.uint8),
        "t": run.t,
        "event_time": np.array([e.time for e in run.events]),
        "event_kind": np.array([e.kind for e in run.events], dtype=str),
        "event_name": np.array([e.name for e in run.events], dtype=str),
        "event_direction": np.array([e.direction for e in run.events], dtype=str),
    }
    return {"about": json.dumps(about | {"checksum": _checksum(about, members)}), **members}


def _run_from(contents: dict[str, Any]) -> Trajectory:
    handles = tuple([tuple(handle) for handle in kind] for kind in json.loads(contents["handles"]))
    scene = _core.Scene.__new__(_core.Scene)
    scene.__setstate__((contents["scene"], [], handles))
    run = _core.Trajectory.__new__(_core.Trajectory)
    run.__setstate__((scene, _bytes(contents["state"])))
    return run


def _about(text: str) -> dict[str, Any]:
    """What a file says of itself, if it is one that can be read."""
    about = json.loads(text)
    if not isinstance(about, dict) or about.get("format") != RUN_FORMAT:
        raise InvalidInput(f'it is no run: its "format" would be "{RUN_FORMAT}"')
    if about.get("version") not in CHECKED or about.get("rbdyn") != _core.__version__:
        raise InvalidInput(
            f"it was written by rbdyn {about.get('rbdyn')!s:.20}, version {about.get('version')!s:.20} of the format; "
            f"this is {_core.__version__}, which reads its own runs, of version {RUN_VERSION}; scenes are for all"
        )
    return about


def _checksum(about: dict[str, Any], members: dict[str, Any]) -> int:
    """Of all that the version of the format checks, in order; of version 1 `about` was no part."""
    version = about["version"]
    value = 0 if version == 1 else zlib.crc32(json.dumps(about).encode())
    for name in CHECKED[version]:
        member = members[name]
        if isinstance(member, str):
            value = zlib.crc32(member.encode("utf-8", "surrogatepass"), value)
        else:
            kind = b"" if version == 1 else f"{member.dtype.str}{member.shape}".encode()
            value = zlib.crc32(np.ascontiguousarray(member).tobytes(), zlib.crc32(kind, value))
    return value


def _save_npz(file: io.BytesIO, contents: dict[str, Any]) -> None:
    np.savez_compressed(file, allow_pickle=False, **contents)


def _load_npz(file: io.BytesIO) -> dict[str, Any]:
    with np.load(file, allow_pickle=False) as archive:
        about = _about(str(archive["about"]))
        if not all(name in archive for name in CHECKED[about["version"]]):
            raise InvalidInput(CHANGED)
        arrays = {name: archive[name] for name in CHECKED[about["version"]]}
    contents = {name: array if array.ndim else str(array) for name, array in arrays.items()}
    checksum = about.pop("checksum", None)
    if checksum != _checksum(about, contents):
        raise InvalidInput(CHANGED)
    return contents


# what is before an HDF5 file's own content: the library that reads it does not bear every change of a byte
_BLOCK = 512


def _seal(content: bytes) -> bytes:
    return f"{RUN_FORMAT} {hashlib.sha256(content).hexdigest()}\n".encode().ljust(_BLOCK, b"\0")


def _save_h5(file: io.BytesIO, contents: dict[str, Any]) -> None:
    h5py = _h5py()
    with h5py.File(file, "w", libver="latest", userblock_size=_BLOCK) as h5:
        for name, value in contents.items():
            if isinstance(value, str):
                h5.create_dataset(name, data=value, dtype=h5py.string_dtype())
            elif value.dtype.kind == "U":
                h5.create_dataset(name, data=value.astype(object), dtype=h5py.string_dtype())
            elif value.size:
                h5.create_dataset(name, data=value, compression="gzip", fletcher32=True)
            else:
                h5.create_dataset(name, data=value)
        for name, value in json.loads(contents["about"]).items():
            h5.attrs[name] = np.nan if value is None else value
    seal = _seal(file.getvalue()[_BLOCK:])
    file.seek(0)
    file.write(seal)


def _load_h5(file: io.BytesIO) -> dict[str, Any]:
    h5py = _h5py()
    content = file.getvalue()
    if content[:_BLOCK] != _seal(content[_BLOCK:]):
        raise InvalidInput(CHANGED)
    with h5py.File(file, "r") as h5:
        _about(h5["about"].asstr()[()])
        texts = {name: h5[name].asstr()[()] for name in ("scene", "handles")}
        return {**texts, "state": h5["state"][()]}


def _h5py() -> Any:
    try:
        import h5py  # type: ignore[import-not-found,import-untyped,unused-ignore]
    except ImportError:
        raise ImportError("files that end with .h5 need h5py: pip install h5py; .npz needs nothing more") from None
    return h5py


def _bytes(state: npt.NDArray[Any]) -> bytes:
    if state.dtype != np.uint8:
        raise InvalidInput(f"its state is of {state.dtype}; it is bytes")
    return state.tobytes()


def _write(place: Path, content: bytes) -> None:
    """A file, whole or not at all: what was there stays until all of it is written."""
    trouble = _core._trouble_writing(os.fsencode(place), content)
    if trouble:
        raise InvalidInput(f"save: {str(place)!r} cannot be written: {trouble}")


def _require_suffix(place: Path, known: tuple[str, ...], what: str) -> None:
    if place.suffix.lower() not in known:
        raise InvalidInput(
            f"{str(place)!r} ends with {place.suffix!r}; {what} is a file that ends with {', '.join(known)}"
        )
