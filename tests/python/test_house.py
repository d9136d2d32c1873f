"""The rules of the house: which room may know which, how long a file may be, what is declared, what an import costs."""

from __future__ import annotations

import ast
import importlib
import importlib.metadata
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import lumel

ROOT = Path(__file__).resolve().parents[2]
CORE = ROOT / "src" / "lumel"
PACKAGE = ROOT / "python" / "lumel"
LONGEST = 400  # lines

# Which other rooms of the core a room may include. A new room needs a line here.
BASE = {"math", "sampling", "scene", "accel", "transfer"}
MAY_INCLUDE: dict[str, set[str]] = {
    "math": set(),
    "sampling": {"math"},
    "scene": {"math", "sampling"},
    "accel": {"math", "sampling", "scene"},
    "transfer": {"math", "sampling", "scene"},
    "raster": {"math", "sampling", "scene"},
    "estimators": {"math", "sampling"},
    "transport": BASE | {"raster"},
    "areas": BASE | {"estimators"},
    "eye": BASE | {"areas", "estimators"},
    "solver": BASE | {"areas", "estimators", "eye", "raster", "transport"},
}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)


def core_files() -> list[Path]:
    """All sources of the core."""
    return sorted(path for path in CORE.rglob("*") if path.suffix in {".h", ".cpp"})


def test_every_room_has_its_place() -> None:
    assert {path.relative_to(CORE).parts[0] for path in core_files()} <= MAY_INCLUDE.keys()


def test_rooms_include_one_way() -> None:
    wrong = []
    for path in core_files():
        room = path.relative_to(CORE).parts[0]
        for _, included in INCLUDE.findall(path.read_text(encoding="utf-8")):
            parts = included.split("/")
            if parts[0] == "lumel" and parts[1] != room and parts[1] not in MAY_INCLUDE[room]:
                wrong.append(f"{path.relative_to(ROOT)} includes {included}")
    assert not wrong


def test_own_headers_are_named_from_src() -> None:
    wrong = [
        f"{path.relative_to(ROOT)} includes {included}"
        for path in core_files()
        for quote, included in INCLUDE.findall(path.read_text(encoding="utf-8"))
        if quote == '"' and not (included.startswith("lumel/") and (ROOT / "src" / included).is_file())
    ]
    assert not wrong


def test_the_core_knows_no_python() -> None:
    wrong = [path.name for path in core_files() if re.search(r"Python\.h|nanobind|pybind", path.read_text(encoding="utf-8"))]
    assert not wrong


def test_no_file_is_long() -> None:
    folders = [CORE, PACKAGE, ROOT / "python" / "bindings", ROOT / "tests", ROOT / "tools"]
    files = [path for folder in folders for path in folder.rglob("*") if path.suffix in {".h", ".cpp", ".py", ".sh"}]
    lengths = {str(path.relative_to(ROOT)): len(path.read_text(encoding="utf-8").splitlines()) for path in files}
    assert not {name: lines for name, lines in lengths.items() if lines > LONGEST}


def third_party_imports(folder: Path) -> set[str]:
    """Top-level names of all modules, neither ours nor Python's own, that the Python files under `folder` import."""
    names: set[str] = set()
    ours = {"lumel"} | {path.stem for part in (folder, ROOT / "tools") for path in part.glob("*.py")}
    for path in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                names |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
                names.add(node.module.split(".")[0])
    return names - sys.stdlib_module_names - ours


@pytest.mark.parametrize("folder", ["python/lumel", "tests/python", "examples"])
def test_every_import_is_declared(folder: str) -> None:
    def plain(name: str) -> str:
        return re.sub(r"[-_.]+", "-", re.split(r"[<>=\[; ]", name)[0]).lower()

    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    requirements = project["dependencies"] + (project["optional-dependencies"]["dev"] if folder.startswith("tests") else [])
    declared = {plain(requirement) for requirement in requirements}
    homes = importlib.metadata.packages_distributions()
    undeclared = {name for name in third_party_imports(ROOT / folder) if not declared & {plain(home) for home in homes.get(name, [name])}}
    assert not undeclared


def test_the_stub_is_that_of_the_native_module() -> None:
    stubgen = pytest.importorskip("nanobind.stubgen")
    module = importlib.import_module("lumel._core")
    generator = stubgen.StubGen(module, quiet=True)
    generator.put(module)
    assert (PACKAGE / "_core.pyi").read_text(encoding="utf-8") == generator.get(), "run `make stub`"


@pytest.mark.parametrize("name", lumel.__all__)
def test_public_names_exist(name: str) -> None:
    assert getattr(lumel, name) is not None
    assert name in dir(lumel)


def test_unknown_names_raise() -> None:
    with pytest.raises(AttributeError, match="no attribute 'rendr'"):
        _ = lumel.rendr  # type: ignore[attr-defined]


def test_render_is_the_function_whatever_was_imported_before() -> None:
    importlib.import_module("lumel.render")
    assert callable(lumel.render)
    assert not isinstance(lumel.render, type(sys))


def test_import_is_light() -> None:
    script = "import sys; before = set(sys.modules); import lumel; print(*sorted(set(sys.modules) - before))"
    loaded = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True).stdout.split()
    assert not {name.split(".")[0] for name in loaded} & {
        "numpy",
        "OpenEXR",
        "PIL",
        "trimesh",
        "typer",
        "rich",
        "matplotlib",
        "importlib.metadata",
    }
    assert not [name for name in loaded if name.startswith("lumel.")]
