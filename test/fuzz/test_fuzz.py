"""The quick form of the attacks: a few cases of each kind, another few at each change of SEED."""

import pytest
import run

SEED, QUICK = 20261122, 5
KINDS = {name: module for name, module in run.kinds().items() if getattr(module, "QUICK", QUICK) > 0}


@pytest.mark.parametrize("name", KINDS)
def test_attacks_end_in_an_answer_or_one_message(name, program):
    module = KINDS[name]
    cases = min(getattr(module, "QUICK", QUICK), module.CASES)
    broken = [run.attack(name, module, program, SEED, number) for number in range(cases)]
    assert not any(broken), "\n".join(filter(None, broken))
