"""The progress bar of simulate(progress=True): one line on stderr, tqdm's if it is installed."""

from __future__ import annotations

import sys


class Bar:
    """Shows a fraction done. Called with it again and again, then closed."""

    def __init__(self) -> None:
        try:
            from tqdm import tqdm  # type: ignore[import-untyped,import-not-found,unused-ignore]
        except ImportError:
            self._tqdm = None
        else:
            self._tqdm = tqdm(total=100, unit="%", bar_format="{l_bar}{bar}| {elapsed}", file=sys.stderr)

    def __call__(self, fraction: float) -> None:
        percent = round(100 * min(max(fraction, 0.0), 1.0))
        if self._tqdm is not None:
            self._tqdm.n = percent
            self._tqdm.refresh()
            return
        filled = percent * 40 // 100
        print(f"\r[{'#' * filled}{' ' * (40 - filled)}] {percent:3d} %", end="", file=sys.stderr, flush=True)

    def close(self) -> None:
        if self._tqdm is not None:
            self._tqdm.close()
        else:
            print(file=sys.stderr)
