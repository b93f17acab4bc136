"""Writes the library's definitions once more, with all mutants in them: which is at work is chosen when a program runs.

    python tests/mutants/mutate.py FOLDER

A mutant is a small change of one definition, as a mistake would be: in the file named, `old` becomes `new`, where it
stands once (within `within`, if that is given). What ends with a semicolon is a statement, the rest are expressions.
The library's own sources know nothing of this: in the copies below FOLDER each place asks for its number.
"""

import re
import sys
from dataclasses import dataclass
from pathlib import Path

try:
    import tomllib
except ImportError:
    from pip._vendor import tomli as tomllib

ROOT = Path(__file__).resolve().parents[2]
DEFINITIONS = Path("cpp/include/rbdyn")

CHOICE = """// Which mutant is at work, by its number in the environment variable RBDYN_MUTANT, and which were
// met, for the file that RBDYN_MUTANTS_MET names.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace rbdyn_mutants {{

struct Choice {{
    int at_work = std::getenv("RBDYN_MUTANT") != nullptr ? std::atoi(std::getenv("RBDYN_MUTANT")) : 0;
    bool met[{count} + 1] = {{}};
    ~Choice() {{
        const char* const path = std::getenv("RBDYN_MUTANTS_MET");
        std::FILE* const file = path != nullptr ? std::fopen(path, "a") : nullptr;
        if (file == nullptr) return;
        for (int i = 1; i <= {count}; ++i)
            if (met[i]) std::fprintf(file, "%d\\n", i);
        std::fclose(file);
    }}
}};
inline Choice choice;
inline bool is(int number) {{
    choice.met[number] = true;
    return choice.at_work == number;
}}

}}  // namespace rbdyn_mutants
"""


@dataclass
class Mutant:
    number: int
    subject: str
    name: str
    file: str
    old: str
    new: str
    within: str

    def place(self, text: str) -> int:
        """Where it is in the text of its file."""
        where = self.within or self.old
        if text.count(where) != 1 or where.count(self.old) != 1:
            raise SystemExit(
                f"{self.name}: {where!r} stands {text.count(where)} times in {self.file}.ipp, and once is wanted"
            )
        place = text.index(where) + where.index(self.old)
        # in brackets it must be the same expression as without
        before, after = text[:place].rstrip()[-1:], text[place + len(self.old) :].lstrip()[:1]
        outside = self.old
        while (inner := re.sub(r"\([^()]*\)|\[[^][]*\]|\{[^{}]*\}", "", outside)) != outside:
            outside = inner
        sums, products = re.search(r" [-+<>=&|?]", outside), re.search(r" [*/]", outside)
        binds = "*/!.-+" if sums else "/!." if products else ""
        if not self.old.endswith(";") and before and (before in binds or (binds and after in "*/.[")):
            raise SystemExit(f"{self.name}: {self.old!r} is a part of a longer expression")
        return place

    def text(self) -> str:
        """What stands there instead."""
        met = f"::rbdyn_mutants::is({self.number})"
        if self.old.endswith(";"):
            return f"if ({met}) {{ {self.new} }} else {{ {self.old} }}"
        return f"({met} ? ({self.new}) : ({self.old}))"


def mutants() -> list[Mutant]:
    """All of them, by subject."""
    found: list[Mutant] = []
    for path in sorted(Path(__file__).parent.glob("*.toml")):
        for entry in tomllib.loads(path.read_text())["mutant"]:
            entry.setdefault("within", "")
            found.append(Mutant(len(found) + 1, path.stem, **entry))
    return found


def write(path: Path, text: str) -> None:
    """Files that are as they were keep their times, so that nothing is compiled anew."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text() != text:
        path.write_text(text)


def main(folder: Path) -> None:
    all_of_them = mutants()
    include = folder / "include"
    write(include / "rbdyn_mutants.hpp", CHOICE.format(count=len(all_of_them)))
    files = {m.file for m in all_of_them}
    kept = {include / "rbdyn" / f"{file}.ipp" for file in files}
    for old in include.rglob("*.ipp"):
        if old not in kept:
            old.unlink()
    for file in sorted(files):
        text = (ROOT / DEFINITIONS / f"{file}.ipp").read_text()
        changes = sorted(((m.place(text), m) for m in all_of_them if m.file == file), key=lambda c: -c[0])
        end = len(text)
        for place, m in changes:
            if place + len(m.old) > end:
                raise SystemExit(f"{m.name}: it overlaps with another one")
            text = text[:place] + m.text() + text[place + len(m.old) :]
            end = place
        text = re.sub(r"#pragma once\n", '#pragma once\n\n#include "rbdyn_mutants.hpp"\n', text, count=1)
        write(include / "rbdyn" / f"{file}.ipp", text)
    print(f"{len(all_of_them)} mutants in {len(files)} files")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
