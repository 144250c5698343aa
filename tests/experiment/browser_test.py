#!/usr/bin/env python3
"""Opens the report in Chromium without a display: every picture loads, no message of an error, and nothing is asked of a
network.

usage: browser_test.py ODOLESS OUT
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77

# Stands at the end of the copy that is opened: tells what the page is like when all has loaded.
PROBE = """<script>
const failures = [];
addEventListener("error", e => failures.push(String(e.message || e.target.src)), true);
addEventListener("load", () => {
  const images = [...document.images];
  const broken = images.filter(i => !i.complete || i.naturalWidth < 100);
  const asked = performance.getEntriesByType("resource").filter(r => !r.name.startsWith("data:"));
  document.title = `images ${images.length} broken ${broken.length} failures ${failures.length} asked ${asked.length}`;
});
</script>"""


def main():
    chromium = shutil.which("chromium")
    if chromium is None:
        print("chromium is not installed (tools/setup installs it): skipped")
        return SKIPPED
    report = (pathlib.Path(sys.argv[2]) / "report.html").read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        page = pathlib.Path(folder) / "page.html"
        page.write_text(report.replace("<head>", "<head>" + PROBE, 1), encoding="utf-8")
        command = [chromium, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                   f"--user-data-dir={folder}/profile", "--enable-logging=stderr", "--virtual-time-budget=20000",
                   "--dump-dom", page.as_uri()]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    title = re.search(r"<title>(.*?)</title>", done.stdout)
    print(title.group(1) if title else done.stderr)
    assert done.returncode == 0, done.returncode
    counts = re.fullmatch(r"images (\d+) broken 0 failures 0 asked 0", title.group(1))
    assert counts and int(counts.group(1)) >= 18, title.group(1)
    console = [line for line in done.stderr.splitlines() if "CONSOLE" in line]
    assert not console, console
    return 0


if __name__ == "__main__":
    sys.exit(main())
