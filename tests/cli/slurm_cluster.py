# SPDX-License-Identifier: GPL-3.0-or-later
"""A Slurm of its own on the loopback of this machine, for the time of a test."""
import os
import pathlib
import secrets
import shutil
import socket
import subprocess
import tempfile
import time

CONFIGURATION = """ClusterName=millpose
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
ReturnToService=2
SlurmdParameters=config_overrides
SchedulerParameters=bf_interval=1,sched_min_interval=0
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=parts Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


class Cluster:
    """munged, slurmctld and slurmd of their own, with `cpus` claimed whatever the machine has. `environment` is what
    sbatch and squeue need. Needs root and Debian's slurm-wlm and munge."""

    def __init__(self, cpus):
        assert os.geteuid() == 0, "slurmd and munged need root"
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="millpose-slurm."))
        self.folder.chmod(0o755)
        self.processes = []
        self.environment = {**os.environ, "SLURM_CONF": str(self.folder / "slurm.conf")}
        try:
            self.start_munge()
            self.start_slurm(cpus)
        except BaseException:
            self.close()
            raise

    def start(self, *command, **options):
        with open(self.folder / f"{pathlib.Path(command[0]).name}.out", "wb") as output:
            self.processes.append(subprocess.Popen([str(word) for word in command], stdout=output, stderr=output,
                                                   stdin=subprocess.DEVNULL, start_new_session=True, **options))

    def start_munge(self):
        place = self.folder / "munge"
        place.mkdir()
        (place / "key").write_bytes(secrets.token_bytes(1024))
        (place / "key").chmod(0o400)
        for path in (place, place / "key"):
            shutil.chown(path, "munge", "munge")
        files = [f"--{name}={place / file}" for name, file in (
            ("key-file", "key"), ("socket", "socket"), ("pid-file", "pid"), ("log-file", "log"), ("seed-file", "seed"))]
        self.start("munged", "--foreground", *files, user="munge", group="munge", extra_groups=[])
        self.wait(lambda: (place / "socket").exists(), "munged")

    def start_slurm(self, cpus):
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        host = socket.gethostname().split(".")[0]
        (self.folder / "slurm.conf").write_text(CONFIGURATION.format(
            folder=self.folder, host=host, cpus=cpus, ports=free_ports(2)), encoding="utf-8")
        self.start("slurmctld", "-D", "-f", self.folder / "slurm.conf", env=self.environment)
        self.start("slurmd", "-D", "-f", self.folder / "slurm.conf", "-N", host, env=self.environment)
        self.wait(lambda: self.run("sinfo", "--noheader", "--format=%t").strip() == "idle", "slurmd")

    def run(self, *command):
        return subprocess.run(command, capture_output=True, text=True, env=self.environment, check=False, timeout=60).stdout

    def wait(self, is_there, who):
        deadline = time.monotonic() + 60
        while not is_there():
            dead = [process.args for process in self.processes if process.poll() is not None]
            if dead or time.monotonic() > deadline:
                logs = "".join(f"{path}:\n{path.read_text(errors='replace')[-2000:]}\n" for path in sorted(
                    [*self.folder.glob("*.out"), *self.folder.glob("*.log"), *self.folder.glob("munge/log")]))
                raise AssertionError(f"{who} does not come up; ended: {dead}\n{logs}")
            time.sleep(0.1)

    def close(self):
        for process in reversed(self.processes):
            process.terminate()
            try:
                process.wait(timeout=20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)
