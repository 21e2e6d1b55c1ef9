#include "edge/records/account/settled_prices.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "edge/core/control/quarter_hour_energy.h"
#include "edge/records/log/atomic_file.h"
#include "shared/host/text.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {

namespace {

constexpr const char* kHeader = "quarter_hour_utc,eur_per_mwh,state";

bool parse_line(std::string_view line, SettledQuarter& quarter) {
  const std::size_t first = line.find(',');
  const std::size_t second = line.find(',', first == line.npos ? first : first + 1);
  if (second == line.npos) return false;
  const std::string_view price = line.substr(first + 1, second - first - 1);
  const std::string_view state = line.substr(second + 1);
  if (!read_number(price, quarter.eur_per_mwh)) return false;
  if (state != "published" && state != "validated") return false;
  quarter.state = state == "validated" ? PriceState::kValidated : PriceState::kPublished;
  return parse_utc(line.substr(0, first), quarter.start_utc_s) &&
         quarter.start_utc_s % kQuarterHourS == 0 &&
         std::abs(quarter.eur_per_mwh) <= kPlausiblePriceMaxEurPerMwh;
}

}  // namespace

void SettledPrices::put(std::span<const SettledQuarter> quarters) {
  // Newer ones come after those of the same time and replace them.
  quarters_.insert(quarters_.end(), quarters.begin(), quarters.end());
  std::ranges::stable_sort(quarters_, {}, &SettledQuarter::start_utc_s);
  std::vector<SettledQuarter> kept;
  kept.reserve(quarters_.size());
  for (const SettledQuarter& quarter : quarters_) {
    if (kept.empty() || kept.back().start_utc_s != quarter.start_utc_s) {
      kept.push_back(quarter);
    } else if (quarter.state >= kept.back().state) {
      kept.back() = quarter;
    }
  }
  quarters_ = std::move(kept);
}

void SettledPrices::drop_before(std::int64_t utc_s) {
  std::erase_if(quarters_, [&](const SettledQuarter& q) { return q.start_utc_s < utc_s; });
}

const SettledQuarter* SettledPrices::find(std::int64_t utc_s) const {
  const std::int64_t start_utc_s = quarter_hour_of(utc_s) * kQuarterHourS;
  const auto found =
      std::ranges::lower_bound(quarters_, start_utc_s, {}, &SettledQuarter::start_utc_s);
  return found != quarters_.end() && found->start_utc_s == start_utc_s ? &*found : nullptr;
}

std::int64_t SettledPrices::first_open(std::int64_t utc_s) const {
  std::int64_t open_utc_s = quarter_hour_of(utc_s) * kQuarterHourS;
  for (const SettledQuarter& quarter : quarters_) {
    if (quarter.start_utc_s < open_utc_s) continue;
    if (quarter.start_utc_s > open_utc_s || quarter.state != PriceState::kValidated) break;
    open_utc_s += kQuarterHourS;
  }
  return open_utc_s;
}

std::string SettledPrices::text() const {
  std::string text = std::string(kHeader) + "\n";
  for (const SettledQuarter& quarter : quarters_) {
    add_formatted(text, "%s,%.10g,%s\n", utc_text(quarter.start_utc_s).c_str(), quarter.eur_per_mwh,
                  quarter.state == PriceState::kValidated ? "validated" : "published");
  }
  return text + std::string(checksum_end(text, kCommentChecksum).view());
}

bool SettledPrices::parse(std::string_view text) {
  quarters_.clear();
  if (check_text(text, kCommentChecksum) != ChecksumState::kIntact) return false;
  std::string_view rest = without_checksum(text, kCommentChecksum);
  if (take_line(rest) != kHeader) return false;
  quarters_.reserve(static_cast<std::size_t>(std::ranges::count(rest, '\n')));
  SettledQuarter quarter;
  while (!rest.empty()) {
    const bool is_next = parse_line(take_line(rest), quarter) &&
                         (quarters_.empty() || quarters_.back().start_utc_s < quarter.start_utc_s);
    if (!is_next) {
      quarters_.clear();
      return false;
    }
    quarters_.push_back(quarter);
  }
  return true;
}

std::string SettledPrices::read(const std::string& path) {
  constexpr std::size_t kLineBytesMax = 64, kQuarterHoursADay = 100;
  quarters_.clear();
  std::string text(kSettledDaysMax * kQuarterHoursADay * kLineBytesMax, '\0');
  const ssize_t size = read_beginning(path.c_str(), text, SymlinkPolicy::kFollowed);
  if (size < 0) return errno == ENOENT ? "" : path + ": cannot be read: " + std::strerror(errno);
  text.resize(static_cast<std::size_t>(size));
  if (parse(text)) return "";
  return path + ": is damaged: fetch its prices again with bess-prices --settle";
}

}  // namespace bess
