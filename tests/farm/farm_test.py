#!/usr/bin/env python3
"""A cluster of three nodes on this one machine, of which one is killed in the middle of a data set.

    farm_test.py PROGRAM SOURCE_FOLDER

munged, slurmctld and three slurmd run with a configuration of their own, on ports of 127.0.0.1, without systemd.
`cradle submit slurm` gives them the samples; one slurmd and all that it has started are ended with -9. Every sample
must be there, once, with the hashes of a run on one machine. Debian packages: slurm-wlm, munge.
"""
import json, os, shutil, signal, socket, subprocess, sys, tempfile, time

PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
SAMPLES = 60
NODES = ("n1", "n2", "n3")
COMMAND = ("sample", os.path.join(SOURCE, "distributions", "dropped_shapes.json"), "-n", str(SAMPLES), "--seed", "3",
           "--passes", "rgb,depth", "--size", "160x120")


def configuration(folder, user, ports):
    """slurm.conf; a node counts as lost after five seconds."""
    lines = [
        "ClusterName=farm", f"SlurmctldHost={socket.gethostname()}(127.0.0.1)", f"SlurmUser={user}", f"SlurmdUser={user}",
        "AuthType=auth/munge", f"AuthInfo=socket={folder}/munge.socket", f"SlurmctldPort={ports[0]}",
        f"SlurmctldPidFile={folder}/slurmctld.pid", f"SlurmctldLogFile={folder}/slurmctld.log",
        f"SlurmdPidFile={folder}/%n.pid", f"SlurmdLogFile={folder}/%n.log", f"SlurmdSpoolDir={folder}/spool_%n",
        f"StateSaveLocation={folder}/state", "CommunicationParameters=NoInAddrAny", "ProctrackType=proctrack/linuxproc",
        "TaskPlugin=task/none", "JobAcctGatherType=jobacct_gather/none", "MpiDefault=none", "SlurmdTimeout=5",
        "SlurmctldTimeout=30", "KillWait=2", "ReturnToService=2", "SelectType=select/cons_tres",
        "SelectTypeParameters=CR_Core", "SchedulerParameters=batch_sched_delay=1,sched_interval=5",
        "PartitionName=all Nodes=ALL Default=YES State=UP MaxTime=INFINITE"]
    for node, port in zip(NODES, ports[1:]):
        lines.append(f"NodeName={node} NodeHostname={socket.gethostname()} NodeAddr=127.0.0.1 Port={port} CPUs=1 State=UNKNOWN")
    return "\n".join(lines) + "\n"


def free_ports(count):
    """Ports that nothing listens on."""
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


def processes_of(node):
    """Ids of the scripts and programs that a node runs, whose environment names it, and of the steps above them."""
    found = set()
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/environ", "rb") as file:
                if f"SLURMD_NODENAME={node}\0".encode() not in file.read():
                    continue
            with open(f"/proc/{name}/stat", encoding="utf-8", errors="replace") as file:
                parent = file.read().rsplit(")", 1)[1].split()[1]
            with open(f"/proc/{parent}/comm", encoding="utf-8") as file:
                found |= {int(name), int(parent)} if file.read().startswith("slurmstepd") else {int(name)}
        except OSError:
            continue  # it has ended, or is of another user
    return found


class Farm:
    """The daemons; they end with the object."""

    def __init__(self, folder):
        self.folder, self.processes = folder, {}
        self.environment = {**os.environ, "SLURM_CONF": f"{folder}/slurm.conf"}
        user = subprocess.run(["id", "-un"], capture_output=True, text=True, check=True).stdout.strip()
        for made in ("state", *(f"spool_{node}" for node in NODES)):
            os.mkdir(os.path.join(folder, made))
        with open(f"{folder}/slurm.conf", "w", encoding="utf-8") as file:
            file.write(configuration(folder, user, free_ports(1 + len(NODES))))
        key = f"{folder}/munge.key"
        with open(os.open(key, os.O_WRONLY | os.O_CREAT, 0o400), "wb") as file:
            file.write(os.urandom(128))
        self.start("munged", "--foreground", "--force", f"--socket={folder}/munge.socket", f"--key-file={key}",
                   f"--log-file={folder}/munged.log", f"--pid-file={folder}/munged.pid", f"--seed-file={folder}/munge.seed")
        self.wait("munged", lambda: os.path.exists(f"{folder}/munge.socket"), 10)
        self.start("slurmctld", "-D", "-f", f"{folder}/slurm.conf")
        for node in NODES:
            self.start(node, "-D", "-N", node, "-f", f"{folder}/slurm.conf", program="slurmd")
        self.wait("three nodes", lambda: self.ask("sinfo", "-h", "-o", "%D %T").split() == ["3", "idle"], 60)

    def start(self, name, *arguments, program=None):
        path = shutil.which(program or name, path=os.environ["PATH"] + ":/usr/sbin:/sbin")
        log = open(os.path.join(self.folder, f"{name}.out"), "w", encoding="utf-8")
        self.processes[name] = subprocess.Popen([path, *arguments], stdout=log, stderr=log, env=self.environment,
                                                start_new_session=True)

    def ask(self, *command):
        return subprocess.run(command, capture_output=True, text=True, env=self.environment, timeout=60).stdout

    def wait(self, what, is_so, seconds):
        end = time.monotonic() + seconds
        while not is_so():
            if time.monotonic() > end:
                raise TimeoutError(f"no {what} after {seconds} s; logs are in {self.folder}")
            time.sleep(0.3)

    def kill(self, node):
        """A node that loses its power: its daemon and all that it runs. The number of processes."""
        daemon = self.processes.pop(node)
        daemon.kill()
        daemon.wait()
        running = processes_of(node)
        for process in running:
            os.kill(process, signal.SIGKILL)
        return 1 + len(running)

    def __enter__(self):
        return self

    def __exit__(self, *unused):
        self.ask("scancel", "--user", str(os.getuid()))
        for process in reversed(self.processes.values()):
            process.terminate()
        for process in self.processes.values():
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()


def index(folder):
    with open(os.path.join(folder, "index.json"), encoding="utf-8") as file:
        return json.load(file)["samples"]


def main():
    folder = tempfile.mkdtemp(prefix="cradle_farm_")
    one, many = os.path.join(folder, "one"), os.path.join(folder, "many")
    print("on one machine ...", flush=True)
    subprocess.run([PROGRAM, *COMMAND, "-o", one, "-j", "2", "-qq"], check=True)
    with Farm(folder) as farm:
        print("on three nodes ...", flush=True)
        written = subprocess.run([PROGRAM, "submit", "slurm", "--run", *COMMAND, "-o", many], env=farm.environment,
                                 capture_output=True, text=True)
        print(written.stdout + written.stderr, end="", flush=True)
        assert written.returncode == 0
        tasks = int(written.stdout.split("sample: ")[1].split()[0])
        assert tasks >= 3, "one task for each node at least"
        done = lambda: sum(os.path.exists(os.path.join(many, f"sample_{i:06}", "sample.json")) for i in range(SAMPLES))
        farm.wait("quarter of the samples", lambda: done() >= SAMPLES // 4, 600)
        running = farm.ask("squeue", "-h", "-t", "R", "-w", "n2", "-o", "%i").split()
        assert running, "n2 has nothing to do"
        killed = farm.kill("n2")
        assert killed >= 4, "a daemon, a step, its script and the program"
        print(f"n2 is killed, with {killed} processes, in the middle of {running[0]}, after {done()} samples", flush=True)
        farm.wait("end", lambda: not farm.ask("squeue", "-h").strip(), 900)
        restarts = farm.ask("scontrol", "show", "job")
    expected, found = index(one), index(many)
    assert [sample["sample"] for sample in found] == list(range(SAMPLES)), "each sample once"
    for a, b in zip(expected, found):
        assert a == b, f"sample {a['sample']} is another one: {a} {b}"
    compared = subprocess.run([PROGRAM, "compare", os.path.join(one, "sample_000007"), os.path.join(many, "sample_000007")])
    assert compared.returncode == 0, "the pictures are others"
    assert "Restarts=1" in restarts or "Restarts=2" in restarts, "no job was started again"
    shutil.rmtree(folder)
    print(f"{SAMPLES} samples in {tasks} tasks, each there once, equal to those of one machine")


if __name__ == "__main__":
    main()
