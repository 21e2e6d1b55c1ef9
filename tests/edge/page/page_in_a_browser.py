"""bess-page in a browser: nothing hangs over, all can be read, every number is that of the answers.

  page_in_a_browser.py PAGE_SITE BESS_PAGE
"""
import json
import os
import subprocess
import sys
import unittest
import urllib.request

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../../workstation/report/page"))
import browser  # noqa: E402
import looks  # noqa: E402

WIDTHS_PX = (1440, 800, 375)


class PageInABrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.site = subprocess.Popen([PAGE_SITE], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                    text=True)
        config = cls.site.stdout.readline().strip()
        cls.server = subprocess.Popen([BESS_PAGE, "--config", config, "--port", "0"],
                                      stdout=subprocess.PIPE, text=True)
        cls.url = cls.server.stdout.readline().split()[-1]
        cls.browser = browser.Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        cls.server.terminate()
        cls.server.communicate(timeout=30)
        cls.site.communicate(timeout=30)

    def tab(self, width_px=1440, dark=False, path=""):
        page = browser.Page(self.browser, width_px, 900, dark)
        page.call("Page.navigate", {"url": self.url + path})
        page.wait("document.readyState === 'complete' && document.querySelector('main')")
        looks.settle(page)
        return page

    def test_looks(self):
        for path in ("", "statement"):
            for width_px in WIDTHS_PX:
                for dark in (False, True):
                    with self.subTest(path=path, width_px=width_px, dark=dark):
                        page = self.tab(width_px, dark, path)
                        self.assertEqual(looks.off_the_screen(page), [])
                        self.assertEqual(looks.cut_off(page), [])
                        self.assertEqual(looks.low_contrast(page), [])
                        self.assertEqual(looks.not_read_aloud(page), [])
                        self.assertEqual(page.complaints(), [])
                        page.close()

    def test_focus_is_seen(self):
        for dark in (False, True):
            page = self.tab(dark=dark)
            self.assertEqual(looks.unseen_focus(page), [])
            page.close()

    def test_every_number_is_that_of_the_answers(self):
        page = self.tab()
        shown = page.run("""[...document.querySelectorAll("data")].map((e) => ({
          of: e.dataset.of, value: Number(e.value), divisor: Number(e.dataset.divisor),
          text: e.textContent}))""")
        self.assertGreater(len(shown), 20)
        answers = {}
        for number in shown:
            name, *path = number["of"].split("/")
            if name not in answers:
                with urllib.request.urlopen(self.url + "api/" + name) as answer:
                    answers[name] = json.load(answer)
            value = answers[name]
            for key in path:
                value = value[int(key)] if isinstance(value, list) else value[key]
            self.assertEqual(number["value"], value, number["of"])
            text = number["text"].replace("\u2212", "-")
            decimals = len(text.split(".")[1]) if "." in text else 0
            self.assertAlmostEqual(float(text), value / number["divisor"],
                                   delta=.5001 * 10 ** -decimals, msg=number["of"])

    def test_an_order_by_hand(self):
        page = self.tab()
        page.run("""(() => {
          const form = document.querySelector("form");
          form.querySelector("[name=token]").value = "0123456789abcdef";
          form.querySelector("button").click();
        })()""")
        page.wait("document.querySelector('[role=alert]')")
        self.assertIn("hold 0 W", page.run("document.querySelector('[role=alert]').textContent"))
        page.close()


if __name__ == "__main__":
    if browser.chromium() is None:
        print("skipped: no Chromium: run tools/setup --test")
        sys.exit(77)
    BESS_PAGE = sys.argv.pop()
    PAGE_SITE = sys.argv.pop()
    unittest.main(verbosity=2)
