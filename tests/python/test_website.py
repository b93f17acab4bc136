"""The documentation site: public names have their place, documents are in the contents, links lead somewhere.

The site itself is built by ./run docs, which fails on what is wrong with it; here is what can be known without Sphinx.
"""

import re
import sys

import pytest
import rbdyn as rb

NAMES = set(rb.__all__) - {"__version__"}


@pytest.fixture(scope="module")
def website(root):
    """The modules that put the site together, by name."""
    sys.path.insert(0, str(root / "docs" / "website"))
    import cpp_reference
    import links
    import make
    import python_reference

    yield {"make": make, "cpp": cpp_reference, "links": links, "python": python_reference}
    sys.path.remove(str(root / "docs" / "website"))


def test_each_public_name_stands_once_in_the_reference(website, tmp_path):
    names = [name for subject in website["python"].SUBJECTS.values() for name in subject]
    assert sorted(names) == sorted(NAMES)
    pages = website["python"].write_pages(tmp_path / "python")
    text = "".join((tmp_path / "python" / file).read_text() for _, file in pages)
    for name in names:
        thing = getattr(rb, name)
        kind = "module" if name == "shapes" else "function"
        if isinstance(thing, type):
            kind = "exception" if issubclass(thing, Exception) else "class"
        assert text.count(f".. auto{kind}:: rbdyn.{name}\n") == 1
        assert (thing.__doc__ or "").strip(), f"rbdyn.{name} has no docstring"


def test_each_header_that_programs_see_stands_once_in_the_reference(website, root, tmp_path):
    cpp, include = website["cpp"], root / "cpp" / "include"
    shown = [header for subject in cpp.SUBJECTS.values() for header in subject]
    assert sorted(shown + cpp.INNER) == sorted(cpp.reachable(include))
    cpp.write_pages(include, tmp_path / "cpp")
    text = (tmp_path / "cpp" / "scenes.md").read_text()
    assert "class Scene {" in text and "BodyHandle add(const Particle& particle" in text
    assert "private:" not in text and "std::vector<Body> bodies_;" not in text


def test_each_document_is_in_the_contents(website, root):
    make = website["make"]
    listed = [name for names in make.GUIDE.values() for name in names] + make.BACKGROUND
    assert sorted(listed) == sorted(path.stem for path in (root / "docs").glob("*.md"))


def test_docstrings_are_text(website):
    escaped, shortened = website["python"].escaped, website["python"].shortened
    assert escaped(["-(c1 + c2 |v|) v, *now* and `it`, I_"]) == [r"-(c1 + c2 \|v\|) v, \*now\* and \`it\`, I\_"]
    lines = [
        "f(*args, **kwargs)",
        "Overloaded function.",
        "",
        "1. f(self: rbdyn._core.A, x: numpy.typing.ArrayLike) -> int",
    ]
    assert escaped(lines) == ["", "``f(x: array_like) -> int``"]
    assert shortened("(t: typing.SupportsFloat | typing.SupportsIndex) -> rbdyn._core.Run") == "(t: float) -> Run"


def places_in(text):
    """Where links to a document can lead: its headings, as forges and Sphinx name them."""
    headings = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def test_links_between_documents_lead_somewhere(root):
    found = 0
    for path in [root / "README.md", root / "CHANGELOG.md", *(root / "docs").rglob("*.md")]:
        text = re.sub(r"^```.*?^```", "", path.read_text(), flags=re.MULTILINE | re.DOTALL)
        for link in re.findall(r"\]\(([^()\s]+)\)", text):
            if re.match(r"https?:", link):
                continue
            file, _, place = link.partition("#")
            target = path.parent / file if file else path
            assert target.exists(), f"{path.name}: {link}"
            assert not place or place in places_in(target.read_text()), f"{path.name}: {link}"
            found += 1
        for named in re.findall(r"`((?:docs|examples|benchmarks|tests|bindings)/[\w./-]*)`", text):
            assert (root / named).exists(), f"{path.name}: {named}"
            found += 1
    assert found > 100


def test_broken_links_in_a_site_are_found(website, tmp_path):
    (tmp_path / "a.html").write_text(
        '<a href="b.html#here">b</a><img src="c.png"><a href="https://example.org/x">x</a>'
    )
    (tmp_path / "b.html").write_text('<p id="here"><a href="a.html">a</a><a href="#there">nowhere</a>')
    problems = website["links"].broken(tmp_path)
    assert problems == ["a.html: c.png leads nowhere", "b.html: #there: no such place in b.html"]
