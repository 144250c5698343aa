"""What the tests of the libraries run."""

import subprocess


def run(*command, **options):
    outcome = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    assert outcome.returncode == 0, f"{command}: {outcome.stdout[-3000:]}{outcome.stderr[-3000:]}"
    return outcome.stdout
