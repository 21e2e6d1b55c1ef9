#include "workstation/runs/run/run_report.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>

#include "shared/host/embed/build_info.h"
#include "shared/host/file.h"
#include "shared/host/run_program.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "workstation/base/answer.h"
#include "workstation/correction/rules/rule.h"
#include "workstation/correction/rules/ruled_policy.h"
#include "workstation/correction/student/certificate.h"
#include "workstation/correction/student/prove.h"
#include "workstation/correction/student/student_policy.h"
#include "workstation/data/env/day_errors.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/report/figures/html.h"
#include "workstation/report/headline.h"
#include "workstation/report/page_data.h"
#include "workstation/report/report_tables.h"
#include "workstation/runs/chain/run_config.h"
#include "workstation/runs/run/run_backtest.h"

namespace bess {

namespace {

namespace fs = std::filesystem;

/// Command line of this process.
std::string command_line() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::string line;
  for (std::string word; std::getline(file, word, '\0');) {
    line += line.empty() ? shell_word(fs::path(word).filename().string()) : ' ' + shell_word(word);
  }
  return line;
}

std::string host_name() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

/// Last part of the path; a proposal will replace its run.
std::string run_name(const RunFolder& folder) {
  const fs::path path = fs::absolute(folder.path / "").lexically_normal().parent_path();
  return path.extension() == ".proposal" ? path.stem().string() : path.filename().string();
}

/// "teacher 12.1 s, ..." of times.json; empty without one.
std::string stage_times(const fs::path& path) {
  std::string text;
  if (!fs::exists(path)) return text;
  const Json times = Json::parse(read_file(path));
  for (const JsonValue stage : times.value()) {
    const auto seconds = stage["seconds"].number();
    if (!seconds) continue;
    text += fmt::format("{}{} {:.1f} s", text.empty() ? "" : ", ", stage.key(), *seconds);
  }
  return text;
}

/// The file and its mark.
std::string prices_text(const RunFolder& folder) {
  const Json run = Json::parse(read_file(folder.path / "run.json"));
  const fs::path named = run.value()["prices"].text_or("");
  const fs::path path = named.has_parent_path() ? named : folder.path / named;
  if (named.empty()) return "not in run.json";
  const std::string mark = file_mark(path);
  if (mark.empty()) return named.string() + ": missing";
  return path.filename().string() + ": " + mark;
}

std::string span_text(const MarketSteps& market) {
  const auto days = [&](Split split) { return market.days_of(split).size(); };
  return fmt::format("{} to {}: {} training, {} validation and {} test days",
                     market.days.front().date(), market.days.back().date(), days(Split::kTrain),
                     days(Split::kValidation), days(Split::kTest));
}

/// Date, run, host, command and times; with SOURCE_DATE_EPOCH only the date.
Entries making_facts(const RunFolder& folder) {
  Entries facts;
  if (const char* epoch = std::getenv("SOURCE_DATE_EPOCH")) {
    facts.emplace_back("date", std::string(utc_text(std::strtoll(epoch, nullptr, 10)).view()));
    return facts;
  }
  facts.emplace_back("date", std::string(utc_text(std::time(nullptr)).view()));
  facts.emplace_back("run", run_name(folder));
  facts.emplace_back("host", host_name());
  facts.emplace_back("command", command_line());
  facts.emplace_back("CPU time", fmt::format("{:.1f} s, this command until here",
                                             static_cast<double>(std::clock()) / CLOCKS_PER_SEC));
  const std::string times = stage_times(folder.path / "times.json");
  if (!times.empty()) facts.emplace_back("stages", times);
  return facts;
}

const NamedEvaluation& exported(const RunSummary& run) {
  const NamedEvaluation* found = find_evaluation(run.evaluations, kCorrectedName);
  if (found == nullptr) {
    fail("{}: \"{}\" is missing; repeat the run", run.folder.file(run_file::kDays).string(),
         kCorrectedName);
  }
  return *found;
}

/// "KEY: A | B | C" for each of them.
std::string what_differs(const std::vector<RunSummary>& runs) {
  std::string text;
  for (const std::string& key : differing_keys(runs)) {
    std::string line;
    for (const RunSummary& run : runs) {
      line += fmt::format("{}{}", line.empty() ? "" : " | ", value_text(run.record, key));
    }
    text += fmt::format("{}: {}\n", key, line);
  }
  return text;
}

/// Refuses results that were edited after the run.
void require_unchanged(const RunRecord& record, const RunFolder& folder) {
  for (const StageRecord& stage : record.stages) {
    for (const auto& [file, mark] : stage.outputs) {
      if (file != run_file::kDays) continue;
      const std::string now = file_mark(folder.file(run_file::kDays));
      if (now == mark) return;
      fail(
          "{}: changed since the run ({} in {}, now {}); regenerate it with 'bess-train report "
          "--run {}'",
          folder.file(run_file::kDays).string(), mark, run_file::kRecord,
          now.empty() ? "missing" : now, folder.path.string());
    }
  }
}

JudgedDays judged_days_of(const RunSummary& run) {
  JudgedDays judged{Split::kTest, {}, run.record.figures->last_learnt_day};
  for (const DayResult& day : exported(run).carried_over.days) judged.dates.push_back(day.date);
  return judged;
}

/// Evaluation days, and the walk-forward result of each run that has one.
std::string standing_text(const std::vector<RunSummary>& runs) {
  std::string text = "\n";
  std::string last;
  for (const RunSummary& run : runs) {
    const std::string judged = judged_days_text(judged_days_of(run));
    if (judged != last) text += judged + "\n";
    last = judged;
  }
  bool any = false;
  for (const RunSummary& run : runs) {
    const WalkForwardOfRun walk = walk_forward_of(run.folder, run.record);
    if (!walk.figure) continue;
    text += fmt::format("{}: {}\n", run.folder.path.string(), walk_forward_text(walk));
    any = true;
  }
  const RunSummary& first = runs.front();
  if (any) return text;
  return with_run_folder(
      text + walk_forward_text(walk_forward_of(first.folder, first.record)) + "\n",
      first.folder.path);
}

std::size_t rules_of(const RunSummary& run) {
  const std::string rules = run.record.value(kRulesKey);
  return rules.empty() ? 0 : parse_rules(rules, "run.json: rules").rules.size();
}

NamedEvaluation evaluate_both(const std::string& name, Policy& policy, const RunResults& run) {
  const std::vector<MarketDay> days = run.market.days_of(Split::kTest);
  return {name, evaluate(run.market, days, policy, {run.battery, run.initial_soc_frac, false}),
          evaluate_carried_over(run.market, days, policy, run.battery, run.initial_soc_frac)};
}

/// Violations before and after the correction, by property and rule.
std::string violations_text(const Certificate& plain, const Certificate& corrected) {
  const auto properties = [](const Certificate& c) {
    return fmt::format("{} / {} / {} in {} states", c.violations_of(1), c.violations_of(2),
                       c.violations_of(3), c.states_checked);
  };
  const std::string before_head = fmt::format("before correction ({})", kPlainName);
  const std::string after_head = fmt::format("after correction ({})", own_student_name(corrected));
  const auto lines = [&](const std::string& of_plain, const std::string& of_corrected) {
    return fmt::format("  {:<36} {}\n  {:<36} {}\n", before_head, of_plain, after_head,
                       of_corrected);
  };
  std::string text =
      "\nviolations of properties 1 / 2 / 3\n" + lines(properties(plain), properties(corrected));
  const std::vector<DemandCount> before = demand_counts(plain);
  const std::vector<DemandCount> after = demand_counts(corrected);
  for (std::size_t d = kPropertyCount; d < after.size(); ++d) {
    text += fmt::format("violations of rule \"{}\" ({})\n", after[d].name, after[d].text);
    if (!after[d].binds_student) {
      text += "  enforced by the guard only\n";
      continue;
    }
    const auto counted = [](const DemandCount& count) {
      return fmt::format("{} in {} states", count.violations, count.states);
    };
    text += lines(counted(before[d]), counted(after[d]));
  }
  return text;
}

/// Plain student, also under each rule.
void evaluate_plain(const RunResults& run, std::vector<NamedEvaluation>& all) {
  const auto plain = std::make_shared<StudentPolicy>(run.plain->net, run.plain->outlook);
  all.push_back(evaluate_both(kPlainName, *plain, run));
  const auto under = [&](const std::string& name, const RuleSet& rules) {
    RuledPolicy ruled(plain, rules, run.plain->net.context);
    all.push_back(evaluate_both(name, ruled, run));
  };
  const RuleSet projected = projected_rules(run.corrected.certificate.rules);
  for (const Rule& rule : projected.rules) under(under_rule_name(rule.name), {{rule}});
  if (!projected.empty()) under(kUnderAllRules, projected);
}

/// Expected full cycles, with the keys that limit them for a warranty.
std::string cycles_text(const StudentFile& student) {
  if (!student.cycles_per_day) return {};
  return fmt::format(
      "expect about {:.1f} full cycles a day (validation days); limit them with [battery] "
      "wear_eur_per_mwh or cycles_per_day_max\n",
      *student.cycles_per_day);
}

namespace fs = std::filesystem;

Cell run_cell(const RunSummary& run, const fs::path& page) {
  const std::string name = run.folder.path.string();
  const fs::path report = run.folder.file(run_file::kReport);
  if (!fs::exists(report)) return text_cell(name);
  const fs::path from = fs::absolute(page).parent_path();
  const fs::path link = fs::absolute(report).lexically_relative(from);
  return {fmt::format("<a href=\"{}\">{}</a>", html_escaped(link.string()), html_escaped(name)),
          name};
}

/// Remaining violations after the last round of a failed proof.
std::string left_text(const RunSummary& run) {
  const std::string rounds = run.folder.file(run_file::kProofRounds).string();
  if (!fs::exists(rounds)) return {};
  const auto parsed = parse_proof_rounds_csv(read_file(rounds), rounds);
  return parsed.empty() ? std::string() : ": " + parsed.back().text();
}

Cell proof_cell(const RunSummary& run) {
  if (run.record.has_failed()) return text_cell("not proved" + left_text(run));
  if (!run.record.figures) return no_text_cell();
  const RunFigures& figures = *run.record.figures;
  if (figures.violations_corrected != 0) {
    return text_cell(fmt::format("{} violations", grouped(figures.violations_corrected)));
  }
  return text_cell(fmt::format("proved in {} states", grouped(figures.states_checked)));
}

const Evaluation* exported_days(const RunSummary& run, EvaluationField field) {
  const NamedEvaluation* found = find_evaluation(run.evaluations, kCorrectedName);
  return found == nullptr ? nullptr : &(found->*field);
}

/// Gain over the first finished run with the same days.
Cell gain_cell(const Evaluation& days, const Evaluation& first) {
  const auto gain = &days == &first ? std::nullopt : gain_over_run(days, first);
  if (!gain) return {kNoValue};
  return number_cell(
      fmt::format("{:+.1f} \u00b1 {} ({})", gain->mean, error_text(gain->errors.plain, 1, kNoValue),
                  error_text(gain->errors.by_month, 1, kNoValue)),
      gain->mean);
}

std::vector<Cell> figure_cells(const RunSummary& run, const Evaluation* first) {
  const Evaluation* carried = exported_days(run, &NamedEvaluation::carried_over);
  if (carried == nullptr || carried->days.empty()) return std::vector<Cell>(7, Cell{kNoValue});
  const auto rows = comparison_rows(run.evaluations, &NamedEvaluation::carried_over);
  const auto row = std::ranges::find(rows, kCorrectedName, &ComparisonRow::name);
  const double reset =
      exported_days(run, &NamedEvaluation::day_reset)->profit_eur_per_day_per_mwh();
  return {number_cell(static_cast<double>(row->days), 0),
          number_cell(fmt::format("{:.1f} \u00b1 {} ({})", row->profit,
                                  error_text(row->errors.plain, 1, kNoValue),
                                  error_text(row->errors.by_month, 1, kNoValue)),
                      row->profit),
          gain_cell(*carried, *first),
          number_cell(row->profit * carried->capacity_mwh, 1),
          number_cell(row->profit_at_reference_wear, 1),
          number_cell(100 * row->foresight_share.value_or(std::nan("")), 1),
          number_cell(reset, 1)};
}

SortTable run_table(const std::vector<RunSummary>& runs, const fs::path& page) {
  SortTable table{"runs",
                  fmt::format("Profit of the {} of each run on its test days", kCorrectedName),
                  {"Run", "State", "Proof", "Rules", "Seed", "Days", "Carried over, EUR/day/MWh",
                   "Gain, EUR/day/MWh", "EUR of this battery per day", "At wear 10, EUR/day/MWh",
                   "% of foresight", "Same charge each day, EUR/day/MWh", "Weights"},
                  {}};
  const Evaluation* first = nullptr;
  for (const RunSummary& run : runs) {
    if (first == nullptr) first = exported_days(run, &NamedEvaluation::carried_over);
  }
  for (const RunSummary& run : runs) {
    const std::string seed = run.record.value("seed");
    const std::string rules = value_text(run.record, kRulesKey);
    std::vector<Cell> row{run_cell(run, page),
                          text_cell(run.trouble.empty() ? run.record.state() : run.trouble),
                          proof_cell(run),
                          text_cell(rules),
                          {html_escaped(seed), seed}};
    std::ranges::move(figure_cells(run, first), std::back_inserter(row));
    row.push_back(run.record.figures ? text_cell(run.record.figures->weights_hash)
                                     : no_text_cell());
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// One column for each key with different values.
SortTable settings_table(const std::vector<RunSummary>& runs) {
  SortTable table{"settings", "Different settings", {"Run"}, {}};
  const std::vector<std::string> keys = differing_keys(runs);
  table.header.insert(table.header.end(), keys.begin(), keys.end());
  for (const RunSummary& run : runs) {
    std::vector<Cell> row{text_cell(run.folder.path.string())};
    for (const std::string& key : keys) row.push_back(text_cell(value_text(run.record, key)));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::string program_text() { return fmt::format("bess-train {}, {}", BESS_VERSION, build_line()); }

Entries run_facts(const RunConfig& config, const MarketSteps& market, const RunFolder& folder) {
  Entries facts = making_facts(folder);
  const auto delay_min = static_cast<std::size_t>(config.market.observation_delay_min);
  facts.insert(facts.end(),
               {{"program", program_text()},
                {"prices", prices_text(folder)},
                {"span", span_text(market)},
                {"observation delay", counted(delay_min, "minute")},
                {"settlement", config.market.settlement == Settlement::kMinute
                                   ? "per minute, by its quarter-hour"
                                   : "per step, by the quarter-hour in which it starts"},
                {"keys changed", changed_keys_text(config)},
                {"seed, threads", fmt::format("{}, {}", config.train.seed, config.train.threads)}});
  return facts;
}

std::string value_text(const RunRecord& record, const std::string& key) {
  const std::string value = record.value(key);
  if (key != kRulesKey) return value.empty() ? "unknown" : one_line(value);
  if (value.empty()) return "none";
  std::string text;
  for (const Rule& rule : parse_rules(value, "run.json: rules").rules) {
    text += fmt::format("{}\"{}\" ({}{})", text.empty() ? "" : "; ", rule.name, rule.text(),
                        rule.enforce ? "; also by the guard" : "");
  }
  return text;
}

std::vector<std::string> differing_keys(const std::vector<RunSummary>& runs) {
  std::vector<std::string> keys;
  for (const RunSummary& run : runs) {
    for (const auto& entry : run.record.identity) {
      const std::string& key = entry.first;
      const bool is_same = std::ranges::all_of(
          runs, [&](const RunSummary& other) { return other.record.value(key) == entry.second; });
      if (!is_same && std::ranges::find(keys, key) == keys.end()) keys.push_back(key);
    }
  }
  return keys;
}

RunSummary load_run_summary(const RunFolder& folder) {
  RunRecord record = existing_run_record(folder);
  const std::string name = folder.path.string();
  if (!record.figures && record.has_failed()) {
    fail(
        "{}: ended without a proof, see {}; repeat the correction with 'bess-train run "
        "--from-teacher {} --config NEW --out ANOTHER'",
        name, folder.file(run_file::kReport).string(), name);
  }
  if (!record.figures) {
    fail("{}: not finished, {}; continue with 'bess-train run --resume --out {}'", name,
         record.state(), name);
  }
  require_unchanged(record, folder);
  const std::string days = folder.file(run_file::kDays).string();
  const RunConfig config = record.config(folder);
  return {folder, std::move(record),
          parse_evaluation_days_csv(read_file(days), days, config.battery)};
}

Json summary_json(const RunSummary& run) {
  const RunRecord& record = run.record;
  Json json = answer("run");
  json.set("run", run.folder.path.string());
  json.set("prices", record.prices);
  json.set("seed", record.config(run.folder).train.seed);
  add_figures(*record.figures, json);
  const auto prices = rule_prices_of(run.evaluations);
  json.set("price_of_correction", prices ? rule_prices_table(*prices).json() : Json::null());
  const auto headline = headline_of(run.evaluations);
  json.set("headline", headline ? headline_json(*headline) : Json::null());
  json.set("judged_days", judged_days_json(judged_days_of(run)));
  const WalkForwardOfRun walk = walk_forward_of(run.folder, record);
  json.set("walk_forward", walk.figure ? walk_forward_json(*walk.figure) : Json::null());
  Json policies = Json::list();
  for (const auto field : {&NamedEvaluation::day_reset, &NamedEvaluation::carried_over}) {
    for (const ComparisonRow& row : comparison_rows(run.evaluations, field)) {
      Json policy = Json::object({{"policy", row.name}, {key::kCarrySoc, row.carry_soc}});
      add_figures(row, policy);
      policies.add(std::move(policy));
    }
  }
  json.set("policies", std::move(policies));
  return json;
}

std::optional<PairedDifference> gain_over_run(const Evaluation& run, const Evaluation& first) {
  if (!std::ranges::equal(run.days, first.days, {}, &DayResult::date, &DayResult::date)) return {};
  return paired_difference(run, first);
}

std::string format_runs_table(const std::vector<RunSummary>& runs) {
  std::size_t width = 3;
  for (const RunSummary& run : runs) width = std::max(width, run.folder.path.string().size());
  std::string text = fmt::format(
      "Profit of the {} of each run on its test days, EUR per day per MWh of capacity\n"
      "{:<{}} {:>5} {:>5} {:>5} {:>8} {:>6} {:>8} {:>8} {:>6} {:>8} {:>11} {:>9} {:>8} {:>9}\n",
      kCorrectedName, "run", width, "seed", "rules", "days", "carried", "s.e.", "by month", "gain",
      "s.e.", "by month", kReferenceWearHead, "foresight", "reset", "weights");
  const Evaluation& first = exported(runs.front()).carried_over;
  for (const RunSummary& run : runs) {
    const NamedEvaluation& student = exported(run);
    const auto rows = comparison_rows(run.evaluations, &NamedEvaluation::carried_over);
    const auto row = std::ranges::find(rows, kCorrectedName, &ComparisonRow::name);
    const auto over_first =
        &run == &runs.front() ? std::nullopt : gain_over_run(student.carried_over, first);
    text += fmt::format(
        "{:<{}} {:>5} {:>5} {:>5} {:>8.1f} {:>6} {:>8} {:>8} {:>6} {:>8} {:>11.1f} {:>9} {:>8.1f} "
        "{:>9}\n",
        run.folder.path.string(), width, run.record.value("seed"), rules_of(run), row->days,
        row->profit, error_text(row->errors.plain, 1), error_text(row->errors.by_month, 1),
        over_first ? fmt::format("{:+.1f}", over_first->mean) : "-",
        over_first ? error_text(over_first->errors.plain, 1) : "-",
        over_first ? error_text(over_first->errors.by_month, 1) : "-",
        row->profit_at_reference_wear,
        row->foresight_share ? fmt::format("{:.1f}", 100 * *row->foresight_share) : "-",
        student.day_reset.profit_eur_per_day_per_mwh(), run.record.figures->weights_hash);
  }
  text += fmt::format(
      "\ncarried, reset: SoC carried over from day to day, or the same at the start of each day;\n"
      "gain: mean day-by-day difference to the first run with the same days; s.e.: its "
      "standard error;\nby month: {}\n",
      by_month_meaning(first.errors().months));
  text += standing_text(runs);
  const std::string differs = runs.size() > 1 ? what_differs(runs) : "";
  if (!differs.empty()) text += "\nDifferent settings\n" + differs;
  return text;
}

void require_test_days(const MarketSteps& market, const std::string& prices) {
  if (!market.days_of(Split::kTest).empty()) return;
  fail("{}: no test days (local days 26 to the end); add prices", prices);
}

std::vector<NamedEvaluation> evaluate_run(const RunResults& run, int threads) {
  std::vector<NamedEvaluation> all;
  const auto baseline = [&](const std::string& name) {
    const auto policy = make_baseline(name, run.market, run.battery);
    all.push_back(evaluate_both(name, *policy, run));
  };
  for (const std::string& name : baseline_names(kInRuns)) {
    if (name != kForesightName) baseline(name);
  }
  if (run.teacher.outlook) {  // the same plans for both accountings
    const std::vector<MarketDay> days = run.market.days_of(Split::kTest);
    run.teacher.outlook->prepare(run.market, days, threads);
    run.teacher.plan_cache->prepare(run.market, days, threads);
    OutlookPolicy program(run.teacher.outlook);
    all.push_back(evaluate_both(kOutlookProgramName, program, run));
  }
  TeacherPolicy teacher(run.teacher);
  all.push_back(evaluate_both(teacher_name(run.teacher), teacher, run));
  if (run.plain) evaluate_plain(run, all);
  all.push_back(evaluate_both(own_student_name(run.corrected.certificate),
                              *exported_policy(run.corrected), run));
  baseline(kForesightName);
  return all;
}

std::vector<std::string> write_run_report(RunResults run, const RunConfig& config,
                                          const RunFolder& folder) {
  const std::vector<NamedEvaluation>& evaluations = run.evaluations;
  run.broken = broken_demands(run.corrected, config.distil.method);
  run.facts = run_facts(config, run.market, folder);
  std::vector<std::string> names = write_report(run, folder.path);
  const Certificate& certificate = run.corrected.certificate;
  const std::string alike = same_program_text(evaluations);
  std::string summary = certificate.violations() == 0 ? "" : proof_sentence(certificate) + "\n\n";
  if (const auto headline = headline_of(evaluations)) {
    summary += headline_text(*headline) + judged_days_text(judged_days(run.market, Split::kTest)) +
               "\n" + walk_forward_text(run.walk_forward) + "\n\n" + gains_text(*headline) + "\n";
  }
  summary += format_comparison_table(evaluations) + (alike.empty() ? "" : alike + "\n") +
             whole_battery_text(evaluations) + cycles_text(run.corrected) +
             violations_text(run.plain->certificate, certificate);
  if (const auto prices = rule_prices_of(evaluations)) {
    summary += '\n';
    summary += rule_prices_text(*prices);
  }
  write_file(folder.file(run_file::kSummary), summary);
  names.emplace_back(run_file::kSummary);
  std::ranges::sort(names);
  return names;
}

RunSummary load_any_run(const RunFolder& folder) {
  RunSummary run{folder, existing_run_record(folder), {}};
  if (!run.record.figures) return run;
  try {
    return load_run_summary(folder);
  } catch (const UserError& error) {
    run.trouble = one_line(error.what());
  }
  return run;
}

std::string runs_page(const std::vector<RunSummary>& runs, const fs::path& page) {
  const std::string title = counted(runs.size(), "run");
  const SortTable settings = settings_table(runs);
  const std::string differ = settings.header.size() > 1
                                 ? sort_table_html(settings)
                                 : "<p class=\"note\">All settings are equal.</p>\n";
  return format_page(
      title,
      fmt::format(
          "<h1>{}</h1>\n{}<p class=\"note\">EUR/day/MWh: EUR per day per MWh of capacity, \u00b1 "
          "standard error (in brackets: by month). Carried over: the SoC is carried from day to "
          "day. Gain: mean day-by-day difference to the first finished run "
          "with the same days. Click a column head to sort, again to reverse; unknown values come "
          "last.</p>\n{}<script>\n{}</script>\n",
          title, sort_table_html(run_table(runs, page)), differ, page_file("sort.js")));
}

}  // namespace bess
