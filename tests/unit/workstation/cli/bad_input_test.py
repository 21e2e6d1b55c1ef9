"""Bad inputs of past defects (hang, acceptance, a library's message): each ends with its code
and one clear line that names the correction, and leaves no files. bad_input_test.py PROGRAM
"""

import errno
import fcntl
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import unittest

PROGRAM = os.path.abspath(sys.argv[1])

STUDENT_KEYS = '{"format": "bess-student", "version": 3, "version": 4}'
RULE = '[[rule]]\nname = "a"\nis = "idle"\nhours = "22:00-06:00"\n'
LONG = "x" * 300
LOG_COLUMNS = ("utc,soc_e4,battery_power_w,ordered_power_w,reason,mode,price_minute_utc,"
               "price_centi_eur_per_mwh,price_age_s,student_action,battery_status,written,"
               "price_level_centi_q16,outlook,break_even_centi,price_stands_in,stand_in_centi\n")
LOG_REST = ",running,2026-06-01T00:00:00Z,5000,2,idle,ok,1,327680000,none,0,0,0\n"
# Arguments, exit code, required words of the line.
CASES = [
    # A pipe without a writer, a link to itself, a name that is too long: for every kind of file.
    ("evaluate --policy rbc --prices pipe", 1, "pipe 10 s"),
    ("config --config loop", 1, "loop"),
    ("rules check --rules loop", 1, "loop"),
    ("evaluate --prices market.csv --policy loop", 1, "loop"),
    ("runs compare loop", 1, "loop"),
    ("run --prices market.csv --out new --from-teacher loop", 1, "loop"),
    ("train --prices market.csv --out loop", 1, "loop"),
    # A file where a folder is needed, also further up: it is the one to name.
    ("train --prices market.csv --out market.csv/teacher.bin", 1, "market.csv"),
    ("run --prices market.csv --out few.csv/runs/first", 1, "few.csv"),
    (f"config --config {LONG}", 1, LONG[:50]),
    (f"evaluate --prices market.csv --policy {LONG}", 1, LONG[:50]),
    (f"train --prices market.csv --out {LONG}", 1, LONG[:50]),
    (f"verify --student {LONG}", 1, LONG[:50]),
    # Reported once, and by the right name.
    ("evaluate --policy rbc --prices market.csv --accept gapss", 2, '--accept "gapss"'),
    ("config --config scalar.toml", 1, 'scalar.toml:1 battery table'),
    ("config --config list.toml", 1, 'list.toml:1 battery table'),
    # Twice: ambiguous.
    ("verify --student twice.json", 1, 'twice.json "version"'),
    ("export --student twice.json --out new.h", 1, 'twice.json "version"'),
    ("runs compare twice", 1, 'twice "prices"'),
    # Other line ends, times in the past, invalid addresses.
    ("evaluate --policy rbc --prices cr.csv", 1, "cr.csv CR"),
    ("prices stats cr.csv", 1, "cr.csv CR"),
    ("prices fetch --from 2023-03-01 --to 2023-03-02 --out new.csv --base-url http://", 1,
     '--base-url "http://"'),
    ("prices fetch --from 2023-03-01 --to 2023-03-02 --out new.csv --base-url "
     "http://127.0.0.1:99999/a", 1,
     "http://127.0.0.1:99999/a"),
    # Reported before the work, and by name.
    ("backtest --prices market.csv --out new --window-days 30 --policy sdp nope", 1,
     "--policy nope"),
    ("backtest --prices market.csv --out new --window-days 30 --policy teacher scalar.toml", 1,
     "scalar.toml"),
    ("evaluate --prices market.csv --policy mpc rbc:9:1", 1, "LOW HIGH"),
    ("run --prices few.csv --out new", 1, "few.csv 26"),
    ("evaluate --policy rbc --prices hour.csv", 1, "hour.csv"),
    ("run --prices hour.csv --out new", 1, "hour.csv"),
    ("backtest --prices market.csv --out new", 1, "60 120"),
    ("battery fit --log few.csv", 1, 'few.csv "utc"'),
    ("battery fit --log log.csv", 1, "log.csv 2"),
    ("battery fit --log log.csv --out log.csv", 1, "--log log.csv"),
    ("battery fit --log nowhere.csv", 1, "nowhere.csv"),
    ("battery fit --out new.toml", 1, "--log --steps"),
    ("battery fit --steps steps.toml", 1, "ramp_w_per_s"),
    ("battery fit --steps single.toml", 1, "single.toml [battery]"),
    # Invalid as TOML.
    ("config --config cr.toml", 1, "cr.toml:1 CR LF"),
    ("rules check --rules single.toml", 1, "single.toml:1 [rule] [[rule]]"),
    # Correct input, which must stay accepted.
    ("evaluate --policy rbc --prices /dev/zero", 1, "/dev/zero 512 MiB"),
    ("evaluate --policy rbc --prices folder", 1, "folder"),
    ("evaluate --policy rbc --prices february.csv", 1, "february.csv:4"),
    ("evaluate --policy rbc --prices doubled.csv", 1, "doubled.csv:5"),
    ("evaluate --policy rbc --prices swapped.csv", 1, "swapped.csv:3 minute_utc,indicative_eur"),
    ("evaluate --policy rbc --prices trailing.csv.gz", 1, "trailing.csv.gz gzip"),
    ("train --prices market.csv --prices market.csv --out new.bin", 2, "--prices 2"),
    ("prices fetch --from 2023-02-30 --to 2023-03-02 --out new.csv", 1, "2023-02-30"),
    ("prices import summer.csv --out new.csv", 1, "summer.csv:2 2023-10-29T02:30:00"),
]


class BadInputs(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = self.scratch.name
        self.bess("prices simulate --days 40 --out market.csv")
        with open(self.path("market.csv")) as file:
            market = file.read()
        lines = market.splitlines(True)
        head, rows = "".join(lines[:3]), lines[3:]
        self.assertTrue(lines[2].startswith("minute_utc"))
        texts = {
            "cr.csv": market.replace("\n", "\r"),
            "february.csv": head + "2023-02-30T00:00:00Z,1,1\n" + "".join(rows),
            "doubled.csv": head + rows[0] + "".join(rows),
            "swapped.csv": head.replace("indicative_eur_mwh,settled_eur_mwh",
                                        "settled_eur_mwh,indicative_eur_mwh"),
            "summer.csv": "Datetime;Resolution code;Imbalance Price\n2023-10-29T02:30:00;PT15M;5\n",
            "scalar.toml": "battery = 3\n",
            "log.csv": LOG_COLUMNS
                       + "2026-06-01T00:00:00Z,5000,0,0,student" + LOG_REST
                       + "2026-06-01T00:02:00Z,5000,0,0,student" + LOG_REST,
            "steps.toml": "[battery]\ndelay_s = 2\n",
            "few.csv": head + "".join(rows[: 15 * 1440]),
            "hour.csv": head + "".join(rows[:60]),
            "cr.toml": "[train]\rsteps = 100\r",
            "single.toml": RULE.replace("[[rule]]", "[rule]"),
            "list.toml": "[[battery]]\npower_w = 1\n",
            "rules.toml": RULE,
            "twice.json": STUDENT_KEYS,
            "twice/run.json": '{"prices": "a", "prices": "b", "identity": {}}',
        }
        os.mkdir(self.path("twice"))
        os.mkdir(self.path("folder"))
        for name, text in texts.items():
            with open(self.path(name), "w", newline="") as file:
                file.write(text)
        packed = subprocess.run(["gzip"], input=market.encode(), capture_output=True,
                                check=True).stdout
        with open(self.path("trailing.csv.gz"), "wb") as file:
            file.write(packed + b"more")
        os.mkfifo(self.path("pipe"))
        os.symlink("loop", self.path("loop"))

    def path(self, name):
        return os.path.join(self.folder, name)

    def bess(self, arguments, before=None):
        return subprocess.run([PROGRAM, *arguments.split()], cwd=self.folder, capture_output=True,
                              text=True, timeout=120,
                              preexec_fn=before)

    def names(self):
        return {os.path.join(where, name) for where, folders, files in os.walk(self.folder)
                for name in folders + files}

    def test_each_is_one_clear_line_and_nothing_is_left(self):
        before = self.names()
        for arguments, code, said in CASES:
            with self.subTest(arguments[:90]):
                done = self.bess(arguments)
                lines = [line for line in done.stderr.splitlines()
                         if not line.startswith("bess-train: warning")]
                self.assertEqual(done.returncode, code, done.stderr)
                for word in said.split():
                    self.assertIn(word, done.stderr)
                self.assertEqual(len(lines), 1, done.stderr)
                self.assertEqual(self.names() - before, set())

    def test_a_name_of_two_lines_or_colours_is_refused_in_one(self):
        for name in ("a\nb.csv", "\x1b[31mred.csv", "bell\a", "back\b", "del\x7f", "carriage\r",
                     "csi\u009bm"):
            for arguments in (["evaluate", "--policy", "rbc", "--prices", name],
                              ["runs", "compare", name],
                              ["verify", "--student", name], ["config", "--config=" + name]):
                with self.subTest(arguments):
                    done = subprocess.run([PROGRAM, *arguments], cwd=self.folder,
                                          capture_output=True, text=True)
                    self.assertEqual(done.returncode, 2)
                    self.assertRegex(done.stderr, r'\Abess-train: ".*".*bess-train --help.*\n\Z')
                    self.assertTrue(done.stderr[:-1].isprintable(), done.stderr)

    def test_a_pipe_with_a_writer_is_read(self):
        with subprocess.Popen(["sh", "-c", "sleep 1; cat market.csv > pipe"], cwd=self.folder):
            done = self.bess("evaluate --policy rbc --json --prices pipe")
        self.assertEqual(json.loads(done.stdout)["policy"], "rbc", done.stderr)

    def test_a_file_that_may_not_grow_is_an_error(self):
        before = self.names()
        for arguments in ("prices simulate --days 62 --out new.csv",
                          "train --prices market.csv --out new.bin",
                          "backtest --prices market.csv --window-days 30 --policy rbc --out "
                          "new/backtest"):
            with self.subTest(arguments):
                done = self.bess(arguments,
                                 lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0)))
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertIn(os.strerror(errno.EFBIG), done.stderr)
                self.assertEqual({n for n in self.names() - before if os.path.isfile(n)}, set())

    def test_one_backtest_at_a_time_works_in_a_folder(self):
        os.mkdir(self.path("new"))
        folder = os.open(self.path("new"), os.O_RDONLY)
        fcntl.flock(folder, fcntl.LOCK_EX)
        backtest = "backtest --prices market.csv --window-days 30 --policy rbc --out new"
        done = self.bess(backtest)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stderr, r"\bnew: .*--out")
        self.assertEqual(os.listdir(self.path("new")), [])
        os.close(folder)
        self.assertEqual(self.bess(backtest).returncode, 0)

    def test_a_checkpoint_of_another_run_names_the_key(self):
        train = "train --prices market.csv --method dqn --out t.bin --threads 1 --config a.toml"
        with open(self.path("a.toml"), "w") as file:
            file.write("[train]\nsteps = 100000\nbatch_size = 64\nvalidate_every = 20\n")
        with subprocess.Popen([PROGRAM, *train.split()], cwd=self.folder, stderr=subprocess.PIPE,
                              text=True) as program:
            for line in program.stderr:
                if "steps" in line:  # it is at work
                    program.send_signal(signal.SIGINT)
                    break
            program.stderr.read()
        self.assertEqual(program.returncode, 3)
        with open(self.path("a.toml"), "a") as file:
            file.write("gamma = 0.5\n")
        done = self.bess(train + " --resume")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stderr,
                         r"\[train\] gamma [0-9.]+ .*\[train\] gamma 0\.5 ")

    def test_absurd_sizes_are_told_before_they_start(self):
        with open(self.path("years.toml"), "w") as file:
            file.write("[train]\nmethod = \"c51\"\nsteps = 10000000\nbatch_size = 1048576\n")
        with subprocess.Popen([PROGRAM,
                               *"train --prices market.csv --out t.bin --threads 1 --config "
                                "years.toml".split()],
                              cwd=self.folder, stderr=subprocess.PIPE, text=True) as program:
            first = program.stderr.readline()
            program.kill()
        self.assertRegex(first,
                         r"10000000 .* 1048576 .* [0-9]+ (days|years) ")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
