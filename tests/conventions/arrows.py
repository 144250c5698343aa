"""Allowed arrows: what each folder may include; no circle among files, nor among the folders of the core."""

import re

import sources

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.MULTILINE)

# Folder to the folders that it may include, besides itself. "core" is every part of it.
ALLOWED = {
    "core/math": [],
    "core/base": ["core/math"],
    "core/geometry": ["core/math"],
    "core": ["core"],
    "rt": ["core/base"],
    "drivers": ["core/base", "core/math", "core/scan", "rt"],
    "config": ["core", "rt", "drivers"],
    "firmware": ["core", "rt", "drivers", "config"],
    "tools": ["core", "rt", "drivers", "config", "firmware"],
    "tests": ["core", "rt", "drivers", "config", "firmware", "tools"],
}
OURS = sorted({folder.split("/")[0] for folder in ALLOWED})

# The method is pure: no thread, clock, file, stream or foreign chance; and no library but Eigen.
PURE = re.compile(
    r"^(thread|mutex|shared_mutex|condition_variable|future|chrono|ctime|time\.h|fstream|iostream|filesystem|random"
    r"|unistd\.h|pthread\.h|(sys|netinet|arpa|linux|fmt|toml\+\+|CLI|nlohmann|lcm)/.*)$"
)


def part(path):
    """core/ndt for core/ndt/cell.hpp, tools for tools/log/reader.hpp."""
    folders = path.split("/")[:-1]
    return "/".join(folders[:2]) if folders[0] == "core" else folders[0]


def allowed(from_part, to_part):
    rules = ALLOWED.get(from_part, ALLOWED[from_part.split("/")[0]])
    return from_part == to_part or any(to_part == rule or to_part.startswith(rule + "/") for rule in rules)


def includes(path, text):
    """(line, path) of each header of the project that a file includes."""
    for match in INCLUDE.finditer(text):
        if match[1] == '"':
            yield text.count("\n", 0, match.start()) + 1, match[2]


def circle(graph):
    """One circle of a graph (node to set of nodes) as a list that ends as it starts, or None."""
    done, path = set(), []

    def visit(node):
        if node in path:
            return path[path.index(node) :] + [node]
        if node in done:
            return None
        path.append(node)
        for successor in sorted(graph.get(node, ())):
            found = visit(successor)
            if found:
                return found
        path.pop()
        done.add(node)
        return None

    return next((found for found in map(visit, sorted(graph)) if found), None)


def wrong_arrows(path, text):
    for line, target in includes(path, text):
        if target.split("/")[0] not in OURS or "/" not in target:
            yield f'{path}:{line}: include "{target}" by its path from the root of the project'
        elif not allowed(part(path), part(target)):
            rules = ALLOWED.get(part(path), ALLOWED[path.split("/")[0]])
            yield f"{path}:{line}: {part(path)} may not include {part(target)}; it may: {', '.join(rules) or 'nothing else'}"


def impure(path, text):
    for match in INCLUDE.finditer(text):
        if match[1] == "<" and PURE.match(match[2]):
            line = text.count("\n", 0, match.start()) + 1
            yield f"{path}:{line}: <{match[2]}> has no place in the core: time enters as stamps, chance as core/base/rng.hpp"


def problems(files):
    found, by_file, by_part = [], {}, {}
    for path, text in files.items():
        if not sources.is_cpp(path) or path.split("/")[0] not in OURS:
            continue
        found += wrong_arrows(path, text)
        found += impure(path, text) if path.startswith("core/") else []
        by_file[path] = {target for _, target in includes(path, text)}
        if path.startswith("core/"):
            by_part.setdefault(part(path), set()).update(part(t) for t in by_file[path] if part(t) != part(path))
    for graph, things in ((by_file, "files"), (by_part, "folders")):
        round_trip = circle(graph)
        found += [f"{round_trip[0]}: circle of {things}: {' -> '.join(round_trip)}"] if round_trip else []
    return found
