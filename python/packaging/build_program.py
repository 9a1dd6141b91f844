"""Build hook of the wheel: the program is built by make, or named by the variable ASPERITY, and goes into the package."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from packaging.tags import sys_tags


class ProgramBuildHook(BuildHookInterface):
    """Called by hatchling."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Puts the program into the wheel as asperity/bin/asperity; the wheel is then one for this kind of machine."""
        if version == "editable":  # a checkout finds its own build/bin/asperity
            return
        program = os.environ.get("ASPERITY", "")
        if not program:
            subprocess.run(["make", "build"], cwd=self.root, check=True, stdout=sys.stderr)
            program = str(Path(self.root, "build", "bin", "asperity"))
        build_data["force_include"][program] = "asperity/bin/asperity"
        build_data["pure_python"] = False
        # auditwheel finds out what the plain tag of this machine can be widened to
        platform = next(tag.platform for tag in sys_tags() if "manylinux" not in tag.platform)
        build_data["tag"] = f"py3-none-{platform}"
