#!/usr/bin/env python3
"""pages_test.py FIXTURE_PROGRAM: every page that bess-train writes, in a headless Chromium: of a run, of one with
rules, of one whose proof failed, of seeds and of a backtest. What they look like, narrow and wide, light and dark; that
every number in their tables is one of their JSON or CSV; and the rules on the maps, held against what the C++ counts.

Exit code 77 where Chromium is not installed (tools/setup --test installs it).
"""
import csv
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

import browser
import looks

FIXTURE = sys.argv.pop(1) if len(sys.argv) > 1 else ""
WIDTHS_PX = (1440, 800, 375)
RUNS = {"run": "", "ruled": "ruled", "failed": "failed"}
OTHERS = {"seeds": "seeds/seeds.html", "backtest": "backtest/backtest.html"}
COMPLETE = "[...document.querySelectorAll('canvas.map')].every((canvas) => canvas.dataset.complete === 'true')"
NUMBER = re.compile(r"[-+\u2212]?\d[\d,]*(?:\.\d+)?")


def numbers_of(text):
    """[(value, decimals)] of a text: "+1,234.5 \u00b1 2" has two."""
    found = []
    for token in NUMBER.findall(text):
        plain = token.replace(",", "").replace("\u2212", "-")
        found.append((float(plain), len(plain.partition(".")[2])))
    return found


def is_among(value, decimals, known):
    """Whether a number that was rounded to so many decimals may stand for one of those."""
    return any(abs(abs(value) - abs(other)) <= .5001 * 10 ** -decimals for other in known)


def mean(values):
    return sum(values) / len(values)


def error_of_mean(values):
    """Of independent days."""
    middle, n = mean(values), len(values)
    return (sum((v - middle) ** 2 for v in values) / (n - 1) / n) ** .5


def error_by_month(dates, values):
    """With the days of a month as one draw (workstation/env/day_errors.h)."""
    middle, sums = mean(values), {}
    for date, value in zip(dates, values):
        sums[date[:7]] = sums.get(date[:7], 0) + value - middle
    g = len(sums)
    return (g / (g - 1) * sum(s * s for s in sums.values())) ** .5 / len(values)


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        subprocess.run([FIXTURE, cls.folder.name], check=True)
        cls.browser = browser.Browser()
        cls.tabs, cls.expected = {}, {}
        for name, part in RUNS.items():
            path = os.path.join(cls.folder.name, part)
            with open(os.path.join(path, "expected.json"), encoding="utf-8") as file:
                cls.expected[name] = json.load(file)
            cls.tabs[name] = browser.Page(cls.browser)
            cls.tabs[name].open(os.path.join(path, "report.html"))
            cls.tabs[name].wait(COMPLETE)
        for name, path in OTHERS.items():
            cls.tabs[name] = browser.Page(cls.browser)
            cls.tabs[name].call("Page.navigate", {"url": "file://" + os.path.join(cls.folder.name, path)})
            cls.tabs[name].wait("document.readyState === 'complete' && document.querySelector('table')")

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

    def rows_of(self, tab, selector):
        """[[name, {label: text} in order as list of pairs]] of a table's body."""
        return tab.run(f"""[...document.querySelectorAll({json.dumps(selector)} + " tbody tr")].map((row) => [
          row.querySelector("th").textContent,
          [...row.querySelectorAll("td")].map((cell) => [cell.dataset.label, cell.textContent])])""")

    # What they look like.

    def test_nothing_hangs_over_is_cut_off_or_hard_to_read(self):
        for name in self.tabs:
            for width in WIDTHS_PX:
                for dark in (False, True):
                    with self.subTest(page=name, width=width, dark=dark):
                        tab = self.tab(name, width, dark)
                        self.assertEqual(looks.off_the_screen(tab), [])
                        self.assertEqual(looks.cut_off(tab), [])
                        self.assertEqual(looks.low_contrast(tab), [])
                        if name in RUNS:
                            self.assertEqual(looks.cut_off_in_canvases(tab), [])

    # Their numbers.

    def profits(self, name, policy, carried=True, wear=0):
        capacity = self.expected[name]["capacity_mwh"]
        days = self.expected[name]["days" if carried else "days_by_themselves"][policy]
        return [(day["profit_eur"] - wear * day["throughput_mwh"]) / capacity for day in days]

    def comparison_of(self, name, policy, carried):
        """What a row of the comparison must say, in the order of its columns."""
        days = self.expected[name]["days" if carried else "days_by_themselves"][policy]
        dates = [day["date"] for day in days]
        own = self.profits(name, policy, carried)
        gain = [a - b for a, b in zip(own, self.profits(name, "rbc", carried))]
        is_first = policy == "rbc"
        return [mean(own), error_of_mean(own), error_by_month(dates, own),
                *([None] * 3 if is_first else [mean(gain), error_of_mean(gain), error_by_month(dates, gain)]),
                min(own), mean([day["cycles"] for day in days]), mean([day["switches"] for day in days]),
                100 * mean(own) / mean(self.profits(name, "foresight", carried)),
                mean(self.profits(name, policy, carried, 10))]

    def risk_of(self, name, policy):
        """The same of the table of risk (workstation/env/day_risk.h)."""
        def quantile(values, share):
            at = share * (len(values) - 1)
            below, ordered = int(at), sorted(values)
            return ordered[below] + (at - below) * (ordered[min(below + 1, len(values) - 1)] - ordered[below])
        def sortino(values):
            losses = mean([min(value, 0) ** 2 for value in values])
            return mean(values) / losses ** .5 if losses > 0 else None
        def won(values):
            return 100 * mean([value > 0 for value in values])
        own = self.profits(name, policy)
        gain = [a - b for a, b in zip(own, self.profits(name, "rbc"))]
        deepest, peak, total = 0, 0, 0
        for value in own:
            total += value
            peak = max(peak, total)
            deepest = max(deepest, peak - total)
        return [won(own), -quantile(own, .05), deepest, sortino(own),
                *([None] * 2 if policy == "rbc" else [won(gain), sortino(gain)])]

    def test_comparisons_are_those_of_the_days(self):
        for name in RUNS:
            rows = self.rows_of(self.tab(name), "#comparison")
            policies = [policy for policy in self.expected[name]["days"] if not policy.startswith("plain student under")]
            self.assertEqual([row[0] for row in rows], policies * 4)
            for at, (policy, cells) in enumerate(rows):
                table = at // len(policies)
                capacity = self.expected[name]["capacity_mwh"]
                wanted = (self.risk_of(name, policy) if table == 3
                          else [capacity * mean(self.profits(name, policy, carried)) for carried in (False, True)]
                          if table == 2 else self.comparison_of(name, policy, table == 0))
                self.assertEqual(len(cells), len(wanted), [label for label, _ in cells])
                for (label, text), value in zip(cells, wanted):
                    with self.subTest(page=name, policy=policy, column=label):
                        if value is None:
                            self.assertEqual(text, "\u2013")
                        else:
                            (shown, decimals), = numbers_of(text)
                            self.assertAlmostEqual(shown, value, delta=.5001 * 10 ** -decimals)

    def test_the_head_is_about_the_student_that_the_run_ended_with(self):
        for name, student in (("run", "corrected student"), ("ruled", "corrected student"), ("failed", "unproved student")):
            tab = self.tab(name)
            self.assertEqual(float(tab.run("document.getElementById('headline-profit').textContent")),
                             round(mean(self.profits(name, student)), 1))
            self.assertIn("the " + student, tab.run("document.querySelector('.hero .figure').textContent"))
            for row in tab.run("""[...document.querySelectorAll(".gains tbody tr")].map((row) => [
                row.querySelector("th").firstChild.data, [...row.querySelectorAll(".number")].map((c) => c.textContent)])"""):
                for wear, text in zip((0, 10), row[1]):
                    gains = [a - b for a, b in zip(self.profits(name, student, wear=wear),
                                                   self.profits(name, row[0], wear=wear))]
                    shown, decimals = numbers_of(text)[0]
                    self.assertAlmostEqual(shown, mean(gains), delta=.5001 * 10 ** -decimals, msg=f"{name}, {row[0]}")
                    error, decimals = numbers_of(text)[1]
                    self.assertAlmostEqual(error, error_of_mean(gains), delta=.5001 * 10 ** -decimals)

    def test_rules_and_their_prices_are_those_of_the_days_and_of_the_proof(self):
        for name, student in (("ruled", "corrected student"), ("failed", "unproved student")):
            tab = self.tab(name)
            demands = {demand["text"]: demand for demand in self.expected[name]["demands"]}
            tables = tab.run("[...document.querySelectorAll('#rules table')].map((table, i) => table.id = 'rules-' + i)")
            self.assertEqual(len(tables), 2)
            rules = self.rows_of(tab, "#rules-0")
            self.assertEqual(len(rules), len(demands) - 3, "and three properties")
            for rule, cells in rules:
                demand = demands[rule.partition(" \u2013 ")[2].replace("\u2212", "-")]
                of = dict(cells)
                count = of[student.capitalize() + " breaks"]
                if not demand["binds_student"]:
                    self.assertEqual((of["States"], count), ("\u2013", "\u2013"))
                    continue
                self.assertEqual(numbers_of(of["States"])[0][0], demand["states"])
                self.assertEqual(numbers_of(count)[0][0], demand["violations"])
            for part, cells in self.rows_of(tab, "#rules-1"):
                others = {"all rules together": ("plain student under all rules", "plain student"), "both": (student, "plain student")}
                with_it, without = others.get(part) or (
                    (student, "plain student under all rules") if "correction" in part
                    else ("plain student under \"%s\"" % part.removesuffix(", alone"), "plain student"))
                for wear, (_, text) in zip((0, 10), cells):
                    wanted = mean([a - b for a, b in zip(self.profits(name, with_it, wear=wear),
                                                         self.profits(name, without, wear=wear))])
                    shown, decimals = numbers_of(text)[0]
                    self.assertAlmostEqual(shown, wanted, delta=.5001 * 10 ** -decimals, msg=f"{name}, {part}")

    def rows_hold(self, tab, known, names):
        """Every number of the rows of these names is one of those known of it, and each name has a row."""
        rows = [row for row in self.rows_of(tab, "table") if row[0] in names]
        self.assertGreaterEqual({row[0] for row in rows}, {name for name in names if not name.startswith("plain student under")})
        for row, cells in rows:
            for label, text in cells:
                for value, decimals in numbers_of(text):
                    self.assertTrue(is_among(value, decimals, known(row, label)), f"{row}, {label}: {text}")

    def test_seeds_are_those_of_the_csv(self):
        with open(os.path.join(self.folder.name, "seeds/seeds.csv"), encoding="utf-8") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        def known(row, _):
            return [float(v) for line in rows if line["policy"] == row for v in line.values()
                    if re.fullmatch(r"-?[\d.]+", v or "")]
        self.rows_hold(self.tab("seeds"), known, {line["policy"] for line in rows})

    def test_a_backtest_is_that_of_its_json(self):
        with open(os.path.join(self.folder.name, "backtest/backtest.json"), encoding="utf-8") as file:
            result = json.load(file)
        of = {policy["policy"]: [v for v in policy.values() if isinstance(v, (int, float))] for policy in result["policies"]}
        with open(os.path.join(self.folder.name, "backtest/backtest.csv"), encoding="utf-8") as file:
            for line in csv.DictReader(file):  # and by month
                for value in line.values():
                    if re.fullmatch(r"-?[\d.]+", value or ""):
                        of[line["policy"]].append(float(value))
        self.rows_hold(self.tab("backtest"), lambda row, _: of[row], set(of))

    # A failed run.

    def test_a_failed_run_leads_to_the_states_where_it_is_wrong(self):
        tab = self.tab("failed")
        self.assertNotIn("orrected student", tab.run("document.body.innerText"))
        self.assertIn("where its proof failed", tab.run("document.querySelector('h1').textContent"))
        broken = [demand for demand in self.expected["failed"]["demands"] if demand["violations"] > 0]
        shown = tab.run("[...document.querySelectorAll('#broken dd')].map((dd) => dd.textContent)")
        self.assertEqual(len(shown), len(broken))
        for text, demand in zip(shown, broken):
            self.assertIn(f"{demand['violations']:,} violations", text)
            self.assertIn("To mend: ", text)
        buttons = tab.run("[...document.querySelectorAll('[data-broken]')].map((b) => Number(b.dataset.broken))")
        self.assertTrue(buttons)
        for button in buttons:
            tab.run(f"document.querySelector('[data-broken=\"{button}\"]').click()")
            tab.wait(COMPLETE)
            minute, quarter_hour, context_class, soc, price = tab.run(f"page.data.broken[{button}]")
            self.assertEqual(tab.run("page.map.context"),
                             {"minute": minute, "quarterHour": quarter_hour, "contextClass": context_class})
            self.assertEqual(tab.run("page.map.marked"), {"price": price, "soc": soc / 200})
            self.assertIn("states against", tab.run("page.map.maps[0].found.textContent"))

    # Rules on the maps.

    def show_map(self, tab, context_class, quarter_hour, minute):
        for name, value in (("context", context_class), ("quarter", quarter_hour), ("minute", minute)):
            tab.set_value(name + "-slider", value)
        tab.wait(COMPLETE)

    def test_what_breaks_a_rule_is_what_the_proof_counts(self):
        seen = 0
        for name in ("ruled", "failed"):
            tab = self.tab(name)
            tab.run("document.querySelector('[data-window=all]').click()")
            students = list(self.expected[name]["students"].values())
            for at, wanted in enumerate(students[0]["maps"]):
                self.show_map(tab, wanted["context_class"], wanted["quarter_hour"], wanted["minute"])
                for index, student in enumerate(students):
                    found = tab.run(f"""Object.fromEntries(page.map.maps[{index}].violations.rules.map(
                      ({{rule, cells}}) => [rule.name, cells.length]))""")
                    counts = {rule: n for rule, n in student["broken_rules"][at].items() if n > 0 and rule != "falls with price"}
                    self.assertEqual(found, counts, f"{name}, student {index}, map {at}")
                    order = tab.run(f"page.map.maps[{index}].violations.order.filter((v) => v.towards === 'price').length")
                    self.assertEqual(order, student["broken_rules"][at]["falls with price"])
                    seen += sum(counts.values())
            tab.run("document.querySelector('[data-window=decisions]').click()")
        self.assertGreater(seen, 1000)

    def pixel(self, tab, price, soc):
        """Colour of the first map at a state, and where the pointer must be for it, in the window."""
        return tab.run(f"""(() => {{
          const map = page.map.maps[0], {{xOf, yOf}} = page.map.frame(map), x = xOf({price}), y = yOf({soc});
          const box = map.canvas.getBoundingClientRect();
          const copy = new OffscreenCanvas(map.canvas.width, map.canvas.height).getContext("2d", {{willReadFrequently: true}});
          copy.drawImage(map.canvas, 0, 0);
          return {{rgb: [...copy.getImageData(Math.round(x), Math.round(y), 1, 1).data].slice(0, 3),
                   x: box.left + x, y: box.top + y}};
        }})()""")

    def point_at(self, tab, at):
        tab.call("Input.dispatchMouseEvent", {"type": "mouseMoved", "x": at["x"], "y": at["y"]})
        looks.settle(tab)

    def test_a_rule_is_outlined_and_named_where_the_pointer_is(self):
        tab = self.tab("failed")
        self.show_map(tab, 6, 48, 7)
        tab.run("document.getElementById('maps').scrollIntoView()")
        for edge, value in (("from", -200), ("to", 600)):
            tab.set_value(f"price-{edge}", value)
        tab.wait(COMPLETE)
        ink = tab.run("colour('ink')")
        wanted = [int(ink[at:at + 2], 16) for at in (1, 3, 5)]
        edge = tab.run("""(() => { const {xOf, yOf} = page.map.frame(page.map.maps[0]);
          return {left: (xOf(-51) + xOf(-50)) / 2, y: yOf(60)}; })()""")
        colours = tab.run(f"""(() => {{ const canvas = page.map.maps[0].canvas;
          const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", {{willReadFrequently: true}});
          copy.drawImage(canvas, 0, 0);
          return [-1, 0].map((dx) => [...copy.getImageData(Math.round({edge["left"]}) + dx, Math.round({edge["y"]}), 1, 1).data].slice(0, 3));
        }})()""")
        self.assertIn(wanted, colours, "the left edge of the box, -50 EUR/MWh, is drawn")
        inside, outside = self.pixel(tab, 200, 100), self.pixel(tab, -150, 190)
        self.point_at(tab, inside)
        readout = tab.run("document.getElementById('map-readout').textContent")
        self.assertIn("1 a rule whose name is forty letters long", readout)
        self.assertIn("3 evening cap", readout)
        self.assertEqual(tab.run("page.map.rules.pointed.name"), "evening cap", "the last of them")
        self.point_at(tab, outside)
        readout = tab.run("document.getElementById('map-readout').textContent")
        self.assertNotIn("forty letters", readout)
        self.assertIn("\u2212150 EUR/MWh at 95.0 %", readout)

    def test_the_legend_says_who_is_held_and_leads_to_where_a_rule_holds(self):
        tab = self.tab("failed")
        self.show_map(tab, 6, 12, 0)
        keys = tab.run("[...document.querySelectorAll('#rule-keys button')].map((b) => [b.textContent, b.disabled])")
        self.assertEqual(len(keys), 5)
        self.assertIn("Held to it: student; does not hold at this time", keys[0][0])
        self.assertEqual([disabled for _, disabled in keys], [False, True, False, True, True])
        tab.run("document.querySelectorAll('#rule-keys button')[0].click()")
        tab.wait(COMPLETE)
        self.assertEqual(tab.run("page.map.context.quarterHour"), 40, "10:00")
        self.assertIn("holds on this map", tab.run("document.querySelector('#rule-keys button').textContent"))
        self.assertTrue(self.tab("run").run("document.getElementById('rule-keys').hidden"), "no rules, no legend")


if __name__ == "__main__":
    if browser.chromium() is None:
        print("skipped: chromium is not installed (tools/setup --test)")
        sys.exit(77)
    unittest.main()
