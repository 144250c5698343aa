"""No exceptions in core, rt, drivers and firmware: they return a Result, or check for a bug."""

import re

import cpp_source
import sources

WITHOUT = ("core/", "rt/", "drivers/", "firmware/")
KEYWORD = re.compile(r"\b(throw|try|catch)\b")


def problems(files):
    found = []
    for path, text in files.items():
        if sources.is_cpp(path) and path.startswith(WITHOUT):
            stripped = cpp_source.strip(text)
            for match in KEYWORD.finditer(stripped):
                line = stripped.count("\n", 0, match.start()) + 1
                found.append(f"{path}:{line}: {match[1]}: return a Result, or ODOLESS_CHECK what only a bug can break")
    return found
