"""lab bench render: our off-screen renderer and MuJoCo's on the same meshes, poses, camera and size, in turn."""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(os.environ["LAB_ROOT"])
PROGRAM = pathlib.Path(os.environ["LAB_BUILD"]) / "bin/bench-render"
DATA = pathlib.Path(os.environ["LAB_ROBOTS"]) / "example-robot-data/robots"
ROBOTS = {
    "simple_3dof_arm": ROOT / "models/simple_3dof_arm.urdf",
    "ur5": DATA / "ur_description/urdf/ur5_robot.urdf",
    "panda": DATA / "panda_description/urdf/panda.urdf",
    "anymal": DATA / "anymal_b_simple_description/robots/anymal.urdf",
    "talos": DATA / "talos_data/robots/talos_reduced.urdf",
}


def say(text):
    print(f"lab bench render: {text}", file=sys.stderr, flush=True)


def options():
    p = argparse.ArgumentParser(
        prog="lab bench render", allow_abbrev=False, formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Frames per second of draft, live and fine against MuJoCo 4.0's off-screen renderer (OSMesa), plain and\n"
                    "with its anti-aliasing and shadow; time to write a PNG against bare libpng (docs/bench.md).",
        epilog="MuJoCo is fetched from PyPI into the cache folder at first use; without it only our side is measured.\n\n"
               "example: scripts/lab bench render --robots panda")
    p.add_argument("--robots", metavar="NAME,..", default=",".join(ROBOTS), help=f"of {', '.join(ROBOTS)}; or URDF files (default: all)")
    p.add_argument("--size", default="640x480", metavar="WxH", help="of the pictures (640x480)")
    p.add_argument("--frames", type=int, default=20, metavar="N", help="poses, drawn in three rounds each time (20)")
    p.add_argument("--rounds", type=int, default=2, metavar="N", help="of each side, in turn; the best counts (2)")
    p.add_argument("--peers", choices=["mujoco", "none"], default="mujoco", help="whom to measure beside us (mujoco)")
    p.add_argument("--json", action="store_true", help="one JSON object instead of lines")
    o = p.parse_args()
    try:
        o.width, o.height = (int(x) for x in o.size.split("x"))
    except ValueError:
        p.error(f"--size must be like 640x480, not '{o.size}'")
    if o.frames < 1 or o.rounds < 1:
        p.error("--frames and --rounds are whole numbers above 0")
    o.robots = {pathlib.Path(r).stem: ROBOTS.get(r, pathlib.Path(r)) for r in o.robots.split(",") if r}
    return o


def run(command, **more):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip().splitlines()[-1] if done.stderr.strip() else f"exit code {done.returncode}")
    return done.stdout


def better(best, new):
    """Keeps the smaller of all times, mode by mode."""
    if not best:
        return new
    for mode, times in new["modes"].items():
        for key, value in times.items():
            best["modes"][mode][key] = min(best["modes"][mode][key], value)
    if "png" in new:
        best["png"] = {key: min(value, new["png"][key]) for key, value in best["png"].items()}
    return best


def measure(name, urdf, o, python):
    ours = theirs = None
    arguments = [urdf, o.width, o.height, o.frames]
    with tempfile.TemporaryDirectory() as folder:
        if python:
            run([PROGRAM, "export", *arguments, folder])
        for _ in range(o.rounds):  # in turn: what drifts, drifts for both
            ours = better(ours, json.loads(run([PROGRAM, "time", *arguments])))
            if python:
                theirs = better(theirs, json.loads(run([python, ROOT / "bench/render/mujoco_side.py", folder])))
    return {"robot": name, "ours": ours, "mujoco": theirs}


def lines(result):
    ours, theirs = result["ours"], result["mujoco"]
    for mode in ("draft", "live", "fine"):
        times = ours["modes"][mode]
        peer = theirs and theirs["modes"]["aa_shadow" if mode == "fine" else "plain"]
        ratio = f"   {peer['ms'] / times['ms']:5.2f} times MuJoCo {'with AA and shadow' if mode == 'fine' else 'plain'}" if peer else ""
        yield (f"{result['robot']:16} {mode:16} {1e3 / times['ms']:7.1f} frames/s {times['ms']:7.2f} ms {times['cpu_ms']:7.2f} ms CPU "
               f"{times['triangles']:7} triangles{ratio}")
    for mode, times in (theirs["modes"] if theirs else {}).items():
        yield f"{result['robot']:16} mujoco {mode:9} {1e3 / times['ms']:7.1f} frames/s {times['ms']:7.2f} ms {times['cpu_ms']:7.2f} ms CPU"
    png = ours["png"]
    yield (f"{result['robot']:16} png              {png['write_png_ms']:7.2f} ms to a file, bare libpng {png['bare_libpng_ms']:.2f} ms: "
           f"{png['write_png_ms'] / png['bare_libpng_ms']:.2f} times, {png['bytes'] / 1e3:.0f} kB")


def main():
    o = options()
    if not os.access(PROGRAM, os.X_OK):
        say("bench-render is not built: run scripts/lab build first")
        return 2
    python = None
    if o.peers == "mujoco":
        ready = subprocess.run([ROOT / "bench/peers/build", "mujoco-python"], stdout=subprocess.PIPE, text=True).stdout.split()
        python = ready[1] if ready else None
    results = []
    for name, urdf in o.robots.items():
        if not urdf.is_file():
            say(f"{name} is skipped: there is no {urdf}" + (" (scripts/lab robots downloads it)" if str(urdf).startswith(str(DATA)) else ""))
            continue
        try:
            results.append(measure(name, urdf, o, python))
        except RuntimeError as error:
            say(f"{name}: {error}")
            return 1
        if not o.json:
            print("\n".join(lines(results[-1])), flush=True)
    if o.json:
        print(json.dumps({"bench": "render", "width": o.width, "height": o.height, "frames": o.frames, "results": results}))
    elif results:
        print(f"drawn by {results[-1]['ours']['gl']}")
    return 0 if results else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
