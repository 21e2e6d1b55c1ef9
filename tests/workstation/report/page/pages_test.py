#!/usr/bin/env python3
"""pages_test.py FIXTURE_PROGRAM BESS_TRAIN: each page that bess-train writes, in a headless
Chromium: it is drawn in whole, without complaint, and nothing hangs over at 1280 and 390 px; and
the student on it decides as the edge's.

Exit code 77 where Chromium is not installed (tools/setup --test installs it).
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest

import browser

FIXTURE = sys.argv.pop(1) if len(sys.argv) > 1 else ""
BESS_TRAIN = sys.argv.pop(1) if len(sys.argv) > 1 else ""
RUNS = ("", "ruled", "failed")  # folders of a run, of one with rules, of one that failed its proof
MANY = ("run-10", "run-9", "ruled", "losing", "other-days", "failed", "stopped", "edited")
DRAWN = ("[...document.querySelectorAll('canvas.map')]"
         ".every((canvas) => canvas.dataset.complete === 'true')")


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        subprocess.run([FIXTURE, cls.folder.name], check=True)
        cls.browser = browser.Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        cls.folder.cleanup()

    def look_at(self, path, drawn):
        page = browser.Page(self.browser)
        page.call("Page.navigate", {"url": "file://" + os.path.join(self.folder.name, path)})
        page.wait("document.readyState === 'complete' && document.querySelector('table')")
        page.wait(drawn)
        for width in (1280, 390):
            page.resize(width, 900)
            page.wait(drawn)
            # Laid out anew some time after the resize; what hangs over never gets there.
            page.wait(f"document.documentElement.scrollWidth === {width}")
        self.assertEqual(page.complaints(), [], path)
        return page

    def test_reports_of_runs_show_their_figures(self):
        for run in RUNS:
            page = self.look_at(os.path.join(run, "report.html"), DRAWN)
            self.assertGreater(page.run("document.querySelectorAll('canvas').length"), 2, run)

    def test_students_on_the_page_are_those_of_the_edge_to_the_bit(self):
        with open(os.path.join(self.folder.name, "expected.json"), encoding="utf-8") as file:
            students = json.load(file)["students"]
        page = self.look_at("report.html", DRAWN)
        for name, student in students.items():
            self.assertGreaterEqual(len(student["answers"]), 4000)
            self.assertEqual(page.run(f"""(() => {{
              const map = page.map.maps.find((map) => map.name === {json.dumps(name)});
              return {json.dumps(student["answers"])}.filter(
                ([minute, quarterHour, contextClass, soc, price, ...answer]) => {{
                  const context = {{minute, quarterHour, contextClass}};
                  const action = map.student.decide(context, soc, price);
                  return [...map.student.logits, action].join() !== answer.join();
                }}).length;
            }})()"""), 0, name)

    def test_backtests_and_many_runs_are_tables(self):
        subprocess.run([BESS_TRAIN, "runs", "compare", *("many/" + name for name in MANY), "--html",
                        "many.html"],
                       cwd=self.folder.name, check=True, stdout=subprocess.DEVNULL)
        for path in ("backtest/backtest.html", "many.html"):
            page = self.look_at(path, "true")
            self.assertGreater(page.run("document.querySelectorAll('tbody tr').length"), 3, path)


if __name__ == "__main__":
    if browser.chromium() is None:
        print("skipped: chromium is not installed (tools/setup --test)")
        sys.exit(77)
    unittest.main()
