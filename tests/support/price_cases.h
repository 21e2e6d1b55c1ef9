// Price files of users, valid and invalid: each a text, its result, and the codes that its one-line
// error names.
#pragma once

#include <fmt/core.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "shared/utc_text.h"

namespace bess {

struct PriceCase {
  std::string name;
  std::string text;
  const char* names;  ///< what the error names
};

/// One row of the file that all cases start from: an ordinary minute.
struct OrdinaryRow {
  std::int64_t utc_s;
  double indicative, settled;
};

/// Three local days of January 2023 without findings.
inline std::vector<OrdinaryRow> ordinary_rows() {
  constexpr std::int64_t kStart_s = 1'672'527'600;  // 2022-12-31T23:00:00Z
  std::vector<OrdinaryRow> rows;
  for (int m = 0; m < 3 * 1440; ++m) {
    const int q = m / 15;
    const double settled = std::round(100 * (90 + 60 * std::sin(q * 0.7) + q % 13)) / 100;
    rows.push_back({kStart_s + 60 * m, settled + 5 - m % 15 * 0.25, settled});
  }
  return rows;
}

inline constexpr const char* kMinuteHeader = "minute_utc,indicative_eur_mwh,settled_eur_mwh\n";

inline std::string row_text(const OrdinaryRow& row, const std::string& indicative,
                            const std::string& settled) {
  return fmt::format("{},{},{}\n", utc_text(row.utc_s).view(), indicative, settled);
}

/// The rows changed by `price`: a text of both price fields, or empty to omit the row.
inline std::string ordinary_text(
    const std::function<std::string(std::size_t, const OrdinaryRow&)>& line = {}) {
  std::string text = kMinuteHeader;
  const std::vector<OrdinaryRow> rows = ordinary_rows();
  for (std::size_t m = 0; m < rows.size(); ++m) {
    text += line ? line(m, rows[m])
                 : row_text(rows[m], fmt::format("{}", rows[m].indicative),
                            fmt::format("{}", rows[m].settled));
  }
  return text;
}

inline std::string scaled_text(double factor) {
  return ordinary_text([factor](std::size_t, const OrdinaryRow& r) {
    return row_text(r, fmt::format("{}", r.indicative * factor),
                    fmt::format("{}", r.settled * factor));
  });
}

/// Minute `at` has these price fields instead; a settled price applies to its whole quarter-hour.
inline std::string with_prices(std::size_t at, const std::string& indicative,
                               const std::string& settled) {
  return ordinary_text([&](std::size_t m, const OrdinaryRow& r) {
    const bool of_quarter_hour = m / 15 == at / 15;
    return row_text(r,
                    m == at && !indicative.empty() ? indicative : fmt::format("{}", r.indicative),
                    of_quarter_hour && !settled.empty() ? settled : fmt::format("{}", r.settled));
  });
}

/// Row `at` of the file, without the header, is this line.
inline std::string with_line(std::size_t at, const std::string& wanted) {
  return ordinary_text([&](std::size_t m, const OrdinaryRow& r) {
    return m == at ? wanted + "\n"
                   : row_text(r, fmt::format("{}", r.indicative), fmt::format("{}", r.settled));
  });
}

/// Files that every command must refuse.
inline std::vector<PriceCase> bad_price_files() {
  std::vector<PriceCase> cases;
  const auto add = [&cases](const std::string& name, std::string text, const char* names) {
    cases.push_back({name, std::move(text), names});
  };
  const auto keep = [](const auto& wanted) {
    return ordinary_text([wanted](std::size_t m, const OrdinaryRow& r) {
      return wanted(m) ? row_text(r, fmt::format("{}", r.indicative), fmt::format("{}", r.settled))
                       : std::string();
    });
  };
  const std::string whole = ordinary_text();
  // Invalid prices, in either column, early and late.
  for (const std::size_t at : {std::size_t{0}, std::size_t{2000}, std::size_t{4319}}) {
    for (const char* price :
         {"1e300", "-1e300", "1e200", "1e100", "1e10", "100000.01", "-100001"}) {
      add(fmt::format("settled {} at {}", price, at), with_prices(at, "", price), "price-range");
      add(fmt::format("indicative {} at {}", price, at), with_prices(at, price, ""), "price-range");
    }
    for (const char* price : {"-9999", "9999", "-9999.99", "9999.99"}) {
      add(fmt::format("settled {} at {}", price, at), with_prices(at, "", price), "sentinel");
      add(fmt::format("indicative {} at {}", price, at), with_prices(at, price, ""), "sentinel");
    }
  }
  for (const char* price :
       {"nan", "inf", "-inf", "NaN", "null", "n/a", "-", "1e999", "1,5", "0x1p3", " 5", "5 ",
        "5 EUR", "1.2.3", "--5", "+5", "1_000", "٣", "\x1b[31m5"}) {
    add(fmt::format("no number: {}", price), with_prices(700, price, ""), "prices.csv:702");
  }
  // Units, constants, swapped and copied columns.
  add("EUR/kWh", scaled_text(0.001), "price-unit 1000");
  add("EUR/kWh, a hundredth of it", scaled_text(0.00001), "price-unit 1000");
  add("cents", scaled_text(100), "price-unit 100");
  add("a thousand of them", scaled_text(1000), "price-unit 100");
  add("1e300 everywhere", scaled_text(1e298), "price-range");
  add("zero everywhere", scaled_text(0), "prices.csv:2 0 constant");
  const auto columns = [](const auto& settled_of, const auto& indicative_of) {
    return ordinary_text([=](std::size_t, const OrdinaryRow& r) {
      return row_text(r, fmt::format("{}", indicative_of(r)), fmt::format("{}", settled_of(r)));
    });
  };
  const auto indicative = [](const OrdinaryRow& r) { return r.indicative; };
  const auto settled = [](const OrdinaryRow& r) { return r.settled; };
  const auto same = [](const OrdinaryRow&) { return 42.5; };
  add("swapped columns", columns(indicative, settled), "settled-changes 4032");
  add("indicative twice", columns(indicative, indicative), "settled-changes");
  add("settled is constant", columns(same, indicative), "settled 42.5 constant");
  add("indicative is constant", columns(settled, same), "indicative 42.5 constant");
  add("one settled price of a minute", with_line(1003, "2023-01-01T15:43:00Z,5,17"),
      "settled-changes");
  // Invalid rows.
  add("quarter-hours", keep([](std::size_t m) { return m % 15 == 0; }), "15 row-step");
  add("hours", keep([](std::size_t m) { return m % 60 == 0; }), "60 row-step");
  add("every other minute", keep([](std::size_t m) { return m % 2 == 0; }), "2 row-step");
  add("five minutes", keep([](std::size_t m) { return m % 5 == 0; }), "5 row-step");
  add("one quarter-hour an hour", keep([](std::size_t m) { return m % 60 < 15; }),
      "60 15 row-step");
  add("no rows", kMinuteHeader, "prices.csv");
  add("one row", std::string(kMinuteHeader) + "2023-01-01T00:00:00Z,5,6\n", "690 720");
  add("half a day", whole.substr(0, whole.find("2023-01-01T10:00:00Z")), "690 720");
  add("indicative reconstruct", columns(settled, [](const OrdinaryRow&) { return std::string(); }),
      "no indicative price");
  add("settled", columns([](const OrdinaryRow&) { return std::string(); }, indicative),
      "no settled price");
  add("no price",
      columns([](const OrdinaryRow&) { return std::string(); },
              [](const OrdinaryRow&) { return std::string(); }),
      "prices.csv");
  add("a row twice", with_line(5, "2022-12-31T23:04:00Z,5,6"), "prices.csv:7 2022-12-31T23:04:00Z");
  add("a row of long ago", with_line(5, "1999-12-31T23:04:00Z,5,6"),
      "prices.csv:7 1999-12-31T23:04:00Z");
  add("a row of the future", with_line(4319, "2103-01-01T00:00:00Z,5,6"),
      "prices.csv:4321 2103-01-01T00:00:00Z 40");
  std::string early = whole;
  std::string late = whole;
  for (std::size_t at = 0; (at = early.find("\n202", at)) != early.npos;)
    early.replace(++at, 3, "197");
  for (std::size_t at = 0; (at = late.find("\n20", at)) != late.npos;) late[at += 2] = '1';
  add("the year 1973", early, "dates");
  add("the year 2123", late, "dates");
  // Invalid text.
  add("empty", "", "prices.csv");
  add("a line end", "\n", "prices.csv");
  add("no header", whole.substr(whole.find('\n') + 1),
      "prices.csv:1 minute_utc,indicative_eur_mwh,settled_eur_mwh");
  add("another header", "a,b,c\n" + whole.substr(whole.find('\n') + 1),
      "prices.csv:1 minute_utc,indicative_eur_mwh,settled_eur_mwh");
  add("header in capitals", "MINUTE_UTC" + whole.substr(10),
      "prices.csv:1 minute_utc,indicative_eur_mwh,settled_eur_mwh");
  add("columns in another order",
      "minute_utc,settled_eur_mwh,indicative_eur_mwh" + whole.substr(whole.find('\n')),
      "prices.csv:1 minute_utc,indicative_eur_mwh,settled_eur_mwh");
  add("semicolons", "minute_utc;indicative_eur_mwh;settled_eur_mwh\n",
      "prices.csv:1 prices import");
  add("prices.csv", "<!DOCTYPE html><html></html>", "a web page");
  add("a ZIP archive", "PK\x03\x04 and so on", "ZIP");
  add("JSON", "[{\"datetime\":\"2023-01-01T00:00:00Z\"}]",
      "prices.csv:1 minute_utc,indicative_eur_mwh,settled_eur_mwh");
  add("UTF-16", "\xFF\xFEm", "UTF-16 UTF-8");
  add("binary",
      std::string("\x7F"
                  "ELF\0\0\0",
                  7),
      "NUL UTF-8");
  add("cut in a time", whole.substr(0, whole.rfind("T")), "prices.csv:4321");
  add("cut before the last price", whole.substr(0, whole.rfind(',')), "prices.csv:4321");
  add("cut in the last price", whole.substr(0, whole.size() - 3), "cut-end");
  add("cut behind the last comma", whole.substr(0, whole.rfind(',') + 1), "cut-end");
  for (const char* line :
       {"2023-01-01T00:00:00Z", "2023-01-01T00:00:00Z,5", "2023-01-01T00:00:00Z,5,6,7", ",,",
        "2023-01-01 00:00,5,6", "01.01.2023 00:00,5,6", "2023-13-01T00:00:00Z,5,6",
        "2023-02-30T00:00:00Z,5,6", "2023-01-01T25:00:00Z,5,6", "2023-01-01T00:00:30Z,5,6",
        "1672531200,5,6", "x", "\"2023-01-01T00:00:00Z\";5;6", "2023-01-01T00:00:00Z,5,6,",
        "minute_utc,indicative_eur_mwh,settled_eur_mwh"}) {
    add(fmt::format("row: {}", line), with_line(60, line), "prices.csv:62");
  }
  return cases;
}

}  // namespace bess
