#!/usr/bin/env python3
"""pages_test.py FIXTURE_PROGRAM BESS_TRAIN: each page that bess-train writes, in a headless
Chromium: it is drawn completely, without errors, and nothing overflows at 1280 and 390 px; the
student on it decides as the edge's; and the cells of the backtest's tables are those of its JSON.

Exit code 77 if Chromium is not installed (tools/setup --test installs it).
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest
import zlib

import browser

FIXTURE = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else ""
BESS_TRAIN = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else ""
RUNS = ("", "failed")  # folders of a run with rules and of one that failed its proof
DRAWN = ("[...document.querySelectorAll('canvas.map')]"
         ".every((canvas) => canvas.dataset.complete === 'true')")
# Columns of the backtest's first table: the JSON's key, and the format of a figure.
BACKTEST = (("profit_eur_per_day_per_mwh", ".1f"),
            ("profit_standard_error", ".1f"),
            ("profit_standard_error_by_month", ".1f"),
            ("gain_eur_per_day_per_mwh", "+.1f"),
            ("gain_standard_error", ".1f"),
            ("gain_standard_error_by_month", ".1f"),
            ("profit_at_wear_10_eur_per_day_per_mwh", ".1f"),
            ("cycles_per_day", ".2f"),
            ("drawdown_eur_per_mwh", ".0f"))
DAYS = ("policy,date,profit_eur,cycles,switches,throughput_mwh,carry_soc,soc_end_frac,"
        "soc_start_frac,charge_value_eur,charge_price_eur_per_mwh\n")


def shown(value, form):
    return "–" if value is None else format(value, form).replace("-", "−")


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

    def bess(self, *words):
        subprocess.run([BESS_TRAIN, *words], cwd=self.folder.name, check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def look_at(self, path, drawn):
        page = browser.Page(self.browser)
        page.call("Page.navigate", {"url": "file://" + self.path(path)})
        page.wait("document.readyState === 'complete' && document.querySelector('table')")
        page.wait(drawn)
        for width in (1280, 390):
            page.resize(width, 900)
            page.wait(drawn)
            # The layout follows the resize after some time; an overflow would persist.
            page.wait(f"document.documentElement.scrollWidth === {width}")
        self.assertEqual(page.complaints(), [], path)
        return page

    def test_reports_of_runs_show_their_figures(self):
        for run in RUNS:
            page = self.look_at(os.path.join(run, "report.html"), DRAWN)
            self.assertGreater(page.run("document.querySelectorAll('canvas').length"), 2, run)
            self.assertEqual(page.run("""[...shownCharts.entries()].filter(
                ([, {chart}]) => !chart.options.scales.y.title.text).map(([id]) => id)"""),
                             ["chart-power"], run)

    def test_a_training_curve_has_loss_and_program(self):
        page = self.look_at("report.html", DRAWN)
        lines = page.run("""shownCharts.get('chart-training').chart.data.datasets.map(
            ({yAxisID, data}) => [yAxisID, data.map(({x, y}) => [x, y])])""")
        self.assertIn(["loss", [[500, 3.0], [750, 2.9]]], lines)
        self.assertIn(["y", [[0, 100], [750, 100]]], lines)

    def test_a_policy_map_has_the_axes_and_colours_of_the_edge(self):
        page = self.look_at("report.html", DRAWN)
        alike = page.run("""(() => {
          const map = page.map.maps[0], {prices, socs, xOf, yOf} = page.map.frame(map);
          const ctx = map.canvas.getContext('2d'), {first} = map.window;
          const states = Array.from({length: 400}, (_, i) => [i * 7 % socs, i * 13 % prices]);
          return states.filter(([soc, price]) => {
            const [red, , blue] = ctx.getImageData(xOf(soc), yOf(first + price), 1, 1).data;
            return Math.sign(blue - red) + 1 === map.grid[soc * prices + price];
          }).length;
        })()""")
        self.assertGreater(alike, 340, "all but outlines and violations")

    def test_students_on_the_page_are_those_of_the_edge_to_the_bit(self):
        with open(self.path("expected.json"), encoding="utf-8") as file:
            students = json.load(file)
        self.assertEqual(len(students), 2)
        page = self.look_at("report.html", DRAWN)
        for name, answers in students.items():
            self.assertEqual(len(answers), 4000)
            self.assertEqual(page.run(f"""(() => {{
              const map = page.map.maps.find((map) => map.name === {json.dumps(name)});
              return {json.dumps(answers)}.filter(
                ([minute, quarterHour, contextClass, soc, price, ...answer]) => {{
                  const context = {{minute, quarterHour, contextClass}};
                  const action = map.student.decide(context, soc, price);
                  return [...map.student.logits, action].join() !== answer.join();
                }}).length;
            }})()"""), 0, name)

    def test_the_cells_of_a_backtest_are_its_json(self):
        self.bess("prices", "simulate", "--days", "90", "--out", "market.csv")
        self.bess("backtest", "--prices", "market.csv", "--policy", "rbc", "sdp", "--window-days",
                  "30", "--out", "backtest")
        with open(self.path("backtest/backtest.json"), encoding="utf-8") as file:
            told = json.load(file)
        page = self.look_at("backtest/backtest.html", "true")
        policies, months = json.loads(page.run("""JSON.stringify(
            [...document.querySelectorAll('table')].slice(0, 2).map((table) =>
                [...table.querySelectorAll('tbody tr')].map((row) =>
                    [row.querySelector('th').textContent, ...[...row.querySelectorAll('td')].map(
                        (cell) => [cell.dataset.label, cell.textContent])])))"""))
        self.assertEqual(len(policies), len(told["policies"]))
        for row, policy in zip(policies, told["policies"]):
            self.assertEqual([row[0], *(text for _, text in row[1:])], [policy["policy"]] + [
                shown(policy[key], form) for key, form in BACKTEST])
        self.assertEqual(months[-1][1:], [[month["month"], str(month["fitted_days"])]
                                          for month in told["months"]])
        self.assertEqual(len(months), len(policies) + 1)

    def write_run(self, name, shares, ends=True):
        """A run's folder by hand: two days of which each policy earns its share of 10 EUR."""
        os.makedirs(self.path(name))
        days = DAYS + "".join(
            f"{policy},2023-0{month}-26,{10 * share},1,2,3,{carried},0.5,0.5,0,\n"
            for policy, share in shares.items() for carried in ("false", "true")
            for month in (1, 2))
        mark = f"crc32 {zlib.crc32(days.encode()):08x}, {len(days)} bytes"
        record = {"prices": "p.csv", "prices_name": "p.csv", "commit": "",
                  "identity": {"prices": "the same", "seed": name},
                  "stages": {"evaluation": {"inputs": {},
                                            "outputs": {"evaluation_days.csv": mark}}}}
        if ends:
            record["figures"] = {
                "provenance": "made by hand", "weights_hash": "0123abcd", "states_checked": 1,
                "states_checked_plain": 1, "violations_plain": 2, "violations_corrected": 0,
                "demands": [], "last_learnt_day": "2023-02-25"}
        for file, text in (("evaluation_days.csv", days), ("run.json", json.dumps(record)),
                           ("report.html", "<html></html>")):
            with open(self.path(f"{name}/{file}"), "w", encoding="utf-8") as out:
                out.write(text)

    def test_many_runs_are_a_table(self):
        self.write_run("10", {"rbc": 1, "corrected student": 3})
        self.write_run("9", {"rbc": 1, "corrected student": -1})
        self.write_run("stopped", {"rbc": 1}, ends=False)
        self.write_run("edited", {"rbc": 1, "corrected student": 2})
        with open(self.path("edited/evaluation_days.csv"), "a", encoding="utf-8") as days:
            days.write("rbc,2023-02-27,9,1,2,3,false,0.5,0.5,0,\n")
        self.bess("runs", "compare", "10", "9", "stopped", "edited", "--html", "many.html")
        page = self.look_at("many.html", "true")
        self.assertGreater(page.run("document.querySelectorAll('tbody tr').length"), 3)


if __name__ == "__main__":
    if browser.chromium() is None:
        print("skipped: chromium is not installed (tools/setup --test)")
        sys.exit(77)
    unittest.main()
