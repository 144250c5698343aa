"""Runs one check over the project: run.py CHECK ROOT. Prints what is wrong, one per line; exit status 1 if anything is."""

import pathlib
import sys

import architecture
import arrows
import documents
import elementary
import exceptions
import figures
import format as formatting
import method
import paths
import readmes
import sizes
import sources
import units

CHECKS = {
    "architecture": architecture.problems,
    "arrows": arrows.problems,
    "documents": documents.problems,
    "elementary": elementary.problems,
    "exceptions": exceptions.problems,
    "figures": figures.problems,
    "format": formatting.problems,
    "method": method.problems,
    "paths": paths.problems,
    "readmes": readmes.problems,
    "sizes": sizes.problems,
    "units": units.problems,
}


def main():
    name, root = sys.argv[1], pathlib.Path(sys.argv[2])
    files = sources.read_all(root)
    found = CHECKS[name](files, root) if name in ("architecture", "format") else CHECKS[name](files)
    print("\n".join(found) if found else f"{name}: {len(files)} files are right")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
