"""The lab against other people's dynamics (Pinocchio, PyPI `pin`). Optional: run.sh makes the environment.

Each logged step must be one semi-implicit Euler step of pin.aba from the one before, and the experiments' tracking
errors must be those of a loop written here that shares no code with the lab.
"""
import json
import pathlib
import re
import sys

import numpy as np
import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "system"))
import labrun as lab  # noqa: E402

pin = pytest.importorskip("pinocchio")

EXPERIMENTS = lab.ROOT / "experiments"


@pytest.fixture(scope="module")
def types(tmp_path_factory):
    return lab.generated_types(tmp_path_factory.mktemp("types"))


def run(name, folder, *options):
    lab.solo(str(EXPERIMENTS / f"{name}.yaml"), folder, *options)
    return list(lab.events(folder / "log.lcm")), json.loads((folder / "metrics.json").read_text())


def model_of(urdf, joint_names, armature, locked):
    """Pinocchio's model with the lab's joints; the others are welded where `locked` says."""
    model = pin.buildModelFromXML(urdf)
    weld = [i for i, name in enumerate(model.names) if i > 0 and name not in joint_names]
    q = pin.neutral(model)
    for i in weld:
        q[model.joints[i].idx_q] = locked[model.names[i]]
    if weld:
        model = pin.buildReducedModel(model, weld, q)
    assert list(model.names)[1:] == list(joint_names)
    model.armature[:] = armature
    return model


@pytest.mark.parametrize("name, dt, armature, locked", [
    ("arm3_sinusoid_ct", 0.001, 0.2, {}),
    ("arm3_cubic_pd", 0.01, 0.2, {}),
    ("panda_reach", 0.001, 0.0, {"panda_finger_joint1": 0.02, "panda_finger_joint2": 0.02}),  # pin cannot mimic
    ("ur5_reach", 0.001, 0.0, {}),
])
def test_every_step_is_one_step_of_pin_aba(types, tmp_path, name, dt, armature, locked):
    if name in ("panda_reach", "ur5_reach") and not lab.robots_are_here():
        pytest.skip("scripts/lab robots has not been here")
    welded = []
    if locked:
        experiment = (EXPERIMENTS / f"{name}.yaml").read_text()
        fingerless = {key: re.search(rf"{key}: \[(.*), [\d.]+\]", experiment)[1] for key in ("q0", "goal")}
        welded = ["--set", "robot.mimic=false", "--set", f"robot.lock={json.dumps(locked)}", "--set", f"simulator.q0=[{fingerless['q0']}]",
                  "--set", f"planner.goal=[{fingerless['goal']}]", "--set", "expect={final_error: {max: 0.001}}"]
    events, _ = run(name, tmp_path / "run", *welded)
    first = types.run_t.decode(events[0][1])
    model = model_of(first.urdf, first.joint_names, armature, locked)
    data = model.createData()
    states = [types.robot_state_t.decode(d) for c, d in events if c == "ROBOT_STATE"]
    commands = [types.command_t.decode(d) for c, d in events if c == "COMMAND"]
    worst = 0.0
    for before, command, after in zip(states, commands, states[1:]):
        assert before.step == command.step == after.step - 1
        np.testing.assert_array_equal(after.tau, np.clip(command.tau, -model.effortLimit, model.effortLimit))
        a = pin.aba(model, data, np.array(before.q), np.array(before.v), np.array(after.tau))
        v = np.array(before.v) + a * dt
        q = np.array(before.q) + v * dt
        worst = max(worst, np.max(np.abs(v - after.v) / np.maximum(1, np.abs(v))), np.max(np.abs(q - after.q) / np.maximum(1, np.abs(q))))
    print(f"{name}: {len(states) - 1} steps, worst relative difference {worst:.2e}")
    assert worst < 1e-9


def loop_by_hand(model, dt, duration, v0, amplitude, kp, kd, computed_torque):
    """Largest joint error of a sinusoid tracked by computed torque or by PD, in the plainest way."""
    data = model.createData()
    q, v = np.zeros(model.nq), np.array(v0, dtype=float)
    w = 1 + 0.3 * np.arange(model.nv)
    largest = 0.0
    for step in range(round(duration / dt) + 1):
        t = step * dt
        q_wanted, v_wanted, a_wanted = amplitude * np.sin(w * t), amplitude * w * np.cos(w * t), -amplitude * w**2 * np.sin(w * t)
        e, e_dot = q_wanted - q, v_wanted - v
        largest = max(largest, np.max(np.abs(e)))
        tau = kp * e + kd * e_dot
        if computed_torque:
            tau = pin.crba(model, data, q) @ (a_wanted + tau) + pin.nle(model, data, q, v)
        v = v + dt * pin.aba(model, data, q, v, np.clip(tau, -model.effortLimit, model.effortLimit))
        q = q + dt * v
    return largest


def test_tracking_errors_are_those_of_a_loop_by_hand(types, tmp_path):
    errors = {}
    for name in ("arm3_sinusoid_ct", "arm3_sinusoid_pd"):
        events, metrics = run(name, tmp_path / name)
        first = types.run_t.decode(events[0][1])
        model = model_of(first.urdf, first.joint_names, 0.2, {})
        by_hand = loop_by_hand(model, 0.001, 5, [0.5, 0.65, 0.8], 0.5, 100, 20, name.endswith("ct"))
        ours = metrics["max_error"]
        errors[name] = ours
        print(f"{name}: largest error {ours:.4e}, by hand {by_hand:.4e}")
        assert 0.5 < ours / by_hand < 2
    assert errors["arm3_sinusoid_pd"] >= 10 * errors["arm3_sinusoid_ct"]
