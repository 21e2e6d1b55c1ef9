#!/usr/bin/env python3
"""sweep_page_test.py SWEEP_WORKER: sweep.html in a headless Chromium, of 500 made-up tasks and of
10,000: tables and heat map held against tasks.csv, sorting, wide and on a phone, light and dark.

Exit code 77 where Chromium is not installed (tools/setup --test installs it).
"""
import csv
import os
import re
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../report/page"))
import browser
import looks
import tabs

WORKER = sys.argv.pop(1) if len(sys.argv) > 1 else ""
NOTHING = "\u2013"
PROFIT = "profit_eur_per_day_per_mwh"
AXES = ("distil.fidelity", "train.learning_rate")


def number(text):
    return float(text.split(" ")[0].replace(",", "").replace("\u2212", "-"))


class SweepPage(tabs.Tabs):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.browser = browser.Browser()
        cls.tabs, cls.tasks = {}, {}
        for count in (500, 10_000):
            path = os.path.join(cls.folder.name, str(count))
            subprocess.run([WORKER, "page", path, str(count)], check=True)
            with open(os.path.join(path, "tasks.csv"), encoding="utf-8") as file:
                cls.tasks[count] = list(csv.DictReader(file))
            began_s = time.monotonic()
            cls.tabs[count] = browser.Page(cls.browser)
            cls.tabs[count].open(os.path.join(path, "sweep.html"))
            size = os.path.getsize(os.path.join(path, "sweep.html"))
            print(f"{count} tasks: {size / 1e6:.1f} MB, open after "
                  f"{time.monotonic() - began_s:.1f} s", flush=True)

    def rows_of(self, tab, table):
        """[[head, {label: text}]] of a table's body, as it stands."""
        return tab.run(f"""[...document.querySelectorAll("#{table} tbody tr")].map((row) => [
          row.querySelector("th").textContent,
          Object.fromEntries([...row.querySelectorAll("td")].map(
            (cell) => [cell.dataset.label, cell.textContent]))])""")

    def test_nothing_hangs_over_is_cut_off_or_hard_to_read(self):
        for width in (1440, 800, 375):
            for dark in (False, True):
                with self.subTest(width=width, dark=dark):
                    tab = self.tab(500, width, dark)
                    self.assertEqual(looks.off_the_screen(tab), [])
                    self.assertEqual(looks.cut_off(tab), [])
                    self.assertEqual(looks.low_contrast(tab), [])
        self.assertEqual(looks.not_read_aloud(self.tab(500)), [])
        self.assertEqual(looks.unseen_focus(self.tab(500)), [])

    def test_every_task_is_that_of_the_table(self):
        for count, tasks in self.tasks.items():
            rows = dict(self.rows_of(self.tab(count), "tasks"))
            self.assertEqual(len(rows), count)
            for task in tasks:
                cells = rows[task["task"]]
                self.assertEqual(cells["State"], task["state"])
                self.assertEqual([cells[name] for name in AXES], [task[name] for name in AXES])
                if task["state"] == "proved":
                    self.assertAlmostEqual(number(cells["Profit"]), float(task[PROFIT]),
                                           delta=.0501)
                    self.assertEqual(cells["Weights"], task["weights_hash"])
                else:
                    self.assertEqual(cells["Profit"], NOTHING)

    def test_the_heat_map_is_the_mean_of_its_tasks(self):
        for count, tasks in self.tasks.items():
            tab = self.tab(count)
            cells = {}
            for task in tasks:
                if task["state"] == "proved":
                    at = tuple(task[name] for name in AXES)
                    cells.setdefault(at, []).append(float(task[PROFIT]))
            means = {at: sum(profits) / len(profits) for at, profits in cells.items()}
            shown = {(across, row): number(text) for row, texts in self.rows_of(tab, "map")
                     for across, text in texts.items() if text != NOTHING}
            self.assertEqual(set(shown), set(means))
            self.assertGreater(len(shown), 90)
            for at, value in shown.items():
                self.assertAlmostEqual(value, means[at], delta=.0501, msg=at)
            shades = tab.run("""[...document.querySelectorAll("#map td[style]")].map((cell) => [
              cell.textContent,
              Number(cell.getAttribute("style").match(/charge\\) (\\d+)%/)[1])])""")
            shades.sort(key=lambda shade: number(shade[0]))
            strengths = [strength for _, strength in shades]
            self.assertEqual(strengths, sorted(strengths), "stronger where it earns more")
            self.assertLess(shades[0][1], shades[-1][1])

    def in_order(self, tab, table, label, descending):
        rows = self.rows_of(tab, table)
        texts = [head if label is None else cells[label] for head, cells in rows]
        known = [text for text in texts if text not in (NOTHING, "")]
        self.assertEqual(texts[:len(known)], known, f"{label}: what is unknown comes last")
        if label == "Weights":
            return
        if all(re.fullmatch(r"[-\u2212\d.,e]+( \u00b1 .*)?", text) for text in known):
            known = [number(text) for text in known]
        elif label in (None, "State", "Region", "Student"):
            known = [[int(part) if part.isdigit() else part for part in re.split(r"(\d+)", text)]
                     for text in known]
        self.assertEqual(known, sorted(known, reverse=descending),
                         f"{table}, {label}, {descending}")

    def test_heads_sort_both_ways(self):
        tab = self.tab(500)
        for table in ("settings", "tasks", "sites"):
            labels = [None, *self.rows_of(tab, table)[0][1]]
            before = sorted(map(str, self.rows_of(tab, table)))
            for at, label in enumerate(labels):
                for descending in (False, True):
                    tab.run(f"document.querySelectorAll('#{table} thead button')[{at}].click()")
                    self.in_order(tab, table, label, descending)
            after = sorted(map(str, self.rows_of(tab, table)))
            self.assertEqual(after, before, "rows keep their cells")

    def test_ten_thousand_rows_are_sorted(self):
        tab = self.tab(10_000)
        profit = 1 + list(self.rows_of(tab, "tasks")[0][1]).index("Profit")
        began_s = time.monotonic()
        tab.run(f"document.querySelectorAll('#tasks thead button')[{profit}].click()")
        looks.settle(tab)
        took_s = time.monotonic() - began_s
        print(f"10,000 rows sorted and drawn in {took_s:.1f} s", flush=True)
        self.in_order(tab, "tasks", "Profit", False)

    def test_on_a_phone_a_list_sorts(self):
        for count in self.tasks:
            tab = self.tab(count, 375)
            self.assertFalse(tab.run("document.querySelector('#tasks thead').checkVisibility()"))
            tab.run("""[...document.querySelectorAll('select.sorting')].forEach(
              (list) => { list.id = 'sorting-' + list.nextElementSibling.id; })""")
            labels = [None, *self.rows_of(tab, "tasks")[0][1]]
            for sign in "+-" if count == 500 else "-":
                began_s = time.monotonic()
                tab.set_value("sorting-tasks", f"{labels.index('Profit')}{sign}")
                looks.settle(tab)
                took_s = time.monotonic() - began_s
                print(f"{count} rows sorted and drawn in {took_s:.1f} s, 375 px wide", flush=True)
                self.in_order(tab, "tasks", "Profit", sign == "-")
            self.assertEqual(tab.run("document.documentElement.scrollWidth"), 375)


if __name__ == "__main__":
    if browser.chromium() is None:
        print("SKIPPED: no chromium here; tools/setup --test installs it")
        sys.exit(77)
    unittest.main(verbosity=2)
