"""Documents: folder READMEs are short, decisions are numbered, and documents and texts for users speak the field's words.

A word here stands for a thing that the field has a word for. Where one is still in use it is counted in words_in_use.txt, whose
numbers may only go down."""

import pathlib
import posixpath
import re

LINES_MAX = 80

# What is not said (a regular expression, in any case): what is said instead.
WORDS = {
    r"\bdoubts?\b": "uncertainty, standard deviation, DEGRADED",
    r"(?<!standard )\bdeviations?\b": "standard deviation",
    r"\btorn\b": "tracking lost, not credible",
    r"\b(?:go|goes|went|run|runs|ran) backwards\b": "out of order",
    r"\bthe seed(?:'s)?\b": "the dissertation, or: the random seed",
    r"\bthesis\b": "the dissertation",
    r"\bthe unseen\b": "unknown cells",
    r"\bswallow(?:s|ed)?\b": "dropout, no return",
    r"\bbrought up (?:again|anew)\b": "restarted, reconnected",
    r"\bline is gone\b": "closed, timed out",
    r"\bmatches alone\b": "laser odometry",
    r"\bpublished at the time\b": "online estimate",
    r"\bmultipl(?:y|ies) alike\b": "are resampled",
    r"\bfinds? itself\b": "is relocalised",
    r"\bin the middle and\b": "median",
    r"\d %? ?within \d": "95th percentile",
    r"\bsecond peak\b": "second hypothesis",
    r"\bleaves? (?:one|a) direction open\b": "degenerate scene, unconstrained direction",
    r"\bpoor(?:ly)?\b": "rejected, ambiguous",
    r"\bclimbs?\b": "refine, maximise",
}
IN_USE = pathlib.Path(__file__).with_name("words_in_use.txt")
SENTENCE = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
FOR_USERS = ("core/", "rt/", "drivers/", "config/", "firmware/", "tools/")


def texts_for_users(path, text):
    """(line, text) of what a reader of documents or a user of the programs sees."""
    if path.endswith(".md"):
        yield from enumerate(text.splitlines(), 1)
    elif path.endswith((".cpp", ".hpp")) and path.startswith(FOR_USERS):
        for match in SENTENCE.finditer(text):
            if " " in match[1]:
                yield text.count("\n", 0, match.start()) + 1, match[1]


def uses(files):
    """(path, word) to the lines where it is used."""
    found = {}
    for path, text in files.items():
        for line, sentence in texts_for_users(path, text):
            for word in WORDS:
                for _ in re.finditer(word, sentence, re.IGNORECASE):
                    found.setdefault((path, word), []).append(line)
    return found


def in_use(text):
    """(path, word) to how often, of lines: NUMBER PATH WORD."""
    parts = [line.split(" ", 2) for line in text.splitlines() if line]
    return {(path, word): int(number) for number, path, word in parts}


def wrong_words(files, allowed):
    found = uses(files)
    for (path, word), lines in sorted(found.items()):
        known = allowed.get((path, word), 0)
        if len(lines) > known:
            where = ", ".join(str(line) for line in lines)
            yield f"{path}:{lines[-1]}: /{word}/ {len(lines)} times (lines {where}), {known} known; say: {WORDS[word]}"
    for (path, word), known in sorted(allowed.items()):
        if len(found.get((path, word), [])) < known:
            yield f"{IN_USE.name}: {path} has /{word}/ {len(found.get((path, word), []))} times now and not {known}: write that"


def wrong_numbers(path, text):
    numbers = [int(number) for number in re.findall(r"(?m)^- \*\*D(\d+)\*\* \(\d{4}-\d\d-\d\d\) \S", text)]
    items = len(re.findall(r"(?m)^- ", text))
    if numbers != list(range(1, items + 1)):
        yield f"{path}: decisions must be items '- **D1** (YYYY-MM-DD) ...', numbered from 1 without a gap; found {numbers} in {items} items"


def dead_links(path, text, files):
    for match in re.finditer(r"\]\((?!https?:)([^)#\s]+)(?:#[^)]*)?\)", text):
        target = posixpath.normpath(posixpath.join(posixpath.dirname(path), match[1]))
        if not any(name == target or name.startswith(target + "/") for name in files) and not pathlib.Path(target).suffix == ".png":
            yield f"{path}:{text.count(chr(10), 0, match.start()) + 1}: {match[1]} leads nowhere"


def problems(files, allowed=None):
    found = []
    for path, text in files.items():
        name = path.split("/")[-1]
        lines = len(text.splitlines())
        if name == "README.md" and "/" in path and lines > LINES_MAX:
            found.append(f"{path}: {lines} lines; at most {LINES_MAX}: move what few need to a page of its own")
        if name.endswith(".md"):
            found += dead_links(path, text, files)
        if name == "DECISIONS.md":
            found += wrong_numbers(path, text)
    return found + list(wrong_words(files, in_use(IN_USE.read_text(encoding="utf-8")) if allowed is None else allowed))


if __name__ == "__main__":  # what words_in_use.txt has to say now; with --texts: all that users of the programs read
    import sys

    import sources

    everything = sources.read_all(".")
    if sys.argv[1:] == ["--texts"]:
        for source, code in everything.items():
            if not source.endswith(".md"):
                for where, sentence in texts_for_users(source, code):
                    print(f"{source}:{where}: {sentence}")
    else:
        for (used_path, used_word), used_lines in sorted(uses(everything).items()):
            print(len(used_lines), used_path, used_word)
