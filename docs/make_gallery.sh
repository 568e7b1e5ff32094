#!/usr/bin/env bash
# Writes docs/gallery.md and its pictures: real robots as the lab's renderer draws them. Needs scripts/lab robots.
#
# usage: docs/make_gallery.sh
. "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../scripts/lib.sh"
verb=docs/make_gallery.sh
case ${1:-} in -h | --help) help && exit 0 ;; esac
need_programs lab-solo lab-renderer lab-experiment
[ -d "$LAB_ROBOTS/example-robot-data" ] || die 2 "no robots yet: run scripts/lab robots"

folder=$(mktemp -d) || die 2 "cannot make a temporary folder"
trap 'rm -rf "$folder"' EXIT
pictures=$LAB_ROOT/docs/pictures/gallery
data=package://example-robot-data/robots
mkdir -p "$pictures"
page=$folder/gallery.md
cat >"$page" <<'MD'
# Gallery

Real robots (of `scripts/lab robots`, and our own arm) as `scripts/lab render --quality fine` draws them: STL, Collada and
OBJ meshes, colours of the URDF and of the files, textures. Written by `docs/make_gallery.sh`; do not edit.

MD

# smaller FROM TO: the same 8-bit RGB picture with values in steps of 4 (its noise is most of its size), every row with the
# filter that suits it best, packed as tightly as zlib can (lab-renderer is after speed)
smaller() {
  python3 - "$1" "$2" <<'PY'
import struct, sys, zlib

data, at, chunks = open(sys.argv[1], "rb").read(), 8, []
while at < len(data):
    size, = struct.unpack(">I", data[at:at + 4])
    chunks.append((data[at + 4:at + 8], data[at + 8:at + 8 + size]))
    at += size + 12
width, height = struct.unpack(">II", chunks[0][1][:8])
raw, stride = zlib.decompress(b"".join(d for t, d in chunks if t == b"IDAT")), 3 * width

def paeth(a, b, c):
    pa, pb, pc = abs(b - c), abs(a - c), abs(a + b - 2 * c)
    return a if pa <= pb and pa <= pc else b if pb <= pc else c

PREDICT = [lambda a, b, c: 0, lambda a, b, c: a, lambda a, b, c: b, lambda a, b, c: (a + b) // 2, paeth]
up, coarse_up, out = bytes(stride), bytes(stride), b""
for y in range(height):
    kind, *line = raw[y * (stride + 1):(y + 1) * (stride + 1)]
    row, predict = bytearray(), PREDICT[kind]
    for i, x in enumerate(line):
        row.append((x + predict(row[i - 3] if i > 2 else 0, up[i], up[i - 3] if i > 2 else 0)) & 255)
    exact, row = bytes(row), bytes(x & 252 for x in row)
    tries = [bytes((x - p(row[i - 3] if i > 2 else 0, coarse_up[i], coarse_up[i - 3] if i > 2 else 0)) & 255 for i, x in enumerate(row)) for p in PREDICT]
    best = min(range(5), key=lambda k: sum(min(x, 256 - x) for x in tries[k]))
    out, up, coarse_up = out + bytes([best]) + tries[best], exact, row
chunk = lambda t, d: struct.pack(">I", len(d)) + t + d + struct.pack(">I", zlib.crc32(t + d))
with open(sys.argv[2], "wb") as file:
    file.write(data[:8] + chunk(*chunks[0]) + chunk(b"IDAT", zlib.compress(out, 9)) + chunk(b"IEND", b""))
PY
}

# show NAME MODEL "WHAT" Q0 [MORE]: one picture of the robot standing at Q0; MORE: further lines of the experiment
show() {
  local name=$1 model=$2 what=$3 q0=$4 more=${5:-}
  say "$verb: $name"
  cat >"$folder/$name.yaml" <<YAML
robot: {model: "$model"${more:+, $more}}
simulator: {dt: 0.001, duration: 0.001, q0: $q0, gravity: [0, 0, 0], allow_fall: true}
renderer: {enabled: false}
YAML
  "$LAB_SCRIPTS/lab-run" --solo "$folder/$name.yaml" -o "$folder/$name" >"$folder/log" 2>&1 || { cat "$folder/log" >&2 && die 1 "$name does not run"; }
  "$LAB_SCRIPTS/lab-render" "$folder/$name" --times 0 --size 360x300 --quality fine --strict -o "$folder/$name.out" >/dev/null ||
    die 1 "$name cannot be drawn"
  smaller "$folder/$name.out"/*.png "$pictures/$name.png" || die 1 "$name: no picture"
  [ "$(stat -c %s "$pictures/$name.png")" -le 60000 ] || say "$verb: warning: $name.png is larger than 60 kB"
  printf '## %s\n\n%s\n\n![%s](pictures/gallery/%s.png)\n\n' "$name" "$what" "$name" "$name" >>"$page"
}

float='floating_base: true'
show simple_3dof_arm "$LAB_ROOT/models/simple_3dof_arm.urdf" "Our own arm, of primitives." '[0.4, 0.6, 0.5]'
show panda $data/panda_description/urdf/panda.urdf "Collada: every colour is the files' own." \
  '[0, -0.785, 0, -2.356, 0, 1.571, 0.785, 0.03]'
show ur5 $data/ur_description/urdf/ur5_robot.urdf "Collada, with node transforms." '[0, -1.2, 1.5, -1.9, -1.57, 0]'
show anymal $data/anymal_b_simple_description/robots/anymal.urdf "Collada with JPEG textures on base and feet." \
  '[0, 0, 0.53, 0, 0, 0, 1, 0, 0.5, -0.9, 0, -0.5, 0.9, 0, 0.5, -0.9, 0, -0.5, 0.9]' "$float"
show solo12 $data/solo_description/robots/solo12.urdf "STL in the colour of the URDF." \
  '[0, 0, 0.26, 0, 0, 0, 1, 0, 0.7, -1.4, 0, 0.7, -1.4, 0, 0.7, -1.4, 0, 0.7, -1.4]' "$float"
show talos $data/talos_data/robots/talos_reduced.urdf "STL; the right half is the left half's files with a negative scale." \
  '[0, 0, 1.06, 0, 0, 0, 1, 0, 0, -0.4, 0.8, -0.4, 0, 0, 0, -0.4, 0.8, -0.4, 0, 0, 0, 0.25, 0.2, 0.2, -1, 0, 0, 0, 0, -0.25, -0.2, -0.2, -1, 0, 0, 0, 0, 0, 0]' "$float"
show tiago $data/tiago_description/robots/tiago.urdf "STL and Collada; the camera's colours are a texture." \
  '{torso_lift_joint: 0.2, arm_1_joint: 0.4, arm_2_joint: -0.6, arm_3_joint: -1.5, arm_4_joint: 1.6}'

mv "$page" "$LAB_ROOT/docs/gallery.md"
say "$verb: docs/gallery.md and $(find "$pictures" -name '*.png' | wc -l) pictures, $(du -sk "$pictures" | cut -f1) kB"
