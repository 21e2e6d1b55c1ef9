#include "workstation/runs/log/log_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"
#include "workstation/base/answer.h"
#include "workstation/correction/student/student_policy.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/data/market/series/local_date.h"
#include "workstation/policy/planners/baselines.h"
#include "workstation/report/figures/html.h"
#include "workstation/runs/chain/run_config.h"

namespace bess {

namespace {

LocalDate date_of(std::int32_t day) { return {day / 10'000, day / 100 % 100, day % 100}; }

std::vector<ExchangeSample> samples_of(const CycleLog& log, const BatteryParameters& battery) {
  std::vector<ExchangeSample> samples;
  for (const LoggedCycle& c : log.cycles) {
    if (!c.has_reading) continue;
    samples.push_back({.utc_s = c.utc_s,
                       .power_w = static_cast<std::int32_t>(c.power_w),
                       .soc_e4 = static_cast<std::int32_t>(std::lround(c.soc_frac * kSocFullE4)),
                       .capacity_wh = static_cast<std::int32_t>(battery.capacity_wh),
                       .order_w = static_cast<std::int32_t>(c.ordered_w),
                       .is_ordered = c.is_ordered});
    if (c.is_ordered && c.has_price) {
      samples.back().set_written(c.price_minute_utc_s, c.price_age_s);
    }
  }
  return samples;
}

int direction(const LoggedCycle& cycle) { return (cycle.ordered_w > 0) - (cycle.ordered_w < 0); }

void add_cycle(const LoggedCycle& c, LoggedDay& day) {
  ++day.cycles;
  day.driven_cycles += c.is_driven ? 1 : 0;
  if (c.reason != "student") ++day.stopped[c.reason];
  if (!c.has_reading) return;
  if (!day.has_reading) day.soc_start_frac = c.soc_frac;
  day.soc_end_frac = c.soc_frac;
  day.has_reading = true;
}

std::int32_t day_of(const std::string& text, const char* option, std::int32_t otherwise) {
  if (text.empty()) return otherwise;
  const auto [year, month, day] = parse_local_date(text, option);
  return (year * 100 + month) * 100 + day;
}

void report_log(const std::string& file, const CycleLog& log, const std::vector<LoggedDay>& days) {
  int missing = 0;
  for (const LoggedDay& day : days) missing += day.missing;
  const auto report_count = [&](int count, const char* noun, const char* what) {
    if (count == 0) return;
    fmt::print(stderr, "{}: {} {}\n", file, counted(static_cast<std::size_t>(count), noun), what);
  };
  report_count(log.torn, "last line", "without a line end: ignored");
  report_count(log.duplicates, "row", "with a duplicate time: ignored");
  report_count(missing, "tick", "without a row: energy estimated from the state of charge");
}

NamedEvaluation run(const std::string& name, const ReadLog& read, double soc_frac, Policy& policy,
                    ContextKind context) {
  const MarketSteps market = market_of_log(read.log, read.prices, read.span, context);
  return {name,
          {},
          evaluate(market, market.days, policy, {read.battery, soc_frac, true}),
          policy.description()};
}

NamedEvaluation run_named(const std::string& name, const ReadLog& read, double soc_frac) {
  const Baseline* baseline = find_baseline(name);
  if (baseline != nullptr && baseline->is_for(kFitted)) {
    fail("--policy {} needs fitting: use bess-train evaluate on the prices of these days", name);
  }
  if (const auto policy = make_baseline(name, {}, read.battery)) {
    return run(name, read, soc_frac, *policy, ContextKind::kLevel);
  }
  const StudentFile student = student_for_log(name);
  return run(name, read, soc_frac, *exported_policy(student), student.net.context.kind);
}

std::size_t index(Action action) { return static_cast<std::size_t>(action); }

void compare(const LoggedCycle& c, Action now, double cycle_mwh, ReplayedDay& day,
             LogReplay& replay) {
  ++day.compared;
  ++replay.decisions[index(*c.student)][index(now)];
  if (*c.student == now) return;
  replay.others.push_back({c.utc_s, c.decided_eur_per_mwh, c.soc_frac, *c.student, now});
  const double more_mwh = (power_sign(now) - power_sign(*c.student)) * cycle_mwh;
  ++day.differing;
  day.mwh_moved += more_mwh;
  day.gained_eur -= more_mwh * c.price_eur_per_mwh;
}

std::vector<std::string> day_row(const std::string& name, const ExchangedDay& day) {
  const QuarterHourMoney& money = day.money;
  return {name,
          fmt::format("{:.3f}", day.charged_wh / 1'000),
          fmt::format("{:.3f}", day.discharged_wh / 1'000),
          fmt::format("{:.2f}", money.earned_eur),
          fmt::format("{:.2f}", money.contract_eur),
          fmt::format("{:.2f}", money.net_eur()),
          fmt::format("{} / {} / {}", money.quarter_hours, money.published, money.validated)};
}

std::string notes(const ExchangedDay& all, double stored_kwh) {
  const QuarterHourMoney& money = all.money;
  std::string text = fmt::format(
      "<p>{} of {} quarter-hours have their settled price, {} of them validated; the others have "
      "the last price of their minutes",
      money.published, money.quarter_hours, money.validated);
  if (money.unpriced > 0) text += fmt::format(", and {} have none", money.unpriced);
  return text +
         fmt::format(
             ": {:.2f} EUR is an estimate. Before validation a settled price may still change. "
             "Unmetered energy (estimated from the SoC): {:.3f} kWh. Change of the stored energy: "
             "{:.3f} kWh. Taxes are included only as [costs] of the configuration contains "
             "them.</p>\n",
             money.estimated_eur, all.unseen_wh / 1'000, stored_kwh);
}

std::string contract_table(const BatteryParameters& battery) {
  const TradingCosts& costs = battery.costs;
  const auto eur = [](double value) { return fmt::format("{:g} EUR per MWh traded", value); };
  const auto percent = [](double value) { return fmt::format("{:g} %", value); };
  return format_table({"Contract terms in addition to the price",
                       {"Term", "Value"},
                       {{"surcharge on imports", eur(costs.import_adder_eur_per_mwh)},
                        {"surcharge, of the absolute price", percent(costs.import_percent)},
                        {"fee on exports", eur(costs.export_fee_eur_per_mwh)},
                        {"fee, of the absolute price", percent(costs.export_percent)},
                        {"wear, imports and exports", eur(battery.wear_eur_per_mwh)}}});
}

}  // namespace

std::vector<SettledQuarter> read_settled(const std::string& path) {
  std::vector<SettledQuarter> settled;
  if (path.empty()) return settled;
  const CsvTable table = CsvTable::read(path);
  const std::size_t start = table.column("quarter_hour_utc");
  const std::size_t price = table.column("eur_per_mwh"), state = table.column("state");
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const bool is_validated = table.text(row, state) == "validated";
    const std::int64_t utc_s = table.utc_s(row, start);
    if (utc_s % kSecondsPerQuarterHour != 0) {
      fail("{}:{}: quarter_hour_utc {} is not the start of a quarter-hour", path, table.line(row),
           table.text(row, start));
    }
    if (!is_validated && table.text(row, state) != "published") {
      fail("{}:{}: state \"{}\": expected published or validated", path, table.line(row),
           table.text(row, state));
    }
    settled.push_back({utc_s, table.number(row, price),
                       is_validated ? PriceState::kValidated : PriceState::kPublished});
  }
  return settled;
}

QuarterPrices prices_of(const CycleLog& log, const std::vector<SettledQuarter>& settled) {
  QuarterPrices prices(settled);
  for (const LoggedCycle& c : log.cycles) {
    if (c.has_price) prices.note(c.utc_s, c.price_minute_utc_s, c.price_eur_per_mwh);
  }
  return prices;
}

std::vector<LoggedDay> days_of(const CycleLog& log, const QuarterPrices& prices,
                               const BatteryParameters& battery, const LoggedSpan& span) {
  const auto exchanged = exchanged_days(samples_of(log, battery), prices, battery);
  std::map<std::int32_t, LoggedDay> days;
  const LoggedCycle* before = nullptr;
  for (const LoggedCycle& c : log.cycles) {
    const std::int32_t date = local_day_at(c.utc_s);
    if (!c.is_cycle || !span.holds(date)) continue;
    LoggedDay& day = days[date];
    add_cycle(c, day);
    if (before != nullptr) {
      if (direction(*before) != direction(c)) ++day.switches;
      const std::int64_t apart_s = c.utc_s - before->utc_s;
      day.missing += static_cast<int>(std::max<std::int64_t>(apart_s / kSecondsPerStep, 1)) - 1;
    }
    before = &c;
  }
  std::vector<LoggedDay> all;
  for (auto& [date, day] : days) {
    const auto found = exchanged.find(date);
    if (found != exchanged.end()) day.exchanged = found->second;
    day.date = format_local_date(date_of(date));
    all.push_back(std::move(day));
  }
  return all;
}

Evaluation evaluation_of(const std::vector<LoggedDay>& days, const BatteryParameters& battery) {
  Evaluation evaluation;
  evaluation.capacity_mwh = battery.capacity_wh / kWattsPerMegawatt;
  evaluation.wear_eur_per_mwh = battery.wear_eur_per_mwh;
  double soc_frac = std::nan("");
  for (const LoggedDay& day : days) {
    const double throughput_mwh =
        (day.exchanged.charged_wh + day.exchanged.discharged_wh) / kWattsPerMegawatt;
    if (std::isnan(soc_frac)) soc_frac = day.soc_start_frac;
    const double end_frac = day.has_reading ? day.soc_end_frac : soc_frac;
    evaluation.days.push_back({.date = day.date,
                               .profit_eur = day.exchanged.money.net_eur(),
                               .cycles = throughput_mwh / (2 * evaluation.capacity_mwh),
                               .switches = day.switches,
                               .soc_end_frac = end_frac,
                               .throughput_mwh = throughput_mwh,
                               .soc_start_frac = soc_frac});
    soc_frac = end_frac;  // the next day starts at this SoC
  }
  return evaluation;
}

MarketStep step_of(const LoggedCycle& cycle, ContextKind context) {
  const LocalMinute local = local_minute_of(cycle.utc_s);
  const bool by_outlook = context == ContextKind::kOutlook && cycle.break_even_centi;
  return {
      .utc_s = cycle.utc_s,
      .observed_eur_per_mwh = cycle.decided_eur_per_mwh,
      .paid_eur_per_mwh = 0,
      .level_centi_eur_per_mwh = by_outlook ? *cycle.break_even_centi : cycle.level_centi,
      .observed_age_min = static_cast<std::int16_t>((cycle.utc_s - cycle.price_minute_utc_s) / 60),
      .minute_of_quarter_hour = static_cast<std::int8_t>(local.minute_of_quarter_hour),
      .quarter_hour = static_cast<std::int8_t>(local.quarter_hour),
      .month = static_cast<std::int8_t>(local.month),
      .half_hour_phase = static_cast<std::int8_t>(local.minute_of_day % 30 / kMinutesPerStep)};
}

MarketSteps market_of_log(const CycleLog& log, const QuarterPrices& prices, const LoggedSpan& span,
                          ContextKind context) {
  MarketSteps market;
  std::int32_t today = 0;
  for (const LoggedCycle& c : log.cycles) {
    const std::int32_t date = local_day_at(c.utc_s);
    if (!c.is_cycle || !span.holds(date)) continue;
    if (date != today) {
      const auto [year, month, day] = date_of(date);
      market.days.push_back({year, month, day, Split::kAll, market.steps.size(), 0});
    }
    today = date;
    const auto first = prices.find(c.utc_s);
    if (!c.has_price || !c.is_price_usable || !first) continue;
    // The log may end before the quarter-hour of the second minute.
    const auto second = prices.find(c.utc_s + 60);
    market.steps.push_back(step_of(c, context));
    market.steps.back().paid_eur_per_mwh =
        0.5 * (first->eur_per_mwh + second.value_or(*first).eur_per_mwh);
    ++market.days.back().step_count;
  }
  return market;
}

double most_ordered_w(const CycleLog& log) {
  double most_w = 0;
  for (const LoggedCycle& c : log.cycles) most_w = std::max(most_w, std::fabs(c.ordered_w));
  return most_w;
}

void require_same_battery(const CycleLog& log, const BatteryParameters& battery,
                          const std::string& config) {
  const double most_w = most_ordered_w(log);
  if (most_w == 0 || (most_w <= battery.power_w_max && most_w >= battery.power_w_max / 20)) return;
  fail(
      "orders in the log reach {:g} W, but [battery] power_w of {} is {:g}: name the "
      "configuration of this battery with --config",
      most_w, config.empty() ? "the defaults" : config, battery.power_w_max);
}

void LogInput::add(ProgramCommand& command, bool counts_money) {
  counts_money_ = counts_money;
  command
      .option("files", files_,
              "controller logs (bess-edge log --csv or [log] csv); several are joined")
      .value_name("FILE")
      .required();
  command.option("--from", from_, "first local day, YYYY-MM-DD (default: first of the log)");
  command.option("--to", to_, "last local day, YYYY-MM-DD (default: last of the log)");
  if (!counts_money) return;
  command.option("--settled", settled_,
                 "settled.csv of bess-prices (default: estimate from the last minute's price)");
  command.option("--config", config_,
                 "configuration (TOML) with [battery] and [costs] of this battery");
}

ReadLog LogInput::read() const {
  const BatteryParameters battery = load_run_config(config_).battery;
  CycleLog log = read_cycle_log(files_);
  if (counts_money_) require_same_battery(log, battery, config_);
  const LoggedSpan span{day_of(from_, "--from", 0), day_of(to_, "--to", 99'999'999)};
  QuarterPrices prices = prices_of(log, read_settled(settled_));
  std::vector<LoggedDay> days = days_of(log, prices, battery, span);
  if (days.empty())
    fail("{}: the log has no control cycle on these days; change --from or --to", files_.front());
  report_log(files_.front(), log, days);
  return {std::move(log), battery, span, std::move(prices), std::move(days)};
}

void LogInput::require_not_read(const std::string& option, const std::string& output) const {
  require_distinct({{option, output}},
                   named_paths("files", files_, {{"--settled", settled_}, {"--config", config_}}));
}

StudentFile student_for_log(const std::string& name) {
  const bool is_run = std::filesystem::is_directory(name);
  StudentFile student = name == "compiled" ? compiled_student()
                                           : load_student(is_run ? name + "/student.json" : name);
  student.outlook = nullptr;
  return student;
}

std::vector<NamedEvaluation> compare_log(const ReadLog& read,
                                         const std::vector<std::string>& policies) {
  const MarketSteps market = market_of_log(read.log, read.prices, read.span, ContextKind::kLevel);
  if (market.steps.empty())
    fail("the log has no control cycle with a price on these days; change --from or --to");
  std::vector<NamedEvaluation> all{{kThisBattery, {}, evaluation_of(read.days, read.battery)}};
  const double soc_frac = all.front().carried_over.days.front().soc_start_frac;
  for (const std::string& name : policies) all.push_back(run_named(name, read, soc_frac));
  all.push_back(run_named(kForesightName, read, soc_frac));
  const double mean_eur_per_mwh = mean_settled_eur_per_mwh(market, market.days);
  for (NamedEvaluation& one : all) {
    value_charge_left(one.carried_over, read.battery, mean_eur_per_mwh);
  }
  return all;
}

NetEarnings net_earnings_of(const Evaluation& evaluation) {
  NetEarnings paid{};
  for (const DayResult& day : evaluation.days) {
    paid.paid_eur += day.profit_eur - day.charge_value_eur;
    paid.charge_eur += day.charge_value_eur;
  }
  return paid;
}

LogReplay replay_log(const CycleLog& log, const LoggedSpan& span, const StudentNet& student) {
  const double cycle_mwh = most_ordered_w(log) * kHoursPerStep / kWattsPerMegawatt;
  const ContextKind context = student.context.kind;
  const StudentPolicy policy(student);
  LogReplay replay;
  replay.student_hash = student_weights_hash(student);
  std::map<std::int32_t, ReplayedDay> days;
  for (const LoggedCycle& c : log.cycles) {
    const LocalMinute local = local_minute_of(c.utc_s);
    if (!span.holds(local_day_of(local)) || !c.has_reading || !c.has_price) continue;
    ReplayedDay& day = days[local_day_of(local)];
    day.date = format_local_date({local.year, local.month, local.day});
    day.prices_eur_per_mwh += c.price_eur_per_mwh;
    ++day.priced;
    if (!c.student) continue;
    if (context == ContextKind::kOutlook && !c.break_even_centi) {
      ++replay.without_context;
      continue;
    }
    compare(c, policy.decide(step_of(c, context), 0, c.soc_frac), cycle_mwh, day, replay);
  }
  for (auto& [date, day] : days) {
    if (day.compared == 0) continue;
    day.gained_eur += day.mwh_moved * day.prices_eur_per_mwh / day.priced;
    replay.compared += day.compared;
    replay.differing += day.differing;
    replay.gained_eur += day.gained_eur;
    replay.days.push_back(std::move(day));
  }
  if (replay.compared > 0) return replay;
  if (replay.without_context > 0) {
    fail(
        "the student decides by the outlook, but none of the {} logged decisions has one: use a "
        "log of a controller with [outlook]",
        replay.without_context);
  }
  fail("the log has no decision of a student on these days; change --from or --to");
}

std::string LogReplay::text() const {
  std::string text =
      fmt::format("student {:08x} changes {} of {} decisions ({:.2f} %), worth about {:+.2f} EUR\n",
                  student_hash, differing, compared, differing_percent(), gained_eur);
  for (const Action before : {Action::kDischarge, Action::kIdle, Action::kCharge}) {
    for (const Action now : {Action::kDischarge, Action::kIdle, Action::kCharge}) {
      const int cycles = decisions[index(before)][index(now)];
      if (before == now || cycles == 0) continue;
      text += fmt::format("{:<9} -> {:<9} {:6}\n", action_name(before), action_name(now), cycles);
    }
  }
  if (without_context > 0)
    text += fmt::format("{} control cycles without an outlook\n", without_context);
  if (differing == 0) return text;
  const ReplayedDay& worst = *std::ranges::min_element(days, {}, &ReplayedDay::gained_eur);
  return text +
         fmt::format(
             "worst day  {}: {} of {}, {:+.2f} EUR\n"
             "estimate: each decision alone, full power for two minutes, offset at the day's "
             "mean price\n",
             worst.date, worst.differing, worst.compared, worst.gained_eur);
}

Json LogReplay::json() const {
  Json json = answer("log_replay", {{"weights_hash", fmt::format("{:08x}", student_hash)},
                                    {"compared", compared},
                                    {"differing", differing},
                                    {"differing_percent", Decimals{differing_percent(), 4}},
                                    {"without_context", without_context},
                                    {"gained_eur", Decimals{gained_eur, 4}}});
  json.set("days", Json::list_from(days, [](const ReplayedDay& day) {
             return Json::object({{"date", day.date},
                                  {"compared", day.compared},
                                  {"differing", day.differing},
                                  {"gained_eur", Decimals{day.gained_eur, 4}}});
           }));
  json.set("others", Json::list_from(others, [](const ReplayedCycle& other) {
             return Json::object({{"utc", utc_text(other.utc_s).view()},
                                  {"price_eur_per_mwh", Decimals{other.price_eur_per_mwh, 2}},
                                  {"soc_percent", Decimals{100 * other.soc_frac, 2}},
                                  {"before", action_name(other.before)},
                                  {"now", action_name(other.now)}});
           }));
  return json;
}

std::string statement_page(const std::vector<LoggedDay>& days, const BatteryParameters& battery) {
  ExchangedDay all;
  std::map<std::string, int> stopped;
  HtmlTable table{"This battery by day",
                  {"Day", "Charged, kWh", "Discharged, kWh", "At quarter-hour prices, EUR",
                   "Contract, EUR", "Net, EUR", "Quarter-hours / settled / validated"},
                  {}};
  HtmlTable stops{"Control cycles not decided by the student", {"Reason", "Cycles"}, {}};
  int cycles = 0, driven = 0, missing = 0;
  for (const LoggedDay& day : days) {
    table.rows.push_back(day_row(day.date, day.exchanged));
    all.add(day.exchanged);
    cycles += day.cycles;
    driven += day.driven_cycles;
    missing += day.missing;
    for (const auto& [reason, count] : day.stopped) stopped[reason] += count;
  }
  table.rows.push_back(day_row("total", all));
  for (const auto& [reason, count] : stopped) {
    stops.rows.push_back({reason, fmt::format("{}", count)});
  }
  const Evaluation evaluation = evaluation_of(days, battery);
  const double stored_kwh =
      (evaluation.days.back().soc_end_frac - evaluation.days.front().soc_start_frac) *
      battery.capacity_wh / 1'000;
  const std::string title = fmt::format("Battery: {} to {}", days.front().date, days.back().date);
  return format_page(
      title,
      fmt::format(
          "<h1>{}</h1>\n{}{}{}<p>Controlled {:.1f} % of the time; {} ticks have no row in the "
          "log.</p>\n{}",
          title, format_table(table), notes(all, stored_kwh), contract_table(battery),
          100.0 * driven / (cycles + missing), missing,
          stops.rows.empty() ? "" : format_table(stops)));
}

}  // namespace bess
