#!/usr/bin/env bash
# The main job as a person would start it; every process, the renderer too, must end with 0 and leave what it should.
#
# usage: LAB_BUILD=build/asan tests/system/one_run.sh FOLDER
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
run=$1
"$root/scripts/lab" run "$root/experiments/cubic_pd.yaml" -o "$run" --timeout 240
python3 - "$run" <<'IN'
import json, os, sys
run = sys.argv[1]
codes = json.load(open(f"{run}/manifest.json"))["exit_codes"]
wanted = dict.fromkeys(["simulator", "planner", "controller", "logger", "renderer", "run"], 0)
assert codes == wanted, codes
for name in ["log.lcm", "telemetry.lcm", "contact.png", "metrics.json"]:
    assert os.path.getsize(f"{run}/{name}") > 0, name
pictures = os.listdir(f"{run}/frames")
assert len(pictures) >= 30 and all(p.endswith(".png") for p in pictures), pictures
IN
