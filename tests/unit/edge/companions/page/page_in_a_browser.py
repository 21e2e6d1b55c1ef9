"""Smoke test of bess-page in a browser: the state is shown, the charts are drawn, the console stays
silent, and nothing is wider than the window.

  page_in_a_browser.py PAGE_SITE BESS_PAGE
"""
import os
import subprocess
import sys
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../../../workstation/report/page"))
import browser  # noqa: E402

WIDTHS_PX = (1280, 390)


class PageInABrowser(unittest.TestCase):
    def start(self, *words, **pipes):
        program = subprocess.Popen(words, stdout=subprocess.PIPE, text=True, **pipes)
        self.addCleanup(program.communicate, timeout=30)
        return program

    def test_smoke(self):
        site = self.start(PAGE_SITE, stdin=subprocess.PIPE)
        server = self.start(BESS_PAGE, "--config", site.stdout.readline().strip(), "--port", "0")
        self.addCleanup(server.terminate)
        url = server.stdout.readline().split()[-1]
        chromium = browser.Browser()
        self.addCleanup(chromium.close)
        for width_px in WIDTHS_PX:
            with self.subTest(width_px=width_px):
                page = browser.Page(chromium, width_px)
                page.call("Page.navigate", {"url": url})
                page.wait("document.documentElement?.dataset.ready === 'true'")
                sentence = page.run("document.getElementById('sentence').textContent")
                self.assertRegex(sentence, r"[0-9]")
                self.assertEqual(page.run("document.querySelectorAll('#flow .value').length"), 2)
                self.assertTrue(page.run(
                    "document.querySelector('#old:not([hidden])')?.textContent"))
                self.assertEqual(page.run("""[...document.querySelectorAll("canvas")].map((c) =>
                  c.getContext("2d").getImageData(0, 0, c.width, c.height).data.some(Boolean))"""),
                                 [True, True])
                # Of the log's prices, some 280 EUR/MWh at most.
                self.assertGreater(page.run("shownCharts.get('day').chart.scales.price.max"), 200)
                self.assertGreater(page.run("document.querySelectorAll('#days tr').length"), 0)
                self.assertEqual(page.run("""[...document.querySelectorAll(".trouble")]
                  .map((e) => e.textContent).join("")"""), "")
                self.assertLessEqual(page.run("document.documentElement.scrollWidth"), width_px)
                page.run("document.getElementById('day-before').click()")
                page.wait("!document.getElementById('day-after').disabled")
                self.assertEqual(page.run("document.getElementById('day-title').textContent"),
                                 "2023-03-25")
                self.assertEqual(page.complaints(), [])
                page.close()


if __name__ == "__main__":
    if browser.chromium() is None:
        print("skipped: no Chromium: run tools/setup --test")
        sys.exit(77)
    BESS_PAGE = sys.argv.pop()
    PAGE_SITE = sys.argv.pop()
    unittest.main(verbosity=2)
