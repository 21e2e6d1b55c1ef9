#!/usr/bin/env python3
"""page_test.py FIXTURE_PROGRAM: the report's page in a headless Chromium, held against what the C++
says.

Exit code 77 where Chromium is not installed (tools/setup --test installs it).
"""
import csv
import gzip
import itertools
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

import browser

FIXTURE = sys.argv.pop(1) if len(sys.argv) > 1 else ""
WIDTHS_PX = (320, 375, 800, 1440, 1600)
COMPLETE = ("[...document.querySelectorAll('canvas.map')]"
            ".every((canvas) => canvas.dataset.complete === 'true')")


def luminance(rgb):
    """WCAG 2 relative luminance of [r, g, b], 0..255."""
    parts = [c / 255 / 12.92 if c / 255 <= .04045 else ((c / 255 + .055) / 1.055) ** 2.4
             for c in rgb]
    return .2126 * parts[0] + .7152 * parts[1] + .0722 * parts[2]


def contrast(a, b):
    """1 to 21."""
    low, high = sorted((luminance(a), luminance(b)))
    return (high + .05) / (low + .05)


def of_hex(text):
    return [int(text[at:at + 2], 16) for at in (1, 3, 5)]


def number_or_text(text):
    try:
        return float(text)
    except ValueError:
        return text


class PageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        subprocess.run([FIXTURE, cls.folder.name], check=True)
        cls.path = os.path.join(cls.folder.name, "report.html")
        with open(os.path.join(cls.folder.name, "expected.json"), encoding="utf-8") as file:
            cls.expected = json.load(file)
        cls.browser = browser.Browser()
        cls.page = browser.Page(cls.browser)
        cls.page.open(cls.path)

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        cls.folder.cleanup()

    def setUp(self):
        self.page.resize(1200, 900)
        self.page.set_dark(False)
        self.page.run("document.querySelector('[data-window=decisions]').click()")

    def tearDown(self):
        self.assertEqual(self.page.complaints(), [])

    def show_map(self, context_class, quarter_hour, minute):
        for name, value in (("context", context_class), ("quarter", quarter_hour),
                            ("minute", minute)):
            self.page.set_value(name + "-slider", value)
        self.page.wait(COMPLETE)

    def whole_range(self):
        self.page.run("document.querySelector('[data-window=all]').click()")

    def pixel_counts(self, map_index):
        """How often each colour occurs on a map's canvas, as "r,g,b"."""
        return self.page.run(f"""(() => {{
          const canvas = document.querySelectorAll("canvas.map")[{map_index}], counts = {{}};
          const copy = new OffscreenCanvas(canvas.width, canvas.height)
            .getContext("2d", {{willReadFrequently: true}});
          copy.drawImage(canvas, 0, 0);
          const bytes = copy.getImageData(0, 0, canvas.width, canvas.height).data;
          for (let i = 0; i < bytes.length; i += 4) {{
            const key = [bytes[i], bytes[i + 1], bytes[i + 2]].join();
            counts[key] = (counts[key] || 0) + 1;
          }}
          return counts;
        }})()""")

    def colours(self):
        return {name: of_hex(self.page.run(f"colour('{name}')"))
                for name in ("paper", "ink", "muted", "idle", "charge", "discharge", "mark")}

    # The students are the edge's, bit for bit.

    def test_logits_are_those_of_the_edge(self):
        for name, student in self.expected["students"].items():
            wrong = self.page.run(f"""(() => {{
              const map = page.map.maps.find((map) => map.name === {json.dumps(name)});
              let wrong = 0;
              for (const [minute, quarterHour, contextClass, soc, price, ...answer] of
                   {json.dumps(student["answers"])}) {{
                const context = {{minute, quarterHour, contextClass}};
                const action = map.student.decide(context, soc, price);
                if ([...map.student.logits, action].join() !== answer.join()) ++wrong;
              }}
              return wrong;
            }})()""")
            self.assertGreaterEqual(len(student["answers"]), 4000)
            self.assertEqual(wrong, 0, name)

    def test_a_wrong_weight_is_noticed(self):
        answers = self.expected["students"]["corrected student"]["answers"][:200]
        wrong = self.page.run(f"""(() => {{
          const net = structuredClone(page.data.students[0].net);
          net.layer2.bias[0] += 1 << net.layer2.shift;
          const student = new Student(net, page.data.lattice);
          return {json.dumps(answers)}.filter((
              [minute, quarterHour, contextClass, soc, price, ...answer]) => {{
            student.decide({{minute, quarterHour, contextClass}}, soc, price);
            return student.logits.join() !== answer.slice(0, 3).join();
          }}).length;
        }})()""")
        self.assertGreater(wrong, 0)

    def test_sliders_change_the_map_to_that_of_the_edge(self):
        self.whole_range()
        seen = set()
        students = self.expected["students"].items()
        for at in range(3):
            wanted = [student["maps"][at] for _, student in students]
            self.show_map(wanted[0]["context_class"], wanted[0]["quarter_hour"],
                          wanted[0]["minute"])
            for index, (name, _) in enumerate(students):
                cells = self.page.run(f"page.map.maps[{index}].grid.join('')")
                self.assertEqual(cells, wanted[index]["cells"], f"{name}, map {at}")
                found = self.page.run(f"page.map.maps[{index}].violations.order.length")
                self.assertEqual(found, wanted[index]["wrong_pairs"], name)
                seen.add(json.dumps(self.pixel_counts(index)))
        self.assertEqual(len(seen), 6, "maps of different states look the same")

    def test_labels_follow_the_sliders(self):
        self.show_map(3, 49, 11)
        self.assertEqual(self.page.run("document.getElementById('quarter-text').value"), "12:15")
        self.assertEqual(self.page.run("document.getElementById('minute-text').value"), "12:26")
        self.assertEqual(self.page.run("document.getElementById('context-text').value"),
                         self.page.run("page.data.contexts[2]"))

    def test_maps_show_where_decisions_are(self):
        self.show_map(6, 48, 7)
        first, last = self.page.run("[page.map.window.first, page.map.window.last]")
        self.assertLess(last - first, 1000)
        share = self.page.run("""(() => {
          const cells = page.map.maps[0].grid;
          return [0, 1, 2].map((action) =>
            cells.filter((cell) => cell === action).length / cells.length);
        })()""")
        self.assertGreater(min(share[0], share[2]), .05, share)

    def test_violations_are_seen_and_found(self):
        mark = ",".join(str(c) for c in self.colours()["mark"])
        self.page.run("document.getElementById('next-violation').click()")
        self.page.wait(COMPLETE)
        counts = self.page.run("page.map.maps.map((map) => map.violations.order.length)")
        self.assertEqual(counts[0], 0, "the corrected student")
        self.assertGreater(counts[1], 0, "the plain one")
        self.assertNotIn(mark, self.pixel_counts(0))
        self.assertGreater(self.pixel_counts(1).get(mark, 0), 20)
        self.assertIn("no violation", self.page.run("page.map.maps[0].found.textContent"))
        self.assertIn(f"{counts[1]} neighbouring pairs",
                      self.page.run("page.map.maps[1].found.textContent"))

    def test_broken_thresholds_are_violations(self):
        found = self.page.run("""(() => {
          const grid = Int8Array.from([1, 1, 0,  2, 1, 1]);  // prices 9, 10, 11 in rows of charge
          return violationsOf(grid, 3, 9, {low: 9, high: 11});
        })()""")
        self.assertEqual(found["threshold"], [{"soc": 0, "column": 0}, {"soc": 1, "column": 2}])
        self.assertEqual(found["order"], [{"soc": 0, "column": 0, "towards": "soc"},
                                          {"soc": 0, "column": 2, "towards": "soc"}])

    # Numbers are those of the evaluation.

    def test_steps_add_up_to_the_days(self):
        days = self.page.run("""page.days.map((day) => ({
          date: day.date, profits: day.policies.map((policy) => cumulative(policy.profit).at(-1)),
          energy: day.policies[0].power.reduce((sum, power) => sum + Math.abs(power), 0)
                  / 1e6 / 30}))""")
        names = self.page.run("page.data.archive.policies")
        for name in ("corrected student", "plain student"):
            wanted = self.expected["days_by_themselves"][name]
            self.assertEqual([day["date"] for day in days], [day["date"] for day in wanted])
            for day, of_evaluation in zip(days, wanted):
                self.assertAlmostEqual(day["profits"][names.index(name)],
                                       of_evaluation["profit_eur"], places=2)
        for day, of_evaluation in zip(days,
                                      self.expected["days_by_themselves"]["corrected student"]):
            self.assertAlmostEqual(day["energy"], of_evaluation["throughput_mwh"], places=4)

    def cumulative_of(self, name, wear):
        capacity, sums, total = self.expected["capacity_mwh"], [], 0
        for day in self.expected["days"][name]:
            total += (day["profit_eur"] - wear * day["throughput_mwh"]) / capacity
            sums.append(total)
        return sums

    def shown_cumulative(self):
        return self.page.run("""Object.fromEntries(shownCharts.get("chart-cumulative").chart.data.datasets.map(
          (line) => [line.label, line.data]))""")

    def test_tear_sheet_with_and_without_wear(self):
        for choice, wear in (("10", 10), ("configured", 0)):
            self.page.run(f"document.querySelector('[data-wear=\"{choice}\"]').click()")
            shown = self.shown_cumulative()
            self.assertEqual(set(shown), {"corrected student", "rbc-tuned", "sdp", "foresight"})
            for name, values in shown.items():
                for value, wanted in zip(values, self.cumulative_of(name, wear), strict=True):
                    self.assertAlmostEqual(value, wanted, places=6)

    def test_hours_add_up_to_the_mean_day(self):
        net = self.page.run("page.tearSheet.profitByHour().net")
        days = self.expected["days_by_themselves"]["corrected student"]
        mean = sum(day["profit_eur"] for day in days) / len(days) / self.expected["capacity_mwh"]
        self.assertEqual(len(net), 24)
        self.assertAlmostEqual(sum(net), mean, places=3)

    def test_drawdown_is_that_of_the_days(self):
        for name in ("corrected student", "rbc-tuned"):
            falls = self.page.run(
                f"page.tearSheet.drawdowns(page.tearSheet.policies([{json.dumps(name)}])[0])")
            peak = 0
            for fall, total in zip(falls, self.cumulative_of(name, 0), strict=True):
                peak = max(peak, total)
                self.assertAlmostEqual(fall, total - peak, places=6)
        shown = self.page.run("!document.getElementById('drawdown-none').hidden")
        self.assertEqual(shown, not self.page.run("shownCharts.has('chart-drawdown')"))

    def test_headline_is_about_the_corrected_student(self):
        days = [day["profit_eur"] / self.expected["capacity_mwh"]
                for day in self.expected["days"]["corrected student"]]
        self.assertEqual(self.page.run("document.getElementById('headline-profit').textContent"),
                         f"{sum(days) / len(days):.1f}")
        plain = [day["profit_eur"] / self.expected["capacity_mwh"]
                 for day in self.expected["days"]["plain student"]]
        gain = sum(a - b for a, b in zip(days, plain)) / len(days)
        cells = self.page.run(
            "[...document.querySelectorAll('.gains tbody tr')].map((row) => row.textContent)")
        self.assertTrue(cells[0].startswith("plain student"), cells)
        self.assertIn(f"{gain:+.1f}", cells[0])

    def test_headline_is_carried_over_and_says_how_it_counts(self):
        headline = self.expected["headline"]
        text = self.page.run("document.getElementById('result').textContent")
        self.assertTrue(headline["carry_soc"])
        self.assertEqual(self.page.run("document.getElementById('headline-profit').textContent"),
                         f"{headline['profit_eur_per_day_per_mwh']:.1f}")
        for key in ("profit_standard_error", "profit_standard_error_by_month",
                    "profit_from_same_soc_eur_per_day_per_mwh",
                    "charge_price_eur_per_mwh"):
            self.assertIn(f"{headline[key]:.1f}", text, key)
        self.assertIn("valued at", text)
        self.assertIn("local days 26 to the end of each month", text)
        self.assertIn("Learning saw days to", text)
        self.assertIn("walk-forward", text.lower())

    def test_worst_days_open(self):
        dates = self.page.run(
            "[...document.querySelectorAll('#worst-days th a')].map((link) => link.textContent)")
        days = self.expected["days_by_themselves"]["corrected student"]
        bound = {day["date"]: day["profit_eur"]
                 for day in self.expected["days_by_themselves"]["foresight"]}
        missed = {day["date"]: (bound[day["date"]] - day["profit_eur"])
                  / self.expected["capacity_mwh"] for day in days}
        self.assertEqual(dates, sorted(missed, key=missed.get, reverse=True)[:8])
        shown = self.page.run(
            "[...document.querySelectorAll('#worst-days tbody td:nth-child(2)')].map((cell) => "
            "cell.textContent)")
        for text, date in zip(shown, dates):
            self.assertAlmostEqual(float(text), missed[date], delta=.051)
        days = sorted(days, key=lambda day: day["profit_eur"])
        self.page.run("document.querySelector('#worst-days th a').click()")
        self.assertEqual(self.page.run("page.day.day.date"), dates[0])
        for row in range(3):
            moment = (f"document.querySelectorAll('#worst-days tbody tr')[{row}]"
                      ".querySelector('td a')")
            self.page.run(f"{moment}.click()")
            self.assertEqual(self.page.run("page.day.day.date"), dates[row])
            self.assertEqual(self.page.run("document.getElementById('step-time').value"),
                             self.page.run(f"{moment}.textContent"))
        self.page.run("document.getElementById('day-best').click()")
        self.assertEqual(self.page.run("document.getElementById('day-select').value"),
                         days[-1]["date"])

    def csv(self, name):
        """Rows of a picture's file, numbers as numbers."""
        opened = gzip.open if name.endswith(".gz") else open
        with opened(os.path.join(self.folder.name, name), "rt", encoding="utf-8") as file:
            return [{key: number_or_text(value) for key, value in row.items()}
                    for row in csv.DictReader(file)]

    # Each picture has its file, and the file its numbers.

    def test_each_picture_links_its_file(self):
        links = self.page.run("""
          [...document.querySelectorAll("figure:not(#policy figure), #policy")].map((figure) =>
            [figure.querySelector("figcaption, h2").firstChild.textContent,
             figure.querySelector("a.csv")?.getAttribute("href")])""")
        self.assertGreaterEqual(len(links), 15)
        for name, link in links:
            self.assertTrue(link and os.path.isfile(os.path.join(self.folder.name, link)),
                            f"{name}: {link}")
        files = os.listdir(self.folder.name)
        own = {file for file in files if file.endswith((".csv", ".csv.gz"))}
        self.assertEqual(own, {link for _, link in links}, "a file that no picture links")

    def drawn(self, chart):
        """Label -> values of each line or bar of a chart; points of {x, y} as pairs."""
        return self.page.run(f"""Object.fromEntries(shownCharts.get({json.dumps(chart)}).chart.data.datasets.map((set) =>
          [set.label, Array.from(set.data, (value) =>
            value.x === undefined ? value : [value.x, value.y])]))""")

    def assert_same(self, drawn, rows, places=5):
        for name, values in drawn.items():
            for value, row in zip(values, rows, strict=True):
                self.assertAlmostEqual(value, row[name], places=places, msg=name)

    def days_of(self, policy):
        """[(date, EUR per MWh of capacity)] of the run's file, charge carried over."""
        return [(row["date"], row["profit_eur"] / self.expected["capacity_mwh"])
                for row in self.csv("evaluation_days.csv")
                if (row["policy"], row["carry_soc"]) == (policy, "true")]

    def test_charts_have_the_numbers_of_the_files(self):
        self.page.run("document.querySelector('[data-wear=configured]').click()")
        name = "corrected student"
        days = self.days_of(name)
        sums = list(itertools.accumulate(profit for _, profit in days))
        months = sorted({date[:7] for date, _ in days})
        own = [[profit for date, profit in days if date.startswith(month)] for month in months]
        falls = [at - max(0, *sums[:d + 1]) for d, at in enumerate(sums)]
        shown = f"page.tearSheet.drawdowns(page.tearSheet.policies([{json.dumps(name)}])[0])"
        for drawn, expected in ((self.drawn("chart-cumulative")[name], sums),
                                (self.drawn("chart-months")[name], [sum(o) / len(o) for o in own]),
                                (self.page.run(shown), falls)):
            for value, other in zip(drawn, expected, strict=True):
                self.assertAlmostEqual(value, other, places=5)
        self.assertEqual(sum(self.drawn("chart-days")[name]), len(days))
        steps = self.csv("steps.csv.gz")
        together = self.drawn("chart-hours")["together"]
        count = self.page.run("page.days.length")
        self.assertAlmostEqual(sum(together),
                               sum(row[name + " profit_eur"] for row in steps) / count
                               / self.expected["capacity_mwh"], places=2)
        prices = self.drawn("chart-prices")
        self.assert_same({"training_days_percent": prices["training days"],
                          "test_days_percent": prices["test days"]},
                         self.csv("prices_seen.csv"))

    def test_checkpoints_and_the_chosen_one(self):
        rows = self.csv("training_curve.csv")
        drawn = self.drawn("chart-training")
        self.assertEqual(drawn["checkpoint"],
                         [[row["step"], row["validation_eur_per_day_per_mwh"]] for row in rows])
        self.assertEqual(drawn["chosen"], [[500, 140]], "what is not shown is not kept")
        first, last = rows[0], rows[-1]
        self.assertEqual(first["step"], 0)
        self.assertEqual(drawn["the program, step 0"],
                         [[row["step"], first["validation_eur_per_day_per_mwh"]]
                          for row in (first, last)])
        self.assertEqual([step for step, _ in drawn["rule-based"]], [first["step"], last["step"]])
        rows = self.csv("student_checkpoints.csv")
        drawn = self.drawn("chart-checkpoints")
        self.assertEqual(len(drawn["checkpoint"]), len(rows))
        for state in ("chosen", "disobeys"):
            self.assertEqual(drawn[state], [[row["epoch"], row["validation_eur_per_day_per_mwh"]]
                                            for row in rows if row["state"] == state])
            self.assertEqual(len(drawn[state]), 1)

    def test_the_losses_of_the_student_are_in_the_file(self):
        rows = self.csv("distil_curve.csv")
        drawn = self.drawn("chart-distil")
        self.assertEqual(drawn["on the states that the teacher visits"],
                         [[row["epoch"], row["visited_loss"]] for row in rows])

    def test_steps_are_in_the_file(self):
        rows = self.csv("steps.csv.gz")
        days = self.page.run("""page.days.map((day) => ({
          observed: [...day.observed], paid: [...day.paid],
          policies: day.policies.map(({profit, power, soc}) => ({
            profit: [...profit], power: [...power], soc: [...soc]}))}))""")
        names = self.page.run("page.data.archive.policies")
        at = 0
        for day in days:
            for step in range(len(day["paid"])):
                row = rows[at]
                self.assertAlmostEqual(row["observed_eur_per_mwh"], day["observed"][step],
                                       delta=.011)
                self.assertAlmostEqual(row["paid_eur_per_mwh"], day["paid"][step], delta=.0011)
                for name, policy in zip(names, day["policies"]):
                    self.assertAlmostEqual(row[name + " power_w"], policy["power"][step], delta=1)
                    self.assertAlmostEqual(row[name + " soc_frac"], policy["soc"][step],
                                           delta=1.1e-4)
                    self.assertAlmostEqual(row[name + " profit_eur"], policy["profit"][step],
                                           delta=.001)
                at += 1
        self.assertEqual(at, len(rows))

    def test_the_map_is_in_the_file(self):
        first = self.page.run("page.data.first_map")
        self.whole_range()
        self.show_map(first["context_class"], first["quarter_hour"], first["minute"])
        names = ["discharge", "idle", "charge"]
        for index, student in enumerate(self.page.run("page.data.students.map(({name}) => name)")):
            cells = [names.index(row["action"]) for row in self.csv("policy_map.csv")
                     if row["student"] == student
                     for _ in range(int(row["price_to_eur_per_mwh"] - row["price_from_eur_per_mwh"])
                                    + 1)]
            self.assertEqual("".join(map(str, cells)),
                             self.page.run(f"page.map.maps[{index}].grid.join('')"), student)

    def test_numbers_have_a_true_minus(self):
        self.page.run("document.getElementById('day-widest').click()")
        ticks = self.page.run("""[...shownCharts.values()].flatMap(({chart}) =>
          Object.values(chart.scales).filter((scale) => scale.type === "linear")
            .flatMap((scale) => scale.ticks.map(({label}) => String(label))))""")
        self.assertTrue(any(tick.startswith("\u2212") for tick in ticks), ticks)
        self.assertEqual([tick for tick in ticks if tick.startswith("-")], [])
        cells = self.page.run(
            "[...document.querySelectorAll('td')].map((cell) => cell.textContent)")
        self.assertEqual([cell for cell in cells if re.match(r"-\d", cell)], [])

    def test_the_far_tails_of_the_prices_are_told(self):
        outside = self.page.run("[page.data.prices.outside_train, page.data.prices.outside_test]")
        rows = self.csv("prices_seen.csv")
        for share, column in zip(outside, ("training_days_percent", "test_days_percent")):
            self.assertAlmostEqual(share, 100 - sum(row[column] for row in rows), places=3)
        self.assertIn(f"{outside[0]:.2f} % of the training",
                      self.page.run("document.getElementById('prices-note').textContent"))

    def test_parts_of_a_day_add_up_to_what_it_missed(self):
        days = self.csv("lost_days.csv")
        self.assertEqual(len(days), len(self.expected["days"]["corrected student"]))
        parts = list(days[0])
        parts = parts[parts.index("foresight_eur_per_mwh") + 1:parts.index("main_cause")]
        self.assertEqual(len(parts), 11)
        for day in days:
            self.assertAlmostEqual(sum(day[part] for part in parts), day["missed_eur_per_mwh"],
                                   places=4)
            self.assertLess(abs(day["rounding_eur_per_mwh"]), .01 * day["missed_eur_per_mwh"] + .5)
        means = {row["cause"]: row["missed_eur_per_day_per_mwh"]
                 for row in self.csv("lost_causes.csv")}
        for part in parts:
            mean = sum(day[part] for day in days) / len(days)
            self.assertAlmostEqual(mean, means.get(part.removesuffix("_eur_per_mwh"), 0), places=4)
        shown = self.page.run(
            "[...document.querySelectorAll('.causes tbody td:nth-child(2)')].map((cell) => "
            "cell.textContent)")
        for text, mean in zip(shown, means.values(), strict=True):
            self.assertAlmostEqual(float(text.replace("\u2212", "-")), mean, delta=.051)

    def test_the_heat_map_adds_up_to_the_months(self):
        cells = self.csv("lost_hours.csv")
        days = self.csv("lost_days.csv")
        for month in {cell["month"] for cell in cells}:
            own = [day for day in days if day["date"].startswith(month)]
            missed = sum(day["missed_eur_per_mwh"] - day["rounding_eur_per_mwh"]
                         for day in own) / len(own)
            self.assertAlmostEqual(sum(cell["missed_eur_per_day_per_mwh"] for cell in cells
                                       if cell["month"] == month),
                                   missed, places=4)
        shown = self.page.run(
            "[...document.querySelectorAll('.heat td')].map((cell) => [cell.title, "
            "cell.textContent, "
                              "Number(cell.style.getPropertyValue('--heat'))])")
        most = max(cell["missed_eur_per_day_per_mwh"] for cell in cells)
        for (title, text, heat), cell in zip(shown, cells, strict=True):
            value = cell["missed_eur_per_day_per_mwh"]
            self.assertEqual(title,
                             f"{cell['month']}, {int(cell['local_hour']):02}:00: {value:.1f}")
            self.assertAlmostEqual(float(text), value, delta=.51)
            self.assertAlmostEqual(heat, value / most, places=2)

    def test_the_day_and_the_map_agree(self):
        self.page.run("document.getElementById('day-worst').click()")
        for step in range(0, 720, 80):
            self.page.set_value("step-slider", step)
            self.page.run("document.getElementById('step-to-map').click()")
            self.page.wait(COMPLETE)
            same = self.page.run(f"""(() => {{
              const state = page.day.state(), student = page.map.maps[0].student;
              // As shared/features.cpp rounds hundredths of EUR and of percent to the lattice:
              // halves up.
              const price = Math.floor((Math.round(100 * state.price) + 50) / 100);
              const soc = Math.floor((Math.round(1e4 * state.soc) + 25) / 50);
              const action = student.decide(page.map.context, soc,
                                            Math.min(Math.max(price, -500), 1500));
              return action === page.day.day.policies[0].action[{step}];
            }})()""")
            self.assertTrue(same, f"step {step}")

    def test_the_ordinary_scale_is_narrower(self):
        self.page.run("document.getElementById('day-widest').click()")
        ranges = []
        for scale in ("all", "ordinary"):
            self.page.run(f"document.querySelector('[data-scale={scale}]').click()")
            ranges.append(
                self.page.run(
                    "(({min, max}) => max - min)(shownCharts.get('chart-price').chart.scales.y)"))
        self.assertLess(ranges[1], ranges[0])

    # What it looks like.

    def test_nothing_is_off_the_screen(self):
        for width in WIDTHS_PX:
            self.page.resize(width, 900)
            self.page.wait(f"innerWidth === {width}")
            self.page.run(
                "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
            beyond = self.page.run("""[...document.body.querySelectorAll("*")].filter((element) => {
              const box = element.getBoundingClientRect();
              return box.width > 0 && (box.right > innerWidth + .5 || box.left < -.5);
            }).map((element) => element.tagName + "#" + element.id + "." + element.className)
              .slice(0, 5)""")
            self.assertEqual(beyond, [], f"{width} px")
            self.assertLessEqual(self.page.run("document.documentElement.scrollWidth"), width)

    def test_light_and_dark(self):
        shown = []
        for dark in (False, True):
            self.page.set_dark(dark)
            self.page.run(
                "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
            colours = self.colours()
            self.assertGreater(contrast(colours["ink"], colours["paper"]), 7)
            self.assertGreater(contrast(colours["muted"], colours["paper"]), 4.5)
            self.assertGreater(contrast(colours["idle"], colours["paper"]), 1.5,
                               "idle is the background")
            background = self.page.run(
                "getComputedStyle(document.querySelector('.card')).backgroundColor")
            self.assertEqual(background, "rgb({}, {}, {})".format(*colours["paper"]))
            ticks = self.page.run(
                "shownCharts.get('chart-cumulative').chart.options.scales.x.ticks.color")
            self.assertEqual(of_hex(ticks), colours["muted"])
            self.show_map(6, 48, 7)
            self.assertIn(",".join(str(c) for c in colours["idle"]), self.pixel_counts(0))
            shown.append(colours)
        self.assertNotEqual(shown[0]["paper"], shown[1]["paper"])

    def test_nothing_is_fetched(self):
        fetched = [event["params"]["request"]["url"]
                   for event in self.page.events_of("Network.requestWillBeSent")]
        self.assertEqual([url for url in fetched if not url.endswith("/report.html")], [])

    def test_every_section_is_there(self):
        missing = self.page.run("""[...document.querySelectorAll("nav a")]
          .map((link) => link.getAttribute("href"))
          .filter((target) => !document.querySelector(target))""")
        self.assertEqual(missing, [])

    def test_a_broken_page_says_so(self):
        with open(self.path, encoding="utf-8") as file:
            broken = file.read().replace('"data":"', '"data":"AAAA', 1)
        path = os.path.join(self.folder.name, "broken.html")
        with open(path, "w", encoding="utf-8") as file:
            file.write(broken)
        tab = browser.Page(self.browser)
        try:
            tab.call("Page.navigate", {"url": "file://" + path})
            tab.wait("document.querySelector('.failure')")
            self.assertIn("could not be shown",
                          tab.run("document.querySelector('.failure').textContent"))
            self.assertTrue(tab.complaints())
        finally:
            tab.close()
            self.page.bring_to_front()


if __name__ == "__main__":
    if browser.chromium() is None:
        print("skipped: chromium is not installed (tools/setup --test)")
        sys.exit(77)
    unittest.main()
