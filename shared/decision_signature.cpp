#include "shared/decision_signature.h"

#include <cinttypes>
#include <cstdio>

#include "shared/fixed_point.h"
#include "shared/local_time.h"
#include "shared/outlook/outlook_plan.h"
#include "shared/price_level.h"
#include "shared/recorded_prices.h"
#include "shared/signature.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

/// House battery of the paper in whole watt-seconds; round-trip efficiency 90 %.
class IntegerBattery {
 public:
  [[nodiscard]] std::int32_t soc_e4() const {
    return static_cast<std::int32_t>(stored_ws_ * kSocFullE4 / kCapacityWs);
  }
  void exchange(std::int32_t power_w) {
    const std::int64_t energy_ws = std::int64_t{power_w} * kSecondsPerStep;
    stored_ws_ += energy_ws > 0 ? energy_ws * kOneWayE4 / 10'000 : energy_ws * 10'000 / kOneWayE4;
    stored_ws_ = clamp_to<std::int64_t>(stored_ws_, kCapacityWs / 10, kCapacityWs);
  }

 private:
  static constexpr std::int64_t kCapacityWs = 8'000 * 3'600;
  static constexpr std::int64_t kOneWayE4 = 9'487;
  std::int64_t stored_ws_ = kCapacityWs / 2;
};

/// The two days from here include the clock changes of March and October.
std::int64_t first_midnight_utc_s(int month) {
  const int day = month == 3 ? 25 : month == 10 ? 28 : 15;
  return utc_from_civil(
             {.year = 2023, .month = month, .day = day, .hour = 0, .minute = 0, .second = 0}) -
         3'600;
}

/// Level, or break-even price of one plan per day, made at the level of the first decision.
class RecordedContext {
 public:
  explicit RecordedContext(const OutlookModel* model) : model_(model) {}
  std::int32_t centi(std::int64_t utc_s, std::int32_t soc_e4, const PriceLevel& level) {
    const std::int32_t level_centi = level.centi_eur_per_mwh();
    if (model_ == nullptr) return level_centi;
    static OutlookPlan plan;  // too large for the stack
    if (!is_made_ || !plan.serves(utc_s)) {
      plan.make(*model_, made_up_outlook_days(utc_s), planned_level_centi(level_centi));
    }
    is_made_ = true;
    return plan.break_even_centi(*model_, utc_s, soc_e4, level_centi);
  }

 private:
  const OutlookModel* model_;
  bool is_made_ = false;
};

}  // namespace

DecisionSignature replay_recorded_days(ReplayedDecider& decider, const OutlookModel* outlook) {
  IntegerBattery battery;
  PriceLevel level;
  RecordedContext context(outlook);
  Signature signature;
  DecisionSignature result;
  for (int month = 1; month <= 12; ++month) {
    std::int64_t now_utc_s = first_midnight_utc_s(month);
    for (const std::int32_t price : kRecordedPricesCentiEurPerMwh) {
      level.observe(now_utc_s - 60, price);
      const std::int32_t soc_e4 = battery.soc_e4();
      const std::int32_t power_w =
          decider.power_w({now_utc_s, soc_e4, context.centi(now_utc_s, soc_e4, level), price});
      battery.exchange(power_w);
      signature.add(now_utc_s);
      signature.add(power_w);
      ++result.decisions;
      result.charging += power_w > 0 ? 1 : 0;
      result.discharging += power_w < 0 ? 1 : 0;
      now_utc_s += kSecondsPerStep;
    }
  }
  result.signature = signature.value();
  return result;
}

FixedText<127> signature_line(std::uint32_t student_hash, const DecisionSignature& found) {
  char line[128];
  std::snprintf(line, sizeof line,
                "student=%08" PRIx32
                " decisions=%d charging=%d discharging=%d signature=%016" PRIx64,
                student_hash, found.decisions, found.charging, found.discharging, found.signature);
  return line;
}

}  // namespace bess
