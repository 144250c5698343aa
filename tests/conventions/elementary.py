"""No elementary function of the C library, nor of Eigen, where results of a replay come from: their bits differ between processors."""

import re

import cpp_source
import sources

WHERE = ("core/", "drivers/", "firmware/", "tools/log/", "tools/output/trajectory", "tools/sim/", "tools/emulate/", "tools/fault_campaign/")
OWN = "core/math/"
FUNCTION = (
    r"(?:a?(?:sin|cos|tan)h?|atan2|sincos|exp|exp2|exp10|expm1|log|log2|log10|log1p|pow|cbrt|hypot|erfc?|[tl]gamma|polar|arg)[fl]?"
)
# What std:: has beside `math::`, whether called or handed on; and what is called with no namespace, of an array too.
CALL = re.compile(r"(?:\bstd::|(?<![\w:])::)" + FUNCTION + r"\b(?!\s*::)|(?<![\w:])(?<!std::function<void\()" + FUNCTION + r"\s*\(")
TURN = re.compile(r"\b(?:AngleAxis|Rotation2D)\w*|\b(?:slerp|eulerAngles|angularDistance)\s*\(")


def problems(files):
    found = []
    for path, text in files.items():
        if sources.is_cpp(path) and path.startswith(WHERE) and not path.startswith(OWN):
            stripped = cpp_source.strip(text)
            for match in sorted([*CALL.finditer(stripped), *TURN.finditer(stripped)], key=lambda m: m.start()):
                line = stripped.count("\n", 0, match.start()) + 1
                found.append(f"{path}:{line}: {match[0].rstrip('( ')}: its bits differ between processors; take one of core/math/elementary.hpp")
    return found
