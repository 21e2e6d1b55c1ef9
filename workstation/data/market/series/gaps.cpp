#include "workstation/data/market/series/gaps.h"

#include <fmt/core.h>

#include <algorithm>

#include "shared/host/minute_file.h"
#include "shared/host/text.h"
#include "shared/utc_text.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {
namespace {

constexpr std::size_t kGapsListed = 5;

std::int64_t minutes_of(const Gap& gap) { return (gap.until_utc_s - gap.from_utc_s) / 60; }

}  // namespace

std::vector<Gap> gaps_in(std::span<const double> values, std::int64_t start_utc_s,
                         std::int64_t step_s) {
  std::vector<Gap> gaps;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (is_published(values[i])) continue;
    const std::int64_t utc_s = start_utc_s + step_s * static_cast<std::int64_t>(i);
    if (gaps.empty() || gaps.back().until_utc_s != utc_s) gaps.push_back({utc_s, utc_s});
    gaps.back().until_utc_s = utc_s + step_s;
  }
  return gaps;
}

std::int64_t minutes_in(const std::vector<Gap>& gaps) {
  std::int64_t minutes = 0;
  for (const Gap& gap : gaps) minutes += minutes_of(gap);
  return minutes;
}

std::string describe_gaps(std::string_view what, std::vector<Gap> gaps) {
  if (gaps.empty()) return fmt::format("{}: no gaps\n", what);
  std::string text = fmt::format("{}: {}, {} missing\n", what, counted(gaps.size(), "gap"),
                                 counted(static_cast<std::size_t>(minutes_in(gaps)), "minute"));
  std::stable_sort(gaps.begin(), gaps.end(),
                   [](const Gap& a, const Gap& b) { return minutes_of(a) > minutes_of(b); });
  for (std::size_t i = 0; i < std::min(kGapsListed, gaps.size()); ++i) {
    text += fmt::format("  {} to {}: {}\n", utc_text(gaps[i].from_utc_s).view(),
                        utc_text(gaps[i].until_utc_s).view(),
                        counted(static_cast<std::size_t>(minutes_of(gaps[i])), "minute"));
  }
  if (gaps.size() > kGapsListed) {
    text += fmt::format("  and {}\n", counted(gaps.size() - kGapsListed, "shorter one"));
  }
  return text;
}

}  // namespace bess
