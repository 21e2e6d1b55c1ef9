"""Partitions of an image file, accessed without root and mounting: FAT boot partition with mtools,
ext4 system partition with debugfs. Writes are verified. Used by tools/flash image."""
import json
import os
import subprocess
import tempfile


class Refused(Exception):
    """Error message of one line, with the remedy."""


def run(*command, text=None, binary=False):
    """Output of a program; raises Refused with its last line on failure."""
    data = text.encode() if isinstance(text, str) else text
    done = subprocess.run(command, input=data, capture_output=True)
    if done.returncode != 0:
        lines = (done.stderr or done.stdout).decode(errors="replace").strip().splitlines()
        raise Refused(f"{command[0]}: {lines[-1] if lines else 'no reason given'}")
    return done.stdout if binary else done.stdout.decode(errors="replace")


class Image:
    """FAT boot partition and ext4 system partition of an image file."""

    def __init__(self, path):
        self.path = path
        try:
            table = json.loads(run("sfdisk", "--json", path))["partitiontable"]
        except (Refused, ValueError, KeyError):
            raise Refused("is not a disk image: no partition table")
        sector = int(table.get("sectorsize", 512))
        self.boot = self.root = None
        for part in table["partitions"]:
            start = int(part["start"]) * sector
            if start + int(part["size"]) * sector > os.path.getsize(path):
                raise Refused("is incomplete: its partition table exceeds its size;"
                              " download it again")
            with open(path, "rb") as file:
                file.seek(start)
                head = file.read(2048)
            if self.boot is None and head[510:512] == b"\x55\xaa" and b"FAT" in head[:90]:
                self.boot = f"{path}@@{start}"
            if self.root is None and len(head) == 2048 and head[1080:1082] == b"\x53\xef":
                self.root = f"{path}?offset={start}"
        if self.boot is None or self.root is None:
            raise Refused("lacks the FAT and ext4 partitions of Raspberry Pi OS:"
                          " download it again")

    # Boot partition.
    def read_boot(self, name):
        return run("mcopy", "-n", "-i", self.boot, f"::{name}", "-", binary=True)

    def make_boot_folder(self, name):
        found = subprocess.run(["mdir", "-b", "-i", self.boot, f"::{name}"], capture_output=True)
        if found.returncode != 0:
            run("mmd", "-i", self.boot, f"::{name}")

    def write_boot(self, name, text):
        try:
            run("mcopy", "-o", "-i", self.boot, "-", f"::{name}", text=text)
        except Refused as refused:
            raise Refused(f"{name} cannot be written to the boot partition: {refused}")
        if self.read_boot(name) != (text.encode() if isinstance(text, str) else text):
            raise Refused(f"{name} differs when read back: is the boot partition full?")

    # System partition.
    def debugfs(self, *commands, write=False):
        with tempfile.NamedTemporaryFile("w", suffix=".debugfs") as script:
            script.write("\n".join(commands) + "\n")
            script.flush()
            options = ["-w"] if write else []
            return run("debugfs", *options, "-f", script.name, self.root)

    def exists(self, path):
        return "Inode:" in self.debugfs(f"stat {path}")

    def read(self, path):
        with tempfile.TemporaryDirectory() as folder:
            self.debugfs(f"dump {path} {folder}/file")
            try:
                return open(f"{folder}/file", "rb").read()
            except OSError:
                raise Refused(f"{path} is missing inside: is it a Raspberry Pi OS image?")

    def make_folder(self, path):
        if path in ("", "/") or self.exists(path):
            return
        self.make_folder(os.path.dirname(path))
        self.debugfs(f"mkdir {path}", f"sif {path} mode 040755", f"sif {path} uid 0",
                     f"sif {path} gid 0", write=True)

    def write(self, path, data, mode=0o644):
        """Replaces the file, owned by root, and verifies it."""
        data = data.encode() if isinstance(data, str) else data
        self.make_folder(os.path.dirname(path))
        with tempfile.NamedTemporaryFile() as file:
            file.write(data)
            file.flush()
            commands = [f"rm {path}"] if self.exists(path) else []
            commands += [f"write {file.name} {path}", f"sif {path} mode 0{0o100000 | mode:o}",
                         f"sif {path} uid 0", f"sif {path} gid 0"]
            self.debugfs(*commands, write=True)
        if self.read(path) != data:
            raise Refused(f"{path} differs when read back: its system partition is full")

    def link(self, path, target):
        self.make_folder(os.path.dirname(path))
        self.debugfs(f"symlink {path} {target}", write=True)
        if target not in self.debugfs(f"stat {path}"):
            raise Refused(f"{path} differs when read back: its system partition is full")

    def check(self):
        done = subprocess.run(["e2fsck", "-fn", self.root], capture_output=True)
        if done.returncode != 0:
            lines = done.stdout.decode(errors="replace").strip().splitlines()
            raise Refused(f"its system partition is not clean: {lines[-1]}")
