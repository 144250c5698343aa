"""Runs the stress program: run.py PROGRAM [--right]. Each right scenario must end well, each weakened one must be found out.

--right leaves the weakened ones out: without ThreadSanitizer, most processors forgive them.
Seconds for each right one: ODOLESS_STRESS_S (1 by default). A weakened one gets up to ten tries.
"""

import os
import subprocess
import sys

FOUND = (1, 66)  # a broken promise, a report of ThreadSanitizer
TRIES = 10


def run(program, name, seconds):
    environment = dict(os.environ, TSAN_OPTIONS="halt_on_error=1 report_signal_unsafe=0")
    command = [program, name, str(seconds)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=3600 + seconds)
    if "unexpected memory mapping" in done.stderr:  # ThreadSanitizer, where addresses are more random than it knows
        command = ["setarch", "--addr-no-randomize", *command]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=3600 + seconds)
    return done.returncode, done.stderr


def problem(program, name, kind, seconds):
    """What is wrong with a scenario, or None."""
    if kind == "right":
        status, said = run(program, name, seconds)
        return f"{name}: exit status {status}\n{said}" if status != 0 else None
    for _ in range(TRIES):
        status, said = run(program, name, 0.1)
        if status in FOUND:
            return None
        if status != 0:
            return f"{name}: exit status {status}\n{said}"
    return f"{name}: is weaker than the product, and nothing was found: this run would not find the like either"


def main():
    program = sys.argv[1]
    seconds = float(os.environ.get("ODOLESS_STRESS_S", "1"))
    listed = subprocess.run([program], capture_output=True, text=True, check=True).stdout
    scenarios = [line.split() for line in listed.splitlines()]
    if "--right" in sys.argv:
        scenarios = [scenario for scenario in scenarios if scenario[1] == "right"]
    problems = list(filter(None, (problem(program, name, kind, seconds) for name, kind in scenarios)))
    print("\n".join(problems) if problems else f"{len(scenarios)} scenarios did as they should")
    return 1 if problems or not scenarios else 0


if __name__ == "__main__":
    sys.exit(main())
