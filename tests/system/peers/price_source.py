#!/usr/bin/python3
r"""Price server with the behaviour of user reports, only from Python's standard library,
independent of bess.

    price_source.py --behaviour JSON --prices wave|walk --seed 7 \
        --scale 60 --anchor-ns N --start-s N

It prints "port N", then serves rows of ods161 (datetime, imbalanceprice, newest first, limit and
offset) at any path, by a clock that runs `scale` times as fast. "wave": ten minutes of -600, then
ten of 1600 EUR/MWh, so that the right action is known; "walk": plausible prices around 90.

Behaviours, any of them together:
  late_s                 delay of rows after their minute
  order                  ascending, shuffled or doubled
  spoil, every           of every Nth row: the price is "null", "NaN", "text", "missing",
                         "twice"; or any number, which stands for none
  factor, from_min       prices are multiplied (another unit), from that minute on
  shift_s                offset of the time stamps
  stale, every           age of every Nth answer in s; frozen_s: of all, permanently
  limit                  {"per_s", "status", "retry_after", "ban_after", "ban_s"}: excess is refused
  encoding               gzip, deflate or gzip_cut
  cut                    share of the body sent, with the full length announced
  chunked                in chunks; "cut" ends them early
  redirect               "path", "host" or "loop"
  instead                "html", "empty", "no_rows", 204, 404, 500: with every, every Nth
  drip_s, wait_s         duration of the body; delay of the headers (wall time)
  drop, every            "reset" or "close" of every Nth connection
  pad                    bytes of unrequested fields in each row
  first_address          behaviour of ::1: "hang", "reset" or "html"; 127.0.0.1 serves
"""
import argparse
import datetime
import gzip
import json
import random
import socket
import struct
import threading
import time
import urllib.parse
import zlib

CHEAP, DEAR, HALF_MIN = -600.0, 1600.0, 10
HISTORY_MIN = 240


class Prices:
    def __init__(self, kind, seed):
        self.kind, self.walk = kind, []
        source = random.Random(seed)
        price = 90.0
        for _ in range(4000):
            price += (90 - price) * 0.02 + source.gauss(0, 12)
            self.walk.append(round(price, 2))

    def of(self, minute):
        if self.kind == "walk":
            return self.walk[minute % len(self.walk)]
        return CHEAP if minute // HALF_MIN % 2 == 0 else DEAR


class Source:
    def __init__(self, options):
        self.options = options
        self.behaviour = json.loads(options.behaviour)
        self.prices = Prices(options.prices, options.seed)
        self.random = random.Random(options.seed)
        self.lock = threading.Lock()
        self.connections = self.answers = self.refusals = 0
        self.served_s = self.banned_until_s = -1e9

    def now_s(self):
        elapsed = (time.clock_gettime_ns(time.CLOCK_MONOTONIC) - self.options.anchor_ns) / 1e9
        return self.options.start_s + elapsed * self.options.scale

    def on(self, key):
        """The behaviour, for every Nth answer if it has "every"."""
        value = self.behaviour.get(key)
        every = self.behaviour.get("every", 1)
        return value if value is not None and self.answers % every == 0 else None

    def row(self, minute):
        price = self.prices.of(minute)
        since_min = minute - self.options.start_s // 60
        if since_min >= self.behaviour.get("from_min", -1e9):
            price = round(price * self.behaviour.get("factor", 1), 5)
        stamp_s = 60 * minute + self.behaviour.get("shift_s", 0)
        stamp = datetime.datetime.fromtimestamp(stamp_s, datetime.timezone.utc).isoformat()
        members = [f'"datetime": "{stamp}"']
        value, spoil = json.dumps(price), self.behaviour.get("spoil")
        if spoil is not None and minute % self.behaviour.get("every", 1) == 0:
            value = {"null": "null", "NaN": "NaN", "missing": "", "text": f'"{price}"',
                     "twice": f'{price}, "imbalanceprice": {price + 7}'}.get(spoil, str(spoil))
        if value:
            members.append(f'"imbalanceprice": {value}')
        if "pad" in self.behaviour:
            members.append('"remark": "' + "x" * self.behaviour["pad"] + '"')
        return "{" + ", ".join(members) + "}"

    def body(self, query):
        if (instead := self.on("instead")) is not None:
            return {"html": "<html><body>Please log in</body></html>", "empty": "",
                    "no_rows": '{"total_count": 0, "results": []}'}.get(instead, "")
        now = self.now_s() - self.behaviour.get("late_s", 0) - (self.on("stale") or 0)
        if "frozen_s" in self.behaviour:
            now = min(now, self.options.start_s + self.behaviour["frozen_s"])
        newest = int(now // 60) - 1  # the last minute that has ended
        limit, offset = int(query.get("limit", ["20"])[0]), int(query.get("offset", ["0"])[0])
        minutes = [newest - offset - i for i in range(limit) if offset + i < HISTORY_MIN]
        order = self.behaviour.get("order")
        if order == "ascending":
            minutes.reverse()
        elif order == "shuffled":
            self.random.shuffle(minutes)
        elif order == "doubled":
            minutes = [m for m in minutes for _ in (0, 1)]
        return '{"results": [' + ",\n".join(self.row(m) for m in minutes) + "]}"

    def refusal(self):
        """Headers of a refusal, or nothing."""
        limit = self.behaviour.get("limit")
        if limit is None:
            return None
        now = self.now_s()
        if now >= self.banned_until_s and now - self.served_s >= limit["per_s"]:
            self.served_s = now
            return None
        self.refusals += 1
        if limit.get("ban_after") and self.refusals % limit["ban_after"] == 0:
            self.banned_until_s = now + limit["ban_s"]
        wait = limit.get("retry_after")
        return [f"HTTP/1.1 {limit['status']} Not now"] + \
            ([f"Retry-After: {wait}"] if wait is not None else [])

    def answer(self, path, connection):
        split = urllib.parse.urlsplit(path)
        with self.lock:
            self.answers += 1
            refused = self.refusal()
            redirect = self.behaviour.get("redirect")
            if refused:
                return self.send(connection, refused, b"")
            if redirect and (redirect == "loop" or not split.path.startswith("/moved")):
                host = "localhost" if redirect == "host" else "127.0.0.1"
                place = f"http://{host}:{self.port}/moved?{split.query}"
                return self.send(connection, ["HTTP/1.1 302 Found", "Location: " + place], b"")
            body = self.body(urllib.parse.parse_qs(split.query)).encode()
            status = self.on("instead")
        head = [f"HTTP/1.1 {status if isinstance(status, int) else 200} As it is",
                "Content-Type: application/json"]
        encoding = self.behaviour.get("encoding")
        if encoding in ("gzip", "gzip_cut"):
            body = gzip.compress(body)
            head.append("Content-Encoding: gzip")
        elif encoding == "deflate":
            body = zlib.compress(body)
            head.append("Content-Encoding: deflate")
        if encoding == "gzip_cut":
            body = body[:len(body) // 2]
        return self.send(connection, head, body)

    def send(self, connection, head, body):
        time.sleep(self.behaviour.get("wait_s", 0))
        whole, cut = len(body), self.on("cut")
        if cut is not None:
            body = body[:int(whole * cut)]
        if self.behaviour.get("chunked"):
            parts = [body[i:i + 700] for i in range(0, len(body), 700)]
            body = b"".join(f"{len(p):x}\r\n".encode() + p + b"\r\n" for p in parts)
            body += b"" if cut is not None else b"0\r\n\r\n"
            head.append("Transfer-Encoding: chunked")
        elif not head[0].startswith("HTTP/1.1 204"):
            head.append(f"Content-Length: {whole}")
        connection.sendall("\r\n".join(head + ["", ""]).encode())
        parts = 50 if "drip_s" in self.behaviour else 1
        for i in range(parts):
            connection.sendall(body[len(body) * i // parts:len(body) * (i + 1) // parts])
            time.sleep(self.behaviour.get("drip_s", 0) / parts)
        return cut is None

    def serve(self, connection):
        try:
            file = connection.makefile("rb")
            while line := file.readline():
                path = line.split()[1].decode()
                while file.readline() not in (b"\r\n", b""):
                    pass
                if not self.answer(path, connection):
                    break
        except (OSError, IndexError):
            pass  # the client is gone
        finally:
            connection.close()

    def accept(self, connection):
        self.connections += 1
        drop = self.behaviour.get("drop")
        if drop and self.connections % self.behaviour.get("every", 1) == 0:
            if drop == "reset":
                connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            connection.close()
            return
        threading.Thread(target=self.serve, args=(connection,), daemon=True).start()

    def play_first_address(self, server, what):
        held = []
        while True:
            connection, _ = server.accept()
            if what == "hang":
                held.append(connection)
                continue
            if what == "html":
                connection.recv(4096)
                connection.sendall(b"HTTP/1.1 502 Bad Gateway\r\nContent-Length: 3\r\n\r\nbad")
            connection.close()

    def listen(self):
        server = socket.create_server(("127.0.0.1", 0), backlog=50)
        self.port = server.getsockname()[1]
        if "first_address" in self.behaviour:
            first = socket.create_server(("::1", self.port), family=socket.AF_INET6)
            threading.Thread(target=self.play_first_address,
                             args=(first, self.behaviour["first_address"]), daemon=True).start()
        print("port", self.port, flush=True)
        while True:
            connection, _ = server.accept()
            self.accept(connection)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--behaviour", default="{}")
    parser.add_argument("--prices", choices=("wave", "walk"), default="wave")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scale", type=int, required=True)
    parser.add_argument("--anchor-ns", type=int, required=True)
    parser.add_argument("--start-s", type=int, required=True)
    Source(parser.parse_args()).listen()
