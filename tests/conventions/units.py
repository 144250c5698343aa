"""Units in names: what is called a distance, an angle, a time and the like says in which unit it is.

Looked at: names of members, parameters, variables and functions of type double or float (and containers of them), and,
for times, of the integer types. A name fails if its last word, leaving out words such as max or mean, is a quantity that
has a unit. Names of other words are taken to be plain numbers or the letters of a formula.
"""

import re

import cpp_source
import sources

QUANTITIES = set(
    """acceleration angle angles azimuth bearing diameter displacement distance distances duration elevation heading height
    interval latency length noise period pitch position radius range ranges resolution roll rotation side size sizes
    spacing speed stamp stamps time timeout times translation velocity width yaw yaws""".split()
)
TIMES = set("duration elapsed interval latency period stamp stamps time timeout timestamp".split())
# Words that say which of several, not what.
WHICH = set("max min mean median limit default sum total threshold average first last squared".split())
# Names that are another's: fields of ROS's messages.
FOREIGN = {"tools/ros2/messages.hpp"}
# Words that make a plain number of a quantity, or a verb of the name.
PLAIN = set("inverse normalised per ratio relative scaled share wrap".split())

NUMBER = r"(?:double|float)"
WHOLE = r"(?:int|unsigned|long|std::u?int(?:32|64)_t)"
CONTAINER = r"std::(?:vector|span|array|optional|Result)\s*<\s*(?:const\s+)?{0}\b[^;(){{}}]*?>"


def _declaration(kind):
    return re.compile(
        r"\b(?:" + kind + r"|" + CONTAINER.format(kind) + r")(?:\s+const\b)?\s*[&*]{0,2}\s*(?P<name>[A-Za-z_]\w*)\s*(?=[;=,(){}\[:])"
    )


REALS = _declaration(NUMBER)
WHOLES = _declaration(WHOLE)


def words(name):
    """Lower-case words of a snake_case or kPascalCase name."""
    if re.match(r"k[A-Z]", name):
        name = name[1:]
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower().strip("_").split("_")


def lacks_unit(name, quantities):
    spoken = words(name)
    if PLAIN & set(spoken):
        return False
    while len(spoken) > 1 and spoken[-1] in WHICH:
        spoken.pop()
    return spoken[-1] in quantities


def problems(files):
    found = []
    for path, text in files.items():
        if not sources.is_cpp(path) or path in FOREIGN:
            continue
        stripped = cpp_source.strip(text)
        for pattern, quantities in ((REALS, QUANTITIES), (WHOLES, TIMES)):
            for match in pattern.finditer(stripped):
                if lacks_unit(match["name"], quantities):
                    line = stripped.count("\n", 0, match.start("name")) + 1
                    found.append(f"{path}:{line}: {match['name']} needs its unit: _m, _rad, _s, _ns, _hz, _cells, ...")
    return found
