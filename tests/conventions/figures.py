"""Figures of recorded logs have one home, tests/results.md, which tools/results writes from runs. README.md and those of core repeat some in
tables: rows and columns that are called as there, with figures that are within 1.3 times of those there. Elsewhere they state none."""

import re

HOME = "tests/results.md"
RATIO_MAX = 1.3
FIGURE = re.compile(r"(-?\d+(?:\.\d+)?) ?(m|deg|%|ms|MB)?(?![\w.])")
DECIMAL = re.compile(r"\d\.\d+ ?(?:m|deg|%|ms|MB)(?!\w)|\d (?:%|ms|MB)(?!\w)")


def is_checked(path):
    return path == "README.md" or (path.startswith("core/") and path.endswith("README.md"))


def cells(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def rows(text):
    """(line, its name, its cells by the head of their column) of each row of each table."""
    head = None
    for number, line in enumerate(text.splitlines(), 1):
        if not line.startswith("|"):
            head = None
        elif head is None:
            head = cells(line)
        elif not set(line) <= set("|-: "):
            row = cells(line)
            yield number, row[0], dict(zip(head[1:], row[1:]))


def measured(text):
    """Name of a log and head of a column to what stands there."""
    return {(name, head): cell for _, name, row in rows(text) for head, cell in row.items()}


def is_near(stated, known):
    """Whether two cells have the same figures, each about as large."""
    pairs = list(zip(FIGURE.findall(stated), FIGURE.findall(known)))
    if not pairs or len(FIGURE.findall(stated)) != len(FIGURE.findall(known)):
        return False
    return all(unit == known_unit and abs(float(a)) <= RATIO_MAX * abs(float(b)) and abs(float(b)) <= RATIO_MAX * abs(float(a))
               for (a, unit), (b, known_unit) in pairs)


def paragraphs(text):
    """(line, text) of each paragraph, and of each row of a table."""
    begin, lines = 1, []
    for number, line in enumerate(text.splitlines() + [""], 1):
        if line.startswith("|") or not line.strip():
            if lines:
                yield begin, "\n".join(lines)
            lines = []
            if line:
                yield number, line
        else:
            begin = begin if lines else number
            lines.append(line)


def problems(files):
    known = measured(files[HOME])
    names = {name for name, _ in known}
    logs = {name.split(",")[0] for name in names}
    found = []
    for path, text in files.items():
        if not is_checked(path):
            continue
        compared = set()
        for number, name, row in rows(text):
            for head in row:
                if (name, head) in known:
                    compared.add(number)
                    if not is_near(row[head], known[name, head]):
                        found.append(f"{path}:{number}: {name}, {head}: {row[head]}; {HOME} has {known[name, head]}")
        for number, paragraph in paragraphs(text):
            if number not in compared and DECIMAL.search(paragraph) and any(log in paragraph for log in logs):
                found.append(f"{path}:{number}: a figure of a recorded log that {HOME} does not have by that row and column: {DECIMAL.search(paragraph)[0]}")
    return found
