# SPDX-License-Identifier: BSD-3-Clause
"""A report as Markdown, LaTeX and a table of values (CSV)."""
import csv
import io

from report_tables import FAILED, LITERATURE


def markdown(tables, facts):
    lines = ["# Report", ""] + [f"- {name}: {value}" for name, value in facts] + [""]
    sources = {}
    for table in tables:
        lines += [f"## {table.title} ({table.unit})", ""]
        if table.note:
            lines += [table.note, ""]
        lines += ["| sequence | " + " | ".join(table.columns) + " |", "|---" * (len(table.columns) + 1) + "|"]
        for heading, cells in table.rows:
            lines.append(f"| {heading} | " + " | ".join(markdown_cell(cell, sources) for cell in cells) + " |")
        lines.append("")
    lines += [f"[{index}] {source}  " for source, index in sources.items()]
    return "\n".join(lines) + "\n"


def markdown_cell(cell, sources):
    text = cell.text.replace("|", "\\|")
    if cell.kind == LITERATURE and cell.text:
        return f"*{text}* [{sources.setdefault(cell.note, len(sources) + 1)}]"
    if cell.details:
        text += " (" + "; ".join(cell.details).replace("|", "\\|") + ")"
    return text


def tex(text):
    escapes = {"\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{",
               "}": r"\}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}
    return "".join(escapes.get(c, c) for c in text)


def latex(tables, facts):
    """Tables to be input into a paper; needs no package but xcolor."""
    lines = ["% " + "; ".join(f"{name}: {value}" for name, value in facts).replace("\n", " ")]
    for table in tables:
        lines += [r"\begin{table}", rf"\caption{{{tex(table.title)} ({tex(table.unit)})}}",
                  rf"\begin{{tabular}}{{l{'r' * len(table.columns)}}}", r"\hline",
                  " & ".join(["sequence", *map(tex, table.columns)]) + r" \\", r"\hline"]
        for heading, cells in table.rows:
            lines.append(" & ".join([tex(heading), *map(latex_cell, cells)]) + r" \\")
        lines += [r"\hline", r"\end{tabular}", r"\end{table}", ""]
    return "\n".join(lines) + "\n"


def latex_cell(cell):
    text = tex(cell.text)
    if cell.kind == LITERATURE and cell.text:
        return rf"\textcolor{{gray}}{{{text}}}"
    if cell.kind == FAILED:
        return rf"\textit{{{text}}}"
    if cell.live is not None or cell.coverage is not None:
        live = "" if cell.live is None else f" / {cell.live:g}" if cell.live == int(cell.live) else f" / {cell.live:.4f}"
        share = "" if cell.coverage is None else f" ({100 * cell.coverage:.1f}\\%)"
        return text + live + share
    return text


def values(tables):
    """One line for each cell."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["table", "sequence", "system", "kind", "value", "unit", "live", "coverage", "least", "most", "runs",
                     "note"])
    for table in tables:
        for heading, cells in table.rows:
            for system, cell in zip(table.columns, cells):
                shown = [show(v) for v in (cell.live, cell.coverage, cell.least, cell.most)]
                writer.writerow([table.name, heading, system, cell.kind, show(cell.value), table.unit, *shown,
                                 cell.runs or "", cell.note])
    return out.getvalue()


def show(value):
    return "" if value is None else f"{value:.6g}"
