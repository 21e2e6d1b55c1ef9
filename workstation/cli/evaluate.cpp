// bess-train evaluate: profit of policies on recorded prices.
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "workstation/base/answer.h"
#include "workstation/cli/commands.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/policy/planners/baselines.h"
#include "workstation/report/comparison.h"
#include "workstation/runs/chain/common_options.h"
#include "workstation/runs/chain/policy_factory.h"
#include "workstation/runs/chain/price_input.h"
#include "workstation/runs/run/run_record.h"

namespace bess {
namespace {

struct EvaluateArguments {
  CommonOptions common;
  PriceInput price_input;
  DayAheadInput day_ahead;
  std::string prices;
  std::vector<std::string> policies;
  std::string split = "test";
  std::string date;
  std::string fit;
  std::optional<int> fit_delay_min;
  bool carry_soc = false;
  bool json = false;
  std::string csv;
  std::string days_out;
  std::string steps_out;

  /// Both accountings, unless one is requested or a single policy is evaluated.
  [[nodiscard]] bool wants_reset() const { return !carry_soc; }
  [[nodiscard]] bool wants_carried() const { return carry_soc || policies.size() > 1; }
};

/// Days and steps of every policy and accounting, as CSV.
struct Records {
  std::string days = "date,profit_eur,cycles,switches,policy,carry_soc,soc_end_frac\n";
  std::string steps =
      "utc,action,power_w,profit_eur,policy,carry_soc,observed_eur_per_mwh,paid_eur_per_mwh,"
      "level_eur_per_mwh,soc_frac\n";

  void add(const std::string& policy, bool carry_soc, const Evaluation& e,
           const std::vector<StepRecord>& records) {
    const std::string whose = fmt::format("{},{}", csv_field(policy), truth(carry_soc));
    for (const DayResult& d : e.days) {
      days += fmt::format("{},{:.8g},{:.4f},{},{},{:.5f}\n", d.date, d.profit_eur, d.cycles,
                          d.switches, whose, d.soc_end_frac);
    }
    for (const StepRecord& r : records) {
      steps += fmt::format("{},{},{:.3f},{:.8g},{},{:.10g},{:.10g},{:.2f},{:.6f}\n",
                           utc_text(r.utc_s).view(), action_name(r.action), r.power_w, r.profit_eur,
                           whose, r.observed_eur_per_mwh, r.paid_eur_per_mwh, r.level_eur_per_mwh,
                           r.soc_frac);
    }
  }
};

/// One line per policy; with several policies, carried-over figures are nested.
void print_json(const std::vector<NamedEvaluation>& results, const NamedEvaluation& foresight,
                const EvaluateArguments& options) {
  const auto reset = comparison_rows(results, &NamedEvaluation::day_reset, &foresight);
  const auto carried = comparison_rows(results, &NamedEvaluation::carried_over, &foresight);
  for (std::size_t i = 0; i < results.size(); ++i) {
    Json json = answer("evaluation", {{"policy", results[i].name},
                                      {"split", options.split},
                                      {"date", text_or_null(options.date)},
                                      {key::kCarrySoc, options.carry_soc}});
    add_figures(options.carry_soc ? carried[i] : reset[i], json);
    json.set("description", text_or_null(results[i].description));
    Json nested = Json::null();
    if (!options.carry_soc && !carried.empty()) {
      nested = Json::object({{key::kCarrySoc, true}});
      add_figures(carried[i], nested);
    }
    json.set(key::kCarriedOver, std::move(nested));
    fmt::print("{}\n", json.line());
  }
}

double price_range(const MarketSteps& market, const MarketDay& day) {
  const auto [low, high] =
      std::ranges::minmax(market.of(day), {}, &MarketStep::observed_eur_per_mwh);
  return high.observed_eur_per_mwh - low.observed_eur_per_mwh;
}

/// Day named by --date, from the split.
MarketDay select_day(const MarketSteps& market, const std::vector<MarketDay>& days,
                     const std::string& date) {
  const auto found =
      date == "widest"
          ? std::ranges::max_element(days, {},
                                     [&](const MarketDay& day) { return price_range(market, day); })
          : std::ranges::find_if(days, [&](const MarketDay& day) { return day.date() == date; });
  if (found == days.end()) {
    fail(
        "--date {}: no complete day of that date in the split; use YYYY-MM-DD or widest, or add "
        "--split all",
        date);
  }
  return *found;
}

/// Keeps one day of an evaluation over the whole split, so that its carried-over SoC is correct.
void keep_day(const MarketDay& day, const MarketSteps& market, Evaluation& evaluation,
              std::vector<StepRecord>& steps) {
  std::erase_if(evaluation.days, [&](const DayResult& d) { return d.date != day.date(); });
  const auto of_day = market.of(day);
  std::erase_if(steps, [&](const StepRecord& r) {
    return r.utc_s < of_day.front().utc_s || r.utc_s > of_day.back().utc_s;
  });
}

/// Market for fitting: training days of --fit, at --fit-delay.
MarketSteps fitting_market(const MinuteSeries& series, const RunConfig& config,
                           const EvaluateArguments& options) {
  MarketOptions market = config.market;
  market.observation_delay_min = options.fit_delay_min.value_or(market.observation_delay_min);
  if (options.fit.empty()) return market_of(series, market, options.prices);
  return market_of(options.price_input.read(options.fit), market, options.fit);
}

bool is_fitted(const std::string& policy) {
  const Baseline* baseline = find_baseline(policy);
  return baseline != nullptr && baseline->is_for(kFitted);
}

/// Common inputs of all evaluations.
struct EvaluationSetup {
  const MarketSteps& market;
  const MarketSteps& fitting;
  std::vector<MarketDay> days;
  std::optional<MarketDay> only_day;
  const RunConfig& config;
  const EvaluateArguments& options;
};

/// In the requested accountings; days and steps go to `records` when given.
NamedEvaluation evaluate_policy(const std::string& name, const EvaluationSetup& setup,
                                Records* records) {
  const EvaluateArguments& options = setup.options;
  const RunConfig& config = setup.config;
  const std::shared_ptr<Policy> policy = make_policy(name, setup.fitting, config.battery);
  NamedEvaluation named{name, {}, {}, policy->description()};
  const bool wants_steps = records != nullptr && !options.steps_out.empty();
  for (const bool carry_soc : {false, true}) {
    if (!(carry_soc ? options.wants_carried() : options.wants_reset())) continue;
    std::vector<StepRecord> steps;
    std::vector<StepRecord>* const wanted_steps = wants_steps ? &steps : nullptr;
    Evaluation& evaluation = carry_soc ? named.carried_over : named.day_reset;
    evaluation = carry_soc
                     ? evaluate_carried_over(setup.market, setup.days, *policy, config.battery,
                                             config.initial_soc_frac, wanted_steps)
                     : evaluate(setup.market, setup.days, *policy,
                                {config.battery, config.initial_soc_frac, false}, wanted_steps);
    if (setup.only_day) keep_day(*setup.only_day, setup.market, evaluation, steps);
    if (records != nullptr) records->add(name, carry_soc, evaluation, steps);
  }
  return named;
}

/// Checked first, so that a wrong name costs no time.
void require_outputs_writable(const EvaluateArguments& options) {
  require_distinct({{"--csv", options.csv},
                    {"--days-out", options.days_out},
                    {"--steps-out", options.steps_out}},
                   named_paths("--policy", options.policies,
                               {{"--prices", options.prices},
                                {"--fit", options.fit},
                                {"--day-ahead", options.day_ahead.path},
                                {"--config", options.common.config_path}}));
  for (const std::string& path : {options.csv, options.days_out, options.steps_out}) {
    if (!path.empty()) require_writable(path);
  }
}

void run_evaluate(const EvaluateArguments& options) {
  require_outputs_writable(options);
  const RunConfig config = options.common.resolve();
  require_policies(options.policies);
  require_outlook(options.policies, options.day_ahead.path);
  const MinuteSeries series = options.price_input.read(options.prices);
  MarketSteps market = market_of(series, config.market, options.prices);
  MarketSteps fitting = fitting_market(series, config, options);
  options.day_ahead.attach_to(market, series, options.price_input.accepted(), config.market);
  attach_day_ahead(fitting, market.day_ahead);
  EvaluationSetup setup{market, fitting, market.days_of(parse_split(options.split)),
                        {},     config,  options};
  if (setup.days.empty()) {
    fail("{}: no complete day in the {} split; add prices or use --split all", options.prices,
         options.split);
  }
  if (!options.date.empty()) setup.only_day = select_day(market, setup.days, options.date);
  JudgedDays judged = judged_days(market, parse_split(options.split));
  // Of a student or teacher, the price file does not tell the training days.
  const bool has_fitted = std::ranges::any_of(options.policies, is_fitted);
  judged.last_learnt = has_fitted ? last_learnt_day(fitting) : "";
  if (setup.only_day) judged.dates = {setup.only_day->date()};
  const NamedEvaluation foresight = evaluate_policy(kForesightName, setup, nullptr);
  std::vector<NamedEvaluation> results;
  Records records;
  if (has_fitted) {
    warn_unknown_regimes("fitted policies", fitting, market, setup.days);
  }
  for (const std::string& name : options.policies) {
    warn_learnt_otherwise(name, circumstances_of(config_entries(config)), market, setup.days);
    results.push_back(evaluate_policy(name, setup, &records));
  }
  if (!options.days_out.empty()) write_file(options.days_out, records.days);
  if (!options.steps_out.empty()) write_file(options.steps_out, records.steps);
  if (!options.csv.empty()) write_file(options.csv, comparison_csv(results, &foresight));
  if (!options.json) {
    fmt::print("{} split: {}{}\n", options.split, format_comparison_table(results, &foresight),
               judged_days_text(judged));
    return;
  }
  print_json(results, foresight, options);
}

}  // namespace

void add_evaluate_command(ProgramCommand& app) {
  auto options = std::make_shared<EvaluateArguments>();
  ProgramCommand command = app.subcommand("evaluate", "evaluate policies on recorded prices");
  command.option("--prices", options->prices, "minute file (.csv or .csv.gz)").required();
  options->price_input.add(command);
  options->day_ahead.add(command);
  command.option("--policy", options->policies, std::string("one or more of ") + policy_help())
      .required();
  command
      .option("--split", options->split,
              "local days of each month: 1-20, 21-25, 26-end, the last two together, or all")
      .one_of({kSplitNames.begin(), kSplitNames.end()})
      .with_default();
  command.option("--date", options->date,
                 "only this day of the split: YYYY-MM-DD, or widest (largest price range)");
  options->common.add_market(command);
  options->common.add_config(command);
  command.flag("--carry-soc", options->carry_soc,
               "carry the SoC from day to day instead of resetting it (default with several "
               "policies: both)");
  command.flag("--json", options->json, "JSON, one line per policy");
  command.option("--csv", options->csv, "output file for the comparison (CSV)");
  const std::string fitted = fmt::format("{}", fmt::join(baseline_names(kFitted), ", "));
  command.option("--fit", options->fit,
                 fmt::format("minute file for fitting {} (default: --prices)", fitted));
  command
      .option("--fit-delay", options->fit_delay_min,
              fmt::format("observation delay for fitting {}, minutes (default: --delay)", fitted))
      .range(0, 5);
  command.option("--days-out", options->days_out, "output file for the days of all policies (CSV)");
  command.option("--steps-out", options->steps_out,
                 "output file for the steps of all policies (CSV)");
  command.footer(
      "Examples:\n"
      "  bess-train evaluate --prices market.csv.gz --policy rbc rbc-tuned tabular mpc foresight "
      "--csv table.csv\n"
      "  bess-train evaluate --prices market.csv.gz --policy rbc:0:150 rbc-tuned --fit-delay 1 "
      "--delay 3\n"
      "  bess-train evaluate --prices 2024.csv.gz --fit 2023.csv.gz --split all --policy rbc-tuned "
      "tabular sdp\n"
      "  bess-train evaluate --prices market.csv.gz --policy runs/a/student.json --split all "
      "--carry-soc --json\n"
      "  bess-train evaluate --prices market.csv.gz --policy compiled --date widest --steps-out "
      "day.csv\n"
      "  bess-train evaluate --prices market.csv.gz --day-ahead day_ahead.csv.gz --policy sdp "
      "sdp-outlook");
  command.runs([options] { run_evaluate(*options); });
}

}  // namespace bess
