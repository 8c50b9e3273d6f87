"""What import-linter cannot say: which packages from outside a room may import."""

import re
import sys
from importlib.metadata import packages_distributions, requires

import grimp
import pytest

GRAPH = grimp.build_graph("flexdepth", include_external_packages=True, cache_dir=None)
TORCH_ALONE = ["geometry", "losses"]


def from_outside(room):
    modules = {room, *GRAPH.find_descendants(room)}
    imported = set().union(*map(GRAPH.find_modules_directly_imported_by, modules))
    return {name for name in imported - sys.stdlib_module_names if not name.startswith("flexdepth")}


def spelt_alike(name):
    return re.sub(r"[-_.]+", "-", name).lower()


def declared(*, in_extras):
    """The distributions that pyproject.toml names: the base's, or those of the extras too."""
    wanted = [line for line in requires("flexdepth") if in_extras or "extra ==" not in line]
    return {spelt_alike(re.match(r"[\w.-]+", line)[0]) for line in wanted}


def undeclared(imported, distributions):
    providers = packages_distributions()
    return {
        name
        for name in imported
        if not distributions & set(map(spelt_alike, providers.get(name, [name])))
    }


@pytest.mark.parametrize("room", TORCH_ALONE)
def test_mathematics_imports_torch_and_jaxtyping_only(room):
    if f"flexdepth.{room}" not in GRAPH.modules:
        pytest.skip(f"there is no flexdepth.{room} yet")
    assert from_outside(f"flexdepth.{room}") <= {"torch", "jaxtyping"}


def test_the_runtime_imports_what_the_base_install_brings():
    assert not undeclared(from_outside("flexdepth.runtime"), declared(in_extras=False))


def test_every_import_is_a_declared_dependency():
    assert not undeclared(from_outside("flexdepth"), declared(in_extras=True))
