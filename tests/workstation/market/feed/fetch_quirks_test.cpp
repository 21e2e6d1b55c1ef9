// The download against a server with one quirk at a time: the file is whole, or there is none and
// one line says why, and what cannot succeed is not asked for again and again.
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <iterator>

#include "shared/host/file.h"
#include "tests/support/market_series.h"
#include "tests/support/market_test_support.h"
#include "tests/support/tokens.h"
#include "tests/workstation/market/feed/quirky_elia.h"
#include "workstation/market/feed/elia_fetch.h"

namespace bess {
namespace {

using testing::HasSubstr;
using Quirk = QuirkyElia::Quirk;

/// Two local days, the second of 23 hours.
constexpr FetchSpan kSpan{{2023, 3, 25}, {2023, 3, 26}};
constexpr std::size_t kMinutes = 1440 + 1380;
constexpr const char* kWhole = "";

struct QuirkCase {
  std::string name;
  Quirk quirk;
  std::string names;  ///< what the error names; kWhole where there is none
  int requests = 0;   ///< for minutes, that are needed; 0 = not looked at
};

/// For the minutes' rows alone.
Quirk on_minutes(const Quirk& quirk) {
  return [quirk](const Ask& ask, Answer& answer) {
    if (ask.minutes() && !ask.wants_total) quirk(ask, answer);
  };
}
Quirk once(const Quirk& quirk) {
  return on_minutes([quirk](const Ask& ask, Answer& answer) {
    if (ask.number == 1) quirk(ask, answer);
  });
}
/// Rows of minutes and their count.
Quirk on_rows(const std::function<void(std::vector<QuirkyRow>&)>& change) {
  return [change](const Ask& ask, Answer& answer) {
    if (ask.minutes()) change(answer.rows);
  };
}
Quirk answered(const std::string& status, const std::string& headers = "",
               const std::string& text = "{\"error\":\"so\"}", bool has_length = true) {
  return on_minutes([=](const Ask&, Answer& answer) {
    answer.status = status;
    answer.headers = headers;
    answer.body = text;
    answer.format = {};
    answer.has_length = has_length;
  });
}
using Format = std::function<std::string(const Ask&, const std::vector<QuirkyRow>&)>;
Quirk formatted(const Format& format, const std::string& headers = "") {
  return on_minutes([=](const Ask&, Answer& answer) {
    answer.format = format;
    answer.headers = headers;
  });
}
/// The ordinary text, changed.
Quirk with(const std::function<std::string(std::string)>& change) {
  return formatted(
      [change](const Ask& ask, const auto& rows) { return change(quirky_csv(ask, rows)); });
}
std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += with.size()) {
    text.replace(at, what.size(), with);
  }
  return text;
}
Quirk with_instead(const std::string& what, const std::string& other) {
  return with([=](std::string text) { return replaced(std::move(text), what, other); });
}
/// One more row, the first.
Quirk with_row(const std::string& row) {
  return with([row](std::string text) { return text.insert(text.find('\n') + 1, row + "\n"); });
}
Quirk at_most(std::size_t count, bool newest_first, bool has_total) {
  return [=](const Ask& ask, Answer& answer) {
    if (ask.wants_total) {
      if (!has_total) answer.status = "404 Not Found";
      return;
    }
    if (newest_first) std::ranges::reverse(answer.rows);
    answer.rows.resize(std::min(count, answer.rows.size()));
  };
}
void leave_out(std::vector<QuirkyRow>& rows, const char* from, const char* until) {
  std::erase_if(rows, [=](const QuirkyRow& row) {
    return row.utc_s >= utc_of(from) && row.utc_s < utc_of(until);
  });
}
Quirk without(const char* from, const char* until) {
  return on_rows([=](auto& rows) { leave_out(rows, from, until); });
}
void without_ten(const Ask&, Answer& answer) {
  leave_out(answer.rows, "2023-03-25T10:00:00Z", "2023-03-25T11:00:00Z");
}
std::string as_json(const Ask& ask, const std::vector<QuirkyRow>& rows, const char* quote = "") {
  std::string text = "[";
  for (const QuirkyRow& row : rows) {
    text +=
        fmt::format("{}{{\"datetime\":\"{}\",\"resolutioncode\":\"{}\",\"imbalanceprice\":{}{}{}}}",
                    text.size() > 1 ? "," : "", utc_text(row.utc_s).view(),
                    ask.minutes() ? "PT1M" : "PT15M", quote, row.price, quote);
  }
  return text + "]";
}
std::string chunked(const std::string& text) {
  std::string chunks;
  for (std::size_t at = 0; at < text.size(); at += 4'096) {
    const std::string part = text.substr(at, 4'096);
    chunks += fmt::format("{:x}\r\n{}\r\n", part.size(), part);
  }
  return chunks + "0\r\n\r\n";
}
std::string gzipped(const std::string& text) {
  const std::string path = testing::TempDir() + "bess_quirk.gz";
  write_file(path, text);
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}
std::string csv_of(const Ask& ask, const std::vector<QuirkyRow>& rows) {
  return quirky_csv(ask, rows);
}
std::string packed_csv(const Ask& ask, const std::vector<QuirkyRow>& rows) {
  return gzipped(quirky_csv(ask, rows));
}
Quirk row_price(const char* price) {
  return on_minutes([price](const Ask&, Answer& answer) {
    if (answer.rows.size() > 700) answer.rows[700].price = price;
  });
}
constexpr const char* kTen = "ods046 60 2820 2023-03-25T10:00:00Z --allow-gaps";

std::vector<QuirkCase> order_and_number() {
  std::vector<QuirkCase> cases{
      {"as it should be", [](const Ask&, Answer&) {}, kWhole, 1},
      {"newest first", on_rows([](auto& rows) { std::ranges::reverse(rows); }), kWhole, 1},
      {"no order", on_rows([](auto& rows) {
         std::ranges::stable_sort(rows, {}, [](const QuirkyRow& r) { return r.utc_s % 3'660; });
       }),
       kWhole, 1},
      {"each row twice", on_rows([](auto& rows) {
         const std::vector<QuirkyRow> copy = rows;
         rows.insert(rows.end(), copy.begin(), copy.end());
       }),
       kWhole, 1},
      {"100 rows at a time, newest first", at_most(100, true, true), kWhole, 29},
      {"100 rows at a time, no total", at_most(100, false, false), kWhole, 29},
      {"1000 rows at a time, newest first, no total", at_most(1'000, true, false), kWhole, 3},
      {"the day before as well, and a row of the day after",
       [](const Ask& ask, Answer& answer) {
         answer.rows = quirky_rows(ask, ask.from_utc_s - 86'400, ask.until_utc_s + 60);
       },
       kWhole, 1},
      {"rows of other days alone", on_minutes([](const Ask& ask, Answer& answer) {
         answer.rows = quirky_rows(ask, ask.from_utc_s - 86'400, ask.from_utc_s);
       }),
       "1440 ods046 2023-03-25 2023-03-26 127.0.0.1", 1},
      {"the same days for every question", on_minutes([](const Ask& ask, Answer& answer) {
         answer.rows =
             quirky_rows(ask, utc_of("2023-03-24T23:00:00Z"), utc_of("2023-03-25T23:00:00Z"));
       }),
       "1380 2820 ods046 2023-03-25T23:00:00Z 1440"},
      {"an hour is missing, and its count", without("2023-03-25T10:00:00Z", "2023-03-25T11:00:00Z"),
       kTen, 1},
      {"an hour is missing, but counted", on_minutes(without_ten), std::string(kTen) + " 2760", 2},
      {"an hour is missing once", once(without_ten), kWhole, 2},
      {"the hour of the clock change is missing",
       without("2023-03-26T01:00:00Z", "2023-03-26T02:00:00Z"), "60 2820 2023-03-26T01:00:00Z"},
      {"the first row is missing", without("2023-03-24T23:00:00Z", "2023-03-24T23:01:00Z"),
       "1 2820 2023-03-24T23:00:00Z"},
      {"the last row is missing", without("2023-03-26T21:59:00Z", "2023-03-26T22:00:00Z"),
       "1 2820 2023-03-26T21:59:00Z"},
      {"a quarter-hour is missing",
       [](const Ask& ask, Answer& answer) {
         if (ask.minutes()) return;
         leave_out(answer.rows, "2023-03-26T12:00:00Z", "2023-03-26T12:15:00Z");
       },
       "1 188 ods047 2023-03-26T12:00:00Z"},
      {"nothing but the names of columns", on_rows([](auto& rows) { rows.clear(); }),
       "2820 ods046 2023-03-24T23:00:00Z 2023-03-26T22:00:00Z", 1},
      {"quarter-hours instead of minutes", formatted([](const Ask&, const auto& rows) {
         std::vector<QuirkyRow> some;
         for (const QuirkyRow& r : rows)
           if (r.utc_s % 900 == 0) some.push_back(r);
         return replaced(quirky_csv({.dataset = "ods046"}, some), "PT1M", "PT15M");
       }),
       "2820 ods046 0"},
  };
  for (const char* total : {"\"many\"", "-1", "1e300", "99999999", "null"}) {
    cases.push_back({fmt::format("100 rows at a time, total {}", total),
                     [total](const Ask& ask, Answer& answer) {
                       at_most(100, false, true)(ask, answer);
                       if (ask.wants_total)
                         answer.body = fmt::format("{{\"total_count\":{}}}", total);
                     },
                     kWhole});
  }
  return cases;
}

/// Spellings that no download has; those of files are in market_rows_test and own_csv_test.
std::vector<QuirkCase> forms() {
  return {
      {"times in local offset", formatted([](const Ask& ask, const auto& rows) {
         std::vector<QuirkyRow> shifted = rows;
         for (QuirkyRow& row : shifted) row.utc_s += 3'600;
         return replaced(quirky_csv(ask, shifted), "+00:00", "+01:00");
       }),
       kWhole, 1},
      {"times without offset", with_instead("+00:00", ""), "ods046:2 \"2023-03-24T23:00:00\"", 2},
      {"an hour off, and saying so", with_instead("+00:00", "+01:00"),
       "60 2820 2023-03-26T21:00:00Z"},
      {"an offset of no zone", with_instead("+00:00", "+99:00"),
       "ods046:2 \"2023-03-24T23:00:00+99:00\""},
      {"JSON", formatted([](const Ask& ask, const auto& rows) { return as_json(ask, rows); }),
       kWhole, 1},
      {"JSON with strings for numbers",
       formatted([](const Ask& ask, const auto& rows) { return as_json(ask, rows, "\""); }), kWhole,
       1},
      {"JSON without its end", formatted([](const Ask& ask, const auto& rows) {
         return as_json(ask, rows).substr(0, 5'000);
       }),
       "ods046 6", 6},
      {"JSON of an error with 200",
       answered("200 OK", "Content-Type: application/json\r\n", "{\"error_code\": \"ODSQLError\"}"),
       "ods046 \"results\"", 2},
      {"JSON within JSON",
       answered("200 OK", "Content-Type: application/json\r\n", std::string(200'000, '[')),
       "ods046 6", 6},
      {"a member twice", formatted([](const Ask& ask, const auto& rows) {
         return replaced(as_json(ask, rows), "\"resolutioncode\"", "\"datetime\"");
       }),
       "ods046 1 \"datetime\"", 2},
      {"no last line end", with([](std::string text) { return text.substr(0, text.size() - 1); }),
       kWhole, 1},
      {"another dataset", with_instead("imbalanceprice", "windpower"),
       "ods046 datetime;resolutioncode;windpower --price-column", 1},
      {"a column twice", with_instead("resolutioncode", "imbalanceprice"),
       "ods046 \"imbalanceprice\" --price-column", 2},
      {"a column more", with_instead("\n", ";x\n"), kWhole, 1},
      {"rows of an hour", with_instead("PT1M", "PT60M"), "ods046:2 \"PT60M\"", 2},
      {"a price that is text", row_price("high"), "ods046:702 \"high\"", 2},
      {"an infinite price", row_price("inf"), "ods046:702 \"inf\"", 2},
      {"a price of 1e300", row_price("1e300"), "2023-03-25T10:40:00Z 1e+300 price-range"},
      {"a row too short",
       with([](std::string text) { return text + "2023-03-25T10:00:00+00:00;PT1M\n"; }),
       "ods046:2822 2 3", 2},
      {"the header once more at the end",
       with([](std::string text) { return text + text.substr(0, text.find('\n') + 1); }),
       "ods046:2822 \"datetime\"", 2},
      {"a row twice, with another price", with_row("2023-03-25T00:00:00+00:00;PT1M;4711"), kWhole,
       1},
      {"a row of another century", with_row("1923-03-25T10:00:00+00:00;PT1M;5"),
       "ods046:2 \"1923-03-25T10:00:00+00:00\"", 2},
      {"a web page", answered("200 OK", "Content-Type: text/html\r\n", "<html>log in</html>"),
       "ods046 127.0.0.1 2", 2},
      {"a web page once", once(answered("200 OK", "", "<html>log in</html>")), kWhole, 2},
      {"rows called a web page", formatted(csv_of, "Content-Type: text/html\r\n"), kWhole, 1},
      {"UTF-16", with([](const std::string& text) { return "\xFF\xFE" + text; }), "UTF-16 UTF-8"},
      {"lines of old Macs", with_instead("\n", "\r"), "ods046 CR LF"},
      {"gzip that does not say so", formatted(packed_csv), "ods046 gunzip", 2},
      {"gzip, announced", formatted(packed_csv, "Content-Encoding: gzip\r\n"), kWhole, 1},
      {"gzip announced not sent", formatted(csv_of, "Content-Encoding: gzip\r\n"), "ods046 6", 6},
      {"gzip that breaks in the middle",
       formatted(
           [](const Ask& ask, const auto& rows) {
             std::string packed = packed_csv(ask, rows);
             packed[packed.size() / 2] ^= 0x55;
             return packed;
           },
           "Content-Encoding: gzip\r\n"),
       "ods046 6", 6},
      {"an encoding that was not asked for", answered("200 OK", "Content-Encoding: br\r\n", "abc"),
       "ods046 6", 12},
  };
}

Quirk moved() {
  return on_minutes([](const Ask& ask, Answer& answer) {
    const auto time = [](std::int64_t utc_s) {
      return std::string(utc_text(utc_s).view().substr(0, 19));
    };
    answer.status = "302 Found";
    answer.headers = fmt::format(
        "Location: ?where=datetime%20%3E%3D%20%22{}%2B00%3A00%22%20AND%20datetime%20%3C%20%22{}"
        "%2B00%3A00%22\r\n",
        time(ask.from_utc_s), time(ask.until_utc_s));
  });
}

std::vector<QuirkCase> transport() {
  const auto without_length = [](Answer& answer, std::size_t sent_max) {
    answer.has_length = false;
    answer.sent_max = sent_max;
  };
  const std::size_t in_a_line =
      quirky_csv({}, {}).size() + std::string("2023-03-25T10:00:00+00:00;PT1M;").size();
  const auto in_chunks = [=](std::size_t sent_max) {
    return on_minutes([=](const Ask&, Answer& a) {
      without_length(a, sent_max);
      a.headers = "Transfer-Encoding: chunked\r\n";
      a.format = [](const Ask& of, const auto& rows) { return chunked(quirky_csv(of, rows)); };
    });
  };
  std::vector<QuirkCase> cases{
      {"cut short", on_minutes([](const Ask&, Answer& a) { a.sent_max = 3'000; }), "ods046 6", 6},
      {"cut short once", once([](const Ask&, Answer& a) { a.sent_max = 3'000; }), kWhole, 2},
      {"no length", on_minutes([=](const Ask&, Answer& a) { without_length(a, a.body.npos); }),
       kWhole, 1},
      {"no length, cut in a line once",
       once([=](const Ask&, Answer& a) { without_length(a, in_a_line); }), kWhole, 2},
      {"no length, cut at a line end", on_minutes([=](const Ask&, Answer& a) {
         without_length(a, a.body.npos);
         a.rows.resize(std::min<std::size_t>(a.rows.size(), 1'000));
       }),
       kWhole, 3},
      {"no length, nothing", on_minutes([=](const Ask&, Answer& a) { without_length(a, 0); }),
       "ods046 6", 6},
      {"chunks", in_chunks(std::string::npos), kWhole, 1},
      {"chunks without their end", in_chunks(20'000), "ods046 6", 6},
      {"chunks of no size",
       answered("200 OK", "Transfer-Encoding: chunked\r\n", "zz\r\nabc\r\n0\r\n\r\n", false),
       "ods046 6", 6},
      {"a length that is too long, once",
       once(answered("200 OK", "Content-Length: 9999999\r\n", "datetime;", false)), kWhole, 2},
      {"a length that is no number", answered("200 OK", "Content-Length: many\r\n", "x", false),
       "Content-Length", 1},
      {"headers without end", answered("200 OK", "X: " + std::string(400'000, 'x') + "\r\n", "x"),
       "100000 1", 1},
      {"headers without end, in lines", on_minutes([](const Ask&, Answer& answer) {
         for (int i = 0; i < 20'000; ++i) answer.headers += "X: " + std::to_string(i) + "\r\n";
       }),
       "100000 1", 1},
      {"moved", once(moved()), kWhole, 2},
      {"moved round and round", moved(), "5 1", 6},
      {"moved to a file", answered("302 Found", "Location: file:///etc/passwd\r\n", "x"),
       "\"file\" 1", 1},
      {"moved to nowhere", answered("302 Found", "", "x"), "302"},
      {"quota, to wait for words", once(answered("429 Many", "Retry-After: soon\r\n")), kWhole, 2},
      {"quota, to wait for ever", answered("429 Many", "Retry-After: 99999999999999999999\r\n"),
       "429 ods046", 1},
      {"busy, until a far reset",
       answered("503 Busy", "X-RateLimit-Reset: 9999-12-31 00:00:00+00:00\r\n"), "503 ods046", 1},
      {"busy, to wait 3 s", once(answered("503 Busy", "Retry-After: 3\r\n")), kWhole, 2},
  };
  for (const char* refused :
       {"203 Other", "204 No Content", "206 Part", "304 Not Modified", "400 Bad", "401 No",
        "404 Not Found", "451 Law", "501 Not Implemented"}) {
    cases.push_back({refused, answered(refused), std::string(refused).substr(0, 3) + " 1", 1});
  }
  for (const char* busy : {"408 Timeout", "429 Many", "500 Error", "504 Gateway", "799 What"}) {
    cases.push_back({busy, answered(busy), std::string(busy).substr(0, 3) + " 6", 6});
  }
  cases.push_back({"502 once", once(answered("502 Gateway")), kWhole, 2});
  return cases;
}

class FetchQuirks : public testing::Test {
 protected:
  FetchRequest request(const QuirkyElia& elia) {
    return {.span = kSpan,
            .out = folder_ / "prices.csv",
            .base_url = elia.base_url(),
            .now_utc_s = 1'750'000'000,
            .retry = {},
            .sleep = [](double, const std::atomic<bool>&) {}};
  }
  static void fetch(const FetchRequest& wanted) {
    const std::atomic<bool> interrupted{false};
    ASSERT_TRUE(fetch_prices(wanted, interrupted));
  }
  static std::string rows_of(const std::filesystem::path& path) {
    const std::string text = read_file(path);
    return text.substr(text.find("minute_utc"));
  }
  /// What an ordinary server leads to.
  std::string whole() {
    const QuirkyElia elia([](const Ask&, Answer&) {});
    FetchRequest wanted = request(elia);
    wanted.out = folder_ / "whole.csv";
    fetch(wanted);
    return rows_of(wanted.out);
  }

  void expect(const std::vector<QuirkCase>& cases) {
    const std::string reference = whole();
    ASSERT_EQ(std::ranges::count(reference, '\n'), static_cast<long>(kMinutes) + 1);
    for (const QuirkCase& c : cases) {
      SCOPED_TRACE(c.name);
      const QuirkyElia elia(c.quirk);
      const FetchRequest wanted = request(elia);
      if (c.names == kWhole) {
        EXPECT_NO_THROW(fetch(wanted));
        ASSERT_TRUE(std::filesystem::exists(wanted.out));
        EXPECT_TRUE(rows_of(wanted.out) == reference) << "another file";
      } else {
        const std::string error = user_error_of([&] { fetch(wanted); });
        EXPECT_THAT(error, Names(c.names));
        EXPECT_EQ(error.find("where="), error.npos) << "the address is kept short";
        EXPECT_EQ(error.find('\n'), error.npos);
        EXPECT_FALSE(std::filesystem::exists(wanted.out));
      }
      const int requests = elia.minute_requests();
      EXPECT_EQ(requests, c.requests > 0 ? c.requests : requests);
      std::filesystem::remove(wanted.out);
      std::filesystem::remove_all(fetch_cache_folder(wanted));
    }
  }

  ScratchFolder folder_;
};

TEST_F(FetchQuirks, OfOrderAndNumber) { expect(order_and_number()); }
TEST_F(FetchQuirks, OfForm) { expect(forms()); }
TEST_F(FetchQuirks, OfTransport) { expect(transport()); }

/// Rows that are there and say nothing: as good as none, where money is counted.
TEST_F(FetchQuirks, ASettledHoleIsOneWhateverItIsMadeOf) {
  for (const char* price : {"", "null", "NaN", "-"}) {
    SCOPED_TRACE(price);
    const QuirkyElia elia([price](const Ask& ask, Answer& answer) {
      if (ask.minutes() || ask.wants_total) return;
      for (QuirkyRow& row : answer.rows) {
        const bool in_hole = row.utc_s >= utc_of("2023-03-25T10:00:00Z") &&
                             row.utc_s < utc_of("2023-03-25T11:00:00Z");
        if (in_hole) row.price = price;
      }
      if (price == std::string("null")) {
        answer.format = [](const Ask& of, const auto& rows) { return as_json(of, rows); };
      }
    });
    FetchRequest wanted = request(elia);
    const std::string error = user_error_of([&] { fetch(wanted); });
    EXPECT_FALSE(std::filesystem::exists(wanted.out));
    if (price == std::string("-")) {
      EXPECT_THAT(error, Names("ods047:46 \"-\""));
      continue;
    }
    EXPECT_THAT(error, Names("4 188 ods047 2023-03-25T10:00:00Z 2023-03-25T11:00:00Z "
                             "--allow-gaps"));
    wanted.allow_gaps = true;
    fetch(wanted);
    EXPECT_THAT(rows_of(wanted.out), HasSubstr("\n2023-03-25T10:00:00Z,"));
    std::filesystem::remove(wanted.out);
    std::filesystem::remove_all(fetch_cache_folder(wanted));
  }
}

/// Kept windows have the hole as well: a second run asks again, and takes what the server has
/// mended.
TEST_F(FetchQuirks, AKeptWindowWithASettledHoleIsAskedForAgain) {
  std::atomic<bool> is_mended{false};
  const QuirkyElia elia([&is_mended](const Ask& ask, Answer& answer) {
    if (ask.minutes() || ask.wants_total || is_mended) return;
    answer.rows[40].price.clear();
  });
  const FetchRequest wanted = request(elia);
  EXPECT_THAT(user_error_of([&] { fetch(wanted); }), Names("1 188 ods047"));
  is_mended = true;
  fetch(wanted);
  EXPECT_TRUE(rows_of(wanted.out) == whole());
}

/// Too slow, and steady without an end.
TEST_F(FetchQuirks, AnAnswerThatDripsEnds) {
  const struct {
    int drip_ms;
    HttpLimits limits;
    const char* names;
  } cases[] = {{20, {.deadline_s = 60, .bytes_per_s_min = 1'000, .slow_s = 1}, "1000 1 s 2"},
               {5, {.deadline_s = 1.5, .bytes_per_s_min = 10, .slow_s = 1}, "1.5 s 2"}};
  for (const auto& c : cases) {
    const QuirkyElia elia(
        on_minutes([&c](const Ask&, Answer& answer) { answer.drip_ms = c.drip_ms; }));
    FetchRequest wanted = request(elia);
    wanted.retry.limits = c.limits;
    EXPECT_THAT(user_error_of([&] { fetch(wanted); }), Names(c.names));
    EXPECT_EQ(elia.minute_requests(), 2);
  }
}

TEST_F(FetchQuirks, AnAnswerTooLargeSaysSo) {
  for (const bool is_packed : {false, true}) {
    const QuirkyElia elia(on_minutes([is_packed](const Ask&, Answer& answer) {
      const std::string bomb = quirky_csv({}, {}) + std::string(3'000'000, '#') + "\n";
      answer.body = is_packed ? gzipped(bomb) : bomb;
      if (is_packed) answer.headers = "Content-Encoding: gzip\r\n";
    }));
    FetchRequest wanted = request(elia);
    wanted.retry.limits.bytes_max = 1'000'000;
    EXPECT_THAT(user_error_of([&] { fetch(wanted); }), Names("1000000 ods046"));
    EXPECT_EQ(elia.minute_requests(), 1) << "another try would bring the same";
  }
}

TEST_F(FetchQuirks, AllowedGapsAreWrittenAndSaid) {
  const QuirkyElia elia(without("2023-03-25T10:00:00Z", "2023-03-25T11:00:00Z"));
  FetchRequest wanted = request(elia);
  wanted.allow_gaps = true;
  fetch(wanted);
  const std::string text = read_file(wanted.out);
  const std::size_t head = text.find("minute_utc");
  EXPECT_THAT(text.substr(0, head), Names("60 2820 ods046 2023-03-25T10:00:00Z"));
  EXPECT_THAT(text.substr(head), HasSubstr("2023-03-25T10:00:00Z,,"));
}

TEST_F(FetchQuirks, AWindowWithAGapIsAskedForAgain) {
  std::atomic<bool> broken{true};
  const QuirkyElia elia([&broken](const Ask& ask, Answer& answer) {
    if (ask.minutes() && broken) without_ten(ask, answer);
  });
  const FetchRequest wanted = request(elia);
  EXPECT_THAT(user_error_of([&] { fetch(wanted); }), Names(kTen));
  broken = false;
  fetch(wanted);
  EXPECT_EQ(std::ranges::count(rows_of(wanted.out), '\n'), static_cast<long>(kMinutes) + 1);
}

}  // namespace
}  // namespace bess
