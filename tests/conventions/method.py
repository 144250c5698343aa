"""The method as a paper, core/method.md: each citation of the sources is in its bibliography, and sections and headers name each other."""

import re

PAPER = "core/method.md"
CITED = re.compile(r"\[([a-z]+(?:19|20)\d\d\w*[^\][]*)\]")
KEY = re.compile(r"\b[a-z]+(?:19|20)\d\d[a-z]\w*|\b[a-z]+(?:19|20)\d\d\b")
ENTRY = re.compile(r"^- \*\*\[(\w+)\]\*\*", re.MULTILINE)
SECTION = re.compile(r"^## (\d+)\. ", re.MULTILINE)
CODE = (".hpp", ".cpp", ".py")


def sections(paper):
    """Number to text of each section."""
    parts = SECTION.split(paper)
    return dict(zip(parts[1::2], parts[2::2]))


def files_of(section):
    """Those that a section's line of files names, relative to core."""
    line = next((line for line in section.splitlines() if line.startswith("Files: ")), "")
    return re.findall(r"`([^`]+)`", line)


def citations(text):
    """(line, what is between the brackets) of each, however its comment is wrapped."""
    for match in CITED.finditer(text):
        yield text.count("\n", 0, match.start()) + 1, re.sub(r"\s*\n\s*//[/<]*\s*", " ", match[1])


def sources_without_the_paper(files):
    return {path: text for path, text in files.items() if path != PAPER and (path.endswith(CODE + (".md",)))}


def wrong_citations(path, line, cited, paper):
    by_number = sections(paper)
    for key in KEY.findall(cited):
        if key not in ENTRY.findall(paper):
            yield f"{path}:{line}: [{key}] is not in the bibliography of {PAPER}"
    if not path.startswith("core/") or not path.endswith(".hpp"):
        return
    named = re.search(r"method (\d+)", cited)
    if not named:
        yield f"{path}:{line}: says no section: [{cited}; method N], N being the one of {PAPER} that describes it"
    elif path[len("core/") :] not in files_of(by_number.get(named[1], "")):
        yield f"{path}:{line}: section {named[1]} of {PAPER} does not name this file"


def problems(files):
    paper = files.get(PAPER, "")
    found = []
    used = set(KEY.findall(" ".join(cited for _, cited in citations(ENTRY.sub("", paper)))))
    for path, text in sources_without_the_paper(files).items():
        if path.startswith("tests/conventions/"):
            continue
        for line, cited in citations(text):
            used |= set(KEY.findall(cited))
            found += wrong_citations(path, line, cited, paper)
    for number, section in sections(paper).items():
        found += [f"{PAPER}: section {number} names core/{name}, which does not exist" for name in files_of(section) if f"core/{name}" not in files]
    folders = {path.split("/")[1] for path in files if path.startswith("core/") and path.count("/") > 1}
    named = {name.split("/")[0] for section in sections(paper).values() for name in files_of(section)}
    found += [f"{PAPER}: no section names a file of core/{folder}" for folder in sorted(folders - named)]
    found += [f"{PAPER}: [{key}] is cited nowhere" for key in ENTRY.findall(paper) if key not in used]
    found += [f"{PAPER}: [{key}] is not in the bibliography" for key in sorted(used - set(ENTRY.findall(paper)))] if paper else []
    return sorted(set(found))
