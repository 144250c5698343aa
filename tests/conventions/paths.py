"""No path of a developer's machine: what the repository says must hold on every machine."""

import re

# Behind a letter, digit, dot or dash it is part of a longer path or address of something else.
MACHINE = re.compile(r"(?<![\w.\-}$)])/(?:home|work|root|Users)/\w|(?<![\w.\-}$)])/tmp\b")
SCRATCH = "/tmp"


def problems(files):
    found = []
    for path, text in files.items():
        for number, line in enumerate(text.splitlines(), 1):
            for match in MACHINE.finditer(line):
                if match[0] != SCRATCH or not path.startswith("tests/"):
                    found.append(f"{path}:{number}: '{match[0]}' is a place on one machine; take it from an option or a variable")
    return found
