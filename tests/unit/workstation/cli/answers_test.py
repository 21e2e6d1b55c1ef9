"""Every answer of --json and every table of bess-train against its printed schema, by
jsonschema.

answers_test.py PROGRAM          commands that take seconds
answers_test.py PROGRAM --full   also those that prove or distil a student: every one with --json
"""

import csv
import json
import os
import re
import subprocess
import sys
import tempfile
import tomllib
import unittest

import jsonschema  # Debian's python3-jsonschema: tools/setup --test

PROGRAM = os.path.abspath(sys.argv[1])
FULL = "--full" in sys.argv or os.environ.get("BESS_THOROUGH") == "1"
SLOW_ANSWERS = {"proof", "omega", "run"}
SLOW_COMMANDS = {"verify", "omega-sweep", "run", "runs compare"}
SLOW_TABLES = {"evaluation_days.csv", "omega_sweep.csv", "proof_rounds.csv", "violations.csv",
               "student_checkpoints.csv", "lost_days.csv", "lost_causes.csv", "lost_hours.csv"}


class Answers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.schema = json.loads(subprocess.run([PROGRAM, "schema"], check=True,
                                               capture_output=True).stdout)
        jsonschema.Draft202012Validator.check_schema(cls.schema)
        cls.folder = tempfile.TemporaryDirectory()
        cls.seen, cls.run_commands, cls.tables = set(), set(), set()
        with open(cls.file("few.toml"), "w") as config:
            config.write("[train]\nsteps = 20\n[distil]\nepochs = 60\n")
        with open(cls.file("rules.toml"), "w") as rules:
            rules.write('[[rule]]\nname = "no expensive charging"\nprice_min = 301\n'
                        'at_most = "idle"\n'
                        '[[rule]]\nname = "steady"\nnever_rises_with = "minute"\n')
        cls.bess(["prices", "simulate", "--days", "60", "--out", cls.file("market.csv")])

    @classmethod
    def file(cls, name):
        return os.path.join(cls.folder.name, name)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def bess(cls, arguments, code=0):
        done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True)
        assert done.returncode == code, (arguments, done.returncode, done.stderr)
        return done.stdout

    def validator(self, name):
        return jsonschema.Draft202012Validator({"$ref": f"#/$defs/{name}",
                                                "$defs": self.schema["$defs"]})

    def answers(self, *arguments, code=0):
        """Answer of a command, each line checked; all keys of a kind are always present."""
        arguments = [self.file(a[1:]) if a.startswith("@") else a for a in arguments]
        self.run_commands.add(re.match(r"((runs|rules|prices|sweep|battery|log) )?\S+",
                                       " ".join(arguments))[0])
        lines = [json.loads(line) for line in self.bess([*arguments, "--json"], code).splitlines()]
        self.assertTrue(lines, arguments)
        for line in lines:
            self.assertEqual(list(line)[:2], ["schema_version", "answer"])
            kind = "answer_" + line["answer"]
            self.validator(kind).validate(line)
            self.assertEqual(set(line), set(self.schema["$defs"][kind]["properties"]))
            self.seen.add(line["answer"])
        return lines

    def table(self, path, name=None):
        """A table's columns are those of the schema in their order, and its rows are as
        described."""
        name = name or os.path.basename(path)
        with open(path, newline="") as file:
            rows = csv.reader(line for line in file if not line.startswith("#"))
            header = next(rows)
            self.assertEqual(header, list(self.schema["$defs"][name]["properties"]), path)
            validator = self.validator(name)
            for number, row in enumerate(rows):
                if number < 50:
                    validator.validate({key: self.value(text) for key,
                                        text in zip(header, row, strict=True)})
        self.tables.add(name)

    @staticmethod
    def value(text):
        if text in ("", "true", "false"):
            return {"": None, "true": True, "false": False}[text]
        try:
            return int(text)
        except ValueError:
            pass
        try:
            return float(text)
        except ValueError:
            return text

    def test_1_prices(self):
        self.answers("prices", "stats", "@market.csv")
        with open(self.file("quarter.csv"), "w") as file:  # no minutes, no imbalance
            file.write("Datetime;Resolution code;Imbalance Price\n")
            for quarter in range(8):
                file.write(
                    f"2023-01-01T{quarter // 4:02}:{quarter % 4 * 15:02}:00+00:00;PT15M;"
                    f"{40 + quarter}\n")
        self.assertIsNone(self.answers("prices", "stats", "@quarter.csv")[0]["convergence"])
        self.table(self.file("market.csv"), "minutes.csv")

    def test_3_teacher_and_plain_student(self):
        self.answers("train", "--prices", "@market.csv", "--out", "@teacher.bin", "--steps", "20",
                     "--curve-out", "@curve.csv")
        self.answers("distil", "--prices", "@market.csv", "--teacher", "@teacher.bin", "--out",
                     "@plain.json",
                     "--plain", "--config", "@few.toml", "--curve-out", "@distil.csv", "--rules",
                     "@rules.toml")
        self.table(self.file("curve.csv"), "training_curve.csv")
        self.table(self.file("distil.csv"), "distil_curve.csv")

    def test_4_evaluate(self):
        common = ["--prices", "@market.csv", "--policy"]
        alone = self.answers("evaluate", *common, "rbc")[0]
        self.assertIsNone(alone["gain_over"])
        self.assertIsNone(alone["carried_over"])
        several = self.answers("evaluate", *common, "rbc", "rbc-tuned", "@plain.json", "foresight",
                               "--csv",
                               "@evaluation.csv", "--days-out", "@days.csv", "--steps-out",
                               "@steps.csv")
        self.assertEqual(several[1]["gain_over"], "rbc")
        self.assertEqual(several[3]["share_of_foresight"], 1)
        self.assertEqual(set(several[1]["carried_over"]) - {"carry_soc"}, set(several[1]) & set(
            several[1]["carried_over"]) - {"carry_soc"})
        carried = self.answers("evaluate", *common, "rbc", "rbc-tuned", "--carry-soc")[1]
        self.assertEqual(carried["gain_eur_per_day_per_mwh"],
                         several[1]["carried_over"]["gain_eur_per_day_per_mwh"])
        day = self.answers("evaluate", *common, "rbc", "rbc-tuned", "--date", "widest")[1]
        self.assertIsNone(day["gain_standard_error"])
        for name in ("evaluation.csv", "days.csv", "steps.csv"):
            self.table(self.file(name))

    def test_4_battery(self):
        with open(self.file("log.csv"), "w") as log:
            print("utc,soc_e4,battery_power_w,ordered_power_w,reason,mode,price_minute_utc,"
                  "price_centi_eur_per_mwh,price_age_s,student_action,battery_status,written,"
                  "price_level_centi_q16,outlook,break_even_centi,price_stands_in,stand_in_centi",
                  file=log)
            for cycle in range(40):
                at = f"2026-06-01T{cycle // 30:02}:{2 * cycle % 60:02}:00Z"
                print(f"{at},5000,{30 + cycle % 3},0,student,running,{at},5000,2,idle,ok,1,"
                      "327680000,none,0,0,0", file=log)
        with open(self.file("steps.toml"), "w") as steps:
            print("[battery]\ndelay_s = 2.5\nramp_w_per_s = 0\ntime_constant_s = 3", file=steps)
        with open(self.file("site.toml"), "w") as site:
            print("[battery]\nwear_eur_per_mwh = 25\n[costs]\nimport_percent = 5", file=site)
        keys = self.answers("battery", "fit", "--log", "@log.csv", "--steps", "@steps.toml",
                            "--config", "@site.toml", "--out", "@battery.toml")
        self.assertEqual([(k["key"], k["observations"]) for k in keys], [("standby_w", 38)])
        with open(self.file("battery.toml"), "rb") as file:
            fitted = tomllib.load(file)
        self.assertEqual(fitted["battery"]["delay_s"], 2.5)
        self.assertEqual(fitted["battery"]["wear_eur_per_mwh"], 25)
        self.assertEqual(fitted["costs"], {"import_percent": 5})
        shown = self.answers("evaluate", "--prices", "@market.csv", "--policy", "rbc",
                             "--config", "@battery.toml")
        self.assertEqual(len(shown), 1)
        compared = self.answers("log", "compare", "@log.csv", "--policy", "rbc", "compiled")
        self.assertEqual([c["policy"] for c in compared],
                         ["this battery", "rbc", "compiled", "foresight"])
        replayed = self.answers("log", "replay", "@log.csv", "--student", "compiled")[0]
        self.assertEqual(replayed["compared"], 40)

    def test_5_rules(self):
        check = ["rules", "check", "--rules", "@rules.toml"]
        self.assertIsNone(self.answers(*check)[0]["decisions"])
        with_policy = self.answers(*check, "--policy", "rbc", "--prices", "@market.csv")
        self.assertEqual([r["rule"] for r in with_policy][-2:], ["no expensive charging", "steady"])
        price = self.answers("rules", "price", "--rules", "@rules.toml", "--prices", "@market.csv",
                             "--policy", "rbc")
        self.assertIsNone(price[1]["gain_eur_per_day_per_mwh"],
                          "steady says nothing of single states")

    def test_6_backtest(self):
        backtest = ["--prices", "@market.csv", "--out", "@backtest", "--window-days", "30",
                    "--policy", "rbc", "tabular"]
        line = self.answers("backtest", *backtest)[0]
        with open(self.file("backtest/backtest.json")) as file:
            self.assertEqual(json.load(file), line)
        for name in ("backtest.csv", "backtest_days.csv"):
            self.table(self.file("backtest/" + name))

    @unittest.skipUnless(FULL, "minutes: with --full")
    def test_7_students(self):
        learn = ["--prices", "@market.csv", "--teacher", "@teacher.bin", "--config", "@few.toml"]
        student = self.answers("distil", *learn, "--out", "@student.json")[0]
        self.assertEqual(student["rules"], [])
        proof = self.answers("verify", "--student", "@student.json")[0]
        self.assertTrue(proof["proved"])
        self.answers("verify", "--student", "@plain.json", "--rules", "@rules.toml", code=1)
        self.answers("omega-sweep", "--prices", "@market.csv", "--teacher", "@teacher.bin", "--out",
                     "@sweep",
                     "--omega", "1e-3", "--epochs", "1")
        self.table(self.file("sweep/omega_sweep.csv"))

    @unittest.skipUnless(FULL, "minutes: with --full")
    def test_8_runs(self):
        lines = self.answers("run", "--prices", "@market.csv", "--config", "@few.toml", "--rules",
                             "@rules.toml",
                             "--out", "@runs/first")
        self.assertEqual(self.answers("runs", "compare", "@runs"), lines)
        run = self.file("runs/first/")
        for name in ("evaluation.csv", "evaluation_days.csv", "training_curve.csv",
                     "distil_curve.csv",
                     "proof_rounds.csv", "student_checkpoints.csv", "lost_days.csv",
                     "lost_causes.csv",
                     "lost_hours.csv"):
            self.table(run + name)
        self.table(run + "student_plain_violations.csv", "violations.csv")

    def test_8_sweep(self):
        planned = self.bess(["sweep", "plan", "--prices", self.file("market.csv"), "--out",
                             self.file("sweeps"), "--set", "distil.fidelity=1,2", "--seeds", "3"])
        self.assertIn("6 tasks, 6 new", planned)
        done = self.answers("sweep", "collect", "@sweeps", "--partial")[0]
        self.assertEqual([done["tasks"], done["missing"], done["proved"]], [6, 6, 0])

    def test_8_size(self):
        with open(self.file("plan.toml"), "w") as plan:
            plan.write(
                '[size]\npower_kw = [5, 10]\ncapacity_kwh = [10]\nwindow_days = 30\npolicy = '
                '"rbc"\n'
                       '[[contract]]\nname = "a, b"\n[purchase]\neur_per_kwh = 300\n')
        self.answers("size", "--prices", "@market.csv", "--plan", "@plan.toml", "--out", "@sizes")
        self.table(self.file("sizes/size.csv"))

    def test_8_impact(self):
        answer = self.answers("impact", "--fleet-mw", "300", "0", "--policy", "rbc", "--train-days",
                              "10", "--test-days",
                              "2", "--seeds", "1", "--rounds", "1", "--out", "@impact")[0]
        self.assertEqual(len(answer["fleets"]), 3 * 2 * 5)
        self.table(self.file("impact/impact.csv"))

    def test_9_nothing_is_left_out(self):
        """Every command with --json was run, and every kind of answer and table occurred."""
        kinds = {name.removeprefix("answer_") for name in self.schema["$defs"]
                 if name.startswith("answer_")}
        tables = {name for name in self.schema["$defs"] if name.endswith(".csv")}
        commands = self.commands_with_json([])
        slow = (set(), set(), set()) if FULL else (SLOW_ANSWERS, SLOW_COMMANDS, SLOW_TABLES)
        self.assertEqual(kinds - slow[0], self.seen)
        self.assertEqual(commands - slow[1], self.run_commands)
        self.assertEqual(tables - slow[2], self.tables)

    def commands_with_json(self, path):
        text = self.bess([*path, "--help"])
        found = {" ".join(path)} if re.search(r"^\s+--json", text, re.M) else set()
        part = re.search(r"^[A-Z][\w -]*commands:\n(.*)", text, re.S | re.M)
        for name in re.findall(r"^  ([a-z-]+)\s", part[1] if part else "", re.M):
            found |= self.commands_with_json([*path, name])
        return found


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
