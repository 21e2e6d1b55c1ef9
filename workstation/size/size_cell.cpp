#include "workstation/size/size_cell.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "workstation/chain/learning_class.h"

namespace bess {
namespace {

constexpr double kDaysPerYear = 365.25;
constexpr int kMonthsPerYear = 12;
constexpr int kLifeMonthsMax = 50 * kMonthsPerYear;

/// What each day leaves of the class's money: wear given back, a share taken of months that earn.
std::vector<DayValue> cash_of(const SizeClass& of, double share_percent) {
  std::vector<DayValue> days;
  std::map<std::string, double> months;
  for (const DayResult& day : of.traded.days) {
    const double eur = day.profit_eur + of.traded.wear_eur_per_mwh * day.throughput_mwh;
    days.emplace_back(day.date, eur);
    months[day.date.substr(0, 7)] += eur;
  }
  for (auto& [date, eur] : days) {
    if (months[date.substr(0, 7)] > 0) eur *= 1 - share_percent / 100;
  }
  return days;
}

double mean_of(const std::vector<DayValue>& days) {
  double sum = 0;
  for (const DayValue& day : days) sum += day.second;
  return sum / static_cast<double>(days.size());
}

double fixed_costs(const SizeContract& contract, const SizeClass& of, double power_w) {
  double kw = 0;
  for (const MonthPeak& peak : of.peaks) {
    kw += peak.power_share * power_w / 1e3 / static_cast<double>(of.peaks.size());
  }
  return kMonthsPerYear * contract.fee_eur_per_month +
         contract.capacity_eur_per_kw_year * std::max(0.0, kw - contract.capacity_free_kw);
}

}  // namespace

double SizeCell::eur_per_cycle() const { return eur_per_year() / (cycles_per_day * kDaysPerYear); }

RunConfig cell_config(const RunConfig& base, double power_w, double capacity_wh,
                      const SizeContract& contract) {
  RunConfig config = base;
  config.battery.power_w_max = power_w;
  config.battery.capacity_wh = capacity_wh;
  config.battery.costs = contract.costs;
  config.battery.wear_eur_per_mwh = contract.wear_eur_per_mwh;
  config.battery.cycles_per_day_max = contract.cycles_per_day_max;
  return config;
}

SizeCells weigh_up(const SizePlan& plan, const RunConfig& base, const SizeTrial& trial) {
  std::vector<RunConfig> configs;
  std::map<std::string, std::size_t> by_key;
  std::vector<std::size_t> class_of;
  for (const double power_w : plan.power_w) {
    for (const double capacity_wh : plan.capacity_wh) {
      for (const SizeContract& contract : plan.contracts) {
        const RunConfig own = cell_config(base, power_w, capacity_wh, contract);
        require_consistent(own, "[[contract]] " + contract.name);
        const RunConfig config = canonical(own);
        const auto [at, is_new] = by_key.try_emplace(learning_key(config, ""), configs.size());
        if (is_new) configs.push_back(config);
        class_of.push_back(at->second);
      }
    }
  }
  SizeCells all{{}, trade_classes(configs, trial)};
  auto of = class_of.begin();
  for (const double power_w : plan.power_w) {
    for (const double capacity_wh : plan.capacity_wh) {
      for (const SizeContract& contract : plan.contracts) {
        all.cells.push_back(size_cell(plan, contract, all.classes[*of], power_w, capacity_wh));
        all.cells.back().class_index = *of++;
      }
    }
  }
  return all;
}

SizeCell size_cell(const SizePlan& plan, const SizeContract& contract, const SizeClass& of,
                   double power_w, double capacity_wh) {
  const std::vector<DayValue> cash = cash_of(of, contract.share_percent);
  const double days_of_cell = kDaysPerYear * capacity_wh / of.battery.capacity_wh;
  SizeCell cell{.power_w = power_w,
                .capacity_wh = capacity_wh,
                .contract = &contract,
                .class_index = 0,
                .profit_eur_per_day_per_mwh = of.traded.profit_eur_per_day_per_mwh(),
                .margin_eur_per_year = mean_of(cash) * days_of_cell,
                .fixed_eur_per_year = fixed_costs(contract, of, power_w),
                .error_eur_per_year = day_errors(cash).by_month * days_of_cell,
                .cycles_per_day = of.traded.cycles_per_day(),
                .share_of_foresight = of.share_of_foresight,
                .price_eur = plan.purchase.price_eur(power_w, capacity_wh),
                .life_years = 0,
                .pay_back_years = NAN,
                .life_eur = 0};
  const LifeOfBattery life = life_of(cell, plan.ageing);
  cell.life_years = life.years;
  cell.pay_back_years = life.pay_back_years;
  cell.life_eur = life.eur;
  return cell;
}

LifeOfBattery life_of(const SizeCell& cell, const Ageing& ageing) {
  LifeOfBattery life{0, NAN, -cell.price_eur};
  double capacity = 1;  // of what was bought
  const double cycles = cell.cycles_per_day * kDaysPerYear / kMonthsPerYear;
  for (int month = 0; month < kLifeMonthsMax && capacity > ageing.end_percent / 100; ++month) {
    const double eur =
        (cell.margin_eur_per_year * capacity - cell.fixed_eur_per_year) / kMonthsPerYear;
    if (life.eur < 0 && life.eur + eur >= 0) {
      life.pay_back_years = (month - life.eur / eur) / kMonthsPerYear;
    }
    life.eur += eur;
    life.years = (month + 1.0) / kMonthsPerYear;
    capacity -= ageing.calendar_percent_per_year / 100 / kMonthsPerYear +
                ageing.cycle_percent_per_1000 / 100 * cycles * capacity / 1000;
  }
  return life;
}

const SizeCell& best_of(const std::vector<SizeCell>& cells) {
  const auto rank = [](const SizeCell& cell) {
    const bool pays = !std::isnan(cell.pay_back_years);
    const double otherwise =
        cell.price_eur > 0 ? cell.life_eur / cell.price_eur : cell.eur_per_kwh_year();
    return std::pair(pays, pays ? -cell.pay_back_years : otherwise);
  };
  return *std::ranges::max_element(cells, {}, rank);
}

}  // namespace bess
