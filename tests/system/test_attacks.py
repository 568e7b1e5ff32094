"""A seeded tenth of the attacks of attacks.py in both clocks (LAB_TEST_ATTACKS=all: every one)."""
import os
import random

import attacks
import pytest


@pytest.fixture(scope="module")
def judge(tmp_path_factory):
    return attacks.Judge(tmp_path_factory.mktemp("attacks"))


def chosen(judge):
    names = list(attacks.ATTACKS)
    return names if os.environ.get("LAB_TEST_ATTACKS") == "all" else random.Random(16).sample(names, len(names) // 10)


def fault_of(judge, name, clock):
    """What the attack did. Real time on a shared machine has moments without any attack: there it must happen three times."""
    faults = []
    for _ in range(3 if clock == "realtime" else 1):
        fault = judge.attack(name, clock, seed=1)
        if not fault:
            return ""
        faults.append(fault)
    return "; ".join(faults)


@pytest.mark.parametrize("clock", attacks.DURATION)
def test_attacks_leave_the_run_unaffected(judge, clock):
    faults = {name: fault for name in chosen(judge) if (fault := fault_of(judge, name, clock))}
    assert not faults
