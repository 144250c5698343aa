"""tools/spy against a robot that sends one of each of our messages: every channel decodes, and the window shows it.

spy_test.py PUBLISHER SPY FOLDER. Runs in a network of its own. Exit status 77, with the reason, where that, Java or the
virtual screen is missing.
"""

import os
import pathlib
import shutil
import subprocess
import sys

URL = "udpm://239.255.76.67:7667"
CHANNELS = """SCAN LRF_RAW_RX LRF_RAW_TX MOTION POSE LASER_POSE POSE_COVARIANCE MAP_TO_ODOM MAP_TILE MAP HEALTH LRF_STATUS
    SCAN_POINTS TILT SCAN_AGAIN MOTION_AGAIN""".split()
SKIPPED = 77


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(SKIPPED)


def enter_private_network():
    """Starts this script again in a network where multicast stays on the loopback device."""
    if os.environ.get("ODOLESS_PRIVATE_NETWORK"):
        return
    unshare = ["unshare", "--net"] if os.geteuid() == 0 else ["unshare", "--net", "--map-root-user"]
    raised = ["sh", "-c", 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"', "sh"]
    if subprocess.run(unshare + raised + ["true"], capture_output=True).returncode != 0:
        skip("no private network: unshare, or ip, is refused here")
    os.environ["ODOLESS_PRIVATE_NETWORK"] = "1"
    os.execvp(unshare[0], unshare + raised + [sys.executable] + sys.argv)


def need(*programs):
    for program in programs:
        if shutil.which(program) is None:
            skip(f"{program} is missing: tools/setup installs it")


def with_robot(publisher, *command):
    robot = subprocess.Popen([publisher, URL, "60"])
    try:
        done = subprocess.run(command, capture_output=True, text=True)
    finally:
        robot.terminate()
        robot.wait()
    print(done.stdout, done.stderr, sep="")
    return done


def colours(picture):
    """How many different colours a picture has: an empty window has few."""
    counted = subprocess.run(["identify", "-format", "%k", str(picture)], capture_output=True, text=True, check=True)
    return int(counted.stdout)


def main():
    publisher, spy, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    need("java", "javac", "lcm-gen", "Xvfb", "import", "identify")
    enter_private_network()
    subprocess.run([spy, "--build"], check=True)

    named = ["ODOLESS_" + channel for channel in CHANNELS]
    checked = with_robot(publisher, spy, "--url", URL, "--check", "4", *named)
    assert checked.returncode == 0, "a channel was silent, or a message did not decode"

    # The check itself: it must fail where something is wrong.
    missing = with_robot(publisher, spy, "--url", URL, "--check", "2", "ODOLESS_NOT_THERE")
    assert missing.returncode == 1 and "nothing on ODOLESS_NOT_THERE" in missing.stdout, "a silent channel was not noticed"
    silent = subprocess.run([spy, "--url", "udpm://239.255.76.67:7668", "--check", "1"], capture_output=True)
    assert silent.returncode == 1, "silence was not noticed"

    picture = folder / "spy.png"
    picture.unlink(missing_ok=True)
    shot = with_robot(publisher, spy, "--url", URL, "--screenshot", str(picture), "8")
    assert shot.returncode == 0, "no screenshot"
    types = len(list((pathlib.Path(spy).parents[1] / "firmware" / "messages").glob("*.lcm")))
    assert f"Found {types} LCM types" in shot.stdout, "lcm-spy did not find our types"
    assert colours(picture) > 100, "the windows are empty"
    print(f"the picture is {picture}")


main()
