"""What pyproject.toml cannot say: the wheel holds plugins for one platform and any Python.

scripts/build_wheel.sh puts this beside pyproject.toml in the tree that it builds from.
"""

import sys
from pathlib import Path

from setuptools import Distribution, setup
from setuptools.command.bdist_wheel import bdist_wheel

# The oldest C library that the plugins run with; pymeshlab's own wheels need it as well.
PLATFORM = "manylinux_2_35_x86_64"
PLUGINS = Path("scripts/devseg/plugins")


class PluginDistribution(Distribution):
    """A distribution with libraries, which makes the wheel one of a platform."""

    def has_ext_modules(self) -> bool:
        """The plugins are such libraries, though no modules of Python."""
        return True


class PluginWheel(bdist_wheel):
    """A wheel that any Python of the platform can use."""

    def run(self) -> None:
        """Refuses to make a wheel that could do nothing."""
        if len(list(PLUGINS.glob("lib*.so"))) != 2:
            sys.exit(
                f"error: expected both plugins in {PLUGINS}, found none; a source distribution "
                "is compiled by scripts/build_wheel.sh, which makes a wheel to install"
            )
        super().run()

    def get_tag(self) -> tuple[str, str, str]:
        """Python, interface and platform."""
        return "py3", "none", PLATFORM


setup(distclass=PluginDistribution, cmdclass={"bdist_wheel": PluginWheel})
