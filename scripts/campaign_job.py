#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""One job of a campaign, in the campaign's folder: campaign_job.py simulate NAME | run NAME SETTING | report. Folders
of recordings and runs are made under another name and renamed when they are complete."""
import datetime
import json
import pathlib
import shutil
import sys

from bench_report import Failed, call
from bench_runs import PROGRAMS, newest
from campaign_tables import figures_of, tables_of, timing_of
from report_html import page, picture
from report_runs import keep, kept, machine
from report_text import markdown, values


def replace_folder(made, final):
    shutil.rmtree(final, ignore_errors=True)  # what is there is older, or empty
    made.rename(final)


def simulate(plan, name):
    recording, final = plan["recordings"][name], pathlib.Path("recordings", name)
    made = final.with_name(f".{name}.part")
    shutil.rmtree(made, ignore_errors=True)
    call(PROGRAMS / "posefusion_simulate", *recording["arguments"], "--output", made)
    (made / "made_from").write_text(recording["source"])
    replace_folder(made, final)


def run(plan, name, setting):
    job, final = plan["runs"][f"{name}/{setting}"], pathlib.Path("runs", name, setting)
    source = plan["recordings"][name]["path"] or pathlib.Path("recordings", name)
    made = final.with_name(f".{setting}.part")
    try:
        shutil.rmtree(made, ignore_errors=True)
        made.mkdir(parents=True)
        # One thread for each run: as many runs at a time as there are cores leave none idle.
        call(PROGRAMS / "posefusion_run", source, "--output", made, "--threads", "1", *job["arguments"])
        replace_folder(newest(made).resolve(), final)
        shutil.rmtree(made)
        figures = figures_of(final)
    except (Failed, OSError, LookupError, ValueError) as error:
        figures = {"failed": str(error)}
    keep(pathlib.Path("figures", name, f"{setting}.json"), job["key"], figures)


def write(path, text):
    temporary = path.with_name(path.name + ".part")
    temporary.write_text(text)
    temporary.replace(path)


def sections_of(plan):
    for name in plan["recordings"]:
        pictures = [(pathlib.Path("runs", name, setting, "map.png"), setting) for setting in plan["settings"]]
        parts = [picture(path, f"The map from above, from the side and from the camera ({setting}).")
                 for path, setting in pictures if path.is_file()]
        yield name, parts or ["<p>No run came to an end.</p>"]


def report(plan):
    figures = {run: kept(pathlib.Path("figures", run + ".json"), job["key"]) or {"failed": "not run"}
               for run, job in plan["runs"].items()}
    tables, timing = tables_of(plan, figures), timing_of(plan, figures)
    facts = [("build", plan["build"]), ("machine", machine()), ("date", f"{datetime.date.today()}"),
             *plan["facts"].items()]
    write(pathlib.Path("campaign.csv"), values(tables))
    write(pathlib.Path("timing.csv"), values(timing))
    write(pathlib.Path("campaign.md"), markdown(tables + timing, facts))
    write(pathlib.Path("index.html"), page(tables + timing, list(sections_of(plan)), facts))


def main():
    plan = json.loads(pathlib.Path("plan.json").read_text())
    {"simulate": simulate, "run": run, "report": report}[sys.argv[1]](plan, *sys.argv[2:])


if __name__ == "__main__":
    try:
        main()
    except (Failed, OSError) as failure:
        print(f"campaign: {' '.join(sys.argv[1:])}: {failure}", file=sys.stderr)
        sys.exit(1)
