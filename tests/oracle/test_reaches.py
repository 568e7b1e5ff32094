"""The figures that docs/experiments.md takes from one page - the same reach by five controllers - by a loop that shares no
code with the lab: Pinocchio (PyPI `pin`, see run.sh) for the dynamics, the arm from the table in docs/sample_models.md, the
laws and the quintic as the handbook writes them.
"""
import json
import pathlib
import sys

import numpy as np
import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "system"))
import labrun as lab  # noqa: E402

pin = pytest.importorskip("pinocchio")

# dt and the times of experiments/reach_*.yaml
DT, LAST, T = 0.001, 4000, 1.5
START, GOAL = np.array([0, 0.2, 0.2, 0, 0.3, 0]), np.array([0.8, 0.6, 0.6, 0.4, 0.5, -0.4])
KP, KD = 100, 20


def arm():
    """The arm of docs/sample_models.md: axis, origin, solid, centre and mass of each joint, rotors of 0.25 kg m2."""
    model = pin.Model()
    upright, level = np.eye(3), pin.utils.rotate("y", np.pi / 2)
    cylinder = lambda m, r, length: pin.Inertia.FromCylinder(m, r, length)  # noqa: E731
    rows = [(pin.JointModelRZ(), upright, 0.15, cylinder(4.0, 0.08, 0.15), 0.075),
            (pin.JointModelRY(), upright, 0.15, cylinder(5.0, 0.05, 0.45), 0.225),
            (pin.JointModelRY(), level, 0.45, cylinder(2.5, 0.045, 0.20), 0.10),
            (pin.JointModelRZ(), upright, 0.20, cylinder(2.0, 0.04, 0.20), 0.10),
            (pin.JointModelRY(), upright, 0.20, cylinder(1.0, 0.04, 0.10), 0.05),
            (pin.JointModelRZ(), upright, 0.10, pin.Inertia.FromBox(0.5, 0.06, 0.06, 0.08), 0.04)]
    parent = 0
    for joint, turn, origin, inertia, centre in rows:
        parent = model.addJoint(parent, joint, pin.SE3(turn, np.array([0, 0, origin])), f"joint{parent + 1}")
        model.appendBodyToJoint(parent, inertia, pin.SE3(np.eye(3), np.array([0, 0, centre])))
    model.armature[:] = 0.25
    model.effortLimit = np.array([300.0] * 3 + [150.0] * 3)
    return model


def heavier(model, scale):
    other = model.copy()
    for i in range(1, other.njoints):
        body = other.inertias[i]
        other.inertias[i] = pin.Inertia(scale * body.mass, body.lever, scale * body.inertia)
    return other


def wanted(t):
    """The quintic from rest to rest."""
    x, way = min(t / T, 1), GOAL - START
    return (START + way * (10 * x**3 - 15 * x**4 + 6 * x**5), way * (30 * x**2 - 60 * x**3 + 30 * x**4) / T,
            way * (60 * x - 180 * x**2 + 120 * x**3) / T**2)


def reach(law):
    """Largest error on the way, and the error left: the mean over the last tenth of the rest."""
    model = arm()
    data, q, v = model.createData(), START.copy(), np.zeros(6)
    errors = np.zeros((LAST + 1, 6))
    for k in range(LAST + 1):
        q_ref, v_ref, a_ref = wanted(k * DT)
        errors[k] = q_ref - q
        tau = law(q, v, q_ref - q, v_ref - v, a_ref)
        v = v + DT * pin.aba(model, data, q, v, np.clip(tau, -model.effortLimit, model.effortLimit))
        q = q + DT * v
    rest = LAST - round(T / DT)
    return np.max(np.abs(errors)), np.max(np.abs(np.mean(errors[LAST - rest // 10 + 1:], axis=0)))


def laws():
    true, wrong = arm(), heavier(arm(), 1.5)
    spring = lambda e, e_dot: KP * e + KD * e_dot  # noqa: E731

    def pd_gravity(model):
        data = model.createData()
        return lambda q, v, e, e_dot, a_ref: spring(e, e_dot) + pin.computeGeneralizedGravity(model, data, q)

    def computed_torque(model):
        data = model.createData()
        return lambda q, v, e, e_dot, a_ref: pin.crba(model, data, q) @ (a_ref + spring(e, e_dot)) + pin.nle(model, data, q, v)

    return {"reach_pd": lambda q, v, e, e_dot, a_ref: spring(e, e_dot), "reach_pd_gravity": pd_gravity(true), "reach_ct": computed_torque(true),
            "reach_wrong_gravity": pd_gravity(wrong), "reach_wrong_masses": computed_torque(wrong)}


def test_what_the_model_is_worth(tmp_path):
    ours, by_hand = {}, {}
    for name, law in laws().items():
        lab.solo(str(lab.ROOT / "experiments" / f"{name}.yaml"), tmp_path / name)
        metrics = json.loads((tmp_path / name / "metrics.json").read_text())
        ours[name] = (metrics["max_error"], metrics["steady_error_max"])
        by_hand[name] = reach(law)
        print(f"{name}: largest error {ours[name][0]:.4e}, by hand {by_hand[name][0]:.4e}; left at rest {ours[name][1]:.4e}, by hand {by_hand[name][1]:.4e}")
    for name in ours:
        assert 0.5 < ours[name][0] / by_hand[name][0] < 2
        if by_hand[name][1] > 1e-11:  # below that it is rounding
            assert 0.5 < ours[name][1] / by_hand[name][1] < 2
    for both in (ours, by_hand):  # the words of the page
        (pd, pd_rest), (gravity, gravity_rest), (ct, _), (wrong, _) = (both[f"reach_{name}"] for name in ("pd", "pd_gravity", "ct", "wrong_masses"))
        print(f"computed torque {pd / ct:.0f} times better than a PD; gravity leaves {gravity_rest / pd_rest:.0e} of its error at rest; wrong masses {wrong / ct:.0f} times worse")
        assert pd / ct > 10 and gravity_rest < 0.01 * pd_rest
    assert 0.5 < (ours["reach_wrong_masses"][0] / ours["reach_ct"][0]) / (by_hand["reach_wrong_masses"][0] / by_hand["reach_ct"][0]) < 2
