"""An X server that draws into memory."""

import os
import shutil
import subprocess


def start(test_class):
    """Its display's name, for as long as the tests of a class run; None without Xvfb."""
    if not shutil.which("Xvfb"):
        return None
    reading, writing = os.pipe()
    screen = ["-screen", "0", "1280x1024x24", "-nolisten", "tcp", "-noreset"]
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(writing), *screen],
        pass_fds=[writing],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    test_class.addClassCleanup(server.wait)
    test_class.addClassCleanup(server.terminate)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        return ":" + pipe.readline().strip()
