#include "workstation/runs/impact/impact_study.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "shared/host/file.h"
#include "workstation/base/answer.h"
#include "workstation/base/parallel_for.h"
#include "workstation/base/progress.h"
#include "workstation/data/market/series/imbalance_price.h"
#include "workstation/data/market/series/local_date.h"
#include "workstation/report/figures/html.h"
#include "workstation/runs/chain/policy_factory.h"

namespace bess {

namespace {

/// Start of the period to which the simulated market was fitted.
constexpr LocalDate kFirstDay{2023, 1, 1};
/// Days before the test days in which the price level settles; not evaluated.
constexpr int kWarmUpDays = 5;

/// Additional wear in the planning of a cautious fleet, EUR/MWh.
constexpr double kShynesses[] = {0, 20, 50, 100, 200, 400};

/// Variant of the fleet.
struct ImpactVariant {
  std::string name;
  bool is_spread = false, has_small_steps = false;
  bool is_shy = false;  ///< plans with the additional wear that was best on the training days
  int round = 0;        ///< number of retrainings
};

/// "as it is", "spread in time", "small steps", "shy", "round 1", ...
std::vector<ImpactVariant> impact_variants(const ImpactPlan& plan) {
  std::vector<ImpactVariant> variants{{"as it is"},
                                      {"spread in time", true},
                                      {"small steps", false, true},
                                      {"shy", false, false, true}};
  for (int round = 1; round <= plan.rounds; ++round) {
    variants.push_back({fmt::format("round {}", round), false, false, false, round});
  }
  return variants;
}

using Policies = std::vector<std::shared_ptr<Policy>>;

std::vector<FleetPart> fleet_of(const Policies& policies, const ImpactVariant& variant,
                                const ImpactPlan& plan) {
  const int clocks = variant.is_spread ? plan.jitter_min + 1 : 1;
  std::vector<FleetPart> fleet;
  for (const auto& policy : policies) {
    for (int late_min = 0; late_min < clocks; ++late_min) {
      fleet.push_back({policy, 1.0 / static_cast<double>(clocks * policies.size()), late_min,
                       variant.has_small_steps ? plan.step_share : 2});
    }
  }
  return fleet;
}

/// Market of one seed, with training and test days.
class SeedOfMarket {
 public:
  SeedOfMarket(const ImpactPlan& plan, std::uint64_t seed)
      : plan_(plan),
        whole_(
            draw_market(local_midnight_utc_s(kFirstDay), plan.train_days + plan.test_days, seed)),
        train_(whole_) {
    train_.quarter_hours.resize(quarter_hour_of(plan.train_days));
    train_.paths.resize(train_.quarter_hours.size());
  }

  /// Run of the fleet on the training days.
  [[nodiscard]] FleetRun trained(const std::vector<FleetPart>& fleet,
                                 const FleetOptions& options) const {
    return run_fleet(train_, fleet, options);
  }

  [[nodiscard]] ImpactFigures traded(const std::vector<FleetPart>& fleet,
                                     FleetOptions options) const {
    options.first_quarter_hour = quarter_hour_of(plan_.train_days - kWarmUpDays);
    FleetRun run = run_fleet(whole_, fleet, options);
    ImpactFigures figures = imbalances(run, options.first_quarter_hour);
    const std::string first_day = format_local_date(add_days(kFirstDay, plan_.train_days));
    for (std::size_t p = 0; p < fleet.size(); ++p) {
      std::erase_if(run.parts[p].days, [&](const DayResult& day) { return day.date < first_day; });
      figures.switches_per_day += fleet[p].share * run.parts[p].switches_per_day();
    }
    figures.eur_per_mw_day = eur_per_mw_day(run, fleet, options);
    return figures;
  }

  [[nodiscard]] static double eur_per_mw_day(const FleetRun& run,
                                             const std::vector<FleetPart>& fleet,
                                             const FleetOptions& options) {
    double eur = 0;
    for (std::size_t p = 0; p < fleet.size(); ++p) {
      eur += fleet[p].share * run.parts[p].profit_eur_per_day_per_mwh() * run.parts[p].capacity_mwh;
    }
    return eur / (options.battery.power_w_max / kWattsPerMegawatt);
  }

 private:
  [[nodiscard]] std::size_t quarter_hour_of(int day) const {
    const std::int64_t utc_s = local_midnight_utc_s(add_days(kFirstDay, day));
    return static_cast<std::size_t>((utc_s - whole_.quarter_hours.front().utc_s) /
                                    kSecondsPerQuarterHour);
  }

  [[nodiscard]] ImpactFigures imbalances(const FleetRun& run, std::size_t first) const {
    ImpactFigures figures{};
    const std::size_t begin = quarter_hour_of(plan_.train_days);
    const auto count = static_cast<double>(whole_.paths.size() - begin);
    for (std::size_t q = begin; q < whole_.paths.size(); ++q) {
      const double alone_mw = whole_.paths[q].imbalance_mw.back();
      const double with_mw = run.imbalance_mw[q - first];
      figures.imbalance_alone_mw += std::fabs(alone_mw) / count;
      figures.imbalance_mw += std::fabs(with_mw) / count;
      figures.overshoot_share += is_short(alone_mw) != is_short(with_mw) ? 1 / count : 0;
    }
    return figures;
  }

  const ImpactPlan& plan_;
  DrawnMarket whole_, train_;
};

Policies fitted(const ImpactPlan& plan, const MinuteSeries& prices, const FleetOptions& options) {
  Policies policies;
  for (const std::string& name : plan.policies) {
    policies.push_back(fitted_policy(name, prices, options));
  }
  return policies;
}

/// The candidate with the highest earnings on the training days.
const Policies& shy(const std::vector<Policies>& candidates, const ImpactPlan& plan,
                    const FleetOptions& options, const SeedOfMarket& market) {
  const auto earned = [&](const Policies& policies) {
    const std::vector<FleetPart> fleet = fleet_of(policies, {}, plan);
    return SeedOfMarket::eur_per_mw_day(market.trained(fleet, options), fleet, options);
  };
  return *std::ranges::max_element(candidates, {}, earned);
}

/// Results of one formula and seed: [fleet][variant].
std::vector<std::vector<ImpactFigures>> figures_of(const ImpactPlan& plan,
                                                   const FleetOptions& options,
                                                   const SeedOfMarket& market) {
  const std::vector<ImpactVariant> variants = impact_variants(plan);
  const MinuteSeries untouched = market.trained({}, options).prices;
  std::vector<Policies> candidates;
  for (const double shyness : kShynesses) {
    FleetOptions wary = options;
    wary.battery.wear_eur_per_mwh += shyness;
    candidates.push_back(fitted(plan, untouched, wary));
  }
  std::vector<std::vector<ImpactFigures>> all;
  for (const double mw : plan.fleet_mw) {
    FleetOptions with = options;
    with.fleet_mw = mw;
    Policies learnt = candidates.front();
    std::vector<ImpactFigures> row;
    for (const ImpactVariant& variant : variants) {
      if (variant.round > 0) {
        learnt = fitted(plan, market.trained(fleet_of(learnt, variant, plan), with).prices, with);
      }
      const Policies& used = variant.is_shy ? shy(candidates, plan, with, market) : learnt;
      row.push_back(market.traded(fleet_of(used, variant, plan), with));
    }
    all.push_back(std::move(row));
  }
  return all;
}

ImpactRow row_of(const std::vector<ImpactFigures>& seeds) {
  ImpactRow row{};
  const auto count = static_cast<double>(seeds.size());
  using F = ImpactFigures;
  for (const auto field : {&F::eur_per_mw_day, &F::overshoot_share, &F::imbalance_mw,
                           &F::imbalance_alone_mw, &F::switches_per_day}) {
    for (const ImpactFigures& seed : seeds) row.*field += seed.*field / count;
  }
  double squares = 0;
  for (const ImpactFigures& seed : seeds) {
    squares += std::pow(seed.eur_per_mw_day - row.eur_per_mw_day, 2);
  }
  row.standard_error = seeds.size() > 1 ? std::sqrt(squares / (count - 1) / count) : NAN;
  return row;
}

constexpr const char* kMoneyUnit = "EUR per MW and day";
constexpr std::array kLineColours{"ink", "charge", "discharge", "muted", "soft", "mark", "idle"};

std::string formula_name(PriceFormula formula) {
  return std::string(kFormulaNames[static_cast<std::size_t>(formula)]);
}

Table table_of(const std::vector<ImpactRow>& rows) {
  using R = ImpactRow;
  static const std::vector<Column<R>> kColumns{
      {{"formula", "", "", 0, "Formula"}, [](const R& r) { return formula_name(r.formula); }},
      {{"fleet_mw", "", "", kAllDecimals, "MW"}, &R::fleet_mw},
      {{"variant", "", "", 0, "Variant"}, &R::variant},
      {{"eur_per_mw_day", "", "{:.1f}", 4, "EUR per MW and day"}, &R::eur_per_mw_day},
      {{"eur_per_mw_day_standard_error", "", "{:.1f}", 4, "s.e. over seeds, EUR per MW and day"},
       &R::standard_error},
      {{"overshoot_share", "", "{:.3f}", 4, "Overshoot, share"}, &R::overshoot_share},
      {{"imbalance_mw", "", "{:.1f}", 4, "Mean |SI|, MW"}, &R::imbalance_mw},
      {{"imbalance_alone_mw", "", "{:.1f}", 4, "Without, MW"}, &R::imbalance_alone_mw},
      {{"switches_per_day", "", "{:.1f}", 4, "Switches/day"}, &R::switches_per_day},
  };
  return {kColumns, rows};
}

const ImpactRow& row_at(const std::vector<ImpactRow>& rows, PriceFormula formula, double mw,
                        const std::string& variant) {
  return *std::ranges::find_if(rows, [&](const ImpactRow& row) {
    return row.formula == formula && row.fleet_mw == mw && row.variant == variant;
  });
}

/// Fleet size with the highest total earnings, and size from which it increases the imbalance.
std::string turning_points(const ImpactPlan& plan, const std::vector<ImpactRow>& rows,
                           PriceFormula formula) {
  const auto as_it_is = [&](double mw) -> const ImpactRow& {
    return row_at(rows, formula, mw, impact_variants(plan).front().name);
  };
  const auto money = [&](double mw) { return mw * as_it_is(mw).eur_per_mw_day; };
  const auto imbalance = [&](double mw) { return as_it_is(mw).imbalance_mw; };
  const double most = *std::ranges::max_element(plan.fleet_mw, {}, money);
  const double best = *std::ranges::min_element(plan.fleet_mw, {}, imbalance);
  std::string text =
      fmt::format("{}: highest total earnings at {:g} MW; lowest system imbalance at {:g} MW",
                  formula_name(formula), most, best);
  for (const double mw : plan.fleet_mw) {
    const ImpactFigures& figures = as_it_is(mw);
    if (mw <= best || figures.imbalance_mw <= figures.imbalance_alone_mw) continue;
    return text + fmt::format(", and higher than without a fleet from {:g} MW", mw);
  }
  return text;
}

/// Lines over fleet size: `value` for each of `names`.
template <typename Value>
Json lines_chart(const std::string& id, const std::string& unit, const ImpactPlan& plan,
                 const std::vector<std::string>& names, Value value) {
  const auto label = [](double mw) { return fmt::format("{:g} MW", mw); };
  Json series = Json::list();
  for (std::size_t n = 0; n < names.size(); ++n) {
    const auto value_of = [&](double mw) { return value(n, mw); };
    series.add(Json::list_of(names[n], kLineColours[n % kLineColours.size()],
                             Json::list_from(plan.fleet_mw, value_of)));
  }
  return Json::object({{"id", id},
                       {"kind", "lines"},
                       {"y", unit},
                       {"labels", Json::list_from(plan.fleet_mw, label)},
                       {"series", std::move(series)}});
}

std::string with_error(const ImpactRow& row) {
  const std::string error =
      std::isnan(row.standard_error) ? "" : fmt::format(" ({:.0f})", row.standard_error);
  return fmt::format("{:.0f}{}", row.eur_per_mw_day, error);
}

std::string plan_text(const ImpactPlan& plan) {
  return fmt::format(
      "{} simulated markets with {} training days and {} traded days; {}; spread: clock delay 0 to "
      "{} min; small steps: {:g} % of the power per two minutes",
      plan.seeds, plan.train_days, plan.test_days, fmt::join(plan.policies, " and "),
      plan.jitter_min, 100 * plan.step_share);
}

}  // namespace

std::shared_ptr<Policy> fitted_policy(const std::string& name, const MinuteSeries& prices,
                                      const FleetOptions& options) {
  MarketSteps market =
      make_market_steps(prices, {.observation_delay_min = options.observation_delay_min});
  for (MarketDay& day : market.days) day.split = Split::kTrain;
  return make_policy(name, market, options.battery);
}

std::vector<ImpactRow> study_impact(const ImpactPlan& plan, const FleetOptions& base) {
  const std::size_t formulas = kFormulaNames.size();
  const auto seeds = static_cast<std::size_t>(plan.seeds);
  std::vector<std::vector<std::vector<ImpactFigures>>> found(formulas * seeds);
  Progress progress("impact", "markets", static_cast<double>(found.size()));
  parallel_for(found.size(), plan.threads, [&](std::size_t i) {
    FleetOptions options = base;
    options.formula = static_cast<PriceFormula>(i / seeds);
    found[i] = figures_of(plan, options, SeedOfMarket(plan, i % seeds + 1));
    progress.advance();
  });
  const std::vector<ImpactVariant> variants = impact_variants(plan);
  std::vector<ImpactRow> rows;
  for (std::size_t f = 0; f < formulas; ++f) {
    for (std::size_t m = 0; m < plan.fleet_mw.size(); ++m) {
      for (std::size_t v = 0; v < variants.size(); ++v) {
        std::vector<ImpactFigures> of_seeds;
        for (std::size_t s = 0; s < seeds; ++s) of_seeds.push_back(found[f * seeds + s][m][v]);
        ImpactRow row = row_of(of_seeds);
        row.formula = static_cast<PriceFormula>(f);
        row.fleet_mw = plan.fleet_mw[m];
        row.variant = variants[v].name;
        rows.push_back(std::move(row));
      }
    }
  }
  return rows;
}

std::string format_impact_table(const ImpactPlan& plan, const std::vector<ImpactRow>& rows) {
  std::string text =
      fmt::format("EUR per MW and day (standard error over seeds)\n{}\n", plan_text(plan));
  const std::vector<ImpactVariant> variants = impact_variants(plan);
  for (std::size_t f = 0; f < kFormulaNames.size(); ++f) {
    const auto formula = static_cast<PriceFormula>(f);
    text += fmt::format("\n{:<12}{:>6}", kFormulaNames[f], "MW");
    for (const ImpactVariant& variant : variants) text += fmt::format(" {:>14}", variant.name);
    text += fmt::format(" {:>10} {:>10} {:>8}\n", "overshoot", "|SI|, MW", "switches");
    for (const double mw : plan.fleet_mw) {
      text += fmt::format("{:>18g}", mw);
      for (const ImpactVariant& variant : variants) {
        text += fmt::format(" {:>14}", with_error(row_at(rows, formula, mw, variant.name)));
      }
      const ImpactFigures& figures = row_at(rows, formula, mw, variants.front().name);
      text += fmt::format(" {:>8.1f} % {:>10.1f} {:>8.1f}\n", 100 * figures.overshoot_share,
                          figures.imbalance_mw, figures.switches_per_day);
    }
  }
  text += "\n";
  for (std::size_t f = 0; f < kFormulaNames.size(); ++f) {
    text += turning_points(plan, rows, static_cast<PriceFormula>(f)) + "\n";
  }
  return text + "overshoot, |SI| and switches: variant 'as it is'\n";
}

std::string impact_csv(const std::vector<ImpactRow>& rows) { return table_of(rows).csv(); }

Json impact_json(const ImpactPlan& plan, const std::vector<ImpactRow>& rows) {
  return answer("impact", {{"policies", Json::list_from(plan.policies)},
                           {"seeds", plan.seeds},
                           {"train_days", plan.train_days},
                           {"test_days", plan.test_days},
                           {"fleets", table_of(rows).json()}});
}

void write_impact_page(const ImpactPlan& plan, const std::vector<ImpactRow>& rows,
                       const std::filesystem::path& folder) {
  const std::vector<std::string> formulas(kFormulaNames.begin(), kFormulaNames.end());
  std::vector<std::string> variants;
  for (const ImpactVariant& variant : impact_variants(plan)) variants.push_back(variant.name);
  Json charts = Json::list();
  std::string body =
      fmt::format("<h1>Price impact of a fleet</h1>\n<p>{}.</p>\n<p class=\"note\">{}</p>\n",
                  html_escaped(plan_text(plan)), csv_link("impact.csv"));
  const auto figure = [&](const std::string& title, const std::string& id, Json chart,
                          const std::string& note) {
    charts.add(std::move(chart));
    body += fmt::format("<figure>\n<h2>{}</h2>\n{}<figcaption>{}</figcaption>\n</figure>\n",
                        html_escaped(title), chart_html(id, title), html_escaped(note));
  };
  const auto of_formula = [&](std::size_t f, double mw) -> const ImpactFigures& {
    return row_at(rows, static_cast<PriceFormula>(f), mw, variants.front());
  };
  figure("EUR per MW and day by fleet size", "money",
         lines_chart("money", kMoneyUnit, plan, formulas,
                     [&](std::size_t f, double mw) { return of_formula(f, mw).eur_per_mw_day; }),
         "Variant 'as it is', by price formula.");
  figure("Mean absolute system imbalance with the fleet, MW", "imbalance",
         lines_chart("imbalance", "MW", plan, formulas,
                     [&](std::size_t f, double mw) { return of_formula(f, mw).imbalance_mw; }),
         fmt::format("Without a fleet {:.1f} MW.", rows.front().imbalance_alone_mw));
  for (std::size_t f = 0; f < formulas.size(); ++f) {
    const auto formula = static_cast<PriceFormula>(f);
    const std::string id = fmt::format("variants-{}", f + 1);
    figure(fmt::format("Variants, formula {}, {}", formulas[f], kMoneyUnit), id,
           lines_chart(id, kMoneyUnit, plan, variants,
                       [&](std::size_t v, double mw) {
                         return row_at(rows, formula, mw, variants[v]).eur_per_mw_day;
                       }),
           turning_points(plan, rows, formula) + ".");
  }
  body += fmt::format("{}<script>\n{}</script>\n",
                      sort_table_html(sort_table("rows", "All fleets", table_of(rows))),
                      page_file("sort.js"));
  write_file(folder / "impact.html",
             format_chart_page("Price impact of a fleet", body, std::move(charts)));
}

}  // namespace bess
