"""Controllers of one's own: in Python beside our own, told apart field by field; in C++ with a kind that we do not have."""
import json
import os

import pytest

import labrun as lab

PD = """
robot: {{model: "{root}/models/simple_3dof_arm.urdf", armature: 0.2}}
simulator: {{dt: 0.005, duration: {duration}}}
planner: {{kind: {planner}}}
controller: {{kind: {kind}, kp: 100, kd: 20}}
renderer: {{enabled: false}}
"""
PATIENT = ("--set", "deadline=60", "--set", "ready=60")  # Python starts slowly on a busy machine


def experiment(folder, planner, kind="pd", duration=2.0):
    path = folder / "own.yaml"
    path.write_text(PD.format(root=lab.ROOT, planner=planner, kind=kind, duration=duration))
    return str(path)


def fields(message):
    return {name: getattr(message, name) for name in message.__slots__}


def test_a_python_controller_differs_in_nothing_but_tau_and_what_follows(tmp_path):
    """The same law in Python and in C++ (where a product and a sum may be one instruction with one rounding): the two logs
    have the same events in the same order, and differ in tau's last bits and in what those do."""
    python = lab.BUILD / "pyenv" / "bin" / "python"
    if not os.access(python, os.X_OK):
        pytest.skip("no Python with LCM here (tests/conformance/pyenv.sh)")
    types = lab.generated_types(tmp_path / "types")
    file = experiment(tmp_path, "sinusoid, amplitude: 0.4")
    lab.solo(file, tmp_path / "ours")
    mine = f"env PYTHONPATH={tmp_path}/types {python} {lab.ROOT}/examples/controller.py 100 "
    for name, kd in (("mine", "20"), ("harder", "21")):
        done = lab.run(file, tmp_path / name, "--set", f"processes.controller={mine}{kd}", *PATIENT)
        assert done.returncode == 0, done.stderr

    kinds = {"RUN": types.run_t, "TYPE": types.type_t, "ROBOT_STATE": types.robot_state_t, "REFERENCE": types.reference_t,
             "COMMAND": types.command_t, "END": types.end_t}
    ours, theirs = (list(lab.events(tmp_path / name / "log.lcm")) for name in ("ours", "mine"))
    assert [channel for channel, _ in ours] == [channel for channel, _ in theirs]
    differing, first, largest = set(), None, 0.0
    for (channel, a), (_, b) in zip(ours, theirs):
        if a == b:
            continue
        one, other = (fields(kinds[channel].decode(data)) for data in (a, b))
        names = {(channel, name) for name in one if one[name] != other[name]}
        assert names, f"{channel}: the bytes differ and no field does"
        first = first or names
        differing |= names
        if channel in ("COMMAND", "ROBOT_STATE"):
            for name in ("tau", "q", "v"):
                largest = max([largest, *(abs(x - y) for x, y in zip(one.get(name, []), other.get(name, [])))])
    print("differ in", sorted(differing), "by at most", largest)
    assert differing <= {("COMMAND", "tau"), ("ROBOT_STATE", "tau"), ("ROBOT_STATE", "q"), ("ROBOT_STATE", "v"),
                         ("ROBOT_STATE", "digest"), ("END", "digest"), ("END", "check")}, differing
    if differing:
        assert first == {("COMMAND", "tau")}, first
        # a rounding of tau (tens of Nm) is some 1e-15, and the stable loop forgets it
        assert largest < 1e-12, largest
    ours, mine, harder = (json.loads((tmp_path / name / "metrics.json").read_text()) for name in ("ours", "mine", "harder"))
    assert mine["complete"] and abs(ours["rms_error"] - mine["rms_error"]) < 1e-13
    assert abs(ours["rms_error"] - harder["rms_error"]) > 1e-6, "it was not Python's command that moved the robot"


def test_a_cpp_controller_with_a_kind_of_its_own(tmp_path):
    """examples/own_controller.cc: a PID. It holds the arm bent, where a PD with the same gains sags by its weight."""
    own = lab.BUILD / "examples" / "own_controller"
    bent = ("--set", "simulator.q0=[0.3,0.6,0.5]", "--set", "simulator.duration=10", *PATIENT)

    def error(name, file, *options):
        done = lab.run(file, tmp_path / name, *bent, *options)
        assert done.returncode == 0, done.stderr
        return json.loads((tmp_path / name / "metrics.json").read_text())["final_error"]
    sag = error("pd", experiment(tmp_path, "hold"))
    pid = error("pid", experiment(tmp_path, "hold", "pid"), "--set", f"processes.controller={own}")
    assert sag > 0.04 and pid < 1e-3 * sag, (sag, pid)
    # without the process that knows it, the kind is unknown
    done = lab.run(experiment(tmp_path, "hold", "pid"), tmp_path / "none")
    assert done.returncode == 3 and "controller.kind: 'pid' is not known; use one of none, pd, " in done.stderr
