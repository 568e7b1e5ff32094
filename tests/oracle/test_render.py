"""Geometry of the off-screen renderer against MuJoCo's: link ids and depth of the same meshes, poses and camera."""
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

os.environ.setdefault("MUJOCO_GL", "osmesa")
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bench/render"))
pytest.importorskip("mujoco")
from mujoco_scene import GEOMS, Scene  # noqa: E402

DATA = pathlib.Path(os.environ["LAB_ROBOTS"]) / "example-robot-data/robots" if "LAB_ROBOTS" in os.environ else None
PROGRAM = pathlib.Path(os.environ.get("LAB_BUILD", ROOT / "build/release")) / "bin/bench-render"
WIDTH, HEIGHT, POSES = 640, 480, 5


@pytest.mark.parametrize("urdf", ["panda_description/urdf/panda.urdf", "talos_data/robots/talos_reduced.urdf"])
def test_ids_and_depth(urdf, tmp_path):
    if DATA is None or not DATA.is_dir():
        pytest.skip("robots are downloaded by scripts/lab robots")
    for verb in ("export", "measure"):
        subprocess.run([PROGRAM, verb, DATA / urdf, str(WIDTH), str(HEIGHT), str(POSES), tmp_path], check=True)
    theirs = Scene(tmp_path, 0, 1024)
    body_of = theirs.body_of_geom()
    segmentation, depth = theirs.renderer(), theirs.renderer()
    segmentation.enable_segmentation_rendering()
    depth.enable_depth_rendering()
    for k in range(POSES):
        our_id = np.fromfile(tmp_path / f"id-{k}.raw", np.uint16).reshape(HEIGHT, WIDTH)
        our_depth = np.fromfile(tmp_path / f"depth-{k}.raw", np.float32).reshape(HEIGHT, WIDTH)
        theirs.pose(k)
        for renderer in (segmentation, depth):
            renderer.update_scene(theirs.data, theirs.camera)
        seen = segmentation.render()
        geom = np.where(seen[..., 1] == int(GEOMS), seen[..., 0], -1)
        their_id = np.where(geom >= 0, body_of[geom] + 1, 0)
        same = (our_id == their_id) & (our_id > 0)
        overlap = same.sum() / ((our_id > 0) | (their_id > 0)).sum()
        error = np.abs(our_depth - depth.render())[same]
        # a pixel that grazes an edge sees another surface behind: of the rest every one must agree
        apart = (error > 0.002).mean()
        print(f"{pathlib.Path(urdf).stem} pose {k}: {same.sum()} pixels, IoU {overlap:.4f}, depth: median {1e6 * np.median(error):.0f} um, "
              f"99 % within {1e3 * np.quantile(error, 0.99):.3f} mm, beyond 2 mm {1e2 * apart:.2f} %")
        assert same.sum() > 3000
        assert overlap >= 0.99
        assert apart <= 0.002
    segmentation.close(), depth.close()
