#include "shared/outlook/outlook_model.h"

namespace bess {
namespace {

constexpr std::int32_t kMoneyMax = 2'000'000;  ///< 20,000 EUR/MWh

constexpr bool is_between(std::int32_t value, std::int32_t low, std::int32_t high) {
  return value >= low && value <= high;
}

template <int kCount>
bool is_money(const std::int32_t (&values)[kCount]) {
  for (const std::int32_t value : values) {
    if (!is_between(value, -kMoneyMax, kMoneyMax)) return false;
  }
  return true;
}

bool is_distribution(const std::int32_t (&row)[OutlookModel::kBins]) {
  std::int64_t sum = 0;
  for (const std::int32_t share : row) {
    if (share < 0) return false;
    sum += share;
  }
  return sum == std::int64_t{1} << OutlookModel::kProbabilityBits;
}

}  // namespace

bool OutlookModel::is_sound() const {
  constexpr std::int32_t kOneQ12 = 1 << kCoefficientBits;
  constexpr std::int32_t kOneQ15 = 1 << kPointBits;
  constexpr std::int32_t kPointsMax = (kSocPoints - 1) * kOneQ15;
  constexpr std::int32_t kEnergyMax = 1 << kEnergyBits;
  bool sound =
      is_money({constant_centi, import_centi, export_centi}) && is_money(hour_centi) &&
      is_money(day_ahead_mean_centi) && is_money(bin_centi) &&
      is_between(day_ahead_q12, -8 * kOneQ12, 8 * kOneQ12) &&
      is_between(level_q12, -8 * kOneQ12, 8 * kOneQ12) && is_between(lasting_q12, 0, kOneQ12) &&
      is_between(row_age_min, 0, 30) && is_between(discount_q15, 1, kOneQ15) &&
      is_between(soc_min_e4, 0, soc_max_e4 - kSocPoints) &&
      is_between(soc_max_e4, kSocPoints, kSocFullE4) && is_between(charge_q24, 1, kEnergyMax) &&
      is_between(discharge_q24, 1, kEnergyMax) && is_between(charge_points_q15, 1, kPointsMax) &&
      is_between(discharge_points_q15, 1, kPointsMax) && is_between(import_share_q12, 0, kOneQ12) &&
      is_between(export_share_q12, 0, kOneQ12);
  for (int bin = 1; bin < kBins; ++bin) sound = sound && bin_centi[bin - 1] <= bin_centi[bin];
  for (int phase = 0; phase < kPhases; ++phase) {
    sound = sound && is_money(paid_centi[phase]);
    for (const auto& row : transition_q15[phase]) sound = sound && is_distribution(row);
  }
  return sound;
}

std::uint32_t OutlookModel::hash() const {
  Crc32 crc;
  visit(*this, [&crc](const char*, const std::int32_t* values, int count) {
    for (int i = 0; i < count; ++i) crc.add_integer(values[i]);
  });
  return crc.value();
}

}  // namespace bess
