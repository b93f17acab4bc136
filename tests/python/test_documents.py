"""What the documents show runs, the Python blocks of each one after the other in one process, and prints what they say.

Their first block imports what they use. What the command line shows behind `$` is run, too.

An output stands in a block of its own: the next fence after the code, if it has no language, or indented right after
the code; a value may stand in a comment behind an expression or a print(). `...` stands for whatever comes.
"""

import ast
import os
import re
import subprocess
import sys
import textwrap

import pytest

DOCUMENTS = [
    "README.md",
    "docs/accuracy.md",
    "docs/bodies.md",
    "docs/command_line.md",
    "docs/conventions.md",
    "docs/cost.md",
    "docs/effects.md",
    "docs/errata.md",
    "docs/files.md",
    "docs/functions.md",
    "docs/many.md",
    "docs/mechanisms.md",
    "docs/pictures.md",
    "docs/plan.md",
    "docs/systems.md",
    "docs/systems_of_equations.md",
    "docs/verification.md",
]
FENCE = re.compile(r"^```(\w*)\n(.*?)^```\n", re.MULTILINE | re.DOTALL)
MARK = "\x01"

# what runs differ in from machine to machine: printed times of events, to the errors asked for in the documents, and
# estimates of errors, which have two digits
TIMES, ESTIMATES = 1e-9, 3.0


def blocks_of(text):
    """The Python blocks, each with the output that is shown after it, if there is one."""
    blocks = []
    for found in FENCE.finditer(text):
        if found[1] != "python":
            continue
        after = text[found.end() :]
        following = FENCE.search(after)
        indented = re.match(r"\n((?: {4}.*\n)+)", after)
        output = textwrap.dedent(indented[1]) if indented else None
        if following and not following[1]:
            output = following[2]
        blocks.append((found[2], output))
    return blocks


def commented(block):
    """The block with what each expression with a value in a comment gives, printed behind a mark; and these values."""
    values, lines = [], block.splitlines()
    for statement in reversed(ast.parse(block).body):
        if not isinstance(statement, ast.Expr) or statement.lineno != statement.end_lineno:
            continue
        code, _, comment = lines[statement.lineno - 1].partition("  # ")
        value = statement.value
        is_print = isinstance(value, ast.Call) and isinstance(value.func, ast.Name) and value.func.id == "print"
        try:
            ast.literal_eval(comment)
        except (ValueError, SyntaxError):
            continue
        printed = code if is_print else f"print({code})"
        lines[statement.lineno - 1] = f"print({MARK!r}); {printed}; print({MARK!r})"
        values.insert(0, comment)
    return "\n".join(lines), values


def is_close(shown, told, column_varies):
    """Whether a word that is shown is what was told."""
    if shown.endswith("...") and told.startswith(shown[:-3]):
        return True
    try:
        a, b = float(shown.rstrip(",:")), float(told.rstrip(",:"))
    except ValueError:
        return shown == told
    if column_varies or a == b:
        return True
    if re.fullmatch(r"\d\.\de[-+]\d+,?", shown):
        return 1 / ESTIMATES <= b / a <= ESTIMATES if a and b else False
    return abs(a - b) <= TIMES * abs(a) and not re.fullmatch(r"\d+,?", shown)


def is_line(shown, told, varying):
    words = [[*re.finditer(r"\S+", line)] for line in (shown, told)]
    if len(words[0]) != len(words[1]):
        return False
    pairs = list(zip(*words, strict=True))
    for i, (a, b) in enumerate(pairs):
        # times that a computation takes
        takes = i + 1 < len(pairs) and pairs[i + 1][0][0] in ("ms", "us")
        if not is_close(a[0], b[0], takes or b.end() in varying):
            return False
    return True


def differs(shown, told):
    """The first line that is shown and was not told; None if all were."""
    told, varying = told.splitlines(), set()
    skips = False
    for line in shown.splitlines():
        if line.strip() == "...":
            skips = True
            continue
        varying |= {found.end() for found in re.finditer(r"time \[ms\]", line)}
        while skips and told and not is_line(line, told[0], varying):
            told.pop(0)
        if not told or not is_line(line, told[0], varying):
            return line
        told.pop(0)
        skips = False
    return None if skips or not any(line.strip() for line in told) else f"(nothing, where there is {told[0]!r})"


@pytest.mark.parametrize("document", DOCUMENTS)
def test_the_python_in_a_document_runs_and_prints_what_it_shows(document, root, tmp_path):
    blocks = blocks_of((root / document).read_text())
    assert blocks
    parts, outputs, values = [], [], []
    for block, output in blocks:
        code, comments = commented(block)
        parts.append(code)
        outputs.append(output)
        values.append(comments)
    program = tmp_path / "program.py"
    end = f"\nprint({MARK + MARK!r})\n"
    program.write_text(end.join(parts) + end)
    (tmp_path / "figures").mkdir()
    environment = {**os.environ, "MPLBACKEND": "Agg"}
    done = subprocess.run(
        [sys.executable, "-W", "error", root / "tests" / "python" / "sizes.py", program],
        cwd=tmp_path / "figures",
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    for told, output, comments in zip(done.stdout.split(MARK + MARK + "\n"), outputs, values, strict=False):
        pieces = told.split(MARK + "\n")
        for comment, piece in zip(comments, pieces[1::2], strict=True):
            assert differs(comment, piece) is None, f"{document}: {comment!r} is shown, and it prints {piece!r}"
        if output is not None:
            line = differs(output, "".join(pieces[::2]))
            assert line is None, f"{document}: {line!r} is shown, and it prints\n{told}"


def test_what_is_shown_of_the_command_line_is_what_it_prints(root, tmp_path):
    text = (root / "docs" / "command_line.md").read_text()
    (hoop,) = re.findall(r"^```python\n(# hoop\.py\n.*?)^```\n", text, re.MULTILINE | re.DOTALL)
    (tmp_path / "hoop.py").write_text(hoop)
    (line,) = re.findall(r"where line 3 of `wrong.py` is `(.*?)`", text)
    (tmp_path / "wrong.py").write_text(f"import rbdyn as rb\n\n{line}\n")
    blocks = re.findall(r"^```console\n(.*?)^```\n", text, re.MULTILINE | re.DOTALL)
    shown = [one.partition("\n") for block in blocks for one in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]]
    assert len(shown) == 3
    for command, _, output in shown:
        program, *arguments = command.split()
        assert program == "rbdyn"
        done = subprocess.run(
            [sys.executable, "-m", "rbdyn", *arguments], cwd=tmp_path, capture_output=True, text=True, timeout=60
        )
        line = differs(output, done.stdout + done.stderr)
        assert line is None, f"{command}: {line!r} is shown, and it prints\n{done.stdout}{done.stderr}"


def test_outputs_that_are_not_what_is_shown_are_found():
    shown = "Run: 8 events, error 1.1e-12, 0.3 ms\nt = 1.0270799513501878 s\n...\nt = 5.5 s\n"
    told = "Run: 8 events, error 1.9e-12, 14 ms\nt = 1.027079951350946 s\nt = 3 s\nt = 5.5 s\n"
    assert differs(shown, told) is None
    assert differs(shown, told.replace("8", "9", 1)) is not None
    assert differs(shown, told.replace("1.9e-12", "1.9e-11")) is not None
    assert differs(shown, told.replace("1.02707", "1.02708")) is not None
    assert differs(shown, told.replace("5.5", "5.6")) is not None
    assert differs(shown, told + "more\n") is not None
    assert differs("1 0.25...", "1 0.2512") is None and differs("1 0.25...", "1 0.26") is not None


def test_each_mutant_is_a_place_of_the_core(root, tmp_path):
    done = subprocess.run(
        [sys.executable, root / "tests" / "mutants" / "mutate.py", tmp_path], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_each_promise_names_a_test_that_there_is(root):
    text = (root / "docs" / "promises.md").read_text()
    rows = re.findall(r"^\| (?!promised|---).* \| (.*) \|$", text, re.MULTILINE)
    assert len(rows) > 20
    for row in rows:
        named = re.findall(r"`([\w/.]+)::(\w+)`", row)
        assert named, row
        for file, name in named:
            language = "cpp" if file.endswith(".cpp") else "python"
            tests = (root / "tests" / language / file).read_text()
            assert re.search(rf"\b{name}\b", tests), f"{file} has no test {name}"


def test_conventions_list_the_words_that_there_are(root):
    """Statuses, event kinds and directions are those of the library."""
    conventions = (root / "docs" / "conventions.md").read_text()
    source = (root / "cpp" / "include" / "rbdyn" / "event" / "event.ipp").read_text()
    functions = source.split("RBDYN_INLINE std::string_view ")
    (kinds,) = (text for text in functions if text.startswith("name_of(EventKind"))
    (statuses,) = (text for text in functions if text.startswith("name_of(Status"))
    (advice,) = (text for text in functions if text.startswith("advice("))
    words = re.findall(r'"([\w -]+)"', kinds)
    (row,) = re.findall(r"^\| event kinds \| (.*)\(", conventions, re.MULTILINE)
    assert re.findall(r"`([\w-]+)`", row) == words and len(words) == 13
    told = re.findall(r'"([^"]+)"', re.sub(r'"\s+"', "", advice))  # texts side by side are one
    table = re.findall(r"^\| `([\w ]+)` \| (.*) \|$", conventions, re.MULTILINE)
    assert [name for name, _ in table] == re.findall(r'"([\w ]+)"', statuses)
    assert [sentence for _, sentence in table] == told
