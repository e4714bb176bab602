# SPDX-License-Identifier: BSD-3-Clause
"""The tables of a campaign: recordings down, settings across. Figures that depend on the machine have tables of their
own."""
import json

from report_tables import Cell, Table, failed

# (key, title, unit, digits), in the order in which they stand.
RESULTS = (("ate_m", "ATE RMSE, as loops have corrected it in the end", "m", 4),
           ("live_ate_m", "ATE RMSE, as reported at the time", "m", 4),
           ("pose_percent", "Frames with a pose", "%", 1), ("false_poses", "False poses", "poses", 0),
           ("wrong_poses", "Wrong poses", "poses", 0), ("loops", "Loops", "loops", 0),
           ("surfels", "Surfels", "surfels", 0))
TIMING = (("frames_per_s", "Speed, one thread", "frames/s", 1), ("memory_mb", "Memory at most", "MB", 0))


def figures_of(folder):
    """Of a run's folder."""
    summary = json.loads((folder / "summary.json").read_text())
    live = summary.get("live", {})
    return {"ate_m": summary.get("ate_rmse_m"), "live_ate_m": live.get("ate_rmse_m"),
            "pose_percent": 100 * summary["frames"]["pose_share"], "false_poses": summary.get("false_poses"),
            "wrong_poses": summary.get("wrong_poses"), "loops": summary["loops"]["accepted"],
            "surfels": summary["surfels"], "frames_per_s": summary["frames_per_second"],
            "memory_mb": summary["peak_memory_mb"]}


def cell(figures, key, digits):
    if "failed" in figures:
        return failed([figures])
    value = figures[key]
    if value is None:
        return Cell("", note="no truth")
    return Cell(f"{value:.{digits}f}", value=value, runs=1)


def tables(plan, figures, listed):
    found = []
    for key, title, unit, digits in listed:
        rows = [(name, [cell(figures[f"{name}/{setting}"], key, digits) for setting in plan["settings"]])
                for name in plan["recordings"]]
        if any(cell.text for _, cells in rows for cell in cells):
            found.append(Table(key, title, unit, list(plan["settings"]), rows))
    return found


def tables_of(plan, figures):
    return tables(plan, figures, RESULTS)


def timing_of(plan, figures):
    return tables(plan, figures, TIMING)
