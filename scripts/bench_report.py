# SPDX-License-Identifier: BSD-3-Clause
"""The output of scripts/bench: rows of figures with their bars."""
import pathlib
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


RESULTS = "## Results"


def tables_of(text):
    """{name of a part: its heading's text and table} of the results in a file."""
    parts = text.partition(RESULTS + "\n")[2].split("\n### ")[1:]
    return {part.partition("\n")[0]: part.partition("\n")[2].strip() for part in parts}


def write_markdown(path, rows_of_parts, measured):
    """Tables of the parts that were measured, in a file whose other parts, and the text before the results, stay as they
    are. `rows_of_parts`: {name: rows} of all parts in their order, none for one that was not measured."""
    text = path.read_text() if path.exists() else ""
    tables = tables_of(text)
    marks = {True: "ok", False: "missed", None: ""}
    for name, rows in rows_of_parts.items():
        if not rows:
            continue
        lines = [measured, "", "| what | measured | bar | |", "|---|---|---|---|"]
        lines += [f"| {what} | {value} | {bar} | {marks[kept]} |" for what, value, bar, kept in rows]
        tables[name] = "\n".join(lines)
    before = text.partition(RESULTS + "\n")[0].rstrip()
    sections = [f"### {name}\n\n{tables[name]}" for name in rows_of_parts if name in tables]
    path.write_text("\n\n".join(([before] if before else []) + [RESULTS] + sections) + "\n")
