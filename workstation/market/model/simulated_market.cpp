#include "workstation/market/model/simulated_market.h"

#include <algorithm>
#include <span>

#include "workstation/market/model/market_scores.h"
#include "workstation/market/model/price_rounding.h"
#include "workstation/market/series/imbalance_price.h"

namespace bess {
namespace {

constexpr std::int64_t kQuarterHoursPerYear = 365 * 96;

double climb_ladder(std::span<const LadderStep> ladder, double probability) {
  const auto above = std::upper_bound(
      ladder.begin(), ladder.end(), probability,
      [](double wanted, const LadderStep& step) { return wanted < step.probability; });
  if (above == ladder.begin()) return ladder.front().value;
  if (above == ladder.end()) return ladder.back().value;
  const LadderStep& below = *(above - 1);
  const double weight =
      (probability - below.probability) / (above->probability - below.probability);
  return below.value + weight * (above->value - below.value);
}

/// Rank of a score among `references` as a probability, then the ladder.
class RankedLadder {
 public:
  RankedLadder(std::span<const LadderStep> ladder, std::vector<double> references)
      : ladder_(ladder), references_(std::move(references)) {
    std::sort(references_.begin(), references_.end());
  }
  double operator()(double score) const {
    const auto below = std::lower_bound(references_.begin(), references_.end(), score);
    const auto rank = static_cast<double>(below - references_.begin()) + 0.5;
    return climb_ladder(ladder_, rank / static_cast<double>(references_.size()));
  }

 private:
  std::span<const LadderStep> ladder_;
  std::vector<double> references_;
};

double pull_of(const ImbalancePull& pull, double now_mw, double before_mw) {
  const auto hinge = [](double value_mw) { return std::max(0.0, value_mw) / kImbalanceUnitMw; };
  return pull.shortage_now * hinge(-now_mw) + pull.shortage_before * hinge(-before_mw) +
         pull.surplus_now * hinge(now_mw) + pull.surplus_before * hinge(before_mw);
}

/// Draws whole years, because ranks need one; the caller cuts.
class YearSimulator {
 public:
  explicit YearSimulator(std::uint64_t seed) : random_(seed) {}
  std::vector<QuarterHour> next_year(std::int64_t start_utc_s);

 private:
  struct Scores {
    std::vector<double> imbalance, incremental, decremental;
  };
  Scores draw_scores(std::int64_t start_utc_s);
  void set_imbalances(std::vector<QuarterHour>& year, const std::vector<double>& scores) const;
  void set_marginal_prices(std::vector<QuarterHour>& year, Scores& scores) const;
  void settle(std::vector<QuarterHour>& year);

  Random random_;
  ScoreProcess imbalance_{kImbalanceScore};
  ScoreProcess incremental_{kIncrementalScore};
  ScoreProcess decremental_{kDecrementalScore};
  double last_imbalance_mw_ = 0;  ///< of the year before
};

YearSimulator::Scores YearSimulator::draw_scores(std::int64_t start_utc_s) {
  Scores scores;
  for (std::int64_t q = 0; q < kQuarterHoursPerYear; ++q) {
    const MarketCalendar calendar = market_calendar_of(start_utc_s + q * kSecondsPerQuarterHour);
    scores.imbalance.push_back(imbalance_.next(calendar, random_));
    scores.incremental.push_back(incremental_.next(calendar, random_));
    scores.decremental.push_back(decremental_.next(calendar, random_));
  }
  return scores;
}

void YearSimulator::set_imbalances(std::vector<QuarterHour>& year,
                                   const std::vector<double>& scores) const {
  const RankedLadder imbalance_mw(kImbalanceLadder, scores);
  for (std::size_t q = 0; q < year.size(); ++q) {
    year[q].system_imbalance_mw = imbalance_mw(scores[q]);
  }
}

/// The ladders are those of the active side, so ranks are taken among the active quarter-hours.
void YearSimulator::set_marginal_prices(std::vector<QuarterHour>& year, Scores& scores) const {
  std::vector<double> active_incremental;
  std::vector<double> active_decremental;
  double before_mw = last_imbalance_mw_;
  for (std::size_t q = 0; q < year.size(); ++q) {
    const double now_mw = year[q].system_imbalance_mw;
    scores.incremental[q] += pull_of(kIncrementalPull, now_mw, before_mw);
    scores.decremental[q] += pull_of(kDecrementalPull, now_mw, before_mw);
    if (is_short(now_mw)) {
      active_incremental.push_back(scores.incremental[q]);
    } else {
      active_decremental.push_back(scores.decremental[q]);
    }
    before_mw = now_mw;
  }
  const RankedLadder incremental(kIncrementalLadder, std::move(active_incremental));
  const RankedLadder decremental(kDecrementalLadder, std::move(active_decremental));
  for (std::size_t q = 0; q < year.size(); ++q) {
    year[q].marginal_incremental_eur_per_mwh = incremental(scores.incremental[q]);
    year[q].marginal_decremental_eur_per_mwh = decremental(scores.decremental[q]);
  }
}

void YearSimulator::settle(std::vector<QuarterHour>& year) {
  for (QuarterHour& quarter_hour : year) {
    const ImbalanceState state{quarter_hour.system_imbalance_mw, last_imbalance_mw_,
                               quarter_hour.marginal_incremental_eur_per_mwh,
                               quarter_hour.marginal_decremental_eur_per_mwh};
    quarter_hour.alpha_eur_per_mwh = alpha_eur_per_mwh(state);
    quarter_hour.price_eur_per_mwh = in_cents(imbalance_price_eur_per_mwh(state));
    last_imbalance_mw_ = quarter_hour.system_imbalance_mw;
  }
}

std::vector<QuarterHour> YearSimulator::next_year(std::int64_t start_utc_s) {
  std::vector<QuarterHour> year(kQuarterHoursPerYear);
  for (std::size_t q = 0; q < year.size(); ++q) {
    year[q].utc_s = start_utc_s + static_cast<std::int64_t>(q) * kSecondsPerQuarterHour;
  }
  Scores scores = draw_scores(start_utc_s);
  set_imbalances(year, scores.imbalance);
  set_marginal_prices(year, scores);
  settle(year);
  return year;
}

}  // namespace

std::vector<QuarterHour> simulate_quarter_hours(const SimulationPeriod& period,
                                                std::uint64_t seed) {
  YearSimulator simulator(seed);
  std::vector<QuarterHour> quarter_hours;
  std::int64_t utc_s = period.start_utc_s;
  while (utc_s < period.end_utc_s) {
    const std::vector<QuarterHour> year = simulator.next_year(utc_s);
    quarter_hours.insert(quarter_hours.end(), year.begin(), year.end());
    utc_s += kQuarterHoursPerYear * kSecondsPerQuarterHour;
  }
  quarter_hours.resize(
      static_cast<std::size_t>((period.end_utc_s - period.start_utc_s) / kSecondsPerQuarterHour));
  return quarter_hours;
}

}  // namespace bess
