#include "edge/prices/fetch/settled_fetch.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "edge/app/settings/retired_keys.h"
#include "edge/core/control/quarter_hour_energy.h"
#include "edge/prices/fetch/fetch.h"
#include "edge/prices/record/transport_security.h"
#include "edge/records/account/settled_prices.h"
#include "edge/records/log/atomic_file.h"
#include "shared/host/http_client.h"
#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/local_time.h"
#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr std::size_t kAnswerBytesMax = 16 * 1024 * 1024;  // 100 days, with every field: 3 MB

void read_settled(TomlTable table, SettledSource& source) {
  table.line("url", source.url);
  table.line("ca_file", source.ca_file);
  table.finish();
  if (source.url.empty() || !table.ok()) return;
  // The prices are public, but plain http would allow forgery.
  const UrlTransport transport = transport_of(settled_url(source, 0, 0));
  if (transport != UrlTransport::kSecure && transport != UrlTransport::kLoopback) {
    return table.fail("url", "must start with https://, or address this machine: http://127.0.0.1");
  }
  const bool has_from = source.url.find("{from}") != std::string::npos;
  const bool has_until = source.url.find("{until}") != std::string::npos;
  const bool has_query = source.url.find('?') != std::string::npos;
  if (has_from != has_until || (has_query && !has_from)) {
    return table.fail("url", "must contain {from} and {until}, or be Elia's without a query");
  }
  if (source.ca_file.empty()) return;
  source.ca_file = table.resolved(source.ca_file);
  if (access(source.ca_file.c_str(), R_OK) != 0) {
    table.fail("ca_file", "= " + source.ca_file + " cannot be read");
  }
}

bool parse_row(JsonValue row, SettledQuarter& quarter) {
  const char* const start = row["datetime"].text();
  if (start == nullptr || !parse_utc(start, quarter.start_utc_s)) return false;
  if (quarter.start_utc_s % kQuarterHourS != 0) return false;
  const auto price = row["imbalanceprice"].number();
  // Until May 2024 there were two prices of equal value.
  const auto found = price ? price : row["positiveimbalanceprice"].number();
  if (!found || !(std::fabs(*found) <= kPlausiblePriceMaxEurPerMwh)) return false;
  quarter.eur_per_mwh = *found;
  // Not for "Not Validated", "NV", "DataIssue" and others.
  const bool is_validated = equals_ignoring_case(row["qualitystatus"].text_or(""), "validated");
  quarter.state = is_validated ? PriceState::kValidated : PriceState::kPublished;
  return true;
}

std::string keep(const SettledSource& source, const SettledPrices& prices) {
  const bool is_kept = make_folder(folder_of(source.file.c_str()).c_str()) &&
                       replace_file_durably(source.file.c_str(), prices.text());
  if (is_kept) return "";
  FileMessage message;
  fail_with_errno(source.file.c_str(), "cannot be written", message);
  return std::string(message.view());
}

}  // namespace

bool load_settled_source(const std::string& path, SettledSource& source, std::string& error) {
  TomlValue document;
  if (!parse_toml_file(path, document, error)) return false;
  TomlTable root(&document, path, "", error);
  read_settled(section(root, "settled"), source);
  return error.empty();
}

std::string settled_url(const SettledSource& source, std::int64_t from_utc_s,
                        std::int64_t until_utc_s) {
  constexpr const char* kEliaQuery =
      "?where=datetime%20%3E%3D%20%22{from}%22%20AND%20datetime%20%3C%20%22{until}%22"
      "&select=datetime,imbalanceprice,qualitystatus&timezone=UTC";
  std::string url = source.url;
  if (url.find('{') == url.npos) url += kEliaQuery;
  replace_all(url, "{from}", utc_text(from_utc_s).view());
  replace_all(url, "{until}", utc_text(until_utc_s).view());
  return url;
}

std::vector<SettledQuarter> parse_settled(std::string_view text, std::string& trouble) {
  std::vector<SettledQuarter> quarters;
  const Json json = parse_answer(text);
  const JsonValue rows = json.value().is_list() ? json.value() : json.value()["results"];
  if (!rows.is_list()) {
    trouble = "the answer is not a list of quarter-hours: check [settled] url";
    return quarters;
  }
  SettledQuarter quarter;
  for (const JsonValue row : rows) {
    if (parse_row(row, quarter)) quarters.push_back(quarter);
  }
  if (quarters.empty() && rows.size() > 0) {
    trouble =
        "no row of the answer has the datetime and imbalanceprice of a quarter-hour: "
        "check [settled] url";
  }
  return quarters;
}

void SettledSchedule::tried(std::int64_t now_utc_s, bool is_whole, double wait_s) {
  constexpr std::int64_t kPauseMinS = 900, kPauseMaxS = 4 * 3'600;
  pause_s_ = is_whole ? 0 : std::clamp(2 * pause_s_, kPauseMinS, kPauseMaxS);
  // After the next midnight, when another day may be available; not at the peak load of midnight.
  constexpr std::int64_t kBehindMidnightS = 2 * 3'600;
  const std::int64_t tomorrow_utc_s = local_midnight_utc_s(now_utc_s, 1) + kBehindMidnightS;
  last_utc_s_ = now_utc_s;
  next_utc_s_ =
      is_whole ? tomorrow_utc_s : now_utc_s + std::max(pause_s_, static_cast<std::int64_t>(wait_s));
}

SettledResult fetch_settled(const SettledSource& source, std::int64_t now_utc_s,
                            const std::stop_token& stop) {
  SettledResult result;
  SettledPrices prices;
  const std::string loss = prices.read(source.file);
  if (!loss.empty()) say(JournalLevel::kWarning, "settled prices: " + loss);
  const std::int64_t until_utc_s = local_midnight_utc_s(now_utc_s);
  const std::int64_t oldest_utc_s = until_utc_s - source.days * kSecondsPerDay;
  const std::string url = settled_url(source, prices.first_open(oldest_utc_s), until_utc_s);
  HttpSettings http;
  http.ca_file = source.ca_file.c_str();
  http.timeout_ms = source.timeout_ms;
  const FetchResult answer = fetch(
      http, url, source.timeout_ms, [&] { return stop.stop_requested(); }, kAnswerBytesMax);
  result.wait_s = answer.wait_s;
  result.trouble = answer.reason;
  if (answer.status != Status::kOk) return result;
  const std::vector<SettledQuarter> fetched = parse_settled(answer.body, result.trouble);
  if (!result.trouble.empty()) return result;
  result.fetched = static_cast<int>(fetched.size());
  const std::vector<SettledQuarter> before = prices.quarters();
  prices.put(fetched);
  prices.drop_before(oldest_utc_s - (kSettledDaysMax - source.days) * kSecondsPerDay);
  result.is_whole = prices.find(until_utc_s - kQuarterHourS) != nullptr;
  if (prices.quarters() != before) result.trouble = keep(source, prices);
  return result;
}

void fetch_settled_daily(const SettledSource& source, const ScaledClock& clock,
                         const std::stop_token& stop) {
  SettledSchedule schedule;
  std::string trouble_before;
  while (!stop.stop_requested()) {
    const std::int64_t now_utc_s = utc_seconds(clock);
    if (schedule.is_due(now_utc_s)) {
      const SettledResult result = fetch_settled(source, now_utc_s, stop);
      schedule.tried(now_utc_s, result.is_whole && result.trouble.empty(), result.wait_s);
      if (!result.trouble.empty() && result.trouble != trouble_before) {
        say(JournalLevel::kWarning, "settled prices: " + result.trouble + "; retrying");
      } else if (result.trouble.empty() && !trouble_before.empty()) {
        say(JournalLevel::kNotice, "settled prices: fetched successfully again");
      }
      trouble_before = result.trouble;
    }
    constexpr std::int64_t kLookNs = 60 * kNanosecondsPerSecond;
    pause(kLookNs, stop);
  }
}

}  // namespace bess
