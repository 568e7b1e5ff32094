"""`lab-model eval` against Pinocchio (PyPI `pin`), on every robot of example-robot-data. Optional: run.sh makes the environment.

All quantities, fixed and floating base, mimic joints free: pin has no mimic in most of its algorithms. What mimic joints do is
tested as mathematics: each quantity of the robot with mimic is that of pin's free robot, projected by the mimic map G.

pin is linear first, ours angular first; its continuous joints have two numbers (cos, sin), ours one angle. Joints and frames
are matched by name. Tolerance: |ours - pin| / max(1, |pin|) below 1e-9, entry by entry. What comes out of a solve with M may
instead differ by 4 eps cond(M) of its largest entry; most robots must do without that.
"""
import collections
import json
import os
import pathlib
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "system"))
import labrun as lab  # noqa: E402

pin = pytest.importorskip("pinocchio")

TOLERANCE = 1e-9
STATES = 3
REFERENCES = {"WORLD": pin.WORLD, "LOCAL": pin.LOCAL, "LOCAL_WORLD_ALIGNED": pin.LOCAL_WORLD_ALIGNED}
ANGULAR_FIRST = np.r_[3:6, 0:3]
# Rounding is amplified by cond(M) in any library. icub's neck gets to 5e8: there a Cholesky solve, pin and we all miss the
# acceleration that the efforts were made from by 1e-8 to 1e-7.
WITH_SOLVE = ("Minv", "ddq", "ddq_dq", "ddq_dv")


def robots():
    """Files by a short name; empty when `lab robots` has not been here."""
    for folder in os.environ.get("LAB_PACKAGE_PATH", "").split(":"):
        root = pathlib.Path(folder) / "example-robot-data" / "robots"
        files = sorted(root.glob("**/*.urdf"))
        if files:
            return {f"{f.relative_to(root).parts[0].removesuffix('_description')}/{f.stem}": f for f in files}
    return {}


def lab_model(verb, file, *options, given=None):
    done = subprocess.run([lab.BUILD / "bin" / "lab-model", verb, file, "--json", *options], input=json.dumps(given or {}),
                          capture_output=True, text=True, timeout=lab.DEADLINE)
    return done.returncode, json.loads(done.stdout) if done.stdout else None, done.stderr


class Layout:
    """Where the joints' numbers stand in our vectors and in pin's, for the same robot."""

    def __init__(self, info, model):
        self.nq, self.nv, self.model = info["nq"], info["nv"], model
        self.joints = [(joint, model.joints[model.getJointId(joint["name"])]) for joint in info["joints"] if joint["nv"]]
        missing = [joint["name"] for joint, _ in self.joints if not model.existJointName(joint["name"])]
        assert not missing, f"joints that pin does not have: {missing}"
        self.v = np.zeros(model.nv, dtype=int)  # v_pin = v_ours[self.v]
        for ours, theirs in self.joints:
            order = ANGULAR_FIRST if ours["kind"] == "FreeFlyer" else np.arange(ours["nv"])
            self.v[theirs.idx_v + np.arange(theirs.nv)] = ours["idx_v"] + order
        self.back = np.argsort(self.v)  # v_ours = v_pin[self.back]

    def q(self, ours):
        q = np.zeros(self.model.nq)
        for joint, theirs in self.joints:
            x = ours[joint["idx_q"]:joint["idx_q"] + joint["nq"]]
            q[theirs.idx_q:theirs.idx_q + theirs.nq] = [np.cos(x[0]), np.sin(x[0])] if theirs.nq == 2 and joint["nq"] == 1 else x
        return q


def random_q(info, rng):
    """A configuration of our robot, between its limits."""
    q = np.zeros(info["nq"])
    for joint in info["joints"]:
        place = slice(joint["idx_q"], joint["idx_q"] + joint["nq"])
        if joint["nq"] == 0:
            continue
        if joint["kind"] == "FreeFlyer":
            turn = rng.normal(size=4)
            q[place] = np.r_[rng.uniform(-1, 1, 3), turn / np.linalg.norm(turn)]
        elif joint["kind"] == "Planar":
            angle = rng.uniform(-np.pi, np.pi)
            q[place] = np.r_[rng.uniform(-1, 1, 2), np.cos(angle), np.sin(angle)]
        else:
            lower, upper = (joint["position"][side][0] for side in ("lower", "upper"))
            q[place] = rng.uniform(-np.pi if lower is None else max(lower, -10), np.pi if upper is None else min(upper, 10))
    return q


def spatial(x):
    return np.asarray(x)[ANGULAR_FIRST]


def both_sides(upper):
    return np.triu(upper) + np.triu(upper, 1).T


def numbers_of_pin(layout, q, v, a, tau, names):
    """Everything that eval prints, in our order, from pin."""
    model, order = layout.model, layout.back
    data = model.createData()
    square = np.ix_(order, order)
    q, v, a, tau = layout.q(q), v[layout.v], a[layout.v], tau[layout.v]
    out = {"M": both_sides(pin.crba(model, data, q))[square], "Minv": both_sides(pin.computeMinverse(model, data, q))[square],
           "C": pin.computeCoriolisMatrix(model, data, q, v)[square].copy(), "nle": pin.nle(model, data, q, v)[order],
           "g": pin.computeGeneralizedGravity(model, data, q)[order], "tau": pin.rnea(model, data, q, v, a)[order],
           "ddq": pin.aba(model, data, q, v, tau)[order], "com": pin.centerOfMass(model, data, q, v).copy(), "vcom": data.vcom[0].copy(),
           "Jcom": pin.jacobianCenterOfMass(model, data, q)[:, order], "Ag": spatial(pin.computeCentroidalMap(model, data, q))[:, order],
           "hg": spatial(pin.computeCentroidalMomentum(model, data, q, v)),
           "dhg": spatial(pin.computeCentroidalMomentumTimeVariation(model, data, q, v, a)),
           "kinetic": pin.computeKineticEnergy(model, data, q, v), "potential": pin.computePotentialEnergy(model, data, q)}
    pin.computeRNEADerivatives(model, data, q, v, a)
    out.update(dtau_dq=data.dtau_dq[square].copy(), dtau_dv=data.dtau_dv[square].copy())
    pin.computeABADerivatives(model, data, q, v, tau)
    out.update(ddq_dq=data.ddq_dq[square].copy(), ddq_dv=data.ddq_dv[square].copy())
    pin.computeJointJacobians(model, data, q)
    pin.forwardKinematics(model, data, q, v, a)
    pin.updateFramePlacements(model, data)
    out["oMi"] = {name: data.oMi[i].homogeneous for i, name in enumerate(model.names)}
    # of frames that share a name the first counts, here and there
    out["oMf"] = {frame.name: data.oMf[i].homogeneous for i, frame in reversed(list(enumerate(model.frames)))}
    out["frames"] = {}
    for name in names:
        i = model.getFrameId(name)
        out["frames"][name] = {
            "J": {key: spatial(pin.getFrameJacobian(model, data, i, r))[:, order] for key, r in REFERENCES.items()},
            "velocity": {key: spatial(pin.getFrameVelocity(model, data, i, r).vector) for key, r in REFERENCES.items()},
            "acceleration": {key: spatial(pin.getFrameAcceleration(model, data, i, r).vector) for key, r in REFERENCES.items()},
            "classical_acceleration": {key: spatial(pin.getFrameClassicalAcceleration(model, data, i, r).vector) for key, r in REFERENCES.items()}}
    return out


def project(free, G, tau):
    """The numbers of a robot with mimic joints from those of the free one: q_free = G q + offset, v_free = G v."""
    out = {key: free[key] for key in ("com", "vcom", "hg", "dhg", "kinetic", "potential", "oMi", "oMf")}
    for key in ("M", "C", "dtau_dq", "dtau_dv"):
        out[key] = G.T @ free[key] @ G
    for key in ("nle", "g", "tau"):
        out[key] = G.T @ free[key]
    for key in ("Jcom", "Ag"):
        out[key] = free[key] @ G
    out["Minv"] = np.linalg.inv(out["M"])
    out["ddq"] = np.linalg.solve(out["M"], tau - out["nle"])
    out["frames"] = {name: {**frame, "J": {key: J @ G for key, J in frame["J"].items()}} for name, frame in free["frames"].items()}
    return out


def leaves(value, path=""):
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from leaves(inner, f"{path}.{key}" if path else key)
    else:
        yield path, np.asarray(value, dtype=float)


class Worst:
    """The largest error over all quantities and states, and the largest part of what is allowed that one uses."""

    def __init__(self):
        self.part, self.error, self.what, self.compared, self.condition, self.exact = 0.0, 0.0, "", set(), 1.0, True

    def add(self, what, ours, theirs):
        assert ours.shape == theirs.shape, f"{what}: {ours.shape} and {theirs.shape}"
        self.compared.add(what.split(".")[0])
        if ours.size == 0:
            return
        error = np.max(np.abs(ours - theirs) / np.maximum(1, np.abs(theirs)))
        part = error / TOLERANCE
        if not part < 1:  # NaN, too
            self.exact = False
            if what in WITH_SOLVE:
                part = np.max(np.abs(ours - theirs)) / np.max(np.abs(theirs)) / (4 * np.finfo(float).eps * self.condition)
                what += f" at cond(M) {self.condition:.0e}"
        self.part = part if not part <= self.part else self.part
        if not error <= self.error:
            self.error, self.what = error, what

    def row(self, name, nv):
        return name, nv, self.what, f"{self.error:.1e}"


def compare(worst, ours, theirs, v):
    """C is not unique: what counts is C v, and C + C' = dM/dt."""
    ours, theirs = dict(ours), dict(theirs)
    worst.condition = np.linalg.cond(theirs["M"])
    mine, his = np.asarray(ours.pop("C")), theirs.pop("C")
    worst.add("C v", mine @ v, theirs["nle"] - theirs["g"])
    worst.add("C + C'", mine + mine.T, his + his.T)
    assert ours.keys() == theirs.keys(), sorted(ours.keys() ^ theirs.keys())
    his = dict(leaves({key: value for key, value in theirs.items() if key not in ("oMi", "oMf")}))
    for path, value in leaves({key: value for key, value in ours.items() if key not in ("oMi", "oMf")}):
        worst.add(path, value, his[path])
    for key in ("oMi", "oMf"):
        assert ours[key].keys() == theirs[key].keys(), sorted(ours[key].keys() ^ theirs[key].keys())
        for name, pose in ours[key].items():
            worst.add(f"{key}", np.asarray(pose), theirs[key][name])


def pin_model(file, floating):
    if floating:
        return pin.buildModelFromUrdf(str(file), pin.JointModelFreeFlyer())
    return pin.buildModelFromUrdf(str(file))


def frames_to_ask(model, rng):
    """A few of those whose name is theirs alone: pin cannot tell the others apart."""
    count = collections.Counter(frame.name for frame in model.frames)
    unique = [frame.name for frame in model.frames if count[frame.name] == 1]
    return [unique[-1], *rng.choice(unique, min(3, len(unique)), replace=False)]


def states_of(info, rng, with_tau):
    """Motions of everyday size; efforts near those that the motion needs, so that accelerations are of everyday size too."""
    out = []
    for _ in range(STATES):
        state = {"q": random_q(info, rng), "v": rng.uniform(-1, 1, info["nv"]), "a": rng.uniform(-1, 1, info["nv"])}
        out.append({**state, "tau": with_tau(state, rng.uniform(-1, 1, info["nv"]))})
    return out


def as_json(states, names):
    return {"states": [{key: list(value) for key, value in state.items()} for state in states], "frames": list(names)}


def prepare(file, *options):
    """Info of our robot, or the line of the refusal; pin's model, or why it refuses."""
    code, info, said = lab_model("info", file, *options)
    try:
        model = pin_model(file, "--floating-base" in options)
    except Exception as error:  # whatever it throws is its refusal
        model, complaint = None, str(error).splitlines()[0]
    if code:
        line = said.splitlines()[0].split("/")[-1]
        return None, None, f"we refuse, pin {'does too' if model is None else 'does not'}: {line}"
    return info, model, "" if model else f"pin refuses: {complaint}"


def table(title, rows):
    print(f"\n{title}")
    width = max(len(row[0]) for row in rows)
    for name, nv, what, error in rows:
        print(f"  {name:{width}}  {nv:>4}  {what:42}  {error}")


@pytest.mark.skipif(not robots(), reason="scripts/lab robots has not been here")
@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_every_quantity_of_every_robot(base):
    rows, bad, compared, exact = [("robot", "nv", "worst quantity", "error")], [], 0, 0
    options = ["--no-mimic"] + (["--floating-base"] if base == "floating" else [])
    for name, file in robots().items():
        info, model, refusal = prepare(file, *options)
        if refusal:
            rows.append((name, "-", refusal, "-"))
            continue
        rng = np.random.default_rng(7)
        layout, names, worst = Layout(info, model), frames_to_ask(model, rng), Worst()

        def effort(state, a):
            data = model.createData()
            return pin.rnea(model, data, layout.q(state["q"]), state["v"][layout.v], a[layout.v])[layout.back]

        states = states_of(info, rng, effort)
        code, ours, said = lab_model("eval", file, *options, given=as_json(states, names))
        if code:
            rows.append((name, layout.nv, f"we cannot: {said.splitlines()[0]}"[:100], "-"))
            continue
        assert ours["joints"] == [joint["name"] for joint, _ in layout.joints]
        worst.add("mass", np.array(ours["mass"]), np.array(sum(inertia.mass for inertia in list(model.inertias)[1:])))
        for state, numbers in zip(states, ours["states"]):
            compare(worst, numbers, numbers_of_pin(layout, **state, names=names), state["v"])
        compared += 1
        exact += worst.exact
        rows.append(worst.row(name, layout.nv))
        if not worst.part < 1:
            bad.append(rows[-1])
    table(f"{base} base: {compared} robots, {exact} of them below {TOLERANCE:g}; {len(worst.compared)} quantities ({', '.join(sorted(worst.compared))})", rows)
    assert exact >= 50
    assert not bad


def mimic_map(file, info, free):
    """Gq, G and offset with q_free = Gq q + offset and v_free = G v, from the file itself; the length of its longest chain; how
    many followers come before their leader; how many there are."""
    rules = {joint.get("name"): (joint.find("mimic").get("joint"), float(joint.find("mimic").get("multiplier", 1)), float(joint.find("mimic").get("offset", 0)))
             for joint in ElementTree.parse(file).getroot().iter("joint") if joint.find("mimic") is not None and joint.get("type") != "fixed"}
    place = {joint["name"]: joint for joint in info["joints"]}
    Gq, G = np.zeros((free["nq"], info["nq"])), np.zeros((free["nv"], info["nv"]))
    offset, longest, later = np.zeros(free["nq"]), 0, 0
    order = [joint["name"] for joint in free["joints"]]
    for joint in free["joints"]:
        name, ratio, shift, steps = joint["name"], 1.0, 0.0, 0
        while name in rules:
            leader, multiplier, plus = rules[name]
            later += steps == 0 and order.index(leader) > order.index(name)
            name, ratio, shift, steps = leader, ratio * multiplier, shift + ratio * plus, steps + 1
        for k in range(joint["nv"]):
            G[joint["idx_v"] + k, place[name]["idx_v"] + k] = ratio
        for k in range(joint["nq"]):
            Gq[joint["idx_q"] + k, place[name]["idx_q"] + k] = ratio
        offset[joint["idx_q"]:joint["idx_q"] + joint["nq"]] = shift
        longest = max(longest, steps)
    return Gq, G, offset, longest, later, len(rules)


CHAINED = ["g1/g1_29dof_rev_1_0", "hyq/hyq_no_sensors", "kinova/kinova", "pr2/pr2", "so_arm/so101", "solo/solo12", "tiago/tiago_no_hand",
           "ur/ur5_robot", "xarm/xarm7", "z1/z1"]


def chained(file, folder):
    """The same robot with a chain of our own: the first joint follows the last one, which follows one in the middle."""
    tree = ElementTree.parse(file)
    place = {joint["name"]: joint["idx_v"] for joint in lab_model("info", file, "--no-mimic")[1]["joints"]}
    joints = [joint for joint in tree.getroot().iter("joint") if joint.get("type") in ("revolute", "continuous", "prismatic")]
    taken = {joint.find("mimic").get("joint") for joint in joints if joint.find("mimic") is not None}
    joints = sorted((j for j in joints if j.find("mimic") is None and j.get("name") not in taken), key=lambda j: place[j.get("name")])
    first, middle, last = joints[0], joints[len(joints) // 2], joints[-1]
    for follower, leader, multiplier, offset in ((first, last, -0.7, 0.1), (last, middle, 1.3, -0.2)):
        ElementTree.SubElement(follower, "mimic", joint=leader.get("name"), multiplier=str(multiplier), offset=str(offset))
    out = folder / f"{file.stem}_chain.urdf"
    tree.write(out)
    return out


@pytest.mark.skipif(not robots(), reason="scripts/lab robots has not been here")
@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_mimic_joints_are_a_projection_of_the_free_robot(base, tmp_path):
    rows, bad, compared = [("robot", "nv", "worst quantity", "error")], [], 0
    options = ["--floating-base"] if base == "floating" else []
    files = {name: file for name, file in robots().items() if "<mimic" in file.read_text()}
    files.update({f"{name} + chain": chained(robots()[name], tmp_path) for name in CHAINED})
    for name, file in files.items():
        info, model, refusal = prepare(file, *options)
        if refusal:
            rows.append((name, "-", refusal, "-"))
            continue
        free = lab_model("info", file, "--no-mimic", *options)[1]
        Gq, G, offset, longest, later, followers = mimic_map(file, info, free)
        if not followers:
            rows.append((name, "-", "<mimic> on fixed joints only", "-"))
            continue
        rng = np.random.default_rng(11)
        layout, worst = Layout(free, model), Worst()
        names = frames_to_ask(model, rng)

        def effort(state, a):
            data = model.createData()
            tau = pin.rnea(model, data, layout.q(Gq @ state["q"] + offset), (G @ state["v"])[layout.v], (G @ a)[layout.v])
            return G.T @ tau[layout.back]

        states = states_of(info, rng, effort)
        code, ours, said = lab_model("eval", file, *options, given=as_json(states, names))
        if code:
            rows.append((name, info["nv"], f"we cannot: {said.splitlines()[0]}"[:100], "-"))
            continue
        for state, numbers in zip(states, ours["states"]):
            q, v, a = Gq @ state["q"] + offset, G @ state["v"], G @ state["a"]
            theirs = project(numbers_of_pin(layout, q, v, a, np.zeros(layout.nv), names), G, state["tau"])
            # derivatives of forward dynamics: those of inverse dynamics at the acceleration that results
            there = numbers_of_pin(layout, q, v, G @ theirs["ddq"], np.zeros(layout.nv), [])
            for key, by in (("ddq_dq", "dtau_dq"), ("ddq_dv", "dtau_dv")):
                theirs[key] = -np.linalg.solve(theirs["M"], G.T @ there[by] @ G)
            compare(worst, numbers, theirs, state["v"])
        compared += 1
        rows.append(worst.row(f"{name}: {followers} followers, longest chain {longest}, {later} before their leader", info["nv"]))
        if not worst.part < 1:
            bad.append(rows[-1])
    table(f"mimic, {base} base: {compared} robots", rows)
    assert compared >= 15
    assert not bad
