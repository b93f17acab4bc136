"""rbdyn cost: what accuracy costs in time, for a scene."""

from __future__ import annotations

import argparse
from typing import Any

from rbdyn._core import Prediction, Price
from rbdyn._core import cost as cost_of
from rbdyn.command_line import output
from rbdyn.command_line.scene_file import add_file, add_json, add_times, called_back, end_of, scene_of
from rbdyn.errors import Error
from rbdyn.tables import price_rows

HELP = "tells what accuracy costs in time: every engine over its tolerances"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments after `cost`."""
    add_file(parser, "a scene (.json), or a Python file that builds `scene`")
    add_times(parser)
    parser.add_argument(
        "--errors",
        type=float,
        nargs="+",
        metavar="E",
        help="engines go from the loosest to the tightest, or their floor",
    )
    parser.add_argument("--engines", nargs="+", metavar="NAME", help="all by default")
    parser.add_argument("--budget", type=float, metavar="S", help="time to spend [s], 5 by default")
    parser.add_argument(
        "--predict", type=float, nargs="+", default=[], metavar="E", help="tells what these errors will cost"
    )
    parser.add_argument("--plot", metavar="PATH", help="draws the work-precision diagram: .png, .svg, .pdf")
    parser.add_argument(
        "--progress", action="store_true", help="a bar on stderr: the share of the budget that is spent"
    )
    add_json(parser)


def execute(arguments: argparse.Namespace) -> int:
    """Prices it. Returns the exit code."""
    output.require_picture(arguments.plot, "--plot")
    scene, until = scene_of(arguments.file)
    names = ("start", "errors", "engines", "budget")
    options: dict[str, Any] = {name: getattr(arguments, name) for name in names}
    options = {name: value for name, value in options.items() if value is not None}
    end = end_of(arguments, until)
    with called_back(arguments.file):
        price = cost_of(scene, end, progress=arguments.progress, **options)
    predictions: dict[float, Prediction | str] = {}
    for error in arguments.predict:
        # one that is refused leaves the others, and the price that was paid for
        try:
            predictions[error] = price.predict(error)
        except Error as refusal:
            predictions[error] = str(refusal)
    if arguments.json:
        print(output.as_json(_contents(price, predictions)))
    else:
        print(price)
        for error, prediction in predictions.items():
            print(f"error {error:g}: {prediction}")
    if arguments.plot:
        price.plot(arguments.plot)
    return 2 if any(isinstance(one, str) for one in predictions.values()) else 0


def _told(prediction: Prediction | str) -> dict[str, Any]:
    if isinstance(prediction, str):
        return {"refused": prediction}
    return output.fields(prediction, ("engine", "tolerance", "seconds", "total", "basis"))


def _contents(price: Price, predictions: dict[float, Prediction | str]) -> dict[str, Any]:
    return {
        "rows": price_rows(price),
        "missing": [output.fields(one, ("engine", "tolerance", "reason", "seconds")) for one in price.missing],
        "automatic": price.automatic,
        "reference": price.reference,
        "seconds": price.seconds,
        "predictions": [{"error": error, **_told(one)} for error, one in predictions.items()],
    }
