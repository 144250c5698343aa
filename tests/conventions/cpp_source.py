"""Just enough of C++ for the checks: text without comments and strings, and where its functions are."""

import dataclasses
import re

SKIPPED = re.compile(
    r"""//[^\n]*|/\*.*?\*/                                  # comments
      |R"(?P<mark>[^()\s\\]{0,16})\(.*?\)(?P=mark)"         # raw strings
      |"(?:\\.|[^"\\\n])*"                                  # strings
      |(?<![0-9A-Fa-f])'(?:\\.|[^'\\\n])+'                  # characters, but not the 1'000 of a number
    """,
    re.VERBOSE | re.DOTALL,
)
DIRECTIVE = re.compile(r"^[ \t]*#(?:[^\n\\]|\\.)*(?:\\\n(?:[^\n\\]|\\.)*)*", re.MULTILINE | re.DOTALL)

CONTROL = {"if", "for", "while", "switch", "catch", "return", "else", "do", "constexpr", "case", "throw"}
NOT_NAMES = CONTROL | {"alignas", "decltype", "noexcept", "requires", "explicit", "sizeof", "static_assert", "typeid"}
QUALIFIER = r"(?:\b(?:const|noexcept|override|final|mutable|volatile)\b|&&?|\)|->\s*[^(){};]+)"
BODY_COMES = re.compile(r"\)\s*(?:" + QUALIFIER + r"\s*)*$")
LAMBDA_COMES = re.compile(r"\[[^\[\]]*\]\s*(?:mutable\s*|noexcept\s*)*$")
SCOPE_COMES = re.compile(r"\b(?:namespace|class|struct|union|enum|extern)\b[^()=]*$")
INITIALISERS_COME = re.compile(r"\)\s*(?:noexcept\s*)?:(?!:)\s*[\w:<>]+\s*(?:$|[({])")


@dataclasses.dataclass
class Function:
    """A function with a body, or a declaration (`lines` is 0 then)."""

    name: str
    line: int
    lines: int
    parameters: list


def _blank(match):
    """As many lines as before, so that line numbers stay, and something that is still one token."""
    text = match.group(0)
    token = '""' if text[0] in "\"R'" else " "
    return token + "\n" * text.count("\n")


def strip(text):
    """The text without comments, contents of strings, and preprocessor lines; every line keeps its number."""
    return DIRECTIVE.sub(lambda match: "\n" * match.group(0).count("\n"), SKIPPED.sub(_blank, text))


def split_top(text):
    """Splits at the commas outside of all brackets."""
    parts, depth, part = [], 0, ""
    for character in text:
        depth += (character in "([{<") - (character in ")]}>")
        if character == "," and depth == 0:
            parts.append(part)
            part = ""
        else:
            part += character
    return [p.strip() for p in parts + [part] if p.strip() and p.strip() != "void"]


def _closing(text, start):
    """Index of the bracket that closes the one at `start`, or -1."""
    depth = 0
    for index in range(start, len(text)):
        depth += (text[index] in "([{") - (text[index] in ")]}")
        if depth == 0:
            return index
    return -1


def parameter_list(header):
    """Name and parameters of the function that a header declares, or None."""
    for match in re.finditer(r"(operator\s*(?:\(\s*\)|[^\s\w(]+|\w+)|~?\w+|\])\s*(?=\()", header):
        name = match.group(1)
        opening = match.end()
        if name in NOT_NAMES and name != "]":
            if name in CONTROL and name != "constexpr":
                return None
            continue
        closing = _closing(header, opening)
        if closing >= 0:
            return ("lambda" if name == "]" else name), split_top(header[opening + 1 : closing])
    return None


def _kind(header):
    """What a brace after `header` opens."""
    header = header.rstrip()
    if SCOPE_COMES.search(header) and not header.endswith(")"):
        return "scope"
    if LAMBDA_COMES.search(header):
        return "lambda"
    lambda_at = header.rfind("](")
    if lambda_at >= 0 and BODY_COMES.search(header) and _inside_is_closed(header[lambda_at + 1 :]):
        return "lambda"
    if BODY_COMES.search(header) or re.search(r"[)}]\s*$", header) and INITIALISERS_COME.search(header):
        found = parameter_list(header)
        return "function" if found else "control"
    if re.search(r"(?:^|\b)(?:else|do|try)$", header):
        return "control"
    return "initialiser"


def _inside_is_closed(text):
    return text.count("(") == text.count(")")


def functions(stripped):
    """All functions of a stripped text, in the order of their ends; lambdas count as functions of their own."""
    found = []
    stack = []  # of (kind, start line, header, round brackets that were open)
    header, depth, line = "", 0, 1
    for character in stripped:
        line += character == "\n"
        if character == "{":
            kind = _kind(header) if header.strip() else "control"
            stack.append((kind, line, header, depth))
            header, depth = ("", 0)
        elif character == "}":
            if not stack:
                return found
            kind, start, opened, depth = stack.pop()
            if kind in ("function", "lambda"):
                name, parameters = _signature(kind, opened)
                first = start - opened.lstrip().count("\n") if kind == "function" else start
                found.append(Function(name, first, line - first + 1, parameters))
            header = opened + "{}" if kind in ("initialiser", "lambda") else ""
            depth = depth if kind in ("initialiser", "lambda") else 0
        elif character == ";" and depth == 0:
            if all(entry[0] == "scope" for entry in stack):
                found += _declaration(header, line)
            header = ""
        else:
            depth += (character == "(") - (character == ")")
            header += character
            if re.search(r"\b(?:public|private|protected):$", header):
                header = ""
    return found


def _signature(kind, header):
    if kind == "function":
        return parameter_list(header)
    at = header.rfind("](")
    closed = header[at + 1 :] if at >= 0 else ""
    return (parameter_list("]" + closed) if closed else None) or ("lambda", [])


def _declaration(header, line):
    """A prototype at the scope of a class or namespace."""
    if "=" in header.split("(")[0].replace("operator=", "") or re.match(r"\s*(using|typedef|static_assert|return)\b", header):
        return []
    declared = parameter_list(header)
    return [Function(declared[0], line, 0, declared[1])] if declared else []
