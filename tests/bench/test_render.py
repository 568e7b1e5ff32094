"""lab bench render, our side alone: its lines and its JSON; never its speed."""
import json
import os
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
LAB = ROOT / "scripts/lab"
ARM = ROOT / "models/simple_3dof_arm.urdf"


def bench(*words):
    return subprocess.run([LAB, "bench", "render", "--peers", "none", "--frames", "2", "--rounds", "1", "--size", "64x48", *words],
                          capture_output=True, text=True, env={**os.environ, "LAB_MESH_CACHE": "off"})


def test_lines():
    done = bench("--robots", str(ARM))
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert [line.split()[1] for line in lines[:-1]] == ["draft", "live", "fine", "png"] and lines[-1].startswith("drawn by ")
    for line in lines[:3]:
        words = line.split()
        assert words[0] == "simple_3dof_arm" and float(words[2]) > 0 and words[3] == "frames/s"


def test_json():
    done = bench("--robots", str(ARM), "--json")
    assert done.returncode == 0, done.stderr
    result, = json.loads(done.stdout)["results"]
    assert result["mujoco"] is None and set(result["ours"]["modes"]) == {"draft", "live", "fine"}
    for times in result["ours"]["modes"].values():
        assert times["ms"] > 0 and times["triangles"] > 0


def test_bad_words():
    assert bench("--size", "640").returncode == 2
    assert bench("--frames", "0").returncode == 2
    none = bench("--robots", "/nonexistent.urdf")
    assert none.returncode == 1 and "there is no /nonexistent.urdf" in none.stderr
