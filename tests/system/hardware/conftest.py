"""Options of the tests on places, and the place fixture."""
import base64
import shlex
import shutil
from pathlib import Path

import pytest

TREE = Path(__file__).resolve().parents[3]


def pytest_addoption(parser):
    group = parser.getgroup("bess", "where the edge runs, and whether a real battery is driven")
    group.addoption("--place", choices=("local", "emulated", "guest", "pi"), default="local")
    group.addoption("--programs",
                    help="folder of bess-edge and bess-sim, instead of that in places.yaml")
    group.addoption("--real", metavar="CONFIG",
                    help="settings of bess-edge for a real battery, a path on the place")
    group.addoption("--yes-drive-real-battery", action="store_true",
                    help="without it a real battery is only read")
    group.addoption("--real-power-w", type=int, default=500,
                    help="no order is larger (default: 500)")
    group.addoption("--real-soc-min", type=float, default=0.3,
                    help="no discharge below (default: 0.3)")
    group.addoption("--real-soc-max", type=float, default=0.7,
                    help="no charge above (default: 0.7)")
    group.addoption("--real-cycles", type=int, default=3, help="of two minutes (default: 3)")


class Place:
    """A machine with bess on it, through labgrid: commands, files, programs in the background."""

    def __init__(self, command, programs, map_path):
        self.command = command
        self.edge, self.sim, self.map = f"{programs}/bess-edge", f"{programs}/bess-sim", map_path
        self.prices = f"{programs}/bess-prices"
        self.folder = self.run("mktemp -d").strip()
        self.map = self.run(f"readlink -f {map_path}").strip()
        self.children = []

    def attempt(self, command, timeout=60):
        """Exit code and text of both streams."""
        out, err, code = self.command.run(f"{command} 2>&1", timeout=timeout)
        return code, "\n".join(out + err)

    def run(self, command, timeout=60):
        code, text = self.attempt(command, timeout)
        assert code == 0, f"{command}: exit code {code}\n{text}"
        return text

    def write(self, path, text):
        """In one line, as a serial console requires."""
        self.run(
            f"echo {base64.b64encode(text.encode()).decode()} | base64 -d > {shlex.quote(path)}")

    def read(self, path):
        return self.run(f"cat {shlex.quote(path)}")

    def start(self, command, log):
        """Process id; both streams go to the file."""
        pid = int(self.run(f"nohup {command} >{log} 2>&1 </dev/null & echo $!").split()[-1])
        self.children.append(pid)
        return pid

    def fetch_prices(self, config):
        """Starts bess-prices for that configuration, unless it runs already."""
        return self.start(f"{self.prices} --config {config}", f"{self.folder}/prices.log")

    def is_running(self, pid):
        """A zombie process counts as ended."""
        code, state = self.attempt(f"sed -n 's/^State:.//p' /proc/{pid}/status")
        return code == 0 and state.strip() != "" and not state.startswith(("Z", "X"))

    def clean_up(self):
        for pid in self.children:
            self.attempt(f"kill {pid}")
        self.attempt(f"rm -rf {shlex.quote(self.folder)}")


@pytest.fixture(scope="session")
def place(env, pytestconfig):
    name = pytestconfig.getoption("--place")
    target = env.get_target(name)
    if name == "emulated" and shutil.which("qemu-aarch64-static") is None:
        pytest.skip("qemu-aarch64-static is not installed: tools/setup --cross installs it")
    if name == "guest":
        kernel = env.config.get_image_path("kernel")
        if not Path(kernel).exists() or not (TREE / "build-aarch64/guest/initramfs.cpio").exists():
            pytest.skip("the guest is not built: run tests/system/soak/aarch64 once")
        power = target.get_driver("QEMUDriver")
        target.activate(power)
        power.on()
    command = target.get_driver("CommandProtocol")
    target.activate(command)
    programs, map_path = (env.config.get_target_option(name, option)
                          for option in ("programs", "map"))
    found = Place(command, pytestconfig.getoption("--programs") or programs, map_path)
    yield found
    found.clean_up()
