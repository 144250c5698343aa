"""Runs the stress program: run.py PROGRAM [--right]. Each right scenario must end well, the wrong one must be found out.

--right leaves the wrong one out: without ThreadSanitizer nobody sees it. Seconds for each: ODOLESS_STRESS_S (1 by default).
"""

import os
import subprocess
import sys

RACE = 66  # a report of ThreadSanitizer


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
    status, said = run(program, name, seconds)
    if kind == "right":
        return f"{name}: exit status {status}\n{said}" if status != 0 else None
    return None if status == RACE else f"{name}: exit status {status}: this run would not find a race in the product either"


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
