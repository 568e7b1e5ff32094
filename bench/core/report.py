"""What the lines of `lab bench core` say: agreement, ratios, ns per joint; as text, JSON and a picture."""
import html
import math

OURS = "lcmlab"
AGREE = 1e-9  # of two libraries' check values, relative to the larger of 1 and the value
CLOSED = 1e-7  # aba(rnea(a)) - a relative to a; chains of 1000 joints leave 2e-8 in every library


class Results:
    def __init__(self, lines):
        self.ns, self.checks, self.header, self.skipped = {}, {}, "", []  # ns[robot][algorithm][peer] = (min, median)
        for line in lines:
            words = line.split()
            if line.startswith("# check "):
                values = dict(w.rsplit("=", 1) for w in words[4:])
                self.checks.setdefault(words[3], {})[words[2]] = {k: float(v) for k, v in values.items()}
            elif line.startswith("# skipped "):
                self.skipped.append(words[2])
            elif line.startswith("#"):
                self.header = self.header or line[2:]
            elif words:
                peer, robot, algorithm = words[:3]
                cell = self.ns.setdefault(robot, {}).setdefault(algorithm, {})
                new = (float(words[3]), float(words[4]))
                cell[peer] = min(cell.get(peer, new), new)  # the better of several lines: rounds, variants
        self.robots = [r for r in self.ns if ":" not in r]
        self.algorithms = list(dict.fromkeys(a for r in self.robots for a, cell in self.ns[r].items() if OURS in cell))

    def ours(self, robot, algorithm):
        return self.ns.get(robot, {}).get(algorithm, {}).get(OURS, (math.nan,))[0]

    def best_peer(self, robot, algorithm):
        """(name, ns) of the fastest peer, or None."""
        peers = {p: t[0] for p, t in self.ns.get(robot, {}).get(algorithm, {}).items() if p != OURS}
        return min(peers.items(), key=lambda item: item[1]) if peers else None

    def ratio(self, robot, algorithm):
        """Ours to the best peer's time, or None where one of them is missing."""
        best, ours = self.best_peer(robot, algorithm), self.ours(robot, algorithm)
        return ours / best[1] if best and not math.isnan(ours) else None

    def mean(self, robots, algorithms):
        """Geometric mean of all ratios there are, or None."""
        known = [x for r in robots for a in algorithms if (x := self.ratio(r, a))]
        return math.exp(sum(map(math.log, known)) / len(known)) if known else None

    def disagreements(self):
        """One text for each quantity that ours and a peer's checks do not share, and for each loop that does not close."""
        bad = []
        for robot, peers in self.checks.items():
            for peer, values in peers.items():
                for name, value in values.items():
                    other = peers.get(OURS, {}).get(name, value)
                    if name.startswith("aba"):
                        if not value < CLOSED:
                            bad.append(f"{peer} {robot}: {name} is {value:g}, must be below {CLOSED:g}")
                    elif not abs(value - other) <= AGREE * max(1, abs(other)):
                        bad.append(f"{robot}: {name} is {value:.12g} in {peer}, {other:.12g} in {OURS}")
        return bad

    def scaling(self):
        """{(kind, algorithm): {peer: [(joints, ns per joint)]}} of the chains and trees."""
        out = {}
        for robot, algorithms in self.ns.items():
            kind, _, n = robot.partition(":")
            for algorithm, cell in algorithms.items() if n else ():
                for peer, t in cell.items():
                    out.setdefault((kind, algorithm), {}).setdefault(peer, []).append((int(n), t[0] / int(n)))
        return out

    def json(self):
        round4 = lambda x: None if x is None else round(x, 4)
        return {
            "bench": "core", "session": self.header, "skipped": self.skipped, "agree": not self.disagreements(),
            "disagreements": self.disagreements(), "checks": self.checks,
            "results": [{"peer": p, "robot": r, "algorithm": a, "min_ns": t[0], "median_ns": t[1]}
                        for r, algorithms in self.ns.items() for a, cell in algorithms.items() for p, t in cell.items()],
            "ratios": {a: {r: {"ratio": round4(self.ratio(r, a)), "best_peer": self.best_peer(r, a)[0]}
                           for r in self.robots if self.ratio(r, a)} for a in self.algorithms},
            "geometric_mean": {a: round4(self.mean(self.robots, [a])) for a in self.algorithms},
            "ns_per_joint": {f"{kind} {algorithm}": {p: {str(n): round(t, 2) for n, t in points} for p, points in peers.items()}
                             for (kind, algorithm), peers in self.scaling().items()},
        }


def grid(title, corner, columns, rows, cell):
    """A text table; `cell` gives the text of (row, column)."""
    widths = [max(len(c), *(len(cell(r, c)) for r in rows)) + 2 for c in columns]
    first = max(len(corner), *(len(r) for r in rows))
    out = [title, corner.ljust(first) + "".join(c.rjust(w) for c, w in zip(columns, widths))]
    return out + [r.ljust(first) + "".join(cell(r, c).rjust(w) for c, w in zip(columns, widths)) for r in rows] + [""]


def tables(results):
    out, rows = [], results.algorithms
    if rows and results.mean(results.robots, rows):
        def ratio(row, column):
            if "mean" in (row, column):
                x = results.mean(results.robots if column == "mean" else [column], rows if row == "mean" else [row])
                return f"{x:.2f} " if x else "- "
            x = results.ratio(column, row)
            return f"{x:.2f}{results.best_peer(column, row)[0][0]}" if x else "- "
        out += grid(f"{OURS} / best peer (p pinocchio, m mujoco, k kdl); mean: geometric", "ratio",
                    [*results.robots, "mean"], [*rows, "mean"], ratio)
    if rows:
        out += grid(f"{OURS}, ns per call", "ns", results.robots, rows,
                    lambda a, r: "-" if math.isnan(results.ours(r, a)) else f"{results.ours(r, a):.0f}")
    scaling = results.scaling()
    if scaling:
        series = {f"{kind} {a}, {peer}": dict(points) for (kind, a), peers in scaling.items() for peer, points in peers.items()}
        sizes = sorted({n for points in series.values() for n in points})
        out += grid("ns per joint (flat: linear)", "joints", [str(n) for n in sizes], list(series),
                    lambda s, n: f"{series[s][int(n)]:.1f}" if int(n) in series[s] else "-")
    return "\n".join(out)


# --- the picture ---------------------------------------------------------------------------------------------------------
LEFT, TOP, WIDE, HIGH = 120, 84, 122, 26  # of the heat map: margins, one cell


def colour(ratio):
    """Green where we are faster, white at 1, red where slower; the full colours at a factor of 4."""
    x = max(-1.0, min(1.0, math.log(ratio) / math.log(4)))
    end = (20, 140, 110) if x < 0 else (205, 60, 50)
    return "#%02x%02x%02x" % tuple(round(255 + (e - 255) * abs(x)) for e in end)


def heat_map(results):
    columns, rows = [*results.robots, "mean"], [*results.algorithms, "mean"]
    out = []
    for c, name in enumerate(columns):
        out.append(f'<text x="{LEFT + (c + .5) * WIDE}" y="{TOP - 8}" text-anchor="middle" class="b">{html.escape(name)}</text>')
    for r, row in enumerate(rows):
        y = TOP + r * HIGH
        out.append(f'<text x="{LEFT - 10}" y="{y + 17}" text-anchor="end" class="b">{html.escape(row)}</text>')
        for c, column in enumerate(columns):
            x = results.mean(results.robots if column == "mean" else [column], results.algorithms if row == "mean" else [row])
            where = f'x="{LEFT + c * WIDE + 1}" y="{y + 1}" width="{WIDE - 2}" height="{HIGH - 2}" rx="3"'
            if x is None:
                out.append(f'<rect {where} fill="#f2f2f2"/>')
                continue
            cell = results.ns.get(column, {}).get(row, {})
            tip = ", ".join(f"{peer} {t[0]:.0f} ns" for peer, t in cell.items()) or "geometric mean"
            ink = "#fff" if abs(math.log(x)) > math.log(2.6) else "#222"
            out.append(f'<g><title>{html.escape(f"{row} {column}: {tip}")}</title><rect {where} fill="{colour(x)}"/>'
                       f'<text x="{LEFT + (c + .5) * WIDE}" y="{y + 17}" text-anchor="middle" fill="{ink}">{x:.2f}</text></g>')
    return out, TOP + len(rows) * HIGH


def curves(results, top, width):
    """ns per joint over joints, both logarithmic, one panel a kind of tree."""
    scaling, out = results.scaling(), []
    kinds = list(dict.fromkeys(kind for kind, _ in scaling))
    if not kinds:
        return [], top
    high = 220
    points = [p for peers in scaling.values() for series in peers.values() for p in series]
    most = max(n for n, _ in points)
    low, top_ns = min(t for _, t in points) * 0.9, max(t for _, t in points) * 1.1
    ticks = [k * 10**e for e in range(6) for k in (1, 2, 5) if low <= k * 10**e <= top_ns]
    panel = (width - LEFT - 30 * len(kinds)) / len(kinds)
    inks = {OURS: "#148c6e", "pinocchio": "#c8503c", "mujoco": "#4664b4", "kdl": "#8c8c8c"}
    for k, kind in enumerate(kinds):
        left, base = LEFT + k * (panel + 30), top + 50 + high
        at = lambda n, t: (left + panel * math.log(n) / max(math.log(most), 1), base - high * math.log(t / low) / math.log(top_ns / low))
        out.append(f'<text x="{left}" y="{top + 36}" class="b">{kind}s: ns per joint (solid rnea, dashed aba)</text>')
        for n in (1, 10, 100, 1000):
            if n <= most:
                x, _ = at(n, low)
                out.append(f'<line x1="{x:.1f}" y1="{base - high}" x2="{x:.1f}" y2="{base}" class="g"/>'
                           f'<text x="{x:.1f}" y="{base + 16}" text-anchor="middle">{n}</text>')
        for tick in ticks:
            _, y = at(1, tick)
            out.append(f'<line x1="{left}" y1="{y:.1f}" x2="{left + panel}" y2="{y:.1f}" class="g"/>')
            if k == 0:
                out.append(f'<text x="{left - 10}" y="{y + 4:.1f}" text-anchor="end">{tick}</text>')
        for (of, algorithm), peers in scaling.items():
            for peer, series in peers.items() if of == kind else ():
                path = " ".join("%.1f,%.1f" % at(n, t) for n, t in sorted(series))
                dash = ' stroke-dasharray="6 4"' if algorithm == "aba" else ""
                out.append(f'<polyline points="{path}" fill="none" stroke="{inks.get(peer, "#222")}" stroke-width="2"{dash}>'
                           f"<title>{peer} {algorithm}</title></polyline>")
    x = LEFT
    for peer in dict.fromkeys(p for peers in scaling.values() for p in peers):
        out.append(f'<rect x="{x}" y="{top + 306}" width="14" height="4" fill="{inks.get(peer, "#222")}"/>'
                   f'<text x="{x + 20}" y="{top + 312}">{peer}</text>')
        x += 110
    return out, top + 330


def svg(results):
    has_map = results.mean(results.robots, results.algorithms) is not None
    width = LEFT + 30 + WIDE * (len(results.robots) + 1 if has_map else 6)
    cells, bottom = heat_map(results) if has_map else ([], TOP - 30)
    lines, bottom = curves(results, bottom, width)
    head = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {bottom + 16}" width="{width}" height="{bottom + 16}">',
            "<style>text{font:13px system-ui,sans-serif;fill:#222}.b{font-weight:600}.t{font-size:17px;font-weight:600}"
            ".g{stroke:#e4e4e4}</style>",
            '<rect width="100%" height="100%" fill="#fff"/>',
            f'<text x="16" y="26" class="t">{OURS}: time of one call / best peer (below 1: {OURS} is faster)</text>',
            f'<text x="16" y="46" fill="#666">{html.escape(results.header)}</text>']
    return "\n".join(head + cells + lines + ["</svg>", ""])
