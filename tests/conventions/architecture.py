"""The architecture as a document: the files and functions that it names exist, its walks are short, and its picture is that of the includes."""

import re
import subprocess
import sys

DOCUMENT = "firmware/architecture.md"
HOPS_MAX = 3
NAMED = re.compile(r"`([\w./]+\.(?:cpp|hpp|md))`(?:: `(\w+)`)?")
QUESTION = re.compile(r"(?m)^(\d+)\. .*\?$")


def wrong_names(document, files):
    for match in NAMED.finditer(document):
        path, function = match[1], match[2]
        line = document.count("\n", 0, match.start()) + 1
        if path not in files:
            yield f"{DOCUMENT}:{line}: {path} does not exist"
        elif function and not re.search(rf"\b{function}\(", files[path]):
            yield f"{DOCUMENT}:{line}: {path} has no function {function}"


def long_walks(document):
    walks = QUESTION.split(document.partition("## Ten questions")[2])
    for number, walk in zip(walks[1::2], walks[2::2]):
        hops = len(re.findall(r"(?m)^ +- `", walk))
        if not 1 <= hops <= HOPS_MAX:
            yield f"{DOCUMENT}: question {number} takes {hops} hops; 1 to {HOPS_MAX}"
    if len(walks) // 2 != 10:
        yield f"{DOCUMENT}: {len(walks) // 2} questions; must be ten"


def problems(files, root=None):
    document = files.get(DOCUMENT, "")
    found = [*wrong_names(document, files), *long_walks(document)]
    if root is not None:
        drawn = subprocess.run([sys.executable, "-B", f"{root}/tools/architecture", "--check"], capture_output=True, text=True, check=False)
        found += [drawn.stdout.strip() or drawn.stderr.strip()] if drawn.returncode != 0 else []
    return found
