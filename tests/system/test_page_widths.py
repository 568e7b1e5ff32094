"""The pages in a browser: nothing is wider than the window, and what is wider than the page scrolls in a box that shows it."""
import json
import pathlib
import shutil
import subprocess

import pytest

import labrun as lab

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
pytestmark = pytest.mark.skipif(not CHROMIUM, reason="no chromium here")

# A robot with joints that turn and joints that slide, and names that no table was made for.
JOINTS = ["torso_vertical_linear_lift_actuator_joint"] + [f"{side}_manipulator_{part}_revolute_joint" for side in ("left", "right")
          for part in ("shoulder_pitch", "shoulder_roll", "elbow_pitch", "forearm_roll", "wrist_pitch")]
EXPERIMENT = """
robot: {{model: {urdf}, armature: 0.2}}
simulator: {{dt: 0.01, duration: 2}}
planner: {{kind: quintic, goal: {goal}, duration: 1}}
controller: {{kind: pd_gravity, kp: {kp}, kd: 10}}
renderer: {{enabled: false}}
expect: {{max_error: {{max: 0.001}}, overshoot_max.{joint}: {{max: 0.5}}}}
"""
SWEEP = """
experiment: {file}
grid: {{controller.kp: {{from: 40, to: 100, count: {rows}}}, controller.kd: {{from: 5, to: 20, count: {columns}}}}}
metrics: [max_error, max_effort.{joint}]
"""
MEASURE = """
<body style="margin:0"><iframe id="page" src="page.html" style="width:{width}px;height:1000px;border:0"></iframe><pre id="found"></pre><script>
document.getElementById('page').onload = e => {{
  const inner = e.target.contentDocument, width = inner.documentElement.clientWidth, out = [], boxes = [];
  for (const one of inner.querySelectorAll('body *')) {{
    const box = one.closest('.scroll, .plots.one, figure.film, pre');
    if (box && box !== one) continue;
    if (one.closest('svg') && one.tagName !== 'svg') continue;
    if (one.getBoundingClientRect().right > width + 1) out.push(one.tagName + '.' + one.className + ' ' + one.textContent.slice(0, 40));
  }}
  for (const box of inner.querySelectorAll('.scroll, .plots.one, figure.film, pre'))
    if (box.scrollWidth > box.clientWidth + 1) boxes.push(getComputedStyle(box).overflowX + ' ' + (box.tagName === 'PRE' || getComputedStyle(box).backgroundImage.includes('gradient')));
  document.getElementById('found').textContent = JSON.stringify({{width, scroll: inner.documentElement.scrollWidth, out, boxes}});
}};
</script>
"""


def urdf():
    link = '<link name="{}"><inertial><origin xyz="0 0 0.05"/><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    text, parent = link.format("base"), "base"
    for i, name in enumerate(JOINTS):
        child = f"link{i}"
        if name == JOINTS[6]:  # the second arm
            parent = "link0"
        text += link.format(child) + f'<joint name="{name}" type="{"revolute" if i else "prismatic"}"><parent link="{parent}"/><child link="{child}"/>' \
            f'<origin xyz="0 0 0.1"/><axis xyz="{"0 1 0" if i % 2 else "0 0 1"}"/><limit lower="-2" upper="2" effort="2000" velocity="3"/></joint>'
        parent = child
    return f'<robot name="service_robot_with_long_names">{text}</robot>'


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """A report, a comparison of six and two sweeps."""
    folder = tmp_path_factory.mktemp("pages")
    (folder / "robot.urdf").write_text(urdf())
    runs = []
    for kp in (20, 40, 60, 80, 100, 120):
        file = folder / f"kp{kp}.yaml"
        file.write_text(EXPERIMENT.format(urdf=folder / "robot.urdf", goal=[0.2] * len(JOINTS), kp=kp, joint=JOINTS[1]))
        done = lab.run(str(file), folder / f"run{kp}", "--solo")
        assert done.returncode in (0, 1), done.stderr
        runs.append(folder / f"run{kp}")
    done = subprocess.run([lab.LAB, "compare", *map(str, runs), "-o", str(folder / "compare.html")], env=lab.environment(), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    all_pages = {"report": runs[0] / "report.html", "compare": folder / "compare.html"}
    for name, rows, columns in (("small", 3, 4), ("wide", 4, 14)):
        (folder / f"{name}.yaml").write_text(SWEEP.format(file=folder / "kp40.yaml", rows=rows, columns=columns, joint=JOINTS[2]))
        done = subprocess.run([lab.LAB, "sweep", str(folder / f"{name}.yaml"), "-o", str(folder / name)], env=lab.environment(), capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        all_pages[name] = folder / name / "sweep.html"
    return all_pages


def chromium(*words):
    return subprocess.run([CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--allow-file-access-from-files", *words],
                          capture_output=True, text=True, timeout=lab.DEADLINE, stdin=subprocess.DEVNULL)


@pytest.mark.parametrize("name", ["report", "compare", "small", "wide"])
@pytest.mark.parametrize("width", [390, 1280, 2560])
def test_nothing_is_wider_than_the_window(pages, tmp_path, name, width):
    (tmp_path / "page.html").write_bytes(pathlib.Path(pages[name]).read_bytes())
    (tmp_path / "measure.html").write_text(MEASURE.format(width=width))
    done = chromium(f"--user-data-dir={tmp_path / 'profile'}", "--window-size=2700,1100", "--virtual-time-budget=8000", "--dump-dom", f"file://{tmp_path / 'measure.html'}")
    found = done.stdout.split('<pre id="found">')[-1].split("</pre>")[0]
    assert found.startswith("{"), done
    found = json.loads(found.replace("&gt;", ">").replace("&lt;", "<").replace("&amp;", "&"))
    assert found["width"] in range(width - 20, width + 1)  # less a scroll bar
    assert found["scroll"] <= found["width"] and found["out"] == []
    assert all(box == "auto true" for box in found["boxes"]), found["boxes"]
    if width >= 1280 and name != "wide":
        assert found["boxes"] == []  # there is room: no table or plot is cut
