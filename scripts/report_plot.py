# SPDX-License-Identifier: BSD-3-Clause
"""Drawings of a report, as SVG that needs nothing else: paths from above, errors over time."""
import html
import math

COLORS = ("#c0392b", "#1f77b4", "#2e8b57", "#8e44ad", "#b8860b", "#16808a")
TRUTH = "#777777"
MOST_POINTS = 700
GAP_S = 0.5  # nothing is drawn over longer ones
WIDTH, HEIGHT, MARGIN = 640, 420, 46


def thinned(points):
    step = max(1, math.ceil(len(points) / MOST_POINTS))
    return points[::step] + ([points[-1]] if points and (len(points) - 1) % step else [])


def nice(length):
    """The largest of 1, 2 or 5 times a power of ten that is no longer."""
    power = 10.0 ** math.floor(math.log10(length))
    return max(step * power for step in (1, 2, 5) if step * power <= length * 1.0000001)


def polyline(points, color, width, dashed=False):
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    dash = ' stroke-dasharray="6 4"' if dashed else ""
    return f'<polyline points="{path}" fill="none" stroke="{color}" stroke-width="{width}"{dash}/>'


def text(x, y, words, anchor="start", color="#333333"):
    return f'<text x="{x:.0f}" y="{y:.0f}" text-anchor="{anchor}" fill="{color}">{html.escape(words)}</text>'


def framed(parts, label):
    return (f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{html.escape(label)}" font-size="14" '
            f'font-family="sans-serif" xmlns="http://www.w3.org/2000/svg">' + "".join(parts) + "</svg>")


def legend(names):
    parts = []
    for i, (name, color) in enumerate(names):
        parts.append(f'<rect x="{MARGIN + 130 * i}" y="8" width="14" height="4" fill="{color}"/>')
        parts.append(text(MARGIN + 130 * i + 19, 16, name[:14]))
    return parts


def from_above(truth, tracks, label):
    """`truth`: [(stamp, x, y)]; `tracks`: [(name, [(stamp, x, y, error)])], in one frame."""
    points = [row[1:3] for row in truth] + [row[1:3] for _, track in tracks for row in track]
    low = [min(p[i] for p in points) for i in (0, 1)]
    high = [max(p[i] for p in points) for i in (0, 1)]
    size = max(high[0] - low[0], (high[1] - low[1]) * WIDTH / HEIGHT, 0.01)
    scale = (WIDTH - 2 * MARGIN) / size
    if (high[1] - low[1]) * scale > HEIGHT - 2 * MARGIN:
        scale = (HEIGHT - 2 * MARGIN) / (high[1] - low[1])

    def place(row):
        return (WIDTH / 2 + scale * (row[1] - (low[0] + high[0]) / 2),
                HEIGHT / 2 - scale * (row[2] - (low[1] + high[1]) / 2))

    bar = nice((WIDTH - 2 * MARGIN) / scale / 3)
    parts = legend([("truth", TRUTH)] + [(name, COLORS[i % len(COLORS)]) for i, (name, _) in enumerate(tracks)])
    parts += [polyline([place(row) for row in thinned(part)], TRUTH, 3) for part in without_gaps(truth)]
    parts += [polyline([place(row) for row in thinned(part)], COLORS[i % len(COLORS)], 1.3)
              for i, (_, track) in enumerate(tracks) for part in without_gaps(track)]
    base = HEIGHT - 14
    parts.append(polyline([(MARGIN, base), (MARGIN + bar * scale, base)], "#333333", 2))
    parts.append(text(MARGIN + bar * scale + 8, base + 5, f"{bar:g} m"))
    return framed(parts, label)


def over_time(tracks, label):
    """Distance from the truth, by seconds from the first pose on."""
    known = [(name, [row for row in track if row[3] is not None]) for name, track in tracks]
    stamps = [row[0] for _, track in known for row in track]
    if not stamps:
        return ""
    start, end = min(stamps), max(max(stamps), min(stamps) + 1e-3)
    most = max(max(row[3] for _, track in known for row in track), 1e-6)

    def place(row):
        return (MARGIN + (WIDTH - 2 * MARGIN) * (row[0] - start) / (end - start),
                HEIGHT - MARGIN - (HEIGHT - 2 * MARGIN) * row[3] / most)

    step = nice(most / 2)
    parts = legend([(name, COLORS[i % len(COLORS)]) for i, (name, _) in enumerate(known)])
    for i in range(int(most / step * 1.0000001) + 1):
        y = place((start, 0, 0, i * step))[1]
        parts.append(polyline([(MARGIN, y), (WIDTH - MARGIN, y)], "#dddddd", 1))
        parts.append(text(MARGIN - 4, y + 4, f"{i * step:g}", "end"))
    parts += [polyline([place(row) for row in peaks(part)], COLORS[i % len(COLORS)], 1.2)
              for i, (_, track) in enumerate(known) for part in without_gaps(track)]
    parts.append(text(MARGIN, HEIGHT - 14, "0 s"))
    parts.append(text(WIDTH - MARGIN, HEIGHT - 14, f"{end - start:.1f} s", "end"))
    parts.append(text(MARGIN - 4, MARGIN - 8, "m", "end"))
    return framed(parts, label)


def without_gaps(rows):
    """The stretches in which no two stamps are farther apart than GAP_S."""
    parts = []
    for i, row in enumerate(rows):
        if i == 0 or row[0] - rows[i - 1][0] > GAP_S:
            parts.append([])
        parts[-1].append(row)
    return parts


def peaks(track):
    """Of each stretch the worst pose: thinning must hide none."""
    step = max(1, math.ceil(len(track) / MOST_POINTS))
    return [max(track[i:i + step], key=lambda row: row[3]) for i in range(0, len(track), step)]
