"""Every C++ source is as clang-format leaves it."""

import subprocess

import sources


def problems(files, root="."):
    cpp = [path for path in files if sources.is_cpp(path)]
    if not cpp:
        return []
    checked = subprocess.run(["clang-format", "--dry-run", "-Werror", *cpp], cwd=root, capture_output=True, text=True)
    if checked.returncode == 0:
        return []
    wrong = sorted({line.split(":")[0] for line in checked.stderr.splitlines() if "[-Wclang-format-violations]" in line})
    return [f"{path}: not formatted; run: clang-format -i {path}" for path in wrong] or [checked.stderr]
