"""Contacts between rough surfaces, with and without oil: the program asperity called from Python.

>>> import asperity
>>> result = asperity.run("case.nml")               # or a dict, a f90nml.Namelist, the text of a namelist
>>> result.pressure.plot()                          # xarray, SI units
>>> result.summary.h_min.attrs["error_estimate"]

The solver is the program; here is no numerical code. Results are read from its HDF5 files.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .calls import NotConvergedWarning, Progress, check, run, run_many
    from .errors import AsperityError, Finding, InputError
    from .program import example, version
    from .result import Result, read
    from .running import read_part

__all__ = [
    "AsperityError",
    "Finding",
    "InputError",
    "NotConvergedWarning",
    "Progress",
    "Result",
    "check",
    "example",
    "read",
    "read_part",
    "run",
    "run_many",
    "version",
]

# Where each name is: modules are loaded when a name of theirs is asked for, so that `asperity.seal` costs no xarray.
_MODULES = {
    "calls": ("NotConvergedWarning", "Progress", "check", "run", "run_many"),
    "errors": ("AsperityError", "Finding", "InputError"),
    "program": ("example", "version"),
    "result": ("Result", "read"),
    "running": ("read_part",),
}

if not TYPE_CHECKING:

    def __getattr__(name):
        """A public name, or a module that has one, loaded at its first use."""
        for module, names in _MODULES.items():
            if name == module or name in names:
                loaded = import_module(f".{module}", __name__)
                globals()[name] = loaded if name == module else getattr(loaded, name)
                return globals()[name]
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

    def __dir__():
        """The public names, loaded or not."""
        return sorted({*globals(), *__all__})
