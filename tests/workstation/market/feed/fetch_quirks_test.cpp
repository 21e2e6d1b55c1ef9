// The download against a server with one quirk at a time: the file is whole, or there is none and
// one line says why, and what cannot succeed is not asked for again and again.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <fstream>
#include <iterator>

#include "shared/host/file.h"
#include "tests/support/market_series.h"
#include "tests/support/market_test_support.h"
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
  std::string error;        ///< words of the line, or kWhole
  int minute_requests = 0;  ///< that are needed; 0 = not looked at
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
/// Rows and their count.
Quirk on_rows(const std::function<void(std::vector<QuirkyRow>&)>& change) {
  return [change](const Ask& ask, Answer& answer) {
    if (ask.minutes()) change(answer.rows);
  };
}
Quirk body(const std::string& text, const std::string& type = "") {
  return on_minutes([text, type](const Ask&, Answer& answer) {
    answer.body = text;
    answer.format = {};
    if (!type.empty()) answer.headers = "Content-Type: " + type + "\r\n";
  });
}
Quirk status(const std::string& line, const std::string& headers = "") {
  return on_minutes([line, headers](const Ask&, Answer& answer) {
    answer.status = line;
    answer.headers = headers;
    answer.body = "{\"error\":\"so\"}";
  });
}
using Format = std::function<std::string(const Ask&, const std::vector<QuirkyRow>&)>;
Quirk formatted(const Format& format) {
  return on_minutes([format](const Ask&, Answer& answer) { answer.format = format; });
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
std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += with.size()) {
    text.replace(at, what.size(), with);
  }
  return text;
}
std::string as_json(const Ask& ask, const std::vector<QuirkyRow>& rows, const char* quote) {
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
Quirk row_price(const char* price) {
  return on_minutes([price](const Ask&, Answer& answer) {
    if (answer.rows.size() > 700) answer.rows[700].price = price;
  });
}

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
      {"100 rows at a time", at_most(100, false, true), kWhole, 29},
      {"100 rows at a time, newest first", at_most(100, true, true), kWhole, 29},
      {"100 rows at a time, no total", at_most(100, false, false), kWhole, 29},
      {"1000 rows at a time, newest first, no total", at_most(1'000, true, false), kWhole, 3},
      {"one row too many",
       [](const Ask& ask, Answer& answer) {
         answer.rows.push_back({ask.until_utc_s, "1"});
       },
       kWhole, 1},
      {"the day before as well",
       [](const Ask& ask, Answer& answer) {
         answer.rows = quirky_rows(ask, ask.from_utc_s - 86'400, ask.until_utc_s);
       },
       kWhole, 1},
      {"rows of other days alone", on_minutes([](const Ask& ask, Answer& answer) {
         answer.rows = quirky_rows(ask, ask.from_utc_s - 86'400, ask.from_utc_s);
       }),
       "the server ignored the time window", 1},
      {"the same days for every question", on_minutes([](const Ask& ask, Answer& answer) {
         answer.rows =
             quirky_rows(ask, utc_of("2023-03-24T23:00:00Z"), utc_of("2023-03-25T23:00:00Z"));
       }),
       "1380 of 2820 minutes missing in ods046"},
      {"an hour is missing, and its count",
       on_rows([](auto& rows) { leave_out(rows, "2023-03-25T10:00:00Z", "2023-03-25T11:00:00Z"); }),
       "60 of 2820 minutes missing in ods046, first from 2023-03-25T10:00:00Z to "
       "2023-03-25T11:00:00Z (the server has no more)",
       1},
      {"an hour is missing, but counted", on_minutes([](const Ask&, Answer& answer) {
         leave_out(answer.rows, "2023-03-25T10:00:00Z", "2023-03-25T11:00:00Z");
       }),
       "(the server counts 2820 rows and sent 2760)", 2},
      {"an hour is missing once", once([](const Ask&, Answer& answer) {
         leave_out(answer.rows, "2023-03-25T10:00:00Z", "2023-03-25T11:00:00Z");
       }),
       kWhole, 2},
      {"every tenth row is missing once", once([](const Ask&, Answer& answer) {
         std::erase_if(answer.rows, [](const QuirkyRow& r) { return r.utc_s % 600 == 0; });
       }),
       kWhole},
      {"the hour of the clock change is missing",
       on_rows([](auto& rows) { leave_out(rows, "2023-03-26T01:00:00Z", "2023-03-26T02:00:00Z"); }),
       "60 of 2820 minutes missing"},
      {"the first row is missing",
       on_rows([](auto& rows) { leave_out(rows, "2023-03-24T23:00:00Z", "2023-03-24T23:01:00Z"); }),
       "1 of 2820 minutes missing"},
      {"the last row is missing",
       on_rows([](auto& rows) { leave_out(rows, "2023-03-26T21:59:00Z", "2023-03-26T22:00:00Z"); }),
       "1 of 2820 minutes missing"},
      {"a quarter-hour is missing",
       [](const Ask& ask, Answer& answer) {
         if (ask.minutes()) return;
         leave_out(answer.rows, "2023-03-26T12:00:00Z", "2023-03-26T12:15:00Z");
       },
       "1 of 188 quarter-hours missing in ods047"},
      {"no quarter-hour at all",
       [](const Ask& ask, Answer& answer) {
         if (!ask.minutes()) answer.rows.clear();
       },
       "188 of 188 quarter-hours missing in ods047"},
      {"nothing but the names of columns", on_rows([](auto& rows) { rows.clear(); }),
       "2820 of 2820 minutes missing", 1},
      {"nothing once", once([](const Ask&, Answer& answer) { answer.rows.clear(); }), kWhole, 2},
      {"quarter-hours instead of minutes", formatted([](const Ask&, const auto& rows) {
         std::vector<QuirkyRow> some;
         for (const QuirkyRow& r : rows)
           if (r.utc_s % 900 == 0) some.push_back(r);
         return replaced(quirky_csv({.dataset = "ods046"}, some), "PT1M", "PT15M");
       }),
       "2820 of 2820 minutes missing"},
  };
  for (const char* total : {"\"many\"", "-1", "1e300", "99999999", "null", "[]", "0.5"}) {
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

std::vector<QuirkCase> forms() {
  return {
      {"times in local offset", formatted([](const Ask& ask, const auto& rows) {
         std::vector<QuirkyRow> shifted = rows;
         for (QuirkyRow& row : shifted) row.utc_s += 3'600;
         return replaced(quirky_csv(ask, shifted), "+00:00", "+01:00");
       }),
       kWhole, 1},
      {"times with Z", formatted([](const Ask& ask, const auto& rows) {
         return replaced(quirky_csv(ask, rows), "+00:00", "Z");
       }),
       kWhole, 1},
      {"times without offset", formatted([](const Ask& ask, const auto& rows) {
         return replaced(quirky_csv(ask, rows), "+00:00", "");
       }),
       "is not a time with its UTC offset", 2},
      {"JSON", formatted([](const Ask& ask, const auto& rows) { return as_json(ask, rows, ""); }),
       kWhole, 1},
      {"JSON with strings for numbers",
       formatted([](const Ask& ask, const auto& rows) { return as_json(ask, rows, "\""); }), kWhole,
       1},
      {"JSON in results", formatted([](const Ask& ask, const auto& rows) {
         return "{\"results\":" + as_json(ask, rows, "") + "}";
       }),
       kWhole, 1},
      {"JSON without its end", formatted([](const Ask& ask, const auto& rows) {
         return as_json(ask, rows, "").substr(0, 5'000);
       }),
       "cut short (6 attempts)", 6},
      {"commas",
       formatted([](const Ask& ask, const auto& rows) { return quirky_csv(ask, rows, ","); }),
       kWhole, 1},
      {"decimal commas", formatted([](const Ask& ask, const auto& rows) {
         return replaced(quirky_csv(ask, rows), ".", ",");
       }),
       kWhole, 1},
      {"lines of Windows", formatted([](const Ask& ask, const auto& rows) {
         return "\xEF\xBB\xBF" + quirky_csv(ask, rows, ";", "\r\n");
       }),
       kWhole, 1},
      {"no last line end", formatted([](const Ask& ask, const auto& rows) {
         const std::string text = quirky_csv(ask, rows);
         return text.substr(0, text.size() - 1);
       }),
       kWhole, 1},
      {"labels of the portal", formatted([](const Ask& ask, const auto& rows) {
         return replaced(quirky_csv(ask, rows), "imbalanceprice", "Imbalance Price");
       }),
       kWhole, 1},
      {"quotes", formatted([](const Ask& ask, const auto& rows) {
         return replaced(quirky_csv(ask, rows), "PT1M", "\"PT1M\"");
       }),
       kWhole, 1},
      {"another dataset", formatted([](const Ask& ask, const auto& rows) {
         return replaced(quirky_csv(ask, rows), "imbalanceprice", "windpower");
       }),
       "no column for the imbalance price", 1},
      {"rows of an hour", formatted([](const Ask& ask, const auto& rows) {
         return replaced(quirky_csv(ask, rows), "PT1M", "PT60M");
       }),
       "neither PT1M nor PT15M", 2},
      {"a price that is text", row_price("high"), "\"high\" is not a number", 2},
      {"a price of 1e300", row_price("1e300"), "lies beyond 100000 EUR/MWh"},
      {"a price of -9999", row_price("-9999"), "stands for \"no price\""},
      {"a row too short", formatted([](const Ask& ask, const auto& rows) {
         return quirky_csv(ask, rows) + "2023-03-25T10:00:00+00:00;PT1M\n";
       }),
       "2 columns where the header has 3", 2},
      {"prices in EUR/kWh",
       [](const Ask&, Answer& answer) {
         for (QuirkyRow& row : answer.rows)
           row.price = fmt::format("{}", std::stod(row.price) / 1'000);
       },
       "multiply by 1000"},
      {"all prices zero",
       [](const Ask&, Answer& answer) {
         for (QuirkyRow& row : answer.rows) row.price = "0";
       },
       "every settled price is 0"},
      {"a web page", body("<html>log in</html>", "text/html"), "a web page, not data", 2},
      {"a web page once", once(body("<html>log in</html>")), kWhole, 2},
      {"words", body("try again later\n"), "no column for the time", 1},
      {"binary", body(std::string("\x01\0\x02\0", 4)), "NUL bytes", 2},
      {"gzip that says so",
       formatted([](const Ask& ask, const auto& rows) { return gzipped(quirky_csv(ask, rows)); }),
       "gzip data inside", 2},
      {"gzip, announced", on_minutes([](const Ask&, Answer& answer) {
         answer.headers = "Content-Encoding: gzip\r\n";
         answer.format = [](const Ask& of, const auto& rows) {
           return gzipped(quirky_csv(of, rows));
         };
       }),
       kWhole, 1},
      {"gzip announced, not sent", on_minutes([](const Ask&, Answer& answer) {
         answer.headers = "Content-Encoding: gzip\r\n";
       }),
       "(6 attempts)", 6},
  };
}

std::vector<QuirkCase> transport() {
  const auto without_length = [](Answer& answer, std::size_t sent_max) {
    answer.has_length = false;
    answer.sent_max = sent_max;
  };
  const std::size_t head = quirky_csv({}, {}).size();
  const std::size_t line = std::string("2023-03-25T10:00:00+00:00;PT1M;").size();
  std::vector<QuirkCase> cases{
      {"cut short", on_minutes([](const Ask&, Answer& a) { a.sent_max = 3'000; }), "(6 attempts)",
       6},
      {"cut short once", once([](const Ask&, Answer& a) { a.sent_max = 3'000; }), kWhole, 2},
      {"no length", on_minutes([=](const Ask&, Answer& a) { without_length(a, a.body.npos); }),
       kWhole, 1},
      {"no length, cut in a line once",
       once([=](const Ask&, Answer& a) { without_length(a, head + line); }), kWhole, 2},
      {"no length, cut at a line end", on_minutes([=](const Ask&, Answer& a) {
         without_length(a, a.body.npos);
         a.rows.resize(std::min<std::size_t>(a.rows.size(), 1'000));
       }),
       kWhole, 3},
      {"no length, nothing", on_minutes([=](const Ask&, Answer& a) { without_length(a, 0); }),
       "cut short (6 attempts)", 6},
      {"chunks", on_minutes([=](const Ask&, Answer& a) {
         without_length(a, a.body.npos);
         a.headers = "Transfer-Encoding: chunked\r\n";
         a.format = [](const Ask& of, const auto& rows) { return chunked(quirky_csv(of, rows)); };
       }),
       kWhole, 1},
      {"chunks without their end", on_minutes([=](const Ask&, Answer& a) {
         without_length(a, 20'000);
         a.headers = "Transfer-Encoding: chunked\r\n";
         a.format = [](const Ask& of, const auto& rows) { return chunked(quirky_csv(of, rows)); };
       }),
       "(6 attempts)", 6},
      {"in pieces", on_minutes([](const Ask&, Answer& a) { a.is_slow = true; }), kWhole, 1},
      {"moved", once([](const Ask& ask, Answer& a) {
         a.status = "302 Found";
         a.headers = fmt::format(
             "Location: "
             "?where=datetime%20%3E%3D%20%22{}%2B00%3A00%22%20AND%20datetime%20%3C%20%22{}%"
             "2B00%3A00%22\r\n",
             utc_text(ask.from_utc_s).view().substr(0, 19),
             utc_text(ask.until_utc_s).view().substr(0, 19));
       }),
       kWhole, 2},
      {"moved round and round", on_minutes([](const Ask& ask, Answer& a) {
         a.status = "302 Found";
         a.headers = fmt::format(
             "Location: "
             "?where=datetime%20%3E%3D%20%22{}%2B00%3A00%22%20AND%20datetime%20%3C%20%22{}%"
             "2B00%3A00%22\r\n",
             utc_text(ask.from_utc_s).view().substr(0, 19),
             utc_text(ask.until_utc_s).view().substr(0, 19));
       }),
       "redirect", 6},
      {"quota, to wait 7 s", once(status("429 Too Many", "Retry-After: 7\r\n")), kWhole, 2},
      {"quota, until a date",
       once(status("429 Too Many",
                   "Retry-After: Sun, 06 Nov 1994 08:49:37 "
                   "GMT\r\n")),
       kWhole, 2},
      {"quota, to wait 2 h", status("429 Too Many", "Retry-After: 7200\r\n"), "wait 120 minutes",
       1},
  };
  for (const char* refused : {"400 Bad", "401 No", "403 No", "404 Not Found", "405 No", "410 Gone",
                              "413 Large", "414 Long", "422 Bad", "451 Law", "204 No Content",
                              "206 Part", "501 Not Implemented", "505 Version"}) {
    cases.push_back({refused, status(refused), std::string(refused).substr(0, 3), 1});
  }
  for (const char* busy :
       {"408 Timeout", "429 Many", "500 Error", "502 Gateway", "503 Busy", "504 Gateway"}) {
    cases.push_back({busy, status(busy), "(6 attempts)", 6});
    cases.push_back({std::string(busy) + ", once", once(status(busy)), kWhole, 2});
  }
  return cases;
}

Quirk raw(const std::string& status, const std::string& headers, const std::string& text,
          bool has_length = true) {
  return on_minutes([=](const Ask&, Answer& answer) {
    answer.status = status;
    answer.headers = headers;
    answer.body = text;
    answer.has_length = has_length;
  });
}
Format with(const std::function<std::string(std::string)>& change) {
  return [change](const Ask& ask, const auto& rows) { return change(quirky_csv(ask, rows)); };
}
/// The text with what is behind its first line changed.
std::string with_a_row(std::string text, const std::string& row) {
  return text.insert(text.find('\n') + 1, row + "\n");
}

/// What other servers, proxies and portals were seen or are allowed to do.
std::vector<QuirkCase> others() {
  const std::string row = "2023-03-25T00:00:00+00:00;PT1M;";
  return {
      {"304 to a question without a condition", status("304 Not Modified"), "304", 1},
      {"203 of a proxy", status("203 Other"), "203", 1},
      {"a status of no kind", status("799 What"), "799", 6},
      {"moved to a file", raw("302 Found", "Location: file:///etc/passwd\r\n", "x"), "(1 attempt)",
       1},
      {"moved to another protocol", raw("302 Found", "Location: gopher://127.0.0.1/\r\n", "x"),
       "(1 attempt)", 1},
      {"moved to nowhere", raw("302 Found", "", "x"), "302", 0},
      {"quota, to wait less than nothing", once(status("429 Too Many", "Retry-After: -5\r\n")),
       kWhole, 2},
      {"quota, to wait for words", once(status("429 Too Many", "Retry-After: soon\r\n")), kWhole,
       2},
      {"quota, to wait for ever", status("429 Too Many", "Retry-After: 99999999999999999999\r\n"),
       "the server asks to wait a day or longer: ods046", 1},
      {"quota, to wait for a number of no size",
       status("429 Too Many", "Retry-After: 1" + std::string(400, '0') + "\r\n"),
       "asks to wait a day or longer", 1},
      {"quota, to wait for infinity", status("429 Too Many", "Retry-After: inf\r\n"),
       "asks to wait a day or longer", 1},
      {"quota, to wait for no number", once(status("429 Too Many", "Retry-After: nan\r\n")), kWhole,
       2},
      {"quota, until the year 9999",
       status("429 Too Many", "Retry-After: Fri, 31 Dec 9999 23:59:59 GMT\r\n"),
       "asks to wait a day or longer", 1},
      {"busy, until a far reset",
       status("503 Busy", "X-RateLimit-Reset: 9999-12-31 00:00:00+00:00\r\n"),
       "asks to wait a day or longer", 1},
      {"busy, to wait 3 s", once(status("503 Busy", "Retry-After: 3\r\n")), kWhole, 2},
      {"a length that is too long, once",
       once(raw("200 OK", "Content-Length: 9999999\r\n", "datetime;", false)), kWhole, 2},
      {"a length that is no number", raw("200 OK", "Content-Length: many\r\n", "x", false),
       "Content-Length", 1},
      {"a length below nothing", raw("200 OK", "Content-Length: -1\r\n", "x", false),
       "Content-Length", 1},
      {"chunks of no size",
       raw("200 OK", "Transfer-Encoding: chunked\r\n", "zz\r\nabc\r\n0\r\n\r\n", false),
       "(6 attempts)", 6},
      {"a chunk larger than any",
       raw("200 OK", "Transfer-Encoding: chunked\r\n", "ffffffffffffffffff\r\nabc\r\n", false),
       "(6 attempts)", 6},
      {"an encoding that nobody asked for", raw("200 OK", "Content-Encoding: br\r\n", "abc"),
       "cut short (6 attempts)", 12},
      {"gzip that breaks in the middle", on_minutes([](const Ask&, Answer& answer) {
         answer.headers = "Content-Encoding: gzip\r\n";
         answer.format = [](const Ask& of, const auto& rows) {
           std::string packed = gzipped(quirky_csv(of, rows));
           packed[packed.size() / 2] ^= 0x55;
           return packed;
         };
       }),
       "(6 attempts)", 6},
      {"headers without end", raw("200 OK", "X: " + std::string(400'000, 'x') + "\r\n", "x"),
       "(1 attempt)", 1},
      {"headers without end, in lines", on_minutes([](const Ask&, Answer& answer) {
         for (int i = 0; i < 20'000; ++i) answer.headers += "X: " + std::to_string(i) + "\r\n";
       }),
       "(1 attempt)", 1},
      {"rows called a web page", on_minutes([](const Ask&, Answer& answer) {
         answer.headers = "Content-Type: text/html\r\n";
       }),
       kWhole, 1},
      {"a byte order mark", formatted(with([](std::string t) { return "\xEF\xBB\xBF" + t; })),
       kWhole, 1},
      {"UTF-16", formatted(with([](std::string t) { return "\xFF\xFE" + t; })), "UTF-16", 0},
      {"lines of old Macs",
       formatted(with([](std::string t) { return replaced(std::move(t), "\n", "\r"); })),
       "CR alone", 0},
      {"the header once more in the middle",
       formatted(with([](std::string t) { return t + t.substr(0, t.find('\n') + 1); })),
       "is not a time", 2},
      {"words behind the rows", formatted(with([](std::string t) { return t + "total: 2820\n"; })),
       "is not a time", 2},
      {"a column more",
       formatted(with([](std::string t) { return replaced(std::move(t), "\n", ";x\n"); })), kWhole,
       1},
      {"columns in another order", formatted([](const Ask& ask, const auto& rows) {
         std::string text = "imbalanceprice;datetime;resolutioncode\n";
         for (const QuirkyRow& r : rows) {
           text += fmt::format("{};{};{}\n", r.price, utc_text(r.utc_s).view(),
                               ask.minutes() ? "PT1M" : "PT15M");
         }
         return text;
       }),
       kWhole, 1},
      {"a column twice", formatted(with([](std::string t) {
         return replaced(std::move(t), "resolutioncode", "imbalanceprice");
       })),
       "may be the price", 2},
      {"no column of prices", formatted(with([](std::string t) {
         return replaced(std::move(t), "imbalanceprice", "price");
       })),
       "no column for the imbalance price", 1},
      {"a row twice, with another price",
       formatted(with([row](std::string t) { return with_a_row(std::move(t), row + "4711"); })),
       kWhole, 1},
      {"a row of tomorrow", formatted(with([](std::string t) {
         return with_a_row(std::move(t), "2023-03-27T10:00:00+00:00;PT1M;5");
       })),
       kWhole, 1},
      {"a row of another century", formatted(with([](std::string t) {
         return with_a_row(std::move(t), "1923-03-25T10:00:00+00:00;PT1M;5");
       })),
       "is not a time", 2},
      {"a minute of 61 seconds", formatted(with([](std::string t) {
         return with_a_row(std::move(t), "2023-03-25T10:00:60+00:00;PT1M;5");
       })),
       " ", 0},
      {"a day that does not exist", formatted(with([](std::string t) {
         return with_a_row(std::move(t), "2023-02-30T10:00:00+00:00;PT1M;5");
       })),
       " ", 0},
      {"day and month swapped", formatted(with([](std::string t) {
         return replaced(std::move(t), "2023-03-25", "2023-25-03");
       })),
       " ", 0},
      {"an hour off, and saying so",
       formatted(with([](std::string t) { return replaced(std::move(t), "+00:00", "+01:00"); })),
       " ", 0},
      {"an offset of no zone",
       formatted(with([](std::string t) { return replaced(std::move(t), "+00:00", "+99:00"); })),
       " ", 0},
      {"seconds since 1970",
       formatted(with([](std::string t) { return with_a_row(std::move(t), "1679702400;PT1M;5"); })),
       " ", 0},
      {"a price with an exponent", row_price("1.5e1e"), "is not a number", 0},
      {"a price with thousands", row_price("1,234.5"), "is not a number", 0},
      {"a price with a minus of print",
       row_price("\xE2\x88\x92"
                 "5"),
       "is not a number", 0},
      {"an infinite price", row_price("inf"), " ", 0},
      {"a price in words of a spreadsheet", row_price("#N/A"), "is not a number", 0},
      {"half of a JSON row", formatted([](const Ask& ask, const auto& rows) {
         const std::string text = as_json(ask, rows, "");
         return text.substr(0, text.size() / 2);
       }),
       " ", 0},
      {"JSON of an error with 200",
       body("{\"error_code\": \"ODSQLError\", \"message\": \"no\"}", "application/json"), " ", 0},
      {"JSON within JSON", body(std::string(200'000, '['), "application/json"), " ", 0},
      {"a member twice", formatted([](const Ask& ask, const auto& rows) {
         return replaced(as_json(ask, rows, ""), "\"resolutioncode\"", "\"datetime\"");
       }),
       "stands twice", 0},
  };
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
      if (c.error == kWhole) {
        EXPECT_NO_THROW(fetch(wanted));
        ASSERT_TRUE(std::filesystem::exists(wanted.out));
        EXPECT_TRUE(rows_of(wanted.out) == reference) << "another file";
      } else {
        const std::string error = user_error_of([&] { fetch(wanted); });
        EXPECT_THAT(error, HasSubstr(c.error));
        EXPECT_THAT(error, testing::Not(HasSubstr("where="))) << "the address is kept short";
        EXPECT_EQ(error.find('\n'), error.npos);
        EXPECT_FALSE(std::filesystem::exists(wanted.out));
      }
      if (c.minute_requests > 0) {
        EXPECT_EQ(elia.minute_requests(), c.minute_requests);
      }
      std::filesystem::remove(wanted.out);
      std::filesystem::remove_all(fetch_cache_folder(wanted));
    }
  }

  ScratchFolder folder_;
};

TEST_F(FetchQuirks, OfOrderAndNumber) { expect(order_and_number()); }
TEST_F(FetchQuirks, OfForm) { expect(forms()); }
TEST_F(FetchQuirks, OfTransport) { expect(transport()); }
TEST_F(FetchQuirks, OfOthers) { expect(others()); }

/// Rows that are there and say nothing: as good as none, where money is counted.
TEST_F(FetchQuirks, ASettledHoleIsOneWhateverItIsMadeOf) {
  const auto settled = [](const std::string& price) -> Quirk {
    return [price](const Ask& ask, Answer& answer) {
      if (ask.minutes() || ask.wants_total) return;
      for (QuirkyRow& row : answer.rows) {
        const bool in_hole = row.utc_s >= utc_of("2023-03-25T10:00:00Z") &&
                             row.utc_s < utc_of("2023-03-25T11:00:00Z");
        if (in_hole) row.price = price;
      }
      if (price == "null") {
        answer.format = [](const Ask& of, const auto& rows) { return as_json(of, rows, ""); };
      }
    };
  };
  for (const char* price : {"", "null", "NaN", "nan", "\"\"", "-"}) {
    SCOPED_TRACE(price);
    const QuirkyElia elia(settled(price));
    FetchRequest wanted = request(elia);
    const std::string error = user_error_of([&] { fetch(wanted); });
    const bool is_hole =
        error.find(
            "4 of 188 quarter-hours missing or without a price in ods047, "
            "first from 2023-03-25T10:00:00Z to 2023-03-25T11:00:00Z") != error.npos;
    EXPECT_TRUE(is_hole || error.find("is not a number") != error.npos) << error;
    EXPECT_FALSE(std::filesystem::exists(wanted.out));
    if (!is_hole) continue;
    EXPECT_THAT(error, HasSubstr("--allow-gaps"));
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
  EXPECT_THAT(user_error_of([&] { fetch(wanted); }), HasSubstr("1 of 188 quarter-hours"));
  is_mended = true;
  fetch(wanted);
  EXPECT_TRUE(rows_of(wanted.out) == whole());
}

TEST_F(FetchQuirks, AnAnswerThatDripsEndsAndIsToldAsSlow) {
  const QuirkyElia elia(on_minutes([](const Ask&, Answer& answer) { answer.drip_ms = 20; }));
  FetchRequest wanted = request(elia);
  wanted.retry.limits = {.deadline_s = 60, .bytes_per_s_min = 1'000, .slow_s = 1};
  EXPECT_THAT(
      user_error_of([&] { fetch(wanted); }),
      HasSubstr("the answer came too slowly, less than 1000 bytes a second for 1 s (2 attempts)"));
  EXPECT_EQ(elia.minute_requests(), 2);
}

TEST_F(FetchQuirks, AnAnswerThatComesSteadilyAndNeverEndsHasADeadline) {
  const QuirkyElia elia(on_minutes([](const Ask&, Answer& answer) { answer.drip_ms = 5; }));
  FetchRequest wanted = request(elia);
  wanted.retry.limits = {.deadline_s = 1.5, .bytes_per_s_min = 10, .slow_s = 1};
  EXPECT_THAT(user_error_of([&] { fetch(wanted); }),
              HasSubstr("the answer was not whole after 1.5 s ("));
  EXPECT_EQ(elia.minute_requests(), 2);
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
    EXPECT_THAT(user_error_of([&] { fetch(wanted); }),
                HasSubstr("the answer is larger than 1000000 bytes, more than is meant here"));
    EXPECT_EQ(elia.minute_requests(), 1) << "another try would bring the same";
  }
}

/// What Belgium settled at, what another country did, and where bids end: in the file to the digit.
TEST_F(FetchQuirks, ExtremePricesAreFetchedAsTheyAre) {
  for (const char* price : {"-999", "25907.54", "-25907.54", "99999", "-99999"}) {
    const QuirkyElia elia([price](const Ask& ask, Answer& answer) {
      if (ask.minutes() || ask.wants_total) return;
      for (QuirkyRow& row : answer.rows) {
        if (row.utc_s == utc_of("2023-03-25T10:00:00Z")) row.price = price;
      }
    });
    const FetchRequest wanted = request(elia);
    fetch(wanted);
    EXPECT_EQ(std::ranges::count(read_minute_file(wanted.out).settled, std::stod(price)), 15);
    std::filesystem::remove(wanted.out);
  }
}

TEST_F(FetchQuirks, AllowedGapsAreWrittenAndSaid) {
  const QuirkyElia elia(
      on_rows([](auto& rows) { leave_out(rows, "2023-03-25T10:00:00Z", "2023-03-25T11:00:00Z"); }));
  FetchRequest wanted = request(elia);
  EXPECT_THAT(user_error_of([&] { fetch(wanted); }), HasSubstr("--allow-gaps"));
  wanted.allow_gaps = true;
  fetch(wanted);
  const std::string text = read_file(wanted.out);
  EXPECT_THAT(text,
              HasSubstr("# 60 of 2820 minutes missing in ods046, first from 2023-03-25T10:00"));
  EXPECT_THAT(text, HasSubstr("2023-03-25T10:00:00Z,,"));
}

TEST_F(FetchQuirks, AWindowWithAGapIsAskedForAgain) {
  std::atomic<bool> broken{true};
  const QuirkyElia elia([&broken](const Ask& ask, Answer& answer) {
    if (ask.minutes() && broken)
      leave_out(answer.rows, "2023-03-25T10:00:00Z", "2023-03-25T11:00:00Z");
  });
  const FetchRequest wanted = request(elia);
  EXPECT_THAT(user_error_of([&] { fetch(wanted); }), HasSubstr("60 of 2820 minutes missing"));
  broken = false;
  fetch(wanted);
  EXPECT_EQ(std::ranges::count(rows_of(wanted.out), '\n'), static_cast<long>(kMinutes) + 1);
}

TEST_F(FetchQuirks, AreMoreThanAHundredAndThirty) {
  EXPECT_GE(order_and_number().size() + forms().size() + transport().size() + others().size(),
            136u);
}

}  // namespace
}  // namespace bess
