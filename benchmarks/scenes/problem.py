"""A problem that other libraries are given too: equations of first order written once, modes and events by hand.

A problem is a start, modes by name, and how the library's own run of the same scene gives the same numbers. A mode is
its slopes and its guards: (value, direction, what follows), where what follows is a function of the state at the
event that gives the next mode and state, or None where the motion ends. Slopes and values are functions of the state
and of a module of functions, so that the same text serves floats, expressions and generated code.
"""

from dataclasses import dataclass, field

G = 9.81


@dataclass
class Mode:
    slopes: object
    guards: list = field(default_factory=list)


@dataclass
class Problem:
    about: str
    start: list
    until: float
    modes: dict
    scene: object  # gives (scene, until)
    read: object  # of a run: the numbers that are compared
    first: str = "only"
    groups: tuple = ()  # slices that have one scale; by default positions and rates by halves
    told: object = lambda state, _: list(state)  # of (state, time of the last event): the numbers that are compared
    linkage: object = None  # for engines of multibody dynamics

    def __post_init__(self):
        if not self.groups:
            half = len(self.start) // 2
            self.groups = (slice(0, half), slice(half, None))
