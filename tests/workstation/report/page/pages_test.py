#!/usr/bin/env python3
"""pages_test.py FIXTURE_PROGRAM BESS_TRAIN: every page that bess-train writes, in a headless
Chromium: of a run, of one with rules, of one whose proof failed, of a backtest and of many runs.
What they look like, narrow and wide, light and dark; that every number in their tables is that of
their JSON; how many runs are sorted; and the rules on the maps, held against what the C++ counts.

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
import tabs

FIXTURE = sys.argv.pop(1) if len(sys.argv) > 1 else ""
BESS_TRAIN = sys.argv.pop(1) if len(sys.argv) > 1 else ""
WIDTHS_PX = (1440, 800, 375)
RUNS = {"run": "", "ruled": "ruled", "failed": "failed"}
OTHERS = {"backtest": "backtest/backtest.html", "many": "many.html"}
NOTHING = "\u2013"
FINISHED = ("run-10", "run-9", "ruled", "losing", "other-days")
UNFINISHED = ("failed", "stopped", "edited")
PROFIT = "profit_eur_per_day_per_mwh"
GAIN = "gain_eur_per_day_per_mwh"
WEAR = "profit_at_wear_10_eur_per_day_per_mwh"
ERRORS = ("profit_standard_error", "profit_standard_error_by_month")
GAIN_AND_ERRORS = (GAIN, "gain_standard_error", "gain_standard_error_by_month")
COMPLETE = ("[...document.querySelectorAll('canvas.map')]"
            ".every((canvas) => canvas.dataset.complete === 'true')")
NUMBER = re.compile(r"[-+\u2212]?\d[\d,]*(?:\.\d+)?")


def numbers_of(text):
    """[(value, decimals)] of a text: "+1,234.5 \u00b1 2" has two."""
    found = []
    for token in NUMBER.findall(text):
        plain = token.replace(",", "").replace("\u2212", "-")
        found.append((float(plain), len(plain.partition(".")[2])))
    return found


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


class Pages(tabs.Tabs):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        subprocess.run([FIXTURE, cls.folder.name], check=True)
        cls.compare_runs(FINISHED + UNFINISHED, "--html", "many.html")
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
            cls.tabs[name].call("Page.navigate",
                                {"url": "file://" + os.path.join(cls.folder.name, path)})
            cls.tabs[name].wait(
                "document.readyState === 'complete' && document.querySelector('table')")

    @classmethod
    def compare_runs(cls, names, *options):
        """Standard output of bess-train runs compare."""
        folders = ["many/" + name for name in names]
        return subprocess.run([BESS_TRAIN, "runs", "compare", *folders, *options],
                              cwd=cls.folder.name,
                              check=True, capture_output=True, text=True).stdout

    def rows_of(self, tab, selector):
        """[[name, {label: text} in order as list of pairs]] of a table's body."""
        return tab.run(f"""[...document.querySelectorAll({json.dumps(selector)} + " tbody tr")]
          .map((row) => [
          row.querySelector("th").textContent,
          [...row.querySelectorAll("td")].map((cell) =>
            [cell.dataset.label, cell.textContent])])""")

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
                *([None] * 3 if is_first else [mean(gain), error_of_mean(gain),
                                               error_by_month(dates, gain)]),
                min(own), mean([day["cycles"] for day in days]),
                mean([day["switches"] for day in days]),
                100 * mean(own) / mean(self.profits(name, "foresight", carried)),
                mean(self.profits(name, policy, carried, 10))]

    def test_comparisons_are_those_of_the_days(self):
        for name in RUNS:
            rows = self.rows_of(self.tab(name), "#comparison")
            policies = [policy for policy in self.expected[name]["days"]
                        if not policy.startswith("plain student under")]
            self.assertEqual([row[0] for row in rows], policies * 3)
            for at, (policy, cells) in enumerate(rows):
                table = at // len(policies)
                capacity = self.expected[name]["capacity_mwh"]
                wanted = ([capacity * mean(self.profits(name, policy, carried))
                           for carried in (False, True)]
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
        for name, student in (("run", "corrected student"), ("ruled", "corrected student"),
                              ("failed", "unproved student")):
            tab = self.tab(name)
            self.assertEqual(
                float(tab.run("document.getElementById('headline-profit').textContent")),
                             round(mean(self.profits(name, student)), 1))
            self.assertIn("the " + student,
                          tab.run("document.querySelector('.hero .figure').textContent"))
            for row in tab.run("""[...document.querySelectorAll(".gains tbody tr")].map((row) => [
                row.querySelector("th").firstChild.data,
                [...row.querySelectorAll(".number")].map((c) => c.textContent)])"""):
                for wear, text in zip((0, 10), row[1]):
                    gains = [a - b for a, b in zip(self.profits(name, student, wear=wear),
                                                   self.profits(name, row[0], wear=wear))]
                    shown, decimals = numbers_of(text)[0]
                    self.assertAlmostEqual(shown, mean(gains), delta=.5001 * 10 ** -decimals,
                                           msg=f"{name}, {row[0]}")
                    error, decimals = numbers_of(text)[1]
                    self.assertAlmostEqual(error, error_of_mean(gains),
                                           delta=.5001 * 10 ** -decimals)

    def test_rules_and_their_prices_are_those_of_the_days_and_of_the_proof(self):
        for name, student in (("ruled", "corrected student"), ("failed", "unproved student")):
            tab = self.tab(name)
            demands = {demand["text"]: demand for demand in self.expected[name]["demands"]}
            tables = tab.run(
                "[...document.querySelectorAll('#rules table')].map((table, i) => table.id = "
                "'rules-' + i)")
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
                others = {"all rules together": ("plain student under all rules", "plain student"),
                          "both": (student, "plain student")}
                with_it, without = others.get(part) or (
                    (student, "plain student under all rules") if "correction" in part
                    else ("plain student under \"%s\"" % part.removesuffix(", alone"),
                          "plain student"))
                for wear, (_, text) in zip((0, 10), cells):
                    wanted = mean([a - b for a, b in zip(self.profits(name, with_it, wear=wear),
                                                         self.profits(name, without, wear=wear))])
                    shown, decimals = numbers_of(text)[0]
                    self.assertAlmostEqual(shown, wanted, delta=.5001 * 10 ** -decimals,
                                           msg=f"{name}, {part}")

    def json_of(self, path):
        with open(os.path.join(self.folder.name, path), encoding="utf-8") as file:
            return json.load(file)

    def lines_of(self, path):
        with open(os.path.join(self.folder.name, path), encoding="utf-8") as file:
            return [json.loads(line) for line in file]

    def says(self, text, values, message=""):
        """The text has these numbers, rounded, and no others."""
        found = numbers_of(text)
        self.assertEqual(len(found), len(values), f"{message}: {text}")
        for (shown, decimals), value in zip(found, values):
            self.assertAlmostEqual(shown, value, delta=.5001 * 10 ** -decimals,
                                   msg=f"{message}: {text}")

    def row_holds(self, name, cells, wanted):
        """Each cell has its label and says its value: a number, None for none, or a text."""
        self.assertEqual([label for label, _ in cells], list(wanted), name)
        for label, text in cells:
            value = wanted[label]
            if value is None or isinstance(value, str):
                self.assertEqual(text, NOTHING if value is None else value, f"{name}, {label}")
            else:
                self.says(text, [value], f"{name}, {label}")

    def tables_of(self, tab):
        """Rows of each table of the page, by its caption."""
        captions = tab.run("""[...document.querySelectorAll("table")].map((table, i) => {
          table.dataset.at = i;
          return table.caption.textContent; })""")
        return {caption: self.rows_of(tab, f'table[data-at="{i}"]')
                for i, caption in enumerate(captions)}

    def test_a_backtest_is_that_of_its_json(self):
        tab, result = self.tab("backtest"), self.json_of("backtest/backtest.json")
        policies = {policy["policy"]: policy for policy in result["policies"]}
        first = result["policies"][0]["policy"]
        total, by_month = self.tables_of(tab).values()
        self.assertEqual([name for name, _ in total], list(policies))
        for name, cells in total:
            of = policies[name]
            gain, error, by_months = [None if name == first else of[key] for key in GAIN_AND_ERRORS]
            self.row_holds(name, cells, {
                "Profit": of[PROFIT], "s.e. over days": of[ERRORS[0]], "By month": of[ERRORS[1]],
                "Gain": gain, "Its s.e.": error, "Gain by month": by_months, "At wear 10": of[WEAR],
                "Cycles a day": of["cycles_per_day"], "Drawdown": of["drawdown_eur_per_mwh"]})
        with open(os.path.join(self.folder.name, "backtest/backtest.csv"),
                  encoding="utf-8") as file:
            lines = {(line["policy"], line["month"]): line for line in csv.DictReader(file)}
        fitted = {month["month"]: month["fitted_days"] for month in result["months"]}
        self.assertEqual([name for name, _ in by_month], [*policies, "fitted on days"])
        for name, cells in by_month:
            self.assertEqual([label for label, _ in cells], list(fitted))
            for month, text in cells:
                keys = (PROFIT,) if name == first else (PROFIT, GAIN)
                wanted = ([float(lines[name, month][key]) for key in keys] if name in policies
                          else [fitted[month]])
                self.says(text, wanted, f"{name}, {month}")

    def test_the_text_of_a_backtest_is_that_of_its_json(self):
        tab, result = self.tab("backtest"), self.json_of("backtest/backtest.json")
        fitted = [month["fitted_days"] for month in result["months"]]
        best = max(result["policies"], key=lambda policy: policy[PROFIT])
        caption = tab.run("document.querySelector('figcaption').firstChild.data")
        fall = [best["drawdown_eur_per_mwh"]] if best["drawdown_eur_per_mwh"] > 0 else []
        self.says(caption, [min(fitted), max(fitted), result["window_days"], best[PROFIT], *fall])
        self.assertIn(best["policy"] + " earned most", caption)
        self.assertIn(f"valued at {result['policies'][0]['charge_price_eur_per_mwh']:.2f} EUR/MWh",
                      tab.run("document.querySelector('.note').textContent"))
        def items(of):
            return tab.run(
                f"[...document.querySelectorAll('{of} li')].map((item) => item.textContent)")
        self.assertEqual(items("ul.note"), [f"{month['month']} is not traded: {month['reason']}"
                                            for month in result["not_traded"]])
        self.assertEqual(
            tab.run("shownCharts.get('profit').chart.data.datasets.map((line) => line.label)"),
                         [policy["policy"] for policy in result["policies"]])

    # Many runs.

    def days_of_run(self, name):
        """Profit by date of a run's student, charge carried over, EUR of the whole battery."""
        path = os.path.join(self.folder.name, "many", name, "evaluation_days.csv")
        with open(path, encoding="utf-8") as file:
            return {line["date"]: float(line["profit_eur"]) for line in csv.DictReader(file)
                    if (line["policy"], line["carry_soc"]) == ("corrected student", "true")}

    def gain_of_run(self, name):
        """Over the first run, from the days; None where they are not the same."""
        own, first = self.days_of_run(name), self.days_of_run(FINISHED[0])
        if name == FINISHED[0] or own.keys() != first.keys():
            return None
        gain = [(own[date] - first[date]) / self.expected["run"]["capacity_mwh"] for date in own]
        return [mean(gain), error_of_mean(gain), error_by_month(list(own), gain)]

    def test_many_runs_are_those_of_the_json(self):
        rows = dict(self.rows_of(self.tab("many"), "#runs"))
        of_json = [json.loads(line) for line in self.compare_runs(FINISHED, "--json").splitlines()]
        self.assertEqual(set(rows), {"many/" + name for name in FINISHED + UNFINISHED})
        for short, run in zip(FINISHED, of_json, strict=True):
            name = "many/" + short
            self.assertEqual(name, run["run"])
            text = dict(rows[name])
            carried, reset = [next(row for row in run["policies"]
                                   if row["policy"] == "corrected student"
                                   and row["carry_soc"] == way)
                              for way in (True, False)]
            errors = [carried[key] for key in ERRORS if carried[key] is not None]
            self.says(text["Carried over"], [carried[PROFIT], *errors], name)
            gain = self.gain_of_run(short)
            self.assertEqual(gain is None, short in ("run-10", "other-days"))
            if gain is None:
                self.assertEqual(text["Gain"], NOTHING, name)
            else:
                self.says(text["Gain"], gain, name)
            whole = mean(list(self.days_of_run(short).values()))
            for label, value in (("Seed", run["seed"]), ("Days", carried["days"]),
                                 ("EUR/day, whole battery", whole), ("At wear 10", carried[WEAR]),
                                 ("% of foresight", 100 * carried["share_of_foresight"]),
                                 ("Same charge each day", reset[PROFIT]),
                                 ("Proof", run["states_checked"])):
                self.says(text[label], [value], f"{name}, {label}")
            self.assertEqual(text["Weights"], run["weights_hash"])
            self.assertEqual(text["State"], "finished")

    def test_runs_without_figures_say_why(self):
        rows = {name: dict(cells) for name, cells in self.rows_of(self.tab("many"), "#runs")}
        for name, state, proof in (("failed", "ended without a proof",
                                    "not proved: property 3: 23994"),
                                   ("stopped", "stopped after the teacher", NOTHING)):
            self.assertEqual(rows["many/" + name]["State"], state)
            self.assertEqual(rows["many/" + name]["Proof"], proof)
        self.assertIn("evaluation_days.csv: is not what the run wrote",
                      rows["many/edited"]["State"])
        self.assertIn("'bess-train report --run many/edited' makes it again",
                      rows["many/edited"]["State"])
        for name in UNFINISHED:
            for label in ("Days", "Carried over", "Gain", "EUR/day, whole battery", "At wear 10",
                          "% of foresight", "Same charge each day"):
                self.assertEqual(rows["many/" + name][label], NOTHING, f"{name}, {label}")

    def test_a_run_leads_to_its_page(self):
        tab = self.tab("many")
        links = tab.run("""[...document.querySelectorAll("#runs a")].map(
          (link) => [link.textContent, link.getAttribute("href")])""")
        self.assertEqual(sorted(links), [[f"many/{name}", f"many/{name}/report.html"]
                                         for name in sorted(FINISHED + UNFINISHED)
                                         if name != "stopped"])
        for _, link in links:
            self.assertTrue(os.path.exists(os.path.join(self.folder.name, link)), link)

    def column(self, tab, label):
        """What each row of the first table shows in a column, from the top."""
        rows = self.rows_of(tab, "#runs")
        return [name if label == "Run" else dict(cells)[label] for name, cells in rows]

    def order_holds(self, tab, label, descending):
        """A column is in order: numbers as numbers, texts as people count, what is unknown last."""
        def natural(text):
            return [(0, int(part), "") if part.isdigit() else (1, 0, part)
                    for part in re.split(r"(\d+)", text) if part]
        texts = self.column(tab, label)
        known = [text for text in texts if text not in (NOTHING, "")]
        self.assertEqual(texts[:len(known)], known, f"{label}: what is unknown comes last")
        is_number = label not in ("Run", "State", "Proof", "Rules", "Weights")
        keys = [numbers_of(text)[0][0] if is_number else natural(text) for text in known]
        self.assertEqual(keys, sorted(keys, reverse=descending), f"{label}, {descending}")
        arrows = tab.run("""[...document.querySelectorAll("#runs th[aria-sort]")].map(
          (head) => [head.textContent, head.getAttribute("aria-sort")])""")
        self.assertEqual(arrows, [[label, "descending" if descending else "ascending"]])

    def heads(self, tab):
        return tab.run(
            "[...document.querySelectorAll('#runs thead th')].map((head) => head.textContent)")

    def test_heads_sort_both_ways(self):
        tab = self.tab("many")
        before = sorted(map(str, self.rows_of(tab, "#runs")))
        orders = set()
        for at, label in enumerate(self.heads(tab)):
            for descending in (False, True, False):
                tab.run(f"document.querySelectorAll('#runs thead button')[{at}].click()")
                self.order_holds(tab, label, descending)
                orders.add(str(self.column(tab, "Run")))
        self.assertEqual(sorted(map(str, self.rows_of(tab, "#runs"))), before,
                         "rows keep their cells")
        self.assertGreater(len(orders), 8)
        tab.run("document.querySelector('#runs thead button').click()")
        names = self.column(tab, "Run")
        self.assertLess(names.index("many/run-9"), names.index("many/run-10"))

    def press(self, tab, key, code):
        event = {"key": key, "windowsVirtualKeyCode": code}
        typed = {"Enter": {"text": "\r"}, " ": {"text": " "}}.get(key, {})
        tab.call("Input.dispatchKeyEvent", {"type": "keyDown", **event, **typed})
        tab.call("Input.dispatchKeyEvent", {"type": "keyUp", **event})

    def test_the_keyboard_sorts(self):
        tab = self.tab("many")
        heads = self.heads(tab)
        tab.run("document.querySelector('#runs thead button').focus()")
        for at, label in enumerate(heads):
            self.assertEqual(tab.run("document.activeElement.textContent"), label, "Tab goes on")
            if at % 4 == 1:
                descending = tab.run(
                    "document.activeElement.closest('[aria-sort=ascending]') !== null")
                for key, code in (("Enter", 13), (" ", 32)):
                    self.press(tab, key, code)
                    self.order_holds(tab, label, descending)
                    descending = not descending
            self.press(tab, "Tab", 9)

    def test_a_list_sorts_where_heads_are_hidden(self):
        tab = self.tab("many", 375)
        self.assertFalse(tab.run("document.querySelector('#runs thead').checkVisibility()"))
        self.assertTrue(tab.run("document.querySelector('select.sorting').checkVisibility()"))
        tab.run("document.querySelector('select.sorting').id = 'sorting'")
        for at, label in enumerate(self.heads(tab)):
            for sign in "+-":
                tab.set_value("sorting", f"{at}{sign}")
                self.order_holds(tab, label, sign == "-")

    def test_a_table_of_texts_and_numbers_is_sorted_as_it_says(self):
        tab = self.tab("many")
        tab.run("""document.body.insertAdjacentHTML("beforeend",
          `<table id="odd"><thead><tr><th>x</th></tr></thead><tbody>
          ${["10", "9", "-2", "", "1e2", "0.5"].map((value) =>
            `<tr><td data-sort="${value}">${value}</td></tr>`).join("")}</tbody></table>`)""")
        def sorted_by(descending):
            tab.run(f"sortTable(document.getElementById('odd'), 0, {json.dumps(descending)})")
            return tab.run(
                "[...document.querySelectorAll('#odd td')].map((cell) => cell.textContent)")
        self.assertEqual(sorted_by(False), ["-2", "0.5", "9", "10", "1e2", ""])
        self.assertEqual(sorted_by(True), ["1e2", "10", "9", "0.5", "-2", ""])
        tab.run("document.querySelector('#odd td').dataset.sort = 'b 10'")
        self.assertEqual(sorted_by(False)[-1], "", "texts, now that one is")
        tab.run("document.getElementById('odd').remove()")

    # Whoever does not see them.

    def test_headings_tables_and_pictures_can_be_read_aloud(self):
        for name in self.tabs:
            with self.subTest(page=name):
                self.assertEqual(looks.not_read_aloud(self.tab(name)), [])

    def test_what_has_the_focus_is_seen(self):
        for name in self.tabs:
            for dark in (False, True):
                with self.subTest(page=name, dark=dark):
                    self.assertEqual(looks.unseen_focus(self.tab(name, dark=dark)), [])

    # A failed run.

    def test_a_failed_run_leads_to_the_states_where_it_is_wrong(self):
        tab = self.tab("failed")
        self.assertNotIn("orrected student", tab.run("document.body.innerText"))
        self.assertIn("where its proof failed", tab.run("document.querySelector('h1').textContent"))
        broken = [demand for demand in self.expected["failed"]["demands"]
                  if demand["violations"] > 0]
        shown = tab.run("[...document.querySelectorAll('#broken dd')].map((dd) => dd.textContent)")
        self.assertEqual(len(shown), len(broken))
        for text, demand in zip(shown, broken):
            self.assertIn(f"{demand['violations']:,} violations", text)
            self.assertIn("To mend: ", text)
        buttons = tab.run(
            "[...document.querySelectorAll('[data-broken]')].map((b) => Number(b.dataset.broken))")
        self.assertTrue(buttons)
        for button in buttons:
            tab.run(f"document.querySelector('[data-broken=\"{button}\"]').click()")
            tab.wait(COMPLETE)
            minute, quarter_hour, context_class, soc, price = tab.run(f"page.data.broken[{button}]")
            self.assertEqual(tab.run("page.map.context"),
                             {"minute": minute, "quarterHour": quarter_hour,
                              "contextClass": context_class})
            self.assertEqual(tab.run("page.map.marked"), {"price": price, "soc": soc / 200})
            self.assertIn("states against", tab.run("page.map.maps[0].found.textContent"))

    # Rules on the maps.

    def show_map(self, tab, context_class, quarter_hour, minute):
        for name, value in (("context", context_class), ("quarter", quarter_hour),
                            ("minute", minute)):
            tab.set_value(name + "-slider", value)
        tab.wait(COMPLETE)

    def test_what_breaks_a_rule_is_what_the_proof_counts(self):
        seen = 0
        for name in ("ruled", "failed"):
            tab = self.tab(name)
            tab.run("document.querySelector('[data-window=all]').click()")
            students = list(self.expected[name]["students"].values())
            for at, wanted in enumerate(students[0]["maps"]):
                self.show_map(tab, wanted["context_class"], wanted["quarter_hour"],
                              wanted["minute"])
                for index, student in enumerate(students):
                    found = tab.run(f"""Object.fromEntries(
                      page.map.maps[{index}].violations.rules.map(
                        ({{rule, cells}}) => [rule.name, cells.length]))""")
                    counts = {rule: n for rule, n in student["broken_rules"][at].items()
                              if n > 0 and rule != "falls with price"}
                    self.assertEqual(found, counts, f"{name}, student {index}, map {at}")
                    order = tab.run(
                        f"page.map.maps[{index}].violations.order.filter((v) => v.towards === "
                        f"'price').length")
                    self.assertEqual(order, student["broken_rules"][at]["falls with price"])
                    seen += sum(counts.values())
            tab.run("document.querySelector('[data-window=decisions]').click()")
        self.assertGreater(seen, 1000)

    def pixel(self, tab, price, soc):
        """Colour of the first map at a state, and where the pointer must be for it, in the
        window."""
        return tab.run(f"""(() => {{
          const map = page.map.maps[0], {{xOf, yOf}} = page.map.frame(map);
          const x = xOf({price}), y = yOf({soc});
          const box = map.canvas.getBoundingClientRect();
          const copy = new OffscreenCanvas(map.canvas.width, map.canvas.height)
            .getContext("2d", {{willReadFrequently: true}});
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
          const copy = new OffscreenCanvas(canvas.width, canvas.height)
            .getContext("2d", {{willReadFrequently: true}});
          copy.drawImage(canvas, 0, 0);
          return [-1, 0].map((dx) => [...copy.getImageData(
            Math.round({edge["left"]}) + dx, Math.round({edge["y"]}), 1, 1).data].slice(0, 3));
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
        keys = tab.run(
            "[...document.querySelectorAll('#rule-keys button')].map((b) => [b.textContent, "
            "b.disabled])")
        self.assertEqual(len(keys), 5)
        self.assertIn("Held to it: student; does not hold at this time", keys[0][0])
        self.assertEqual([disabled for _, disabled in keys], [False, True, False, True, True])
        tab.run("document.querySelectorAll('#rule-keys button')[0].click()")
        tab.wait(COMPLETE)
        self.assertEqual(tab.run("page.map.context.quarterHour"), 40, "10:00")
        self.assertIn("holds on this map",
                      tab.run("document.querySelector('#rule-keys button').textContent"))
        self.assertTrue(self.tab("run").run("document.getElementById('rule-keys').hidden"),
                        "no rules, no legend")


if __name__ == "__main__":
    if browser.chromium() is None:
        print("skipped: chromium is not installed (tools/setup --test)")
        sys.exit(77)
    unittest.main()
