# SPDX-License-Identifier: BSD-3-Clause
"""The tables of a report, independent of the format: their cells and places."""
import dataclasses
import statistics

OWN, OTHER, LITERATURE, FAILED = "own", "other", "literature", "failed"


@dataclasses.dataclass
class Cell:
    text: str
    kind: str = OWN
    details: tuple = ()  # further words, each a line where there is room
    value: float = None  # of `text`, for the table of values
    live: float = None
    coverage: float = None
    least: float = None
    most: float = None
    runs: int = 0
    note: str = ""  # its source, or why it is empty


@dataclasses.dataclass
class Table:
    name: str  # for the table of values: ate
    title: str
    unit: str
    columns: list  # headings, after that of the sequences
    rows: list = dataclasses.field(default_factory=list)  # (heading, cells)
    note: str = ""


def number(value, digits):
    return "none" if value is None else f"{value:.{digits}f}"


def percent(share):
    return "" if share is None else f"{100 * share:.1f} % of frames"


def middle(values):
    """(median, least, most) of those that there are; None of none."""
    values = [value for value in values if value is not None]
    return (statistics.median(values), min(values), max(values)) if values else (None, None, None)


def spread(values, digits):
    """Words for least and most, where runs differ."""
    _, least, most = middle(values)
    return "" if least is None or least == most else f"{least:.{digits}f} to {most:.{digits}f}"


def failed(results):
    """A cell for runs none of which came to an end."""
    reason = results[0]["failed"] if results else "not run"
    short = reason if len(reason) <= 60 else reason[:57] + "..."
    return Cell("failed" if not reason.startswith("no ") else "none", FAILED, (short,), note=reason)


def good(results):
    return [result for result in results if "failed" not in result]


def cell_of(results, values, digits, kind=OWN, details=()):
    """Median of the runs; `values` gives that of a result, or None."""
    found = good(results)
    if not found:
        return failed(results)
    listed = [values(result) for result in found]
    median, least, most = middle(listed)
    if median is None:
        return Cell("none", FAILED, ("not measured",), note="not measured")
    words = [*details, spread(listed, digits)]
    if len(found) < len(results):
        words.append(f"{len(results) - len(found)} of {len(results)} runs failed")
    return Cell(number(median, digits), kind, tuple(filter(None, words)), median, least=least, most=most,
                runs=len(found))


def error_cell(results, what, digits, kind):
    """Final, live and coverage of one figure."""
    cell = cell_of(results, lambda r: r["final"].get(what), digits, kind)
    if cell.kind == FAILED:
        return cell
    found = good(results)
    cell.live = middle([r["live"].get(what) for r in found if "live" in r])[0]
    cell.coverage = middle([r["final"].get("coverage") for r in found])[0]
    details = [f"live {number(cell.live, digits)}"] if cell.live is not None else []
    cell.details = tuple(filter(None, (*details, percent(cell.coverage), *cell.details)))
    return cell


class Tables:
    """`results`: {(sequence's key, system): [figures of each run]}; `modes` and `others` are systems."""

    def __init__(self, sequences, modes, others, results, literature):
        self.sequences, self.modes, self.others = sequences, modes, others
        self.results, self.figures = results, literature["figures"]

    def of(self, sequence, system):
        return self.results.get((sequence.key, system), [])

    def literature(self, of):
        """The published systems that have such a figure of one of the sequences."""
        names = {sequence.name for sequence in self.sequences}
        return [entry for entry in self.figures if entry["of"] == of and names & set(entry["values"])]

    @staticmethod
    def quoted(entry, sequence, words):
        """A cell of the literature; `words` formats the value."""
        value = entry["values"].get(sequence.name)
        if value is None:
            return Cell("", LITERATURE, note="no figure published")
        read_as = value.get("read_as", "") if isinstance(value, dict) else ""
        text, plain = words(value)
        source = entry["source"] + ("; on the real recording of that name" if sequence.simulated else "")
        return Cell(text, LITERATURE, (read_as,) if read_as else (), plain,
                    note="; ".join(filter(None, (source, read_as))))

    def table(self, name, title, unit, own, of=None, words=None, note="", others=True):
        """`own(results, kind)` is the cell of a system, `of` the kind of the literature's figures."""
        published = self.literature(of) if of else []
        systems = [(mode, OWN) for mode in self.modes] + [(o, OTHER) for o in self.others if others]
        table = Table(name, title, unit, [s for s, _ in systems] + [e["system"] for e in published], note=note)
        for sequence in self.sequences:
            cells = [own(self.of(sequence, system), kind) for system, kind in systems]
            cells += [self.quoted(entry, sequence, words) for entry in published]
            table.rows.append((sequence.heading, cells))
        return table

    def all(self):
        return [self.removed(), self.errors("ate", "II. Absolute trajectory error, RMSE", "m", "ate_m", 4, "ate_m"),
                self.errors("rpe_second", "III. Relative pose error per second, RMSE", "m/s", "rpe_m_s", 4, "rpe_m_s"),
                self.errors("rpe_frame", "III b. Relative pose error per frame, RMSE", "m", "rpe_m_frame", 5),
                self.loops(), self.people(), self.wrong(), self.speed(), self.memory()]

    def removed(self):
        def own(results, kind):
            cell = cell_of(results, lambda r: r["removed"], 0, kind)
            if cell.kind != FAILED:
                read = good(results)[0]["read"]
                cell.details = (f"{100 * cell.value / max(read, 1):.2f} % of {read}", *cell.details)
            return cell

        def words(value):
            return f"{value['frames']}", value["frames"]

        table = self.table("removed", "I. Frames removed by the blur gate", "frames", own, "removed", words,
                           "The modes elastic and posefusion have no gate.", others=False)
        for sequence, (_, cells) in zip(self.sequences, table.rows):
            for entry, cell in zip(self.literature("removed"), cells[len(self.modes):]):
                if cell.value is not None:
                    cell.details = (f"{100 * entry['values'][sequence.name]['share']:.2f} %",)
        return table

    def errors(self, name, title, unit, what, digits, of=None):
        def words(value):
            value = value["value"] if isinstance(value, dict) else value
            return f"{value:g}", value

        return self.table(name, title, unit, lambda results, kind: error_cell(results, what, digits, kind), of, words,
                          "First the trajectory as loops have corrected it in the end, then (live) as reported at "
                          "the time, each with the share of frames that have a pose. Falls are not left out.")

    def loops(self):
        def own(results, kind):
            cell = cell_of(results, lambda r: r["loops"]["loops"], 0, kind)
            if cell.kind != FAILED:
                loops = good(results)[0]["loops"]
                cell.text = f"{loops['ferns']} ferns, {cell.text} loops"
                cell.details = (f"{loops['corrections']} corrections", f"{loops['relocalised']} times found again",
                                *cell.details)
            return cell

        def words(value):
            return f"{value['ferns']} ferns, {value['loops']} loops", value["loops"]

        return self.table("loops", "IV. Ferns, loops and relocalisations", "loops", own, "loops", words, others=False)

    def people(self):
        def own(results, kind):
            cell = cell_of(results, lambda r: None if r.get("people_left") is None else 100 * r["people_left"], 2, kind)
            if cell.note == "not measured":
                cell.details = ("no true masks",)
            return cell

        return self.table("people", "People left in the map", "% of stable surfels", own, others=False,
                          note="Against the true masks of the sequence.")

    def wrong(self):
        def own(results, kind):
            cell = cell_of(results, lambda r: r["final"].get("wrong"), 0, kind)
            if cell.kind != FAILED:
                first = good(results)[0]
                cell.live = first.get("live", {}).get("wrong")
                lived = [f"live {cell.live}"] if cell.live is not None else []
                cell.details = (*lived, f"{first['final'].get('false')} off by as much from the start", *cell.details)
            return cell

        return self.table("wrong", "Wrong poses", "poses", own,
                          note="Motions over a second that are off by more than 0.10 m or 5 degrees.")

    def speed(self):
        def own(results, kind):
            stages = middle([r["stages"].get("tracking_and_fusion") for r in good(results)])[0]
            details = (f"tracking and fusion {stages:.1f} ms",) if stages is not None else ()
            return cell_of(results, lambda r: r["frames_per_s"], 1, kind, details)

        return self.table("speed", "Speed", "frames/s", own, others=False, note="Varies from run to run.")

    def memory(self):
        return self.table("memory", "Peak memory", "MB",
                          lambda results, kind: cell_of(results, lambda r: r["memory_mb"], 0, kind), others=False)
