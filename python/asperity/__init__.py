"""Contacts between rough surfaces, with and without oil: the program asperity called from Python.

>>> import asperity
>>> result = asperity.run("case.nml")               # or a dict, a f90nml.Namelist, the text of a namelist
>>> result.pressure.plot()                          # xarray, SI units
>>> result.summary.h_min.attrs["error_estimate"]

The solver is the program; here is no numerical code. Results are read from its HDF5 files.
"""

from .calls import NotConvergedWarning, Progress, check, run
from .errors import AsperityError, Finding, InputError
from .program import version
from .result import Result, read

__all__ = [
    "AsperityError",
    "Finding",
    "InputError",
    "NotConvergedWarning",
    "Progress",
    "Result",
    "check",
    "read",
    "run",
    "version",
]
