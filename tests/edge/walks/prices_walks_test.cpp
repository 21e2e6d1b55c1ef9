// Walks over edge/prices: answers with a slip in them, addresses, steps that wait, pages of
// history.
#include <cstdio>
#include <fstream>

#include "edge/prices/history_pages.h"
#include "edge/prices/http_secrets.h"
#include "edge/prices/http_trust.h"
#include "edge/prices/newest_row.h"
#include "edge/prices/price_json.h"
#include "edge/prices/step_hold.h"
#include "shared/utc_text.h"
#include "tests/edge/walks/slips.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

constexpr std::int64_t kAskedUtcS = 1'755'391'080;  // 2025-08-17T00:38:00Z

std::string drawn_time(Walk& walk) {
  const std::int64_t utc_s =
      kAskedUtcS + walk.edge({0, -60, -120, -3'600, 60, 86'400}, 1) + walk.from(-2, 2) * 60;
  std::string text(utc_text(utc_s).view());
  if (walk.once_in(2)) text.replace(text.size() - 1, 1, "+00:00");
  if (walk.once_in(9)) text = walk.once_in(2) ? "2025-08-17T02:36:00+02:00" : "null";
  return text;
}

std::string drawn_row(Walk& walk) {
  static constexpr const char* kPrices[] = {"7",       "-30.258",   "1.005",     "null", "0.004999",
                                            "100000",  "100000.01", "-100000",   "1e3",  "\"7\"",
                                            "-100001", "0.005",     "99999.999", "true", "-0.005"};
  std::string row = R"({"datetime":")" + drawn_time(walk) + R"(","imbalanceprice":)" +
                    kPrices[walk.from(0, 14)] + R"(,"qualitystatus":"DataIssue"})";
  if (walk.once_in(20)) row = "null";
  if (walk.once_in(20)) row = R"({"datetime":1,"imbalanceprice":2})";
  if (walk.once_in(20)) row = R"({"imbalanceprice":2})";
  if (walk.once_in(20)) row = R"({"datetime":"2025-08-17T00:36:00Z"})";
  return row;
}

TEST(PricesWalk, Answers) {
  Walk walk("price_answers");
  for (int block = 0; block < 20; ++block) {
    for (int i = 0; i < 500; ++i) {
      std::string json;
      const int rows = walk.number(0, 6);
      for (int r = 0; r < rows; ++r) json += (r > 0 ? "," : "") + drawn_row(walk);
      json = "[" + json + "]";
      PriceFields fields;
      if (walk.once_in(2)) {
        json = R"({"total_count":4,"results":)" + json + "}";
      } else if (walk.once_in(3)) {
        fields.rows = "data.rows";
        json = R"({"data":{"rows":)" + json + "}}";
      }
      if (walk.once_in(4)) json = with_slips(walk, json, 2);
      PriceRow row;
      walk.see(parse_newest_price(json, fields, kAskedUtcS, row), row.minute_utc_s,
               row.price_centi_eur_per_mwh);
      int items = -1;
      const PriceRowTaker taker{&walk, [](void* self, const PriceRow& taken) {
                                  static_cast<Walk*>(self)->see(taken.minute_utc_s,
                                                                taken.price_centi_eur_per_mwh);
                                }};
      walk.see(parse_prices(json, fields, kAskedUtcS, taker, items), items);
    }
    walk.end_line(block);
  }
  walk.hold();
}

TEST(PricesWalk, Addresses) {
  Walk walk("price_addresses");
  const std::vector<std::string> urls = {"http://127.0.0.1:8080/a?b=c",
                                         "https://user:word@example.org/x",
                                         "http://[::1]:80/",
                                         "https://api.example.org:443",
                                         "http://10.0.0.1",
                                         "HTTPS://EXAMPLE.org/A",
                                         "ftp://a/b",
                                         "http://127.1.2.3/",
                                         "http://user@localhost/secret?key=1",
                                         "http://[fe80::1]/",
                                         "https://a:b@[2001:db8::1]:9/p"};
  for (int i = 0; i < 6'000; ++i) {
    std::string url = urls[static_cast<std::size_t>(walk.from(0, 10))];
    if (walk.once_in(2)) url = with_slips(walk, url, 2);
    if (url.find('\0') != std::string::npos) continue;
    const UrlParts parts = url_parts(url);
    walk.see(parts.authority_at, parts.login_bytes, parts.path_at, holds_login(url));
    walk.see_text(loggable_url(url).view());
    if (i % 300 == 299) walk.end_line(i / 300);
  }
  walk.hold();
}

TEST(PricesWalk, SecretHeaders) {
  Walk walk("secret_headers");
  const TemporaryFolder folder;
  const std::string path = folder.file("headers");
  const std::string good = "X-Key: abc\n\n# a word\nAuthorization: Bearer 123\n";
  for (int i = 0; i < 500; ++i) {
    std::string text = walk.once_in(9) ? good : with_slips(walk, good, 3);
    if (walk.once_in(20))
      text += "Long: " +
              std::string(static_cast<std::size_t>(walk.edge({2'000, 2'012, 2'040}, 9)), 'x') +
              "\n";
    if (walk.once_in(30)) text = "Host: a\n";
    std::ofstream(path) << text;
    FixedText<2047> headers;
    std::string error;
    walk.see(load_http_headers(path.c_str(), headers, error));
    walk.see_text(headers.view());
    const std::size_t at = error.find(path);
    if (at != std::string::npos) error.erase(at, path.size());
    walk.see_text(error);
    if (i % 100 == 99) walk.end_line(i / 100);
  }
  walk.hold();
}

TEST(PricesWalk, Rows) {
  Walk walk("price_rows");
  for (int block = 0; block < 30; ++block) {
    const std::int32_t step = block % 3 == 0 ? 100 : 1'000;
    const bool is_holding = block % 2 == 0;
    NewestRow newest(step, is_holding);
    StepHold hold(step, is_holding);
    PriceRow before{.minute_utc_s = 0, .price_centi_eur_per_mwh = 0};
    std::int64_t minute_utc_s = kAskedUtcS;
    std::int32_t centi = 0;
    for (int i = 0; i < 400; ++i) {
      minute_utc_s += walk.from(-1, 2) * 60;
      if (walk.once_in(3)) centi = walk.edge({centi, centi + step, centi - step, 0, 5 * step});
      const PriceRow row{.minute_utc_s = minute_utc_s, .price_centi_eur_per_mwh = centi};
      const StepHold::Verdict verdict = hold.judge(before, row);
      if (verdict.is_taken) before = row;
      walk.see(verdict.is_taken, verdict.is_large_step, hold.has_held(), hold.held().minute_utc_s,
               hold.held().price_centi_eur_per_mwh);
      newest.publish(walk.once_in(9) ? Status::kTimeout : Status::kOk, row, i, 2 * i);
      const PriceReport& r = newest.report();
      walk.see(r.has_row, r.minute_utc_s, r.price_centi_eur_per_mwh, r.received_monotonic_ns,
               r.fetch_us, r.status, r.large_step, r.step_held, r.held_centi_eur_per_mwh);
    }
    walk.end_line(block);
  }
  walk.hold();
}

/// A server of history, with rows missing and requests that fail.
struct WalkedPages {
  Walk& walk;
  std::uint64_t failing = 0;
  int rows_per_page = 100;
  int rows_left = 0;
  std::int64_t newest_utc_s = kAskedUtcS;
  Status fetch_page(const char* url, std::int32_t timeout_ms, const PriceRowTaker& taker,
                    int& items) {
    walk.see_text(url);
    walk.see(timeout_ms);
    if (failing > 0 && walk.once_in(failing)) return Status::kTimeout;
    items = 0;
    for (; items < rows_per_page && rows_left > 0; ++items, --rows_left) {
      newest_utc_s -= 60;
      if (!walk.once_in(20)) {
        taker.take(taker.self, {.minute_utc_s = newest_utc_s, .price_centi_eur_per_mwh = items});
      }
    }
    return Status::kOk;
  }
};
struct WalkedClock {
  std::int64_t now_ns = 1;
  std::int64_t step_ns = 1;
  bool stop = false;
  [[nodiscard]] std::int64_t monotonic_ns() { return now_ns += step_ns; }
  [[nodiscard]] ScaledClock scaled() const { return ScaledClock{}; }
  [[nodiscard]] bool stop_requested() const { return stop; }
};

TEST(PricesWalk, HistoryPages) {
  Walk walk("history_pages");
  for (int block = 0; block < 200; ++block) {
    PriceHistory history(walk.number(1, 6), kAskedUtcS);
    PriceFeedSettings price;
    price.http.url = walk.once_in(3) ? "http://a/records?limit=3&offset=7" : "http://a/records";
    if (walk.once_in(5)) price.http.url = "http://a/r?limit=1";
    HistorySettings settings;
    if (walk.once_in(2)) settings.url = "http://b/r?offset=2";
    WalkedPages pages{.walk = walk,
                      .failing = walk.once_in(2) ? 0U : 3U,
                      .rows_per_page = walk.edge({100, 40}),
                      .rows_left = walk.number(0, 600)};
    if (walk.once_in(20)) pages.rows_left = 20'000;
    WalkedClock clock{.step_ns = walk.once_in(4) ? 4'000'000'000 : 1'000'000,
                      .stop = walk.once_in(30)};
    walk.see(fetch_history(pages, price, settings, clock, history), history.rows(),
             history.level().centi_q16);
    if (block % 10 == 9) walk.end_line(block);
  }
  walk.hold();
}

}  // namespace
}  // namespace bess
