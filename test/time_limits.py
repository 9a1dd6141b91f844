"""Limits of time in tests: processor time, which a busy machine does not change. Wall time only guards against hanging."""

import resource

# Nothing takes so long [s of wall time], however busy the machine is.
HANGING = 900


def processor(seconds):
    """For `preexec_fn`: the process is killed (status -9) when it has taken so many seconds of processor time."""
    return lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
