#include "edge/account/stops.h"

#include <algorithm>
#include <map>

#include "edge/account/account_days.h"
#include "shared/host/text.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

/// What the undisturbed student meets as well: the ends of the battery, and the thresholds.
bool is_undisturbed(Reason reason) {
  switch (reason) {
    case Reason::kStudent:
    case Reason::kSocFull:
    case Reason::kSocEmpty:
    case Reason::kPriceLow:
    case Reason::kPriceHigh:
      return true;
    default:
      return false;
  }
}

}  // namespace

double Stops::cost_eur() const {
  double sum = 0;
  for (const Stop& stop : by_reason) sum += stop.cost_eur;
  return sum;
}

double Stops::driven_share() const {
  const int all = cycles + missing_cycles;
  return all == 0 ? 0 : static_cast<double>(driven_cycles) / all;
}

void StopBook::add(const CycleRecord& record) {
  if (record.mode == Mode::kStopping) return;  // no cycle
  Cycle cycle{.power_w = record.measurement.power_w,
              .soc_e4 = record.has_measurement ? record.measurement.soc_e4 : -1,
              .reason = record.reason,
              .is_driven = record.mode == Mode::kRunning,
              .has_price = record.price.has_row};
  cycle.priced.utc_s = record.utc_s;
  if (cycle.has_price) cycle.priced = priced_cycle(record, prices_);
  cycles_.push_back(cycle);
}

double StopBook::mean_eur_per_mwh() const {
  double sum = 0;
  int priced = 0;
  for (const Cycle& cycle : cycles_) {
    if (!cycle.has_price) continue;
    sum += cycle.priced.paid_eur_per_mwh;
    ++priced;
  }
  return priced == 0 ? 0 : sum / priced;
}

/// Cycles `first` to `end` of one reason; what they moved is measured at the next tick.
void StopBook::value(std::size_t first, std::size_t end, double mean_eur_per_mwh,
                     Stop& stop) const {
  std::vector<PricedCycle> priced;
  double moved_eur = 0;
  std::int32_t last_e4 = cycles_[first].soc_e4;
  for (std::size_t i = first; i < end; ++i) {
    const bool is_followed = i + 1 < cycles_.size() && cycles_[i + 1].soc_e4 >= 0;
    if (!cycles_[i].has_price || !is_followed) continue;
    priced.push_back(cycles_[i].priced);
    moved_eur += earned_eur(battery_, {static_cast<double>(cycles_[i + 1].power_w), 0},
                            cycles_[i].priced.paid_eur_per_mwh);
    last_e4 = cycles_[i + 1].soc_e4;
  }
  if (priced.empty() || cycles_[first].soc_e4 < 0 || battery_.capacity_wh <= 0) return;
  const double soc_frac = static_cast<double>(cycles_[first].soc_e4) / kSocFullE4;
  const Driven student = drive_through(
      priced, soc_frac, battery_,
      [&](std::size_t i, double soc) { return decide_undisturbed(priced[i], soc, thresholds_); },
      [](const PricedCycle&, const Driven&) {});
  const double more_frac = student.soc_frac - static_cast<double>(last_e4) / kSocFullE4;
  stop.valued += static_cast<int>(priced.size());
  stop.cost_eur +=
      student.earned_eur - moved_eur + stored_worth_eur(battery_, more_frac, mean_eur_per_mwh);
}

Stops StopBook::stops() const {
  Stops stops;
  stops.cycles = static_cast<int>(cycles_.size());
  std::map<Reason, Stop> by_reason;
  const double mean = mean_eur_per_mwh();
  for (std::size_t i = 0; i < cycles_.size(); ++i) {
    stops.driven_cycles += cycles_[i].is_driven ? 1 : 0;
    if (i == 0) continue;
    const std::int64_t apart_s = cycles_[i].priced.utc_s - cycles_[i - 1].priced.utc_s;
    stops.missing_cycles +=
        static_cast<int>(std::max<std::int64_t>(apart_s / kSecondsPerStep, 1)) - 1;
  }
  for (std::size_t first = 0, end = 0; first < cycles_.size(); first = end) {
    const Reason reason = cycles_[first].reason;
    while (end < cycles_.size() && cycles_[end].reason == reason) ++end;
    if (is_undisturbed(reason)) continue;
    Stop& stop = by_reason[reason];
    stop.reason = reason;
    stop.cycles += static_cast<int>(end - first);
    for (std::size_t i = first; i < end; ++i) stop.not_driven += cycles_[i].is_driven ? 0 : 1;
    value(first, end, mean, stop);
  }
  for (const auto& [reason, stop] : by_reason) stops.by_reason.push_back(stop);
  std::ranges::stable_sort(stops.by_reason, std::greater<>(), &Stop::cost_eur);
  return stops;
}

Stops stops_of_days(const LogReader& log, std::int32_t first_day, std::int32_t last_day,
                    const BatteryParameters& battery, const PriceThresholds& thresholds,
                    const QuarterPrices& prices) {
  StopBook book(battery, thresholds, prices);
  CycleRecord record;
  for (std::uint64_t n = log.oldest_number(); n > 0 && n <= log.newest_number(); ++n) {
    if (!log.read(n, record)) continue;
    const std::int32_t day = local_day_at(record.utc_s);
    if (day > last_day) break;
    if (day >= first_day) book.add(record);
  }
  return book.stops();
}

std::string stops_text(const Stops& stops) {
  std::string text;
  add_formatted(text, "driven %.1f %% of the time", 100 * stops.driven_share());
  if (stops.missing_cycles > 0) {
    add_formatted(text, "; %d cycles have no record, their cost is not known",
                  stops.missing_cycles);
  }
  text += "\n";
  if (stops.by_reason.empty()) return text;
  text += "where the student did not decide, and what it would have earned there (estimate):\n";
  for (const Stop& stop : stops.by_reason) {
    add_formatted(text, "  %-18s %5d cycles, %5d not driven, ", reason_name(stop.reason).data(),
                  stop.cycles, stop.not_driven);
    if (stop.valued == 0) {
      text += "cost not known\n";
      continue;
    }
    add_formatted(text, "cost %.2f EUR", stop.cost_eur);
    if (stop.valued < stop.cycles) add_formatted(text, " (of %d cycles)", stop.valued);
    text += "\n";
  }
  add_formatted(text, "together %.2f EUR\n", stops.cost_eur());
  return text;
}

Json stops_json(const Stops& stops) {
  Json reasons = Json::list();
  for (const Stop& stop : stops.by_reason) {
    reasons.add(Json::object(
        {{"reason", reason_name(stop.reason)},
         {"cycles", stop.cycles},
         {"not_driven", stop.not_driven},
         {"valued_cycles", stop.valued},
         {"cost_eur", stop.valued > 0 ? Json(Decimals{stop.cost_eur, 4}) : Json::null()}}));
  }
  return Json::object({{"driven_share", Decimals{stops.driven_share(), 4}},
                       {"missing_cycles", stops.missing_cycles},
                       {"cost_eur", Decimals{stops.cost_eur(), 4}},
                       {"by_reason", std::move(reasons)}});
}

}  // namespace bess
