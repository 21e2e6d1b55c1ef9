#!/usr/bin/env python3
"""Monitoring files (tools/delivery/monitoring): promtool and amtool read the files and run
the unit tests of the rules.

  monitoring_test.py SOURCE

77: a checker is not installed.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

CHECKERS = ("promtool", "amtool")
FILES = "tools/delivery/monitoring"
RULES_TEST = "tests/unit/tools/delivery/monitoring/bess_rules_test.yml"


def read(*path):
    with open(os.path.join(SOURCE, *path), encoding="utf-8") as file:
        return file.read()


class Monitoring(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="bess-monitoring-")
        self.addCleanup(shutil.rmtree, self.folder)
        self.files = os.path.join(self.folder, "monitoring")
        shutil.copytree(os.path.join(SOURCE, FILES), self.files)
        shutil.copy(os.path.join(SOURCE, RULES_TEST), self.files)

    def check(self, *command):
        done = subprocess.run(command, cwd=self.files, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_checkers_accept_the_files(self):
        self.check("promtool", "check", "config", "prometheus.yml")
        self.check("promtool", "check", "rules", "bess_rules.yml")
        self.check("promtool", "test", "rules", "bess_rules_test.yml")
        self.check("amtool", "check-config", "alertmanager.yml")

    def test_each_rule_is_tested(self):
        alerts = set(re.findall(r"- alert: (\w+)", read(FILES, "bess_rules.yml")))
        tests = read(RULES_TEST)
        self.assertEqual(alerts, set(re.findall(r'alertname="(\w+)"', tests)))


if __name__ == "__main__":
    missing = [checker for checker in CHECKERS if shutil.which(checker) is None]
    if missing:
        print(f"skipped: no {missing[0]}: run tools/setup --test")
        sys.exit(77)
    SOURCE = sys.argv[1]
    del sys.argv[1]
    unittest.main(verbosity=2)
