"""A system of its own to install packages in, which costs nothing and is gone when the process ends: an overlay over this
machine's root, or over a clean one that debootstrap made, in a mount namespace. What was changed in it can be listed."""

import filecmp
import os
import subprocess
import tempfile

ENTERED = "ODOLESS_TEST_IN_NAMESPACE"
# What any installation leaves: the databases of dpkg and what is made from them, logs, and backups of the users' files.
UNREMARKABLE = ("var/lib/dpkg/", "var/log/", "var/cache/", "var/lib/apt/", "etc/.pwd.lock", "etc/passwd-", "etc/group-",
                "etc/shadow-", "etc/gshadow-", "etc/subuid-", "etc/subgid-", "etc/ld.so.cache", "tmp/", "run/", "etc/resolv.conf")


def enter_namespace(arguments):
    """Starts the program anew where its mounts are nobody else's. Returns why that cannot be; otherwise only in there."""
    if os.environ.get(ENTERED):
        return ""
    if os.geteuid() != 0:
        return "needs root"
    command = ["unshare", "--mount", "--propagation", "private"]
    try:
        outcome = subprocess.run(command + ["true"], capture_output=True, text=True, check=False)
    except FileNotFoundError:
        return "unshare is not on this machine"
    if outcome.returncode != 0:
        return "no mount namespace here: " + outcome.stderr.strip()
    os.execvpe("unshare", command + arguments, {**os.environ, ENTERED: "1"})


class Root:
    def __init__(self, lower):
        self.lower = lower
        folder = tempfile.mkdtemp()
        self.problem = self._mount(folder, "-t", "tmpfs", "tmpfs")
        self.path, self.upper = os.path.join(folder, "root"), os.path.join(folder, "upper")
        work = os.path.join(folder, "work")
        for path in (self.path, self.upper, work):
            os.makedirs(path)
        self.problem = self.problem or self._mount(
            self.path, "-t", "overlay", "overlay", "-o", f"lowerdir={lower},upperdir={self.upper},workdir={work}")
        for name in ("proc", "dev"):
            self.problem = self.problem or self._mount(self.at(name), "--rbind", "/" + name)
        for name in ("run", "tmp"):
            self.problem = self.problem or self._mount(self.at(name), "-t", "tmpfs", "-o", "mode=1777", "tmpfs")

    @staticmethod
    def _mount(place, *what):
        return subprocess.run(["mount", *what, place], capture_output=True, text=True, check=False).stderr.strip()

    def at(self, path):
        return os.path.join(self.path, path.lstrip("/"))

    def text(self, path):
        with open(self.at(path), encoding="utf-8") as file:
            return file.read()

    def command(self, *words, user=None):
        """What runs `words` in here, as root or as a user of this system."""
        as_user = ["setpriv", "--reuid", user, "--regid", user, "--init-groups"] if user else []
        return ["chroot", self.path, *as_user, "env", "PATH=/usr/sbin:/usr/bin:/sbin:/bin", "LC_ALL=C",
                "DEBIAN_FRONTEND=noninteractive", *words]

    def run(self, *words, user=None, timeout=120):
        return subprocess.run(self.command(*words, user=user), capture_output=True, text=True, timeout=timeout, check=False)

    def changed(self):
        """Files that are others than before, and folders of odoless; but for what any installation leaves."""
        found = []
        for folder, folders, files in os.walk(self.upper):
            inside = os.path.relpath(folder, self.upper)
            found += [os.path.normpath(os.path.join(inside, name)) for name in folders if "odoless" in name]
            found += [path for path in (os.path.normpath(os.path.join(inside, name)) for name in files) if self._is_new(path)]
        return sorted(path for path in found if not path.startswith(UNREMARKABLE))

    def _is_new(self, path):
        before, now = os.path.join(self.lower, path), os.path.join(self.upper, path)
        return not (os.path.isfile(before) and os.path.isfile(now) and filecmp.cmp(before, now, shallow=False))
