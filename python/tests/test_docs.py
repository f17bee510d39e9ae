"""Examples of the documentation run."""

import doctest
import importlib
import pathlib

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = {
    "README.md": "C1  b4j1 in b7j1",
    "docs/src/tutorials/python.md": "C1  b4j1 in b7j1",
    "docs/src/reference/finders.md": "",
}
"""Pages, and what their examples print."""
MODULES = [
    "ramp",
    "ramp.agent",
    "ramp.twin",
    "ramp.driver",
    "ramp.gym",
    "ramp.policies.fasten",
    "ramp.policies.looking",
]


def blocks(text):
    """The Python blocks of a page."""
    parts = text.split("```python\n")[1:]
    return [part.split("```", 1)[0] for part in parts]


@pytest.mark.parametrize("page", PAGES)
def test_the_examples_of_a_page_run(page, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    if "gymnasium" in (text := (ROOT / page).read_text(encoding="utf-8")):
        pytest.importorskip("gymnasium")
    names = {}
    assert blocks(text)
    for block in blocks(text):
        exec(compile(block, page, "exec"), names)
    assert PAGES[page] in capsys.readouterr().out


def test_the_example_of_the_environments_runs(capsys):
    pytest.importorskip("gymnasium")
    page = ROOT / "docs/src/reference/environments.md"
    exec(compile(blocks(page.read_text(encoding="utf-8"))[0], page, "exec"), {})
    assert capsys.readouterr().out in ("True\n", "False\n")


def test_the_examples_of_the_open_class_run():
    pytest.importorskip("gymnasium")
    page = ROOT / "docs/src/reference/open-class.md"
    for block in blocks(page.read_text(encoding="utf-8")):
        exec(compile(block, page, "exec"), {})
    names = importlib.import_module("ramp").goals.of_class("open-2026")
    assert len(names) == 60 and names[0] == "open-2026-small-01"


def test_the_package_s_page_has_the_example_of_the_readme():
    pages = [(ROOT / page).read_text(encoding="utf-8") for page in ("README.md", "python/README.md")]
    assert blocks(pages[0]) == blocks(pages[1])


@pytest.mark.parametrize("name", MODULES)
def test_the_examples_of_a_module_run(name):
    module = importlib.import_module(name)
    failed, tried = doctest.testmod(module, extraglobs={"ramp": importlib.import_module("ramp")})
    assert tried > 0 and failed == 0
