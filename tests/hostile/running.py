"""A program as a test meets it: how a run ended and what it took, and what a folder holds before and after."""
import os, subprocess, tempfile, threading

MOST_MEMORY = 1 << 30  # bytes
# Of CPU time, before an input is refused. Alone on a machine it is 2 s at most; where others share its caches and its
# memory, the same work takes several times as much. What hangs, or grows with the square of the input, takes far more.
MOST_SECONDS = 10.0
PATIENCE = 60          # s, for machines that do other things


def read(path):
    with open(path, "rb") as file:
        return file.read()


def write(path, content):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as file:
        file.write(content.encode() if isinstance(content, str) else content)
    return path


def everything(folder):
    """Name and content of all that is in a folder; of large files the size, of links the target."""
    found = {}
    for place, folders, names in os.walk(folder):
        for name in names + folders:
            path = os.path.join(place, name)
            if os.path.islink(path):
                content = os.readlink(path)
            elif os.path.isfile(path):
                content = read(path) if os.path.getsize(path) < 1 << 26 else os.path.getsize(path)
            else:
                content = None
            found[os.path.relpath(path, folder)] = content
    return found


class Ended:
    """A run that has ended: exit code (minus the signal that killed it), texts, CPU time (s) and memory (bytes), both
    with those of the processes that it started and waited for. `settings` are added to the environment."""
    def __init__(self, program, arguments, folder, settings={}):
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as error:
            process = subprocess.Popen([program, *arguments], stdin=subprocess.DEVNULL, stdout=out, stderr=error, cwd=folder,
                                       env={**os.environ, **settings})
            timer = threading.Timer(PATIENCE, process.kill)
            timer.start()
            self.pid = process.pid
            _, status, usage = os.wait4(process.pid, 0)
            timer.cancel()
            process.returncode = self.code = os.waitstatus_to_exitcode(status)
            self.seconds, self.memory = usage.ru_utime + usage.ru_stime, 1024 * usage.ru_maxrss
            for file in (out, error):
                file.seek(0)
            self.out, self.error = out.read().decode(errors="replace"), error.read().decode(errors="replace")
