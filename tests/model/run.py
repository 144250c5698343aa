"""Checks every model beside this file with spin: as it is, nothing is wrong; with each `weak:` variant, an assertion fails.

run.py [MODEL [VARIANT]] says what it did, and, for a single variant, what spin said.
"""

import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).parent
WEAK = re.compile(r"^ \* weak: (\w+)", re.MULTILINE)
SHARED = {"views.pml"}


def check(model, variant):
    """What spin says of all states of a model: (number of errors, its words)."""
    with tempfile.TemporaryDirectory() as folder:
        flags = [f"-D{variant}"] if variant else []
        for source in HERE.glob("*.pml"):  # spin looks for includes in its working folder
            shutil.copy(source, folder)
        for command in (
            ["spin", "-a", *flags, model.name],
            ["cc", "-O1", "-w", "-DSAFETY", "-DVECTORSZ=2048", "-DMEMLIM=2000", "-o", "pan", "pan.c"],
            ["./pan", "-m100000"],
        ):
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=600)
            said = done.stdout + done.stderr
            if done.returncode != 0 and command[0] != "./pan":
                raise RuntimeError(f"{' '.join(command)}: {said}")
    errors = re.search(r"errors: (\d+)", said)
    complete = errors and "search depth too small" not in said and ("Search not completed" not in said or errors[1] != "0")
    if not complete:
        raise RuntimeError(f"{model.name} {variant or ''}: not all states were seen:\n{said}")
    return int(errors[1]), said


def cases(names):
    for model in sorted(HERE.glob("*.pml")):
        if model.name not in SHARED and (not names or model.stem == names[0]):
            for variant in [None, *WEAK.findall(model.read_text())]:
                if len(names) < 2 or variant == names[1]:
                    yield model, variant


def problem(model, variant, errors, said):
    if variant is None and errors:
        return f"{model.stem}: spin found an error"
    if variant and (not errors or "assertion violated" not in said):
        return f"{model.stem} {variant}: spin found nothing, so the model says nothing"
    return None


def main():
    all_cases = list(cases(sys.argv[1:]))
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        answers = list(pool.map(lambda case: check(*case), all_cases))
    for (model, variant), (errors, said) in zip(all_cases, answers):
        states = re.search(r"(\d+) states, stored", said)
        print(f"{model.stem} {variant or ''}: {errors} errors, {states[1] if states else '?'} states")
        if len(all_cases) == 1:
            print(said)
    problems = list(filter(None, (problem(*case, *answer) for case, answer in zip(all_cases, answers))))
    print("\n".join(problems) if problems else f"{len(all_cases)} models did as they should")
    return 1 if problems or not all_cases else 0


if __name__ == "__main__":
    sys.exit(main())
