// Download from a server like Elia's, without and with one fault: the file is complete, or there is
// none and one line gives the reason, and hopeless requests are not repeated.
#include "workstation/data/market/feed/elia_fetch.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <iterator>

#include "shared/host/file.h"
#include "shared/host/http_client.h"
#include "shared/host/minute_file.h"
#include "shared/utc_text.h"
#include "tests/support/fake_elia.h"
#include "tests/support/market_series.h"
#include "tests/support/market_test_support.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Ask = EliaRequest;
using Answer = EliaAnswer;
using Rows = std::vector<EliaRow>;
using Quirk = FakeElia::Quirk;

/// Two local days, the second of 23 hours.
constexpr FetchSpan kSpan{{2023, 3, 25}, {2023, 3, 26}};
constexpr std::size_t kMinutes = 1440 + 1380;

class EliaFetch : public testing::Test {
 protected:
  FetchRequest request(const FakeElia& elia, const FetchSpan& span = kSpan,
                       bool allow_gaps = false) {
    return {
        .span = span,
        .out = folder_ / "prices.csv",
        .base_url = elia.base_url(),
        .now_utc_s = 1'750'000'000,  // 15 June 2025, 17:06:40 local
        .retry = {},
        .allow_gaps = allow_gaps,
        .sleep = [this](double seconds, const std::atomic<bool>&) { waits_.push_back(seconds); }};
  }
  static FetchedPrices fetch(const FetchRequest& wanted) {
    const std::atomic<bool> interrupted{false};
    return fetch_prices(wanted, interrupted).value();
  }
  static std::string error_of(const FetchRequest& wanted) {
    const std::string error = user_error_of([&] { fetch(wanted); });
    EXPECT_EQ(error.find("where="), error.npos) << "the address is kept short";
    EXPECT_EQ(error.find('\n'), error.npos);
    EXPECT_FALSE(std::filesystem::exists(wanted.out));
    return error;
  }
  static std::size_t windows_kept(const FetchRequest& wanted) {
    std::error_code absent;
    const std::filesystem::directory_iterator files(fetch_cache_folder(wanted), absent);
    return static_cast<std::size_t>(std::distance(begin(files), end(files)));
  }
  static std::string rows_of(const std::filesystem::path& path) {
    const std::string text = read_file(path);
    return text.substr(text.find("minute_utc"));
  }
  static void remove(const FetchRequest& wanted) {
    std::filesystem::remove(wanted.out);
    std::filesystem::remove_all(fetch_cache_folder(wanted));
  }
  /// Result of an ordinary server.
  std::string whole() {
    const FakeElia elia;
    FetchRequest wanted = request(elia);
    wanted.out = folder_ / "whole.csv";
    fetch(wanted);
    return rows_of(wanted.out);
  }

  ScratchFolder folder_;
  std::vector<double> waits_;
};

TEST_F(EliaFetch, JoinsDatasetsAcrossTheChangeOfMay2024) {
  FakeElia elia;
  const FetchRequest wanted = request(elia, {{2024, 4, 30}, {2024, 6, 2}});
  const JoinedMarket market = fetch(wanted).market;
  EXPECT_EQ(market.report.minutes, 34u * 1440);
  EXPECT_EQ(market.report.quarter_hours, 34u * 96);
  EXPECT_EQ(market.report.duplicates, 0u);
  EXPECT_EQ(utc_text(read_minute_file(wanted.out).start_utc_s), "2024-04-29T22:00:00Z");
  EXPECT_EQ(windows_kept(wanted), 0u);
  EXPECT_THAT(read_file(wanted.out),
              Names("Elia opendata.elia.be CC BY 4.0 ods046 ods047 ods133 ods134"));
  EXPECT_TRUE(waits_.empty());
}

TEST_F(EliaFetch, TodayIsOfTheNearRealTimeDatasetsAndWhatHasNotEndedIsDropped) {
  FakeElia elia;
  FetchRequest wanted = request(elia, {{2025, 6, 14}, {2025, 6, 15}});
  const FetchedPrices prices = fetch(wanted);
  EXPECT_THAT(elia.requests(), ElementsAre(std::pair("ods133", 1), std::pair("ods134", 1),
                                           std::pair("ods161", 1), std::pair("ods162", 1)));
  EXPECT_EQ(prices.market.report.minutes, 1440u + 17 * 60 + 6);
  EXPECT_EQ(prices.market.report.quarter_hours, 96u + 17 * 4);
  EXPECT_THAT(prices.description, Names(std::to_string(1440 - 1026 + 96 - 68)));
}

TEST_F(EliaFetch, WaitsAsRequestedOtherwiseLongerAndLonger) {
  FakeElia elia([](const Ask& ask, Answer& answer) {
    if (ask.dataset != "ods046" || ask.wants_total || ask.number > 5) return;
    if (ask.number < 3) answer.status = "429 Many";
    if (ask.number == 1) answer.headers = "Retry-After: 7\r\n";
    if (ask.number == 2) answer.headers = "X-RateLimit-Reset: 9\r\n";
    if (ask.number == 3) answer.status = "500 Error";
    if (ask.number == 4) answer.body = "<html>proxy</html>\n";
    if (ask.number == 5) answer.sent_max = 14;
  });
  EXPECT_EQ(fetch(request(elia)).market.report.minutes, kMinutes);
  EXPECT_THAT(waits_, ElementsAre(7, 9, 4, 8, 16));
}

TEST_F(EliaFetch, GivesUpInTheEndAndResumesWhereItStopped) {
  std::atomic<bool> broken{true};
  FakeElia elia([&broken](const Ask& ask, Answer& answer) {
    if (broken && ask.dataset == "ods047" && ask.number > 1) answer.status = "502 Gateway";
  });
  const FetchRequest wanted = request(elia, {{2023, 1, 30}, {2023, 2, 3}});
  EXPECT_THAT(error_of(wanted), Names("502 ods047"));
  EXPECT_THAT(elia.requests(), ElementsAre(std::pair("ods046", 2), std::pair("ods047", 1 + 6)));
  EXPECT_THAT(waits_, ElementsAre(1, 2, 4, 8, 16));
  broken = false;
  EXPECT_EQ(fetch(wanted).market.report.minutes, 5u * 1440);
  EXPECT_THAT(elia.requests(), ElementsAre(std::pair("ods046", 2), std::pair("ods047", 8)));
  EXPECT_EQ(windows_kept(wanted), 0u);
}

TEST_F(EliaFetch, AServerThatIsNotThereIsNotAskedForLong) {
  FetchRequest wanted;
  {
    const FakeElia gone;
    wanted = request(gone);
  }
  EXPECT_THAT(error_of(wanted), Names("3 ods046 --base-url"));
  EXPECT_THAT(waits_, ElementsAre(1, 2));
}

/// Without the hour from ten to eleven of the first day.
void without_ten(Rows& rows) {
  const std::int64_t ten = utc_of("2023-03-25T10:00:00Z");
  std::erase_if(rows, [=](const EliaRow& row) { return row.utc_s / 3'600 == ten / 3'600; });
}
/// Rows of minutes, or else those of quarter-hours, and their count.
Quirk on_rows(const std::function<void(Rows&)>& change, bool of_minutes = true) {
  return [=](const Ask& ask, Answer& answer) {
    if (ask.minutes() == of_minutes) change(answer.rows);
  };
}

/// Truncated; empty, as an earlier version kept them; or with a gap that was allowed before.
TEST_F(EliaFetch, ADamagedCopyIsFetchedAgain) {
  Rows rows = elia_rows({.dataset = "ods046"}, utc_of("2023-03-24T23:00:00Z"),
                        utc_of("2023-03-26T22:00:00Z"));
  const std::string kept = elia_csv({.dataset = "ods046"}, rows);
  without_ten(rows);
  for (const std::string& damaged :
       {kept, elia_csv({}, {}), elia_csv({.dataset = "ods046"}, rows)}) {
    std::atomic<bool> broken{true};
    FakeElia elia([&broken](const Ask& ask, Answer& answer) {
      if (broken && ask.dataset == "ods047") answer.status = "404 Not Found";
    });
    const FetchRequest wanted = request(elia);
    EXPECT_THAT(error_of(wanted), Names("404 ods047"));
    EXPECT_TRUE(waits_.empty());  // a retry cannot fix a 404
    EXPECT_EQ(windows_kept(wanted), 1u);
    for (const auto& entry : std::filesystem::directory_iterator(fetch_cache_folder(wanted))) {
      EXPECT_EQ(read_file(entry.path()), kept);
      write_file(entry.path(), damaged);
      if (damaged == kept) {
        std::filesystem::resize_file(entry.path(), std::filesystem::file_size(entry.path()) / 2);
      }
    }
    broken = false;
    EXPECT_EQ(fetch(wanted).market.report.minutes, kMinutes);
    EXPECT_THAT(elia.requests(), ElementsAre(std::pair("ods046", 2), std::pair("ods047", 2)));
    remove(wanted);
  }
}

TEST_F(EliaFetch, AWindowThatLacksSomethingIsAskedForAgain) {
  const std::pair<Quirk, const char*> cases[] = {
      {on_rows(without_ten), "60 2820 ods046"},
      {on_rows([](Rows& rows) { rows[40].price.clear(); }, false), "1 188 ods047"},
      {[](const Ask& ask, Answer& answer) {
         if (ask.minutes()) answer.rows.clear();
         if (!ask.minutes()) answer.status = "404 Not Found";
       },
       "404 ods047"}};
  const std::string reference = whole();
  for (const auto& [quirk, names] : cases) {
    std::atomic<bool> broken{true};
    const FakeElia elia([&](const Ask& ask, Answer& answer) {
      if (broken) quirk(ask, answer);
    });
    const FetchRequest wanted = request(elia);
    EXPECT_THAT(error_of(wanted), Names(names));
    broken = false;
    fetch(wanted);
    EXPECT_TRUE(rows_of(wanted.out) == reference) << names;
    remove(wanted);
  }
}

TEST_F(EliaFetch, DaysThatMayStillBeFillingAreNotKept) {
  FakeElia elia([](const Ask& ask, Answer& answer) {
    if (ask.dataset == "ods134" && ask.number > 1) answer.status = "404 Not Found";
  });
  const FetchRequest wanted = request(elia, {{2025, 6, 10}, {2025, 6, 14}});
  EXPECT_THAT(error_of(wanted), Names("404"));
  EXPECT_EQ(windows_kept(wanted), 2u);  // 10 to 12 June; not ods133 of the 13th and 14th
}

TEST_F(EliaFetch, WithoutAnyPriceNothingIsKept) {
  FakeElia elia([](const Ask&, Answer& answer) { answer.rows.clear(); });
  const FetchRequest wanted = request(elia, kSpan, true);
  write_file(fetch_cache_folder(wanted) / "of_another_version.csv.gz", elia_csv({}, {}));
  EXPECT_THAT(error_of(wanted), Names("127.0.0.1 2023-03-25"));
  EXPECT_FALSE(std::filesystem::exists(fetch_cache_folder(wanted)));
}

TEST_F(EliaFetch, AnEmptyWindowIsReported) {
  FakeElia elia([](const Ask& ask, Answer& answer) {
    if (ask.dataset == "ods133" || ask.dataset == "ods134") answer.rows.clear();
  });
  FetchRequest wanted = request(elia, {{2025, 6, 14}, {2025, 6, 14}}, true);
  EXPECT_THAT(error_of(wanted), Names("127.0.0.1 ods133")) << "yesterday may still be to come";
  wanted.span.to = {2025, 6, 15};
  EXPECT_THAT(fetch(wanted).description, Names("ods134 2025-06-13T22:00:00Z 2025-06-14T22:00:00Z"));
  EXPECT_TRUE(waits_.empty());
}

TEST_F(EliaFetch, TheServersWordsAreOneQuietLine) {
  FakeElia elia([](const Ask&, Answer& answer) {
    answer.status = "400 Bad";
    answer.body = "{\"message\":\"bad\x1b[31m where\n second line\"}" + std::string(500, 'x');
  });
  const std::string text = error_of(request(elia));
  EXPECT_THAT(text, HasSubstr("400: {\"message\":\"bad [31m where second line"));
  EXPECT_THAT(text, testing::Not(HasSubstr(std::string(200, 'x'))));
}

// ---- Faults ---------------------------------------------------------------------------------

/// For the minutes' rows only.
Quirk on_minutes(const Quirk& quirk) {
  return [quirk](const Ask& ask, Answer& answer) {
    if (ask.minutes() && !ask.wants_total) quirk(ask, answer);
  };
}
Quirk once(const Quirk& quirk) {
  return [quirk](const Ask& ask, Answer& answer) {
    if (ask.number == 1) quirk(ask, answer);
  };
}
Quirk answered(const std::string& status, const std::string& headers = "",
               const std::string& text = "{\"error\":\"so\"}", bool has_length = true) {
  return on_minutes([=](const Ask&, Answer& answer) {
    answer.status = status;
    answer.headers = headers;
    answer.body = text;
    answer.has_length = has_length;
  });
}
/// The ordinary text, changed.
Quirk with(const std::function<std::string(std::string)>& change, const std::string& headers = "") {
  return on_minutes([=](const Ask&, Answer& answer) {
    answer.format = [change](const Ask& ask, const Rows& rows) {
      return change(elia_csv(ask, rows));
    };
    answer.headers = headers;
  });
}
Quirk with_instead(const std::string& what, const std::string& other) {
  return with([=](std::string text) {
    for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += other.size()) {
      text.replace(at, what.size(), other);
    }
    return text;
  });
}
Quirk at_most(std::size_t count, bool newest_first, const std::string& total = "") {
  return [=](const Ask& ask, Answer& answer) {
    if (ask.wants_total) {
      if (total.empty()) return;
      answer.body = total;
      if (total == "none") answer.status = "404 Not Found";
      return;
    }
    if (newest_first) std::ranges::reverse(answer.rows);
    answer.rows.resize(std::min(count, answer.rows.size()));
  };
}
std::string as_json(const Ask& ask, const Rows& rows) {
  std::string text;
  for (const EliaRow& row : rows) {
    text += fmt::format("{}{{\"datetime\":\"{}\",\"resolutioncode\":\"{}\",\"imbalanceprice\":{}}}",
                        text.empty() ? "[" : ",", utc_text(row.utc_s).view(),
                        ask.minutes() ? "PT1M" : "PT15M", row.price);
  }
  return text + "]";
}
std::string gzipped(const std::string& text) {
  const std::string path = testing::TempDir() + "bess_quirk.gz";
  write_file(path, text);
  return text_of_file(path);
}
Quirk row_price(const char* price) {
  return on_minutes([price](const Ask&, Answer& answer) {
    if (answer.rows.size() > 700) answer.rows[700].price = price;
  });
}
/// A redirect to the same place.
void move(const Ask& ask, Answer& answer) {
  const auto time = [](std::int64_t utc_s) {
    return std::string(utc_text(utc_s).view().substr(0, 19));
  };
  answer.status = "302 Found";
  answer.headers = fmt::format(
      "Location: ?where=datetime%20%3E%3D%20%22{}%2B00%3A00%22%20AND%20datetime%20%3C%20%22{}"
      "%2B00%3A00%22\r\nRetry-After: 500\r\n",
      time(ask.from_utc_s), time(ask.until_utc_s));
}

struct QuirkCase {
  const char* name;
  Quirk quirk;
  const char* names;  ///< named in the error; empty if the file is complete
  int requests;       ///< for minutes, that are needed
};

/// Spellings of files are in market_rows_test and own_csv_test; truncation by length, chunk and
/// compression in http_whole_test.
std::vector<QuirkCase> quirks() {
  const auto same = [](const std::string& text) { return text; };
  const auto cut_in_a_line = [](const Ask&, Answer& a) {
    a.has_length = false;
    a.sent_max = elia_csv({}, {}).size() + std::string("2023-03-25T10:00:00+00:00;PT1M;").size();
  };
  return {
      // Order and number.
      {"no order", on_rows([](auto& rows) {
         std::ranges::stable_sort(rows, {}, [](const EliaRow& r) { return r.utc_s % 3'660; });
       }),
       "", 1},
      {"each row twice", on_rows([](auto& rows) {
         const Rows copy = rows;
         rows.insert(rows.end(), copy.begin(), copy.end());
       }),
       "", 1},
      {"100 rows at a time, newest first", at_most(100, true), "", 29},
      {"1000 rows at a time, newest first, no total", at_most(1'000, true, "none"), "", 3},
      {"total of no number", at_most(100, false, "{\"total_count\":\"many\"}"), "", 29},
      {"total too large", at_most(100, false, "{\"total_count\":99999999}"), "", 29},
      {"the day before as well, and a row of the day after",
       [](const Ask& ask, Answer& answer) {
         answer.rows = elia_rows(ask, ask.from_utc_s - 86'400, ask.until_utc_s + 60);
       },
       "", 1},
      {"rows of other days alone", on_minutes([](const Ask& ask, Answer& answer) {
         answer.rows = elia_rows(ask, ask.from_utc_s - 86'400, ask.from_utc_s);
       }),
       "1440 ods046 2023-03-25 2023-03-26 127.0.0.1", 1},
      {"the same days for every question", on_minutes([](const Ask& ask, Answer& answer) {
         answer.rows =
             elia_rows(ask, utc_of("2023-03-24T23:00:00Z"), utc_of("2023-03-25T23:00:00Z"));
       }),
       "1380 2820 ods046 2023-03-25T23:00:00Z 1440", 3},
      {"an hour is missing, and its count", on_rows(without_ten),
       "ods046 60 2820 2023-03-25T10:00:00Z --allow-gaps", 1},
      {"an hour is missing, but counted",
       on_minutes([](const Ask&, Answer& a) { without_ten(a.rows); }),
       "ods046 60 2820 2023-03-25T10:00:00Z --allow-gaps 2760", 2},
      {"an hour is missing once",
       once(on_minutes([](const Ask&, Answer& a) { without_ten(a.rows); })), "", 2},
      {"the last row is missing", on_rows([](auto& rows) { rows.pop_back(); }),
       "1 2820 2023-03-26T21:59:00Z", 1},
      {"a settled hour is missing", on_rows(without_ten, false),
       "4 188 ods047 2023-03-25T10:00:00Z 2023-03-25T11:00:00Z --allow-gaps", 1},
      {"nothing but the names of columns", on_rows([](auto& rows) { rows.clear(); }),
       "2820 ods046 2023-03-24T23:00:00Z 2023-03-26T22:00:00Z", 1},
      // Spellings that no download uses.
      {"times without offset", with_instead("+00:00", ""), "ods046:2 \"2023-03-24T23:00:00\"", 2},
      {"an hour off, and saying so", with_instead("+00:00", "+01:00"),
       "60 2820 2023-03-26T21:00:00Z", 3},
      {"JSON", on_minutes([](const Ask&, Answer& answer) { answer.format = as_json; }), "", 1},
      {"JSON without its end", on_minutes([](const Ask& ask, Answer& answer) {
         answer.body = as_json(ask, answer.rows).substr(0, 5'000);
       }),
       "ods046 6", 6},
      {"JSON of an error with 200", answered("200 OK"), "ods046 \"results\"", 2},
      {"another dataset", with_instead("imbalanceprice", "windpower"),
       "ods046 datetime;resolutioncode;windpower --price-column", 1},
      {"a price that is text", row_price("high"), "ods046:702 \"high\"", 2},
      {"a price of 1e300", row_price("1e300"), "2023-03-25T10:40:00Z 1e+300 price-range", 1},
      {"a web page", answered("200 OK", "Content-Type: text/html\r\n", "<html>log in</html>"),
       "ods046 127.0.0.1 2", 2},
      {"rows called a web page", with(same, "Content-Type: text/html\r\n"), "", 1},
      {"gzip that does not say so", with(gzipped), "ods046 gunzip", 2},
      {"gzip, announced", with(gzipped, "Content-Encoding: gzip\r\n"), "", 1},
      {"gzip announced not sent", with(same, "Content-Encoding: gzip\r\n"), "ods046 6", 6},
      {"an encoding that was not asked for", answered("200 OK", "Content-Encoding: br\r\n", "abc"),
       "ods046 6", 12},
      // Transport.
      {"no length, cut in a line once", once(on_minutes(cut_in_a_line)), "", 2},
      {"no length, cut at a line end", on_minutes([](const Ask&, Answer& a) {
         a.has_length = false;
         a.rows.resize(std::min<std::size_t>(a.rows.size(), 1'000));
       }),
       "", 3},
      {"a length that is no number", answered("200 OK", "Content-Length: many\r\n", "x", false),
       "Content-Length", 1},
      {"headers without end", answered("200 OK", "X: " + std::string(400'000, 'x') + "\r\n", "x"),
       "100000 1", 1},
      {"moved", once(on_minutes(move)), "", 2},
      {"moved round and round", on_minutes(move), "5 1", 6},
      {"moved to a file", answered("302 Found", "Location: file:///etc/passwd\r\n", "x"),
       "\"file\" 1", 1},
      {"quota, to wait for words", once(answered("429 Many", "Retry-After: soon\r\n")), "", 2},
      {"quota, to wait for ever", answered("429 Many", "Retry-After: 99999999999999999999\r\n"),
       "429 ods046", 1},
      {"no rows", answered("204 No Content"), "204 1", 1},
      {"busy", answered("408 Timeout"), "408 6", 6},
  };
}

TEST_F(EliaFetch, QuirksEndInTheWholeFileOrInOneLine) {
  const std::string reference = whole();
  ASSERT_EQ(std::ranges::count(reference, '\n'), static_cast<long>(kMinutes) + 1);
  for (const QuirkCase& c : quirks()) {
    SCOPED_TRACE(c.name);
    FakeElia elia(c.quirk);
    const FetchRequest wanted = request(elia);
    if (*c.names == '\0') {
      EXPECT_NO_THROW(fetch(wanted));
      ASSERT_TRUE(std::filesystem::exists(wanted.out));
      EXPECT_TRUE(rows_of(wanted.out) == reference) << "another file";
    } else {
      EXPECT_THAT(error_of(wanted), Names(c.names));
    }
    EXPECT_EQ(elia.requests().at("ods046"), c.requests);
    remove(wanted);
  }
}

/// Too slow, and steady without an end.
TEST_F(EliaFetch, AnAnswerThatDripsEnds) {
  const struct {
    int drip_ms;
    HttpLimits limits;
    const char* names;
  } cases[] = {{20, {.deadline_s = 60, .bytes_per_s_min = 1'000, .slow_s = 1}, "1000 1 s 2"},
               {5, {.deadline_s = 0.5, .bytes_per_s_min = 10, .slow_s = 1}, "0.5 s 2"}};
  for (const auto& c : cases) {
    FakeElia elia(on_minutes([&c](const Ask&, Answer& answer) { answer.drip_ms = c.drip_ms; }));
    FetchRequest wanted = request(elia);
    wanted.retry.limits = c.limits;
    EXPECT_THAT(error_of(wanted), Names(c.names));
    EXPECT_EQ(elia.requests().at("ods046"), 2);
  }
}

TEST_F(EliaFetch, AnAnswerTooLargeSaysSo) {
  for (const bool is_packed : {false, true}) {
    FakeElia elia(on_minutes([is_packed](const Ask&, Answer& answer) {
      const std::string bomb = elia_csv({}, {}) + std::string(3'000'000, '#') + "\n";
      answer.body = is_packed ? gzipped(bomb) : bomb;
      if (is_packed) answer.headers = "Content-Encoding: gzip\r\n";
    }));
    FetchRequest wanted = request(elia);
    wanted.retry.limits.bytes_max = 1'000'000;
    EXPECT_THAT(error_of(wanted), Names("1000000 ods046"));
    EXPECT_EQ(elia.requests().at("ods046"), 1) << "a retry would get the same answer";
  }
}

TEST_F(EliaFetch, AllowedGapsAreWrittenAndSaid) {
  const FakeElia elia([](const Ask&, Answer& answer) { without_ten(answer.rows); });
  const FetchRequest wanted = request(elia, kSpan, true);
  fetch(wanted);
  const std::string text = read_file(wanted.out);
  const std::size_t head = text.find("minute_utc");
  EXPECT_THAT(text.substr(0, head), Names("60 2820 4 188 ods046 ods047 2023-03-25T10:00:00Z"));
  EXPECT_EQ(text.find("\n2023-03-25T10:", head), text.npos);
  EXPECT_THAT(text.substr(head, 80), HasSubstr("2023-03-24T23:00:00Z,81.25,76\n"));
}

constexpr std::int64_t kFetchTime_s = 1'750'000'000;  // 15 June 2025, 17:06 local

std::vector<std::string> described(const FetchSpan& span) {
  std::vector<std::string> lines;
  for (const FetchWindow& window : plan_fetch(span, kFetchTime_s)) {
    const auto hour = [](std::int64_t utc_s) {
      return std::string(utc_text(utc_s).view().substr(0, 13));
    };
    lines.push_back(window.dataset + " " + hour(window.from_utc_s) + " " +
                    hour(window.until_utc_s) + (window.settles_later ? " later" : ""));
  }
  return lines;
}

TEST(FetchPlan, CutsByMonthAndChangesDatasetsOn22May2024) {
  EXPECT_THAT(described({{2024, 4, 30}, {2024, 6, 1}}),
              testing::ElementsAre(
                  "ods046 2024-04-29T22 2024-04-30T22", "ods047 2024-04-29T22 2024-04-30T22",
                  "ods046 2024-04-30T22 2024-05-21T22", "ods047 2024-04-30T22 2024-05-21T22",
                  "ods133 2024-05-21T22 2024-05-31T22", "ods134 2024-05-21T22 2024-05-31T22",
                  "ods133 2024-05-31T22 2024-06-01T22", "ods134 2024-05-31T22 2024-06-01T22"));
}

TEST(FetchPlan, TodayHasItsOwnDatasetsAndTomorrowNone) {
  EXPECT_THAT(described({{2025, 6, 14}, {2025, 7, 31}}),
              testing::ElementsAre("ods133 2025-06-13T22 2025-06-14T22 later",
                                   "ods134 2025-06-13T22 2025-06-14T22 later",
                                   "ods161 2025-06-14T22 2025-06-15T22 later",
                                   "ods162 2025-06-14T22 2025-06-15T22 later"));
}

TEST(FetchPlan, RefusesEmptySpans) {
  EXPECT_THAT(user_error_of([] {
                (void)plan_fetch({{2023, 2, 1}, {2023, 1, 1}}, kFetchTime_s);
              }),
              Names("--from 2023-02-01 --to 2023-01-01"));
  EXPECT_THAT(user_error_of([] {
                (void)plan_fetch({{2026, 2, 1}, {2026, 3, 1}}, kFetchTime_s);
              }),
              Names("2026-02-01"));
}

TEST(WaitSeconds, EveryFormServersUse) {
  EXPECT_EQ(wait_seconds("120", 1e9), 120);
  EXPECT_EQ(wait_seconds("1750000030", kFetchTime_s), 30);
  EXPECT_EQ(wait_seconds("2025-06-15 15:07:00+00:00", kFetchTime_s), 20);
  EXPECT_EQ(wait_seconds("Sun, 15 Jun 2025 15:07:00 GMT", kFetchTime_s), 20);
  EXPECT_EQ(wait_seconds("Sun, 15 Jun 2025 15:00:00 GMT", kFetchTime_s), 0);
  EXPECT_EQ(wait_seconds("-5", kFetchTime_s), 0);
  for (const char* far : {"99999999999999999999", "1e999", "inf", "86401",
                          "2026-06-15 00:00:00+00:00", "Fri, 31 Dec 9999 23:59:59 GMT"}) {
    EXPECT_EQ(wait_seconds(far, kFetchTime_s), kWaitMax_s) << far;
  }
  EXPECT_EQ(wait_seconds("nan", kFetchTime_s), std::nullopt);
  EXPECT_THAT(describe_wait(7), Names("7"));
  EXPECT_THAT(describe_wait(7'200), Names("120"));
  EXPECT_EQ(wait_seconds("soon", kFetchTime_s), std::nullopt);
  EXPECT_EQ(wait_seconds("", kFetchTime_s), std::nullopt);
}

}  // namespace
}  // namespace bess
