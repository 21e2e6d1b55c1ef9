#!/usr/bin/env python3
"""What watches batteries (tools/monitoring): promtool and amtool read the files and run the unit
tests of the rules, and the names in rules and dashboard are those of metrics that exist.

  monitoring_test.py SOURCE SCENARIO_METRICS

77: a checker is not installed.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

CHECKERS = ("promtool", "amtool")
# Of this machine, an upgrade, a student by outlook, a fleet's inventory: no scenario has them.
ELSEWHERE = {"bess_card_used_life_ratio", "bess_card_spare_level", "bess_file_system_errors",
             "bess_update_trouble", "bess_outlook_planned_timestamp_seconds",
             "bess_expected_student_info"}


def read(*path):
    with open(os.path.join(SOURCE, *path), encoding="utf-8") as file:
        return file.read()


class Monitoring(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="bess-monitoring-")
        self.addCleanup(shutil.rmtree, self.folder)
        self.files = os.path.join(self.folder, "monitoring")
        shutil.copytree(os.path.join(SOURCE, "tools/monitoring"), self.files)
        shutil.copy(os.path.join(SOURCE, "tests/tools/monitoring/bess_rules_test.yml"), self.files)

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
        alerts = set(re.findall(r"- alert: (\w+)", read("tools/monitoring/bess_rules.yml")))
        tests = read("tests/tools/monitoring/bess_rules_test.yml")
        self.assertEqual(alerts, set(re.findall(r'alertname="(\w+)"', tests)))

    def test_rules_and_dashboard_ask_for_what_exists(self):
        lines = subprocess.run([SCENARIO_METRICS, os.path.join(SOURCE, "tests/scenarios")],
                               stdout=subprocess.PIPE, check=True, timeout=300).stdout
        exist = {name.decode() for name in re.findall(rb"^(bess_\w+)", lines, re.M)} | ELSEWHERE
        rules = "\n".join(re.findall(r"^ +(?:expr: .*|.*\[\d+m\].*)$",
                                     read("tools/monitoring/bess_rules.yml"), re.M))
        panels = json.loads(read("tools/monitoring/grafana_dashboard.json"))["panels"]
        asked = [target["expr"] for panel in panels for target in panel.get("targets", [])]
        self.assertGreater(len(asked), 10)
        for text in [rules, *asked]:
            self.assertEqual(set(re.findall(r"\b(bess_\w+)", text)) - exist, set())


if __name__ == "__main__":
    missing = [checker for checker in CHECKERS if shutil.which(checker) is None]
    if missing:
        print(f"skipped: no {missing[0]}: run tools/setup --test")
        sys.exit(77)
    SOURCE, SCENARIO_METRICS = sys.argv[1:3]
    del sys.argv[1:3]
    unittest.main(verbosity=2)
