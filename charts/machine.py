"""What the figures were measured on, and with."""
import os, re, subprocess

PACKAGES = ["libbullet-dev", "libode-dev", "libmujoco-dev", "libsimbody-dev", "libeigen3-dev", "libc6", "chromium"]


def output_of(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def processor():
    with open("/proc/cpuinfo") as file:
        found = re.findall(r"^model name\s*: (.*)$", file.read(), re.M)
    return f"{found[0] if found else 'unknown'}, {os.cpu_count()} cores seen, one used"


def cached(build, name):
    with open(os.path.join(build, "CMakeCache.txt")) as file:
        found = re.search(rf"^{name}:\w+=(.*)$", file.read(), re.M)
    return found[1].strip() if found else ""


def compiler(build):
    return output_of(cached(build, "CMAKE_CXX_COMPILER"), "--version").splitlines()[0]


def versions():
    lines = output_of("dpkg-query", "-W", "-f", "${Package} ${Version} ${db:Status-Status}\n", *PACKAGES).splitlines()
    return ", ".join(" ".join(line.split()[:2]) for line in lines if line.endswith(" installed"))


def machine(build, source, date):
    """(what, which) pairs."""
    program = output_of(os.path.join(build, "bin", "cradle"), "--version")
    commit = output_of("git", "-C", source, "describe", "--always", "--dirty")
    return [("Date", date), ("Machine", output_of("uname", "-srm")), ("Processor", processor()), ("Cradle", f"{program}, commit {commit}"),
            ("Compiler", f"{compiler(build)}, {cached(build, 'CMAKE_BUILD_TYPE')}, {cached(build, 'CMAKE_CXX_FLAGS_RELEASE')}"),
            ("Packages", versions())]
