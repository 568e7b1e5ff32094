#!/usr/bin/env bash
# Draws the pictures of docs/experiments.md again, from runs of today's programs: a film strip of every experiment, and the
# errors of some of them side by side, as compare pages draw them. Pillow (PyPI) makes the strips small: 96 colours are enough.
#
# usage: docs/make_pictures.sh [NAME..]     (experiments, or `plots`; default: all. LAB_BUILD: whose programs)
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
lab=$root/scripts/lab
pictures=$root/docs/pictures/catalogue
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$pictures"
python=$root/build/pictures/bin/python
if [ ! -x "$python" ] || ! "$python" -c 'import PIL' 2>/dev/null; then
  python3 -m venv "$root/build/pictures"
  "$root/build/pictures/bin/pip" install -q pillow==13.0.0
fi

run() { [ -d "$work/$1" ] || "$lab" run "$1" --solo --no-report -o "$work/$1" >/dev/null; }

# three moments: the start, a time on the way, the end
strip() {
  run "$1"
  times=$(python3 - "$work/$1/metrics.json" <<'IN'
import json, sys
metrics = json.load(open(sys.argv[1]))
end = metrics["last_step"] * metrics["dt"]
reaches = metrics["reaches"]
middle = (reaches[0]["begin"] + reaches[0]["arrival"]) / 2 if len(reaches) == 1 else 0.4 * end
print(f"0,{middle:.6f},{end:.6f}")
IN
  )
  "$lab" render "$work/$1" --times "$times" --size 200x160 --quality fine -o "$work/$1/strip" >/dev/null
  "$python" - "$work/$1/strip/contact.png" "$pictures/$1.png" <<'IN'
import sys
from PIL import Image
Image.open(sys.argv[1]).convert("RGB").quantize(96, dither=Image.Dither.NONE).save(sys.argv[2], optimize=True)
IN
  echo "$pictures/$1.png: $(stat -c %s "$pictures/$1.png") bytes"
}

# plot NAME RUN RUN..: the first plot of a compare page, with the page's style inside and a legend
plot() {
  name=$1
  shift
  folders=()
  for one; do run "$one" && folders+=("$work/$one"); done
  "$lab" compare "${folders[@]}" -o "$work/compare.html" >/dev/null 2>&1
  python3 - "$work/compare.html" "$pictures/$name.svg" "$@" <<'IN'
import re, sys
page, out, *names = open(sys.argv[1]).read(), *sys.argv[2:]
style = re.search(r"<style>(.*?)</style>", page, re.S)[1]
colours = dict(re.findall(r"--([a-z]+): (#[0-9a-f]+)", style.split("}")[0]))  # by daylight
plain = lambda text: re.sub(r"var\(--([a-z]+)\)", lambda match: colours[match[1]], text)
rules = [plain(line) for line in style.splitlines() if line.startswith(("svg g", "svg .t", "svg .grid", ".s-"))]
chart = next(svg for svg in re.findall(r"<svg.*?</svg>", page, re.S) if "size of the error" in svg)
inks = re.findall(r'class="[^"]*\b(s-[a-z]+)\b', chart)
order = list(dict.fromkeys(inks))
box = [float(x) for x in re.search(r'viewBox="([^"]+)"', chart)[1].split()]
legend = "".join(f'<path class="{ink}" stroke-width="2" d="M {60 + 200 * i} -8 h 24"/><text class="t" x="{90 + 200 * i}" y="-4">{name}</text>'
                 for i, (ink, name) in enumerate(zip(order, names)))
view = f'viewBox="{box[0]:g} {box[1] - 22:g} {box[2]:g} {box[3] + 22:g}"'
chart = re.sub(r'viewBox="[^"]+"', view, chart, count=1)
chart = re.sub(r"<svg", '<svg xmlns="http://www.w3.org/2000/svg"' if "xmlns" not in chart else "<svg", chart, count=1)
back = f'<rect x="{box[0]:g}" y="{box[1] - 22:g}" width="{box[2]:g}" height="{box[3] + 22:g}" fill="{colours["paper"]}"/>'
head = chart.index(">") + 1
chart = re.sub(r"(\d\.\d)\d+(?=[ ,)'])", r"\1", chart)  # a tenth of a pixel will do
open(out, "w").write(chart[:head] + "<style>" + "\n".join(rules) + "</style>" + back + chart[head:].replace("</svg>", legend + "</svg>") + "\n")
IN
  echo "$pictures/$name.svg: $(stat -c %s "$pictures/$name.svg") bytes"
}

plots() {
  plot five_reaches reach_ct reach_pd reach_pd_gravity reach_wrong_gravity reach_wrong_masses
  plot rings cubic_rings quintic_rings
}

if [ $# -gt 0 ]; then
  for name; do if [ "$name" = plots ]; then plots; else strip "$name"; fi; done
  exit
fi
for file in "$root"/experiments/*.yaml; do
  grep -q '^ *clock: realtime' "$file" || strip "$(basename "$file" .yaml)"
done
plots
