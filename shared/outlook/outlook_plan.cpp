#include "shared/outlook/outlook_plan.h"

#include "shared/crc32.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"

namespace bess {

namespace {

constexpr int kPoints = OutlookModel::kSocPoints;
constexpr int kBins = OutlookModel::kBins;
constexpr std::int32_t kUsualMaxCenti = 400'000;  ///< 4,000 EUR/MWh, limit of the auction
constexpr std::int64_t kValuesPerCenti = 100;
constexpr std::int32_t kCentiPerTenth = 10;
constexpr std::int32_t kBreakEvenMaxTenths = 30'000;
/// Number of points at each end without break-even price of their own, where a step may not fit.
constexpr int kEndPoints = 2;

constexpr std::int64_t shifted(std::int64_t value, int bits) {
  return (value + (std::int64_t{1} << (bits - 1))) >> bits;
}

int phase_of(std::int64_t utc_s) {
  return static_cast<int>(utc_s / 60 % (2 * kMinutesPerQuarterHour)) / kMinutesPerStep;
}

std::int32_t with_share(std::int32_t price_centi, std::int32_t share_q12) {
  const std::int64_t size = price_centi < 0 ? -price_centi : price_centi;
  return static_cast<std::int32_t>(shifted(size * share_q12, OutlookModel::kCoefficientBits));
}

/// Cost of a full step at this price, in the unit of values.
std::int64_t exchange_value(std::int32_t energy_q24, std::int64_t price_centi) {
  return shifted(energy_q24 * price_centi * kValuesPerCenti, OutlookModel::kEnergyBits);
}

constexpr std::int64_t kValueMax = std::int64_t{1} << 29;  ///< 50,000 EUR per MWh of capacity

constexpr std::int32_t bounded(std::int64_t value) {
  return static_cast<std::int32_t>(clamp_to(value, -kValueMax, kValueMax));
}

/// sum over n of share[n] values[n][i], with vectorisable 32-bit products: shares sum to 2^15 and
/// values are within 2^29, so neither half overflows.
struct ValueHalves {
  std::int32_t high[kBins][kPoints];
  std::int32_t low[kBins][kPoints];

  explicit ValueHalves(const std::int32_t (&value)[kBins][kPoints]) {
    for (int b = 0; b < kBins; ++b) {
      for (int i = 0; i < kPoints; ++i) {
        high[b][i] = value[b][i] >> 16;
        low[b][i] = value[b][i] & 0xFFFF;
      }
    }
  }
  void weigh(const std::int32_t (&share)[kBins], std::int64_t (&sum)[kPoints]) const {
    std::int32_t sum_high[kPoints] = {};
    std::int32_t sum_low[kPoints] = {};
    for (int n = 0; n < kBins; ++n) {
      if (share[n] == 0) continue;
      for (int i = 0; i < kPoints; ++i) {
        sum_high[i] += share[n] * high[n][i];
        sum_low[i] += share[n] * low[n][i];
      }
    }
    for (int i = 0; i < kPoints; ++i) sum[i] = std::int64_t{sum_high[i]} * 65'536 + sum_low[i];
  }
};

}  // namespace

OutlookDays outlook_days_around(std::int64_t utc_s) {
  OutlookDays days;
  days.yesterday_utc_s = local_midnight_utc_s(utc_s, -1);
  days.today_utc_s = local_midnight_utc_s(utc_s, 0);
  days.tomorrow_utc_s = local_midnight_utc_s(utc_s, 1);
  days.end_utc_s = local_midnight_utc_s(utc_s, 2);
  for (std::int32_t& price : days.day_ahead_centi) price = kDayAheadUnknown;
  return days;
}

/// Unknown prices of tomorrow: hourly mean plus the persistent share of the deviation of the last
/// known day.
void OutlookPlan::find_usual(const OutlookModel& model, const OutlookDays& days) {
  const auto quarter_hour_of = [](std::int64_t utc_s) {
    return local_minute_of(utc_s).quarter_hour;
  };
  const std::int64_t midnights[] = {days.yesterday_utc_s, days.today_utc_s, days.tomorrow_utc_s,
                                    days.end_utc_s};
  std::int64_t height_centi = 0;
  for (int day = 0; day < 3; ++day) {
    std::int64_t sum = 0;
    std::int64_t count = 0;
    for (std::int64_t t = midnights[day]; t < midnights[day + 1]; t += kSecondsPerQuarterHour) {
      const std::int32_t known = days.day_ahead_centi[days.index_of(t)];
      if (known == kDayAheadUnknown) continue;
      sum += known - model.day_ahead_mean_centi[quarter_hour_of(t)];
      ++count;
    }
    if (count > 0) height_centi = rounding_divide(sum, count);
  }
  constexpr int kBits = OutlookModel::kCoefficientBits;
  const std::int64_t lasting_centi = shifted(height_centi * model.lasting_q12, kBits);
  int at = 0;
  for (std::int64_t t = days.today_utc_s; t < days.end_utc_s; t += kSecondsPerQuarterHour) {
    const int quarter_hour = quarter_hour_of(t);
    const std::int32_t known = days.day_ahead_centi[days.index_of(t)];
    const std::int64_t day_ahead = known != kDayAheadUnknown
                                       ? known
                                       : model.day_ahead_mean_centi[quarter_hour] + lasting_centi;
    const std::int64_t usual =
        model.constant_centi + model.hour_centi[quarter_hour] +
        shifted(model.day_ahead_q12 * day_ahead + std::int64_t{model.level_q12} * level_centi_,
                kBits);
    usual_[at++] =
        static_cast<std::int32_t>(clamp_to<std::int64_t>(usual, -kUsualMaxCenti, kUsualMaxCenti));
  }
}

void OutlookPlan::find_moves(const OutlookModel& model) {
  constexpr int kBits = OutlookModel::kPointBits;
  constexpr std::int32_t kLast = (kPoints - 1) << kBits;
  const auto move_to = [](std::int32_t to_q15, std::int32_t moved_q15, std::int32_t full_q15) {
    const std::int32_t lower = to_q15 == kLast ? kPoints - 2 : to_q15 >> kBits;
    const auto share = (std::int64_t{moved_q15} << kBits) / full_q15;
    return Move{lower, to_q15 - (lower << kBits), static_cast<std::int32_t>(share)};
  };
  for (std::int32_t i = 0; i < kPoints; ++i) {
    const std::int32_t from = i << kBits;
    const std::int32_t up = clamp_to(model.charge_points_q15, 0, kLast - from);
    const std::int32_t down = clamp_to(model.discharge_points_q15, 0, from);
    charge_[i] = move_to(from + up, up, model.charge_points_q15);
    discharge_[i] = move_to(from - down, down, model.discharge_points_q15);
  }
}

std::int32_t OutlookPlan::usual_centi(std::int64_t utc_s) const {
  const auto last = static_cast<std::int64_t>((end_utc_s_ - today_utc_s_) / kSecondsPerQuarterHour);
  const std::int64_t before = utc_s < today_utc_s_ ? today_utc_s_ : utc_s;
  const std::int64_t at = (before - today_utc_s_) / kSecondsPerQuarterHour;
  return usual_[at < last ? at : last - 1];
}

/// Updates `value_` from the next step to this one, and `lead_`.
void OutlookPlan::step_back(const OutlookModel& model, std::int64_t utc_s) {
  const int phase = phase_of(utc_s);
  const std::int32_t usual_paid = (usual_centi(utc_s) + usual_centi(utc_s + 60)) / 2;
  const ValueHalves halves(value_);
  std::int64_t next[kBins][kPoints];
  for (int b = 0; b < kBins; ++b) {
    std::int64_t ahead[kPoints];
    halves.weigh(model.transition_q15[phase][b], ahead);
    for (std::int64_t& value : ahead) {
      value = shifted(shifted(value, OutlookModel::kProbabilityBits) * model.discount_q15,
                      OutlookModel::kProbabilityBits);
    }
    const std::int32_t paid = model.paid_centi[phase][b] + usual_paid;
    const std::int64_t cost =
        exchange_value(model.charge_q24, std::int64_t{paid} + model.import_centi +
                                             with_share(paid, model.import_share_q12));
    const std::int64_t gain =
        exchange_value(model.discharge_q24, std::int64_t{paid} - model.export_centi -
                                                with_share(paid, model.export_share_q12));
    for (int i = 0; i < kPoints; ++i) {
      const auto after = [&](const Move& move, std::int64_t exchanged) {
        const std::int64_t rise = ahead[move.to + 1] - ahead[move.to];
        return ahead[move.to] + shifted(rise * move.weight_q15, OutlookModel::kPointBits) +
               shifted(exchanged * move.share_q15, OutlookModel::kPointBits);
      };
      const std::int64_t charged = after(charge_[i], -cost);
      const std::int64_t discharged = after(discharge_[i], gain);
      const std::int64_t moved = charged > discharged ? charged : discharged;
      next[b][i] = moved > ahead[i] ? moved : ahead[i];
      lead_[b][i] = bounded(charged - discharged);
    }
  }
  // Only differences matter: keep values near zero to prevent overflow.
  const std::int64_t middle = next[kBins / 2][kPoints / 2];
  for (int b = 0; b < kBins; ++b) {
    for (int i = 0; i < kPoints; ++i) value_[b][i] = bounded(next[b][i] - middle);
  }
}

void OutlookPlan::find_break_even(const OutlookModel& model, std::int64_t utc_s) {
  std::int16_t(&row)[kPoints] = break_even_[(utc_s - today_utc_s_) / kSecondsPerStep].tenths;
  const std::int32_t usual_seen = usual_centi(utc_s - 60 * std::int64_t{model.row_age_min});
  for (int i = kEndPoints; i < kPoints - kEndPoints; ++i) {
    std::int64_t lost = 0;  // loss of a cut: lead of charging above it, and of discharging below it
    for (int b = 0; b < kBins; ++b) lost += lead_[b][i] > 0 ? lead_[b][i] : 0;
    std::int64_t least = lost;
    int cut = 0;
    for (int b = 0; b < kBins; ++b) {
      lost -= lead_[b][i];
      if (lost >= least) continue;
      least = lost;
      cut = b + 1;
    }
    std::int64_t deviation = model.bin_centi[cut < kBins ? cut : kBins - 1];
    if (cut > 0 && cut < kBins) {
      const std::int64_t below = lead_[cut - 1][i];
      const std::int64_t above = -std::int64_t{lead_[cut][i]};
      const std::int64_t from = model.bin_centi[cut - 1];
      const std::int64_t width = deviation - from;
      deviation =
          below > 0 && above > 0 ? from + width * below / (below + above) : from + width / 2;
    }
    const auto tenths = static_cast<std::int16_t>(clamp_to<std::int64_t>(
        rounding_divide<std::int64_t>(usual_seen + deviation, kCentiPerTenth), -kBreakEvenMaxTenths,
        kBreakEvenMaxTenths));
    row[i] = i == kEndPoints || tenths < row[i - 1] ? tenths : row[i - 1];
  }
  for (int i = 0; i < kEndPoints; ++i) {
    row[i] = row[kEndPoints];
    row[kPoints - 1 - i] = row[kPoints - 1 - kEndPoints];
  }
}

void OutlookPlan::make(const OutlookModel& model, const OutlookDays& days,
                       std::int32_t level_centi) {
  today_utc_s_ = days.today_utc_s;
  tomorrow_utc_s_ = days.tomorrow_utc_s;
  end_utc_s_ = days.end_utc_s;
  level_centi_ = level_centi;
  find_usual(model, days);
  find_moves(model);
  // Final value of stored energy: mean price of tomorrow.
  std::int64_t sum = 0;
  const auto all = static_cast<int>((end_utc_s_ - today_utc_s_) / kSecondsPerQuarterHour);
  const auto first = static_cast<int>((tomorrow_utc_s_ - today_utc_s_) / kSecondsPerQuarterHour);
  for (int q = first; q < all; ++q) sum += usual_[q];
  const std::int64_t mean_centi = rounding_divide<std::int64_t>(sum, all - first);
  const std::int64_t full_e4 = model.soc_max_e4 - model.soc_min_e4;
  for (auto& row : value_) {
    for (int i = 0; i < kPoints; ++i) {
      const std::int64_t stored_e4 = full_e4 * (i - kPoints / 2) / (kPoints - 1);
      row[i] = bounded(mean_centi * kValuesPerCenti * stored_e4 / kSocFullE4);
    }
  }
  for (std::int64_t t = end_utc_s_ - kSecondsPerStep; t >= today_utc_s_; t -= kSecondsPerStep) {
    step_back(model, t);
    if (t < tomorrow_utc_s_) find_break_even(model, t);
  }
}

std::int32_t BreakEvenRow::at(const OutlookModel& model, std::int32_t soc_e4,
                              std::int32_t level_centi, std::int32_t planned_level_centi) const {
  constexpr int kBits = OutlookModel::kPointBits;
  constexpr std::int64_t kLast = std::int64_t{kPoints - 1} << kBits;
  const std::int64_t span_e4 = model.soc_max_e4 - model.soc_min_e4;
  const std::int64_t at = clamp_to<std::int64_t>(
      (soc_e4 - std::int64_t{model.soc_min_e4}) * kLast / span_e4, 0, kLast - 1);
  const auto lower = static_cast<int>(at >> kBits);
  const std::int64_t weight = at - (std::int64_t{lower} << kBits);
  const std::int64_t fall = tenths[lower] - tenths[lower + 1];
  const std::int64_t planned =
      tenths[lower] * std::int64_t{kCentiPerTenth} - shifted(fall * kCentiPerTenth * weight, kBits);
  return static_cast<std::int32_t>(
      planned + shifted(std::int64_t{model.level_q12} * (level_centi - planned_level_centi),
                        OutlookModel::kCoefficientBits));
}

OutlookDays made_up_outlook_days(std::int64_t utc_s) {
  OutlookDays days = outlook_days_around(utc_s);
  constexpr int kQuarterHoursOfSixHours = 24;
  int q = 0;
  for (std::int64_t t = days.yesterday_utc_s; t < days.end_utc_s; t += kSecondsPerQuarterHour) {
    const bool is_hole = q % 97 == 50 || t >= days.end_utc_s - 6 * 3'600;
    const int from_peak = (q + 3) % (2 * kQuarterHoursOfSixHours) - kQuarterHoursOfSixHours;
    const int size = from_peak < 0 ? -from_peak : from_peak;
    days.day_ahead_centi[days.index_of(t)] =
        is_hole ? kDayAheadUnknown : 900 * size - 2'000 + 7 * q;
    ++q;
  }
  return days;
}

std::uint32_t outlook_check(const OutlookModel& model, OutlookPlan& plan) {
  constexpr std::int32_t kLevelCenti = 8'700;
  const OutlookDays days = made_up_outlook_days(utc_from_civil({2025, 3, 30, 10, 0, 0}));
  plan.make(model, days, planned_level_centi(kLevelCenti));
  Crc32 crc;
  for (std::int64_t t = days.today_utc_s; t < days.tomorrow_utc_s; t += kSecondsPerStep) {
    for (const std::int32_t soc_e4 : {1'000, 2'345, 5'000, 7'654, kSocFullE4}) {
      crc.add_integer(plan.break_even_centi(model, t, soc_e4, kLevelCenti));
    }
  }
  return crc.value();
}

}  // namespace bess
