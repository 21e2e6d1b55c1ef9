"""labgrid driver for the local machine: its shell, as SSHDriver is the shell of
another machine."""
import subprocess

import attr
from labgrid.driver.commandmixin import CommandMixin
from labgrid.driver.common import Driver
from labgrid.factory import target_factory
from labgrid.protocol import CommandProtocol
from labgrid.step import step


@target_factory.reg_driver
@attr.s(eq=False)
class LocalShellDriver(CommandMixin, Driver, CommandProtocol):
    """Runs commands in the start folder of pytest."""

    @Driver.check_active
    @step(args=["cmd"], result=True)
    def run(self, cmd, *, timeout=30.0, codec="utf-8", decodeerrors="strict"):
        return self._run(cmd, timeout=timeout, codec=codec, decodeerrors=decodeerrors)

    def _run(self, cmd, *, timeout=30.0, codec="utf-8", decodeerrors="strict"):
        done = subprocess.run(["/bin/sh", "-c", cmd], stdin=subprocess.DEVNULL, capture_output=True,
                              timeout=timeout)
        out, err = (text.decode(codec, decodeerrors).splitlines()
                    for text in (done.stdout, done.stderr))
        return out, err, done.returncode

    @Driver.check_active
    @step(args=["cmd"], result=True)
    def run_check(self, cmd, *, timeout=30.0, codec="utf-8", decodeerrors="strict"):
        return self._run_check(cmd, timeout=timeout, codec=codec, decodeerrors=decodeerrors)

    def get_status(self):
        return 1
