"""The fault matrix as a table of the README: written from a run, and read again."""

import math
import re

from matrix import ROWS

BEGIN, END = "<!-- written by tools/fault-matrix: -->", "<!-- until here -->"
HEAD = ("| # | Fault | Injected by | Promised | Measured | Kept |", "|---|---|---|---|---|---|")
KEPT = re.compile(r"yes|not run: .+|failed: .+|\*\*no\*\*: .+ instead of .+")


def figure_text(value, unit):
    return "not in the run" if not math.isfinite(value) else f"{value:.3g} {unit}"


def measured_text(result):
    figures = result["measured"].items()
    return "; ".join(f"{what} {figure_text(each['value'], each['unit'])}" for what, each in figures) or "by its tests"


def verdict(row, result):
    for wanted in ("failed", "not run", "skipped"):
        names = [name for name, test in result["tests"].items() if test["outcome"] == wanted]
        if names:
            return f"{'failed' if wanted == 'failed' else 'not run'}: {', '.join(name.split(':')[-1] for name in names)}"
    broken = []
    for what, bound in row.bounds.items():
        figure = result["measured"].get(what)
        if figure is None:
            return f"failed: {what} was not measured"
        if not figure["value"] <= bound:
            broken.append(f"{what} {figure_text(figure['value'], figure['unit'])} instead of {bound:g}")
    return "yes" if not broken else "**no**: " + ", ".join(broken)


def described(row):
    """What a line of the table says whatever was measured."""
    return [str(row.number), row.fault + (f" ({row.remark})" if row.remark else ""), row.by, row.promise]


def line(row, result):
    return "| " + " | ".join([*described(row), measured_text(result), result["kept"]]) + " |"


def rewrite(path, results):
    with open(path, encoding="utf-8") as file:
        before, rest = file.read().split(BEGIN)
    lines = [BEGIN, *HEAD, *(line(row, results[row.number]) for row in ROWS), END]
    with open(path, "w", encoding="utf-8") as file:
        file.write(before + "\n".join(lines) + rest.split(END)[1])


def read(path):
    """The cells of each line."""
    with open(path, encoding="utf-8") as file:
        lines = file.read().split(BEGIN)[1].split(END)[0].strip().split("\n")
    if tuple(lines[:2]) != HEAD:
        raise ValueError(f"{path}: the table has another head than {HEAD[0]}")
    return [text.strip("| ").split(" | ") for text in lines[2:]]
