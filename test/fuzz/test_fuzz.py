"""The quick form of the attacks: a few cases of each kind, another few at each change of SEED."""

import pytest
import run

SEED = 20261122
KINDS = {name: kind for name, kind in run.kinds().items() if kind.quick > 0}
# The reader of namelists with the checked build too.
NAMES = [pytest.param(name, marks=pytest.mark.path) if name == "namelist_bytes" else name for name in KINDS]


@pytest.mark.parametrize("name", NAMES)
def test_attacks_end_in_an_answer_or_one_message(name, program):
    broken = [run.outcome(name, KINDS[name], program, SEED, number) for number in range(KINDS[name].quick)]
    assert not any(broken), "\n".join(filter(None, broken))
