#include "workstation/data/market/series/plausibility.h"

#include <fmt/format.h>

#include <algorithm>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

bool holds_time(std::string_view line, std::int64_t utc_s) {
  const char separator = line.find(';') == line.npos ? ',' : ';';
  CsvFields fields(line, separator);
  for (std::string_view field; fields.take(field);) {
    std::int64_t time_s = 0;
    if (parse_utc(field, time_s, kAlsoBlank) && time_s == utc_s) return true;
  }
  return false;
}

/// "prices.csv:17", or name and time if no row is found: JSON and XML have none.
std::string place_of(const Finding& finding, const std::vector<PriceText>& texts) {
  if (!finding.utc_s) return texts.front().name;
  const std::int64_t quarter_hour_s =
      *finding.utc_s - *finding.utc_s % kSecondsPerQuarterHour;  // for downloads of settled prices
  for (const std::int64_t utc_s : {*finding.utc_s, quarter_hour_s}) {
    for (const PriceText& text : texts) {
      const std::size_t row = row_of_time(text.text, utc_s);
      if (row != 0) return fmt::format("{}:{}", text.name, row);
    }
  }
  return fmt::format("{}: {}", texts.front().name, utc_text(*finding.utc_s).view());
}

}  // namespace

AcceptedFindings::AcceptedFindings(std::string_view list) {
  for (CsvFields fields(list); !list.empty();) {
    std::string_view name;
    if (!fields.take(name)) break;
    if (std::ranges::find(kFindingNames, name) == kFindingNames.end()) {
      fail("--accept: no finding is called \"{}\"; use one or more of {}", one_line(name, 40),
           fmt::join(kFindingNames, ","));
    }
    names_.emplace_back(name);
  }
}

AcceptedFindings AcceptedFindings::all() {
  AcceptedFindings accepted;
  accepted.names_.assign(kFindingNames.begin(), kFindingNames.end());
  return accepted;
}

bool AcceptedFindings::accepts(std::string_view name) const {
  return std::ranges::find(names_, name) != names_.end();
}

void judge(const std::vector<Finding>& findings, const AcceptedFindings& accepted,
           const std::vector<PriceText>& texts) {
  for (const Finding& finding : findings) {
    if (!finding.is_error || accepted.accepts(finding.name)) continue;
    fail("{}: {} (--accept {} if intended)", place_of(finding, texts), finding.what, finding.name);
  }
  for (const Finding& finding : findings) {
    fmt::print(stderr, "bess-train: warning: {}: {} [{}]\n", place_of(finding, texts), finding.what,
               finding.name);
  }
}

std::size_t row_of_time(std::string_view text, std::int64_t utc_s) {
  text = without_byte_order_mark(text);
  for (std::size_t row = 1; !text.empty(); ++row) {
    const std::string_view line = take_line(text);
    if (!line.starts_with('#') && holds_time(line, utc_s)) return row;
  }
  return 0;
}

void judge_minutes(const MinuteSeries& series, const PriceText& text,
                   const AcceptedFindings& accepted) {
  std::vector<Finding> findings = implausible_end(text.text, series);
  for (Finding& finding : implausible(series)) findings.push_back(std::move(finding));
  judge(findings, accepted, {text});
}

MinuteSeries read_judged_minutes(const std::filesystem::path& path,
                                 const AcceptedFindings& accepted) {
  const std::string text = read_file(path);
  MinuteSeries series = parse_minute_csv(text, path.string());
  judge_minutes(series, {path.string(), text}, accepted);
  return series;
}

}  // namespace bess
