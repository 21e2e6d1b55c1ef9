#include "workstation/market/feed/overlap.h"

#include <fmt/core.h>

#include "shared/host/text.h"
#include "shared/utc_text.h"

namespace bess {

void Overlap::add_price(Prices& known, const char* column, std::int64_t utc_s, double eur_per_mwh) {
  if (!is_published(eur_per_mwh)) return;
  const std::size_t file = names_.size() - 1;
  const auto [found, is_new] = known.try_emplace(utc_s, Price{eur_per_mwh, file});
  if (is_new || found->second.eur_per_mwh == eur_per_mwh || found->second.file == file) return;
  if (disagreements_++ > 0) return;
  first_ = {"overlap", true,
            fmt::format("{} and {} disagree about {}: {} price {:g} and {:g}",
                        names_[found->second.file], names_[file], utc_text(utc_s).view(), column,
                        found->second.eur_per_mwh, eur_per_mwh),
            utc_s};
}

void Overlap::add(const std::string& name, const MarketRows& rows) {
  names_.push_back(name);
  for (const MinuteRow& row : rows.minutes) {
    add_price(minutes_, "indicative", row.utc_s, row.indicative_eur_per_mwh);
  }
  for (const QuarterHour& row : rows.quarter_hours) {
    add_price(quarter_hours_, "settled", row.utc_s, row.price_eur_per_mwh);
  }
}

std::vector<Finding> Overlap::findings() const {
  if (disagreements_ == 0) return {};
  Finding finding = first_;
  finding.what +=
      fmt::format(" ({} in all); leave one of them out", counted(disagreements_, "difference"));
  return {finding};
}

}  // namespace bess
