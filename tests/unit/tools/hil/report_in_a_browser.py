"""Report page of bess-hil in a browser: charts are drawn with their panels in order, nothing is
loaded or wider than the window, and the console stays silent.

  report_in_a_browser.py BESS_HIL SCENARIOS
"""
import os
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../../workstation/report/page"))
import browser  # noqa: E402

WRONG = "\n[[expect]]\nfrom_min = 10\ncommand = 'none'\n"


class ReportInABrowser(unittest.TestCase):
    def test_charts(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        wrong, report = (os.path.join(folder.name, name) for name in ("wrong.toml", "report.html"))
        with open(wrong, "w", encoding="utf-8") as file:
            with open(os.path.join(SCENARIOS, "bus_silence.toml"), encoding="utf-8") as scenario:
                file.write(scenario.read() + WRONG)
        subprocess.run([BESS_HIL, "run", wrong, os.path.join(SCENARIOS, "edge_killed.toml"),
                        "--report", report], check=False, capture_output=True)
        chromium = browser.Browser()
        self.addCleanup(chromium.close)
        for width_px, dark in ((1280, False), (390, True)):
            with self.subTest(width_px=width_px, dark=dark):
                page = browser.Page(chromium, width_px, dark=dark)
                page.open(report)
                self.assertEqual(page.run("""[...shownCharts.values()].map(({chart}) =>
                  Object.values(chart.scales).filter((scale) => scale.axis === "y")
                    .sort((a, b) => a.top - b.top).map((scale) => scale.id).join(" "))"""),
                                 2 * ["price power soc mode"])
                self.assertEqual(page.run("""[...document.querySelectorAll("canvas")].map((c) =>
                  c.getContext("2d").getImageData(0, 0, c.width, c.height).data.some(Boolean))"""),
                                 [True, True])
                self.assertEqual(page.run("performance.getEntriesByType('resource').length"), 0)
                self.assertLessEqual(page.run("document.documentElement.scrollWidth"), width_px)
                self.assertEqual(page.complaints(), [])
                page.close()


if __name__ == "__main__":
    if browser.chromium() is None:
        print("skipped: no Chromium: run tools/setup --test")
        sys.exit(77)
    SCENARIOS = sys.argv.pop()
    BESS_HIL = sys.argv.pop()
    unittest.main(verbosity=2)
