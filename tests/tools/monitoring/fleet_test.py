"""Many batteries, scraped by Prometheus and by VictoriaMetrics for a quarter of an hour.

  fleet_test.py SOURCE BESS_EDGE BESS_SIM COUNT

One server gives COUNT batteries' metrics, each as 'bess-edge status --prometheus' of a real
controller printed it, every 120 s. Nine tenths are in a region whose source is late everywhere; in
the other one, some batteries have a late price by themselves; in both, some have tripped and some
do not answer. Told are: memory, disk, scrapes that were lost. It fails unless each engine's
Alertmanager holds each planted fault once and nothing else, and hushes what follows from the late
source. 77: an engine is not installed.
"""
import asyncio
import collections
import json
import multiprocessing
import os
import re
import shutil
import subprocess
import sys
import threading
import time
import unittest
import urllib.request

import monitoring_test as base

SCRAPE_S = 120
SETTLED_S = 14 * 60  # BessPriceOld waits for ten minutes, and a scrape for two
MEASURED_S = 10 * 60
LATE_S = 4000


class Fleet:
    """Which battery has which fault. Of ten, nine are in "be", whose source is late everywhere."""

    def __init__(self, count):
        self.count = count

    def region(self, i):
        return "nl" if i % 10 == 0 else "be"

    def is_dead(self, i):
        return i % 400 in (11, 20)

    def is_tripped(self, i):
        return i % 250 in (12, 30)

    def is_late_alone(self, i):
        return i % 500 == 140

    def name(self, i):
        return f"battery-{i:05}"

    def chosen(self, is_chosen):
        return sorted(self.name(i) for i in range(self.count) if is_chosen(i))

    def answer(self, i, template):
        age = LATE_S if self.region(i) == "be" or self.is_late_alone(i) else 60
        return template % {"age": age, "tripped": int(self.is_tripped(i)), "now": int(time.time())}

    def targets(self, address):
        return [{"targets": [address],
                 "labels": {"instance": self.name(i), "site": self.name(i),
                            "region": self.region(i), "__metrics_path__": f"/{i}"}}
                for i in range(self.count)]


def template_of(metrics):
    """What a controller printed, with holes where batteries differ."""
    text = metrics.replace("%", "%%")
    for name, hole in (("bess_price_age_seconds", "age"), ("bess_tripped", "tripped"),
                       ("bess_last_cycle_timestamp_seconds", "now")):
        text, found = re.subn(rf"^{name} \S+$", f"{name} %({hole})d", text, flags=re.M)
        assert found == 1, name
    return text


def serve(fleet, template, port):
    async def answer(reader, writer):
        try:
            line = await reader.readline()
            while (await reader.readline()).strip():
                pass
            i = int(line.split()[1][1:])
            if not fleet.is_dead(i):
                body = fleet.answer(i, template).encode()
                writer.write(b"HTTP/1.1 200 OK\r\nContent-Type: text/plain; version=0.0.4\r\n"
                             b"Connection: close\r\nContent-Length: %d\r\n\r\n" % len(body) + body)
                await writer.drain()
        except (ConnectionError, ValueError, IndexError):
            pass
        finally:
            writer.close()

    async def run():
        server = await asyncio.start_server(answer, "127.0.0.1", port, backlog=4096)
        async with server:
            await server.serve_forever()

    asyncio.run(run())


def bytes_under(folder):
    return sum(os.path.getsize(os.path.join(at, name))
               for at, _, names in os.walk(folder) for name in names)


def peak_memory_bytes(pid):
    with open(f"/proc/{pid}/status", encoding="ascii") as file:
        return 1024 * int(re.search(r"VmHWM:\s+(\d+)", file.read())[1])


class TenThousand(base.Folder):
    def setUp(self):
        super().setUp()
        self.fleet = Fleet(COUNT)
        port = base.free_port()
        template = template_of(self.metrics_of_a_controller())
        server = multiprocessing.Process(target=serve, args=(self.fleet, template, port),
                                         daemon=True)
        server.start()
        self.addCleanup(server.terminate)
        with open(os.path.join(self.files, "batteries.yml"), "w", encoding="utf-8") as file:
            json.dump(self.fleet.targets(f"127.0.0.1:{port}"), file)  # JSON is YAML
        self.change("prometheus.yml",
                    ("scrape_interval: 60s", f"scrape_interval: {SCRAPE_S}s"))
        base.wait_for("the fleet", lambda: base.get(f"http://127.0.0.1:{port}/0"))

    def metrics_of_a_controller(self):
        site = self.start(BESS_SIM, "site", "--folder=site",
                          "--map=" + base.SOURCE + "/edge/maps/simulator.toml",
                          "--prices=" + base.SOURCE + "/tests/data/benchmark_minutes_2023.csv.gz",
                          "--utc-start=2023-03-26T06:00:00Z", "--time-scale=60",
                          "--set", "price.timeout_ms=200")
        config = os.path.join(self.folder, "site/edge.toml")
        base.wait_for("the site", lambda: os.path.exists(config))
        subprocess.run([BESS_EDGE, "commission", "--config", config, "--yes"], check=True,
                       timeout=60, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        edge = self.start(BESS_EDGE, "--config", config)

        def printed():
            text = subprocess.run([BESS_EDGE, "status", "--prometheus", "--config", config],
                                  stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                                  check=False).stdout
            return text if re.search('bess_state{state="running"} 1$', text, re.M) else None

        text = base.wait_for("a running controller", printed)
        edge.stop()
        site.stop()
        return text

    def start_manager(self, name):
        manager = f"127.0.0.1:{base.free_port()}"
        self.start("prometheus-alertmanager", "--config.file=monitoring/alertmanager.yml",
                   "--storage.path=alerts-" + name, "--web.listen-address=" + manager,
                   "--cluster.listen-address=")
        base.wait_for("Alertmanager", lambda: base.get(f"http://{manager}/-/healthy"))
        return "http://" + manager

    def start_called(self):
        server = base.http.server.ThreadingHTTPServer(("127.0.0.1", 0), base.Called)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        self.change("alertmanager.yml",
                    ("127.0.0.1:9094", f"127.0.0.1:{server.server_port}"))

    def start_engines(self):
        """{name: (url, program, folder, url of its Alertmanager)}"""
        prometheus, victoria = (f"127.0.0.1:{base.free_port()}" for _ in range(2))
        managers = [self.start_manager(name) for name in ("prometheus", "victoria")]
        config = self.change("prometheus.yml", ("127.0.0.1:9093", managers[0][7:]))
        first = self.start("prometheus", "--config.file=" + config,
                           "--storage.tsdb.path=prometheus", "--web.listen-address=" + prometheus)
        second = self.start("victoria-metrics", "-storageDataPath=victoria",
                            "-retentionPeriod=1", "-httpListenAddr=" + victoria,
                            "-promscrape.config=" + config, "-promscrape.config.strictParse=false")
        url = "http://" + victoria
        base.wait_for("VictoriaMetrics", lambda: base.get(url + "/health"))
        self.start("vmalert", "-rule=monitoring/bess_rules.yml", "-notifier.url=" + managers[1],
                   f"-httpListenAddr=127.0.0.1:{base.free_port()}",
                   *(f"-{end}.url={url}"
                     for end in ("datasource", "remoteRead", "remoteWrite")))
        return {"Prometheus": ("http://" + prometheus, first, "prometheus", managers[0]),
                "VictoriaMetrics": (url, second, "victoria", managers[1])}

    def query(self, engine, expression):
        answer = json.loads(base.get(engine + "/api/v1/query", query=expression))
        return {series["metric"].get("instance", ""): float(series["value"][1])
                for series in answer["data"]["result"]}

    def lost_scrapes(self, engine):
        """Of batteries that answer: scrapes that failed, and those that are missing."""
        dead = set(self.fleet.chosen(self.fleet.is_dead))
        window = f"[{MEASURED_S}s]"
        scrapes = self.query(engine, f'count_over_time(up{{job="bess"}}{window})')
        answered = self.query(engine, f'sum_over_time(up{{job="bess"}}{window})')
        self.assertEqual(len(scrapes), COUNT)
        wanted = MEASURED_S // SCRAPE_S
        return sum(max(0, wanted - int(answered[name]))
                   for name in scrapes if name not in dead)

    def alerts_are_as_planted(self, name, manager):
        with urllib.request.urlopen(manager + "/api/v2/alerts", timeout=60) as answer:
            alerts = json.load(answer)
        active, hushed = collections.defaultdict(list), collections.Counter()
        for alert in alerts:
            labels = alert["labels"]
            if alert["status"]["state"] == "active":
                active[labels["alertname"]].append(labels.get("instance", labels.get("region")))
            else:
                hushed[labels["alertname"], labels.get("region")] += 1
        fleet = self.fleet
        planted = {"BessTripped": fleet.chosen(fleet.is_tripped),
                   "BessUnreachable": fleet.chosen(fleet.is_dead),
                   "BessPriceOld": fleet.chosen(fleet.is_late_alone),
                   "BessSourceLate": ["be"]}
        self.assertEqual({alert: sorted(of) for alert, of in active.items()}, planted, name)
        hushed_there = fleet.chosen(lambda i: fleet.region(i) == "be" and not fleet.is_dead(i))
        self.assertEqual(hushed, {("BessPriceOld", "be"): len(hushed_there)}, name)
        return sum(map(len, planted.values()))

    def test_are_watched(self):
        self.start_called()
        engines = self.start_engines()
        time.sleep(SETTLED_S + 2 * SCRAPE_S)
        for name, (url, program, folder, manager) in engines.items():
            series = self.query(url, "sum(scrape_samples_scraped)")[""]
            lost = self.lost_scrapes(url)
            count = self.alerts_are_as_planted(name, manager)
            disk = bytes_under(os.path.join(self.folder, folder))
            print(f"{name}: {COUNT} batteries, {series:.0f} series every {SCRAPE_S} s: "
                  f"{peak_memory_bytes(program.process.pid) / 1e9:.2f} GB of memory at most, "
                  f"{disk / 1e6:.0f} MB of disk, {lost} scrapes lost of "
                  f"{COUNT * MEASURED_S // SCRAPE_S}, {count} planted faults held once each",
                  flush=True)
            self.assertEqual(lost, 0, name)
        told = [alert["labels"] for message in base.Called.heard for alert in message["alerts"]
                if alert["status"] == "firing"]
        print(f"{len(base.Called.heard)} messages to who is called, {len(told)} alerts in them",
              flush=True)
        self.assertFalse([labels for labels in told
                          if (labels["alertname"], labels["region"]) == ("BessPriceOld", "be")])


if __name__ == "__main__":
    missing = [engine for engine in base.ENGINES if shutil.which(engine) is None]
    if missing:
        print(f"skipped: no {missing[0]}: run tools/setup --test")
        sys.exit(77)
    base.SOURCE, BESS_EDGE, BESS_SIM = map(os.path.abspath, sys.argv[1:4])
    COUNT = int(sys.argv[4])
    del sys.argv[1:5]
    unittest.main(verbosity=2)
