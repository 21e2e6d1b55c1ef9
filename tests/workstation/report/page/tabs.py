"""Tests with a tab for each page: `cls.tabs` by name, of `cls.browser`; files in `cls.folder`."""
import unittest

import looks


class Tabs(unittest.TestCase):
    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        cls.folder.cleanup()

    def tearDown(self):
        for name, tab in self.tabs.items():
            self.assertEqual(tab.complaints(), [], name)

    def tab(self, name, width_px=1440, dark=False):
        tab = self.tabs[name]
        tab.bring_to_front()
        tab.resize(width_px, 900)
        tab.set_dark(dark)
        tab.wait(f"innerWidth === {width_px}")
        looks.settle(tab)
        return tab
