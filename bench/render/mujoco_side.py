"""Milliseconds a frame of MuJoCo's off-screen renderer on a scene that bench-render exported, as JSON."""
import json
import os
import sys
import time

os.environ.setdefault("MUJOCO_GL", "osmesa")
import mujoco

from mujoco_scene import Scene

results = {"version": mujoco.__version__, "modes": {}}
for mode, samples, shadow_side in (("plain", 0, 1024), ("aa_shadow", 4, 1024)):
    scene = Scene(sys.argv[1], samples, shadow_side)
    renderer = scene.renderer()
    flags = renderer.scene.flags
    flags[mujoco.mjtRndFlag.mjRND_SHADOW] = mode == "aa_shadow"
    flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
    scene.pose(0)
    renderer.update_scene(scene.data, scene.camera)
    picture = renderer.render()
    best = [1e9, 1e9]
    for _ in range(3):
        wall = cpu = 0.0
        for k in range(len(scene.frames)):
            scene.pose(k)
            start = time.perf_counter(), time.process_time()
            renderer.update_scene(scene.data, scene.camera)
            renderer.render(out=picture)
            wall, cpu = wall + time.perf_counter() - start[0], cpu + time.process_time() - start[1]
        best = [min(best[0], 1e3 * wall / len(scene.frames)), min(best[1], 1e3 * cpu / len(scene.frames))]
    results["modes"][mode] = {"ms": best[0], "cpu_ms": best[1]}
    renderer.close()
print(json.dumps(results))
