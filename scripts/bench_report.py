# SPDX-License-Identifier: BSD-3-Clause
"""The output of scripts/bench: rows of figures with their bars."""
import os
import pathlib
import platform
import subprocess


class Failed(Exception):
    """A program ended with an error; the message is its output."""


def call(*command, **named):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True, **named)
    if done.returncode != 0:
        said = (done.stderr.strip() or done.stdout.strip()).splitlines()
        raise Failed(f"{pathlib.Path(command[0]).name}: {said[-1] if said else done.returncode}")
    return done.stdout


class Report:
    def __init__(self):
        self.rows = []

    def row(self, what, value, unit, bar=None, most=True, digits=4, live=None):
        """One figure. `bar`: it must be at most that (or at least, where `most` is false). None: there is none (nothing
        was located, say), and the bar is missed. `live`: the same figure of the poses as reported at the time, in the
        same unit, without a bar."""
        kept = None if bar is None else value is not None and (value <= bar if most else value >= bar)
        text = "none" if value is None else f"{value:.{digits}f} {unit}".strip()
        if live is not None:
            text += f"; live {live:.{digits}f}"
        self.rows.append((what, text, "" if bar is None else f"{'<=' if most else '>='} {bar:g}", kept))
        self.print_row(self.rows[-1])

    def fact(self, what, kept, text):
        self.rows.append((what, text, "", kept))
        self.print_row(self.rows[-1])

    @staticmethod
    def print_row(row):
        mark = {True: "ok", False: "MISSED", None: ""}[row[3]]
        print(f"{row[0]:<66} {row[1]:>24} {row[2]:>10}  {mark}", flush=True)


def write_markdown(path, rows):
    """The table, below the text that the file begins with (all before its first "Printed by")."""
    cores, machine = os.cpu_count(), platform.machine()
    text = path.read_text().split("Printed by")[0].rstrip() if path.exists() else ""
    lines = [text, ""] if text else []
    lines += [f"Printed by `scripts/bench` on {cores} cores ({machine}).", "",
             "| what | measured | bar | |", "|---|---|---|---|"]
    marks = {True: "ok", False: "missed", None: ""}
    lines += [f"| {what} | {value} | {bar} | {marks[kept]} |" for what, value, bar, kept in rows]
    path.write_text("\n".join(lines) + "\n")
