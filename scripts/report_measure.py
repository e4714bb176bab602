# SPDX-License-Identifier: BSD-3-Clause
"""Measures a run for a report: its summary, and its trajectories against the truth."""
import bisect
import hashlib
import json

from bench_report import Failed, call
from bench_runs import PROGRAMS


def evaluate(*arguments):
    return json.loads(call(PROGRAMS / "posefusion_evaluate", *arguments, "--json"))


def errors_of(track):
    """Errors of a trajectory, from what posefusion_evaluate prints."""
    def rmse(of):
        return track[of]["rmse"] if track[of]["count"] > 0 else None

    return {"ate_m": rmse("ate_m"), "rpe_m_s": rmse("rpe_trans_m_per_s"), "rpe_m_frame": rmse("rpe_trans_m_per_frame"),
            "wrong": track["wrong_poses"], "false": track["false_poses"],
            "coverage": track.get("coverage", {}).get("share")}


def people_left(sequence, folder):
    """Share of the stable surfels that lie on people; None where no true masks are."""
    if not (sequence.path / "mask").is_dir():
        return None
    found = evaluate("run", folder, sequence.path)["people_in_map"]
    return found["part"] if found["frames_with_masks"] > 0 else None


def from_summary(summary):
    """Errors from the run's own summary, for a recording whose truth is not in a folder."""
    final = {"ate_m": summary.get("ate_rmse_m"), "rpe_m_s": summary.get("rpe_trans_m_per_s"), "rpe_m_frame": None,
             "wrong": summary.get("wrong_poses"), "false": summary.get("false_poses"),
             "coverage": summary["frames"]["pose_share"]}
    live = summary.get("live", {})
    return final, {"ate_m": live.get("ate_rmse_m"), "rpe_m_s": None, "rpe_m_frame": None,
                   "coverage": summary["frames"]["pose_share"]}


def figures_of(sequence, folder):
    summary = json.loads((folder / "summary.json").read_text())
    figures = {"folder": folder.name, "read": summary["frames"]["read"], "removed": summary["frames"]["blurred"],
               "frames_per_s": summary["frames_per_second"], "memory_mb": summary["peak_memory_mb"],
               "stages": {name: time["median_ms"] for name, time in summary.get("stages", {}).items()},
               "loops": {"ferns": summary["loops"]["ferns"], "loops": summary["loops"]["accepted"],
                         "corrections": summary["loops"]["corrections"],
                         "relocalised": summary["loops"]["places_found"]},
               "surfels": summary["surfels"]}
    figures["trajectory"] = hashlib.sha256((folder / "trajectory.txt").read_bytes()).hexdigest()[:16]
    if sequence.has_truth:
        figures["final"] = errors_of(evaluate(sequence.path, folder / "trajectory.txt"))
        figures["live"] = errors_of(evaluate(sequence.path, folder / "trajectory_live.txt"))
        figures["people_left"] = people_left(sequence, folder)
    else:
        figures["final"], figures["live"] = from_summary(summary)
    return figures


def figures_of_other(sequence, file):
    if not sequence.has_truth:
        raise Failed(f"{sequence.name} has no groundtruth.txt")
    final = errors_of(evaluate(sequence.path, file))
    final["coverage"] = coverage_of(sequence, [row[0] for row in rows_of(file)])
    return {"final": final}


def coverage_of(sequence, stamps):
    """Share of the frames that have a pose. Others round stamps: a pose belongs to the frame less than 5 ms away."""
    lists = [sequence.path / name for name in ("associations.txt", "rgb.txt")]
    text = next(path for path in lists if path.is_file()).read_text()
    frames = [float(line.replace(",", " ").split()[0]) for line in text.splitlines() if line.strip() and line[0] != "#"]
    posed = 0
    for frame in frames:
        at = bisect.bisect_left(stamps, frame)
        posed += any(abs(stamp - frame) < 0.005 for stamp in stamps[max(at - 1, 0):at + 1])
    return posed / len(frames)


def track_of(sequence, file):
    """The true path, and the estimated one laid on it: [(stamp, x, y, error in m)], both by stamps in s."""
    truth = [row[:4] for row in rows_of(sequence.path / "groundtruth.txt")]
    answer = evaluate("trajectory", sequence.path / "groundtruth.txt", file)
    rotation, shift = answer["rotation"], answer["translation_m"]
    track, at = [], 0
    for row in rows_of(file):
        x, y, z = (sum(r * p for r, p in zip(axis, row[1:4])) + s for axis, s in zip(rotation, shift))
        while at + 1 < len(truth) and abs(truth[at + 1][0] - row[0]) <= abs(truth[at][0] - row[0]):
            at += 1
        there = truth[at]
        far = abs(there[0] - row[0]) > 0.02
        off = None if far else ((x - there[1]) ** 2 + (y - there[2]) ** 2 + (z - there[3]) ** 2) ** 0.5
        track.append((row[0], x, y, off))
    return [(row[0], row[1], row[2]) for row in truth], track


def rows_of(file):
    lines = (line.replace(",", " ").split() for line in file.read_text().splitlines() if not line.startswith("#"))
    return sorted([float(word) for word in line] for line in lines if len(line) == 8)
