"""The files of the project."""

import pathlib
import subprocess

BUILT = {"build", "out", ".git", ".cache"}


def paths(root):
    """All files that git tracks or would, or those of an unpacked archive; relative to `root`."""
    command = ["git", "-c", "safe.directory=*", "-C", str(root), "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    try:
        listed = subprocess.run(command, check=True, capture_output=True).stdout.decode().split("\0")
    except (OSError, subprocess.CalledProcessError):
        listed = [str(p.relative_to(root)) for p in root.rglob("*") if not BUILT & set(p.relative_to(root).parts)]
    return sorted(p for p in listed if p and (root / p).is_file())


def read_all(root):
    """Path to text, for every file that is text."""
    files = {}
    for path in paths(pathlib.Path(root)):
        data = (pathlib.Path(root) / path).read_bytes()
        if b"\0" not in data[:8000]:
            files[path] = data.decode("utf-8", errors="replace")
    return files


def is_cpp(path):
    return path.endswith((".cpp", ".hpp"))
