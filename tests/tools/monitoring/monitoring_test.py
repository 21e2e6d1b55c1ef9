"""What watches batteries (tools/monitoring), against the engines that it is for.

  monitoring_test.py SOURCE SCENARIO_METRICS BESS_EDGE BESS_SIM BESS_PAGE

promtool and amtool read the files and run the unit tests of the rules; vmalert judges the metrics
of every scenario with the same rules; Prometheus and VictoriaMetrics scrape a real controller, and
an alert reaches who is called. 77: an engine is not installed.
"""
import functools
import http.server
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import urllib.error
import urllib.parse
import urllib.request

ENGINES = ("promtool", "prometheus", "amtool", "prometheus-alertmanager", "victoria-metrics",
           "vmalert")
DAY_BEGINS, DAY_ENDS = "2026-01-01T00:00:00Z", "2026-01-02T00:00:00Z"
PATIENCE_S = 60

# Of each rule, scenarios that have its fault. What no scenario has is left to the unit tests.
FAULTS = {
    "BessBatteryWeak": {"device_part_power"},
    "BessBusFailing": {"bus_cut", "bus_silence", "rtu_silence", "bus_wrong_frames"},
    "BessControllerSilent": {"edge_killed", "edge_stopped"},
    "BessCyclesMissed": {"edge_paused"},
    "BessEnergyMissing": {"device_half_flow"},
    "BessHouseImplausible": {"meter_inverted", "meter_offset"},
    "BessMeterNotBelieved": {"meter_frozen", "meter_inverted", "meter_other_phase", "meter_ratio"},
    "BessNotDriving": {"device_wrong_sign", "prices_outage_nine_hours"},
    "BessOrdersLate": {"bus_silence", "battery_paused"},
    "BessOrdersLost": {"device_other_master", "device_ends_orders"},
    "BessPowerAtRest": {"device_hidden_drain"},
    "BessPriceFrozen": {"prices_frozen"},
    "BessPriceOld": {"prices_outage_half_hour", "prices_quarter_hours_old", "market_paused"},
    "BessTripped": {"device_wrong_sign", "device_soc_stuck", "device_echo"},
}
ONLY_IN_UNIT_TESTS = {
    "BessUnreachable", "BessOrdersUnanswered", "BessRampSlow", "BessBatteryLocked",
    "BessBatteryWarns", "BessLogLost", "BessCardWorn", "BessUpdateTrouble",
    "BessStudentsDiffer", "BessStudentUnexpected", "BessOutlookUnplanned", "BessSourceLate"}
# Nothing is wrong in these: nobody is called.
WELL = {"quiet_hour", "rtu_quiet_hour", "a_day_of_2023", "a_week_of_2023", "summer_time_begins",
        "summer_time_ends", "reserve_kept", "reversal_cap", "edge_restarted", "edge_handed_over",
        "hold_during_a_peak", "limit_charge", "meter_of_a_house", "meter_import_limit",
        "meter_peak_cap"}
# Panels that are empty where nothing of the kind has happened, or is there.
MAY_BE_EMPTY = {"Alerts"}


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def get(url, **parameters):
    query = "?" + urllib.parse.urlencode(parameters, doseq=True) if parameters else ""
    with urllib.request.urlopen(url + query, timeout=10) as answer:
        return answer.read().decode()


def wait_for(what, probe):
    end = time.monotonic() + PATIENCE_S
    while True:
        try:
            found = probe()
        except (OSError, urllib.error.URLError):
            found = None
        if found:
            return found
        if time.monotonic() > end:
            raise AssertionError(f"{what}: not within {PATIENCE_S} s")
        time.sleep(.1)


class Program:
    """A program that ends with the test, its words in a file."""

    def __init__(self, folder, *command, pipe=False):
        name = os.path.basename(command[0])
        self.log = open(os.path.join(folder, name + ".log"), "ab")
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE if pipe else self.log,
                                        stderr=self.log, cwd=folder, text=pipe)

    def stop(self, with_signal=signal.SIGTERM):
        if self.process.poll() is None:
            self.process.send_signal(with_signal)
        self.process.communicate(timeout=30)
        self.log.close()


class Folder(unittest.TestCase):
    """A test with a folder of its own, a copy of tools/monitoring in it, and programs beside it."""

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="bess-monitoring-")
        self.addCleanup(shutil.rmtree, self.folder)
        self.files = os.path.join(self.folder, "monitoring")
        shutil.copytree(os.path.join(SOURCE, "tools/monitoring"), self.files)
        os.chmod(self.files, 0o755)

    def start(self, *command, **options):
        program = Program(self.folder, *command, **options)
        self.addCleanup(program.stop)
        return program

    def change(self, name, *changes):
        """Of a copied file, each by what must stand there."""
        path = os.path.join(self.files, name)
        with open(path, encoding="utf-8") as file:
            text = file.read()
        for before, after in changes:
            self.assertIn(before, text)
            text = text.replace(before, after)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def start_victoria(self, *options):
        url = f"http://127.0.0.1:{free_port()}"
        self.start("victoria-metrics", "-storageDataPath=victoria", "-retentionPeriod=100y",
                   "-httpListenAddr=" + url[7:], "-search.latencyOffset=1s", *options)
        wait_for("VictoriaMetrics", lambda: get(url + "/health"))
        return url


class Files(Folder):
    def run_tool(self, *command):
        done = subprocess.run(command, cwd=self.files, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_engines_accept_them(self):
        self.run_tool("promtool", "check", "config", "prometheus.yml")
        self.run_tool("promtool", "check", "rules", "bess_rules.yml")
        self.run_tool("amtool", "check-config", "alertmanager.yml")
        self.run_tool("vmalert", "-dryRun", "-rule=bess_rules.yml")

    def test_rules_fire_in_time(self):
        shutil.copy(os.path.join(HERE, "bess_rules_test.yml"), self.files)
        self.run_tool("promtool", "test", "rules", "bess_rules_test.yml")

    def test_each_rule_is_tested(self):
        with open(os.path.join(HERE, "bess_rules_test.yml"), encoding="utf-8") as file:
            tested = set(re.findall(r'alertname="(\w+)"', file.read()))
        self.assertEqual(alerts(), tested)
        self.assertEqual(alerts(), set(FAULTS) | ONLY_IN_UNIT_TESTS)
        self.assertFalse(set(FAULTS) & ONLY_IN_UNIT_TESTS)


def alerts():
    with open(os.path.join(SOURCE, "tools/monitoring/bess_rules.yml"), encoding="utf-8") as file:
        return set(re.findall(r"- alert: (\w+)", file.read()))


@functools.lru_cache(maxsize=None)
def scenario_metrics():
    return subprocess.run([SCENARIO_METRICS, os.path.join(SOURCE, "tests/scenarios")],
                          stdout=subprocess.PIPE, check=True, timeout=300).stdout


class Scenarios(Folder):
    """The same rules over what every scenario would have shown."""

    def setUp(self):
        super().setUp()
        lines = scenario_metrics()
        self.names = set(re.findall(rb"^(bess_\w+)", lines, re.M))
        self.url = self.start_victoria()
        urllib.request.urlopen(self.url + "/api/v1/import/prometheus", lines, 120).close()
        get(self.url + "/internal/force_flush")

    def query(self, expression):
        answer = json.loads(get(self.url + "/api/v1/query_range", query=expression,
                                start=DAY_BEGINS, end=DAY_ENDS, step="60"))
        self.assertEqual(answer["status"], "success", expression)
        return answer["data"]["result"]

    def test_faults_call_somebody_and_what_is_well_does_not(self):
        subprocess.run(["vmalert", "-replay.timeFrom=" + DAY_BEGINS, "-replay.timeTo=" + DAY_ENDS,
                        "-replay.rulesDelay=0s", "-replay.disableProgressBar",
                        "-datasource.queryStep=1m", "-rule=" + self.files + "/bess_rules.yml",
                        *(f"-{end}.url={self.url}" for end in
                          ("datasource", "remoteRead", "remoteWrite"))],
                       check=True, timeout=300, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
        get(self.url + "/internal/force_flush")
        fired = {}
        for series in self.query('ALERTS{alertstate="firing"}'):
            labels = series["metric"]
            fired.setdefault(labels["alertname"], set()).add(labels["instance"])
        for alert, scenarios in FAULTS.items():
            self.assertLessEqual(scenarios, fired.get(alert, set()), alert)
        self.assertLessEqual(WELL, {series["metric"]["instance"]
                                    for series in self.query("bess_soc_ratio")})
        for alert, scenarios in fired.items():
            self.assertEqual(scenarios & WELL, set(), alert)

    def test_dashboard_asks_for_what_exists(self):
        with open(os.path.join(self.files, "grafana_dashboard.json"), encoding="utf-8") as file:
            panels = json.load(file)["panels"]
        self.assertGreater(len(panels), 10)
        for panel in panels:
            for target in panel["targets"]:
                query = target["expr"].replace("$job", "bess").replace("$instance", ".*")
                with self.subTest(panel=panel["title"], query=query):
                    found = self.query(query)
                    if panel["title"] not in MAY_BE_EMPTY:
                        self.assertTrue(found)

    def test_rules_ask_for_what_exists(self):
        with open(os.path.join(self.files, "bess_rules.yml"), encoding="utf-8") as file:
            expressions = re.findall(r"^ +(?:expr: .*|.*\[\d+m\].*)$", file.read(), re.M)
        asked = set(re.findall(r"\b(bess_\w+)", "\n".join(expressions)))
        of_this_machine = {"bess_card_used_life_ratio", "bess_card_spare_level",
                           "bess_file_system_errors"}
        of_an_update = {"bess_update_trouble"}
        of_an_outlook = {"bess_outlook_planned_timestamp_seconds"}  # the built-in student has none
        of_an_inventory = {"bess_expected_student_info"}
        elsewhere = of_this_machine | of_an_update | of_an_outlook | of_an_inventory
        exist = {name.decode() for name in self.names} | elsewhere
        self.assertGreater(len(asked), 20)
        self.assertEqual(asked - exist, set())
        for name in elsewhere:  # written where the machine, an update or an inventory tells
            found = subprocess.run(["grep", "-rq", name, os.path.join(SOURCE, "edge"),
                                    os.path.join(SOURCE, "tools/ansible")], check=False)
            self.assertEqual(found.returncode, 0, name)


class Called(http.server.BaseHTTPRequestHandler):
    """Who is called: keeps what Alertmanager sends."""

    heard = []

    def do_POST(self):
        body = self.rfile.read(int(self.headers["Content-Length"]))
        self.heard.append(json.loads(body))
        self.send_response(200)
        self.end_headers()

    def log_message(self, *_):
        pass


class RealController(Folder):
    """bess-edge on a simulated site, its page, and both engines that scrape it."""

    def setUp(self):
        super().setUp()
        self.start(BESS_SIM, "site", "--folder=site",
                   "--map=" + SOURCE + "/edge/maps/simulator.toml",
                   "--prices=" + SOURCE + "/tests/data/benchmark_minutes_2023.csv.gz",
                   "--utc-start=2023-03-26T06:00:00Z", "--time-scale=60",
                   "--set", "price.timeout_ms=200")
        config = os.path.join(self.folder, "site/edge.toml")
        wait_for("the site", lambda: os.path.exists(config))
        subprocess.run([BESS_EDGE, "commission", "--config", config, "--yes"], check=True,
                       timeout=PATIENCE_S, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.start(BESS_EDGE, "--config", config)
        with open(config, "a", encoding="utf-8") as file:
            file.write(f'\n[page]\nprogram = "{BESS_EDGE}"\nrefresh_s = 1\n')
        self.page = self.start(BESS_PAGE, "--config", config, "--port", "0", pipe=True)
        self.page_url = self.page.process.stdout.readline().split()[-1]
        wait_for("a cycle", lambda: "bess_cycles_total" in get(self.page_url + "metrics"))
        self.change("batteries.yml", ("127.0.0.1:8745", self.page_url.split("/")[2]))
        self.change("prometheus.yml", ("scrape_interval: 60s", "scrape_interval: 1s"),
                    ("evaluation_interval: 60s", "evaluation_interval: 1s"))

    def newest(self, engine, expression):
        answer = json.loads(get(engine + "/api/v1/query", query=expression))
        return [(series["metric"], float(series["value"][1]))
                for series in answer["data"]["result"]]

    def holds_what_the_page_gives(self, engine):
        """Every series of /metrics is there, under its labels; what stands still with its value."""
        wait_for("a scrape", lambda: self.newest(engine, "bess_cycles_total"))
        text = get(self.page_url + "metrics")
        names = set(re.findall(r"^(bess_\w+)", text, re.M))
        wait_for("all series", lambda: names <= {labels["__name__"] for labels, _ in self.newest(
            engine, '{job="bess"}')})
        info, one = self.newest(engine, "bess_model_info")[0]
        self.assertEqual((one, info["site"], info["region"]), (1, "garage", "be"))
        self.assertIn(f'student="{info["student"]}"', text)
        self.assertEqual([value for _, value in self.newest(engine, "sum(bess_state)")], [1])
        before = self.newest(engine, "bess_cycles_total")[0][1]
        wait_for("the next cycle",
                 lambda: self.newest(engine, "bess_cycles_total")[0][1] > before)

    def test_victoria_metrics_scrapes_it(self):
        self.holds_what_the_page_gives(self.start_victoria(
            "-promscrape.config=" + self.files + "/prometheus.yml",
            "-promscrape.config.strictParse=false"))

    def test_prometheus_scrapes_it_and_somebody_is_called(self):
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Called)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        manager, engine = (f"127.0.0.1:{free_port()}" for _ in range(2))
        self.change("alertmanager.yml", ("127.0.0.1:9094", f"127.0.0.1:{server.server_port}"),
                    ("group_wait: 30s", "group_wait: 1s"), ("group_wait: 1m", "group_wait: 1s"))
        self.start("prometheus-alertmanager", "--config.file=monitoring/alertmanager.yml",
                   "--storage.path=alerts", "--web.listen-address=" + manager,
                   "--cluster.listen-address=")
        config = self.change("prometheus.yml", ("127.0.0.1:9093", manager))
        # How long each waits is the unit tests' matter.
        self.change("bess_rules.yml", ("for: 5m", "for: 1s"), ("interval: 1m", "interval: 1s"))
        self.start("prometheus", "--config.file=" + config, "--storage.tsdb.path=prometheus",
                   "--web.listen-address=" + engine)
        engine = "http://" + engine
        self.holds_what_the_page_gives(engine)
        self.assertEqual([value for _, value in self.newest(engine, 'up{job="bess"}')], [1])
        self.page.stop(signal.SIGKILL)
        wait_for("a call", lambda: any(
            alert["labels"]["alertname"] == "BessUnreachable"
            and alert["labels"]["site"] == "garage"
            and "bess-page" in alert["annotations"]["action"]
            for message in Called.heard for alert in message["alerts"]))


if __name__ == "__main__":
    missing = [engine for engine in ENGINES if shutil.which(engine) is None]
    if missing:
        print(f"skipped: no {missing[0]}: run tools/setup --test")
        sys.exit(77)
    HERE = os.path.dirname(os.path.abspath(__file__))
    SOURCE, SCENARIO_METRICS, BESS_EDGE, BESS_SIM, BESS_PAGE = sys.argv[1:6]
    del sys.argv[1:6]
    unittest.main(verbosity=2)
