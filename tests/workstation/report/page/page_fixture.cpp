// page_fixture FOLDER: the pages that bess-train writes, of small runs, and beside each report.html
// an expected.json: what the C++ says about the same students, days and rules. page_test.py and
// pages_test.py open them and compare.
//   FOLDER          a run
//   FOLDER/ruled    a run with rules, proved
//   FOLDER/failed   a run with rules that its student does not obey
//   FOLDER/backtest a walk-forward backtest, with its JSON
//   FOLDER/many     the folders of many runs, without their page (many_runs.h)
#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <random>
#include <stdexcept>

#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/local_time.h"
#include "tests/workstation/report/page/many_runs.h"
#include "tests/workstation/report/report_test_support.h"
#include "workstation/chain/policy_factory.h"
#include "workstation/report/backtest_report.h"
#include "workstation/report/evaluation_days.h"
#include "workstation/report/figures/curves.h"
#include "workstation/report/figures/policy_map.h"
#include "workstation/report/headline.h"
#include "workstation/report/rule_prices.h"
#include "workstation/report/shown_policies.h"
#include "workstation/rules/rule_file.h"
#include "workstation/rules/ruled_policy.h"
#include "workstation/student/exported_policy.h"
#include "workstation/student/student_policy.h"
#include "workstation/student/verify.h"

namespace bess {
namespace {

constexpr int kStatesPerStudent = 4000;
constexpr std::size_t kCounterexamples = 25;
constexpr int kRowsSearched = 100;
constexpr PolicyContext kMaps[] = {{1, 0, 0}, {12, 95, 14}, {6, 48, 7}};

LatticeState random_state(std::mt19937& random) {
  const auto draw = [&](int low, int high) {
    return static_cast<std::int16_t>(std::uniform_int_distribution(low, high)(random));
  };
  return {.minute_of_quarter_hour = draw(0, kMinuteOfQuarterHourCount - 1),
          .quarter_hour = draw(0, kQuarterHourCount - 1),
          .context_class = draw(1, kContextClassCount),
          .soc_index = draw(0, kSocCount - 1),
          .price_eur_per_mwh = draw(kLatticePriceMinEurPerMwh, kLatticePriceMaxEurPerMwh)};
}

/// [minute, quarter-hour, class, SoC index, price, three logits, action]
Json answer_of(const StudentNet& net, const LatticeState& s) {
  std::int16_t x[kStudentInputs];
  std::int32_t z[kActionCount];
  net.quantise(s, x);
  net.propagate(x, z);
  const std::int32_t numbers[] = {s.minute_of_quarter_hour,
                                  s.quarter_hour,
                                  s.context_class,
                                  s.soc_index,
                                  s.price_eur_per_mwh,
                                  z[0],
                                  z[1],
                                  z[2],
                                  static_cast<std::int32_t>(argmax_action(z))};
  return std::span(numbers);
}

Json answers_of(const StudentNet& net) {
  std::mt19937 random(1);
  Json answers = Json::list();
  for (int i = 0; i < kStatesPerStudent; ++i) answers.add(answer_of(net, random_state(random)));
  return answers;
}

/// Neighbours at which the action increases with price or with SoC.
std::int64_t wrong_pairs_of(const ActionGrid& grid) {
  std::int64_t pairs = 0;
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    if (cell + kPriceCount < grid.size() && grid[cell + kPriceCount] > grid[cell]) ++pairs;
    if ((cell + 1) % kPriceCount != 0 && grid[cell + 1] > grid[cell]) ++pairs;
  }
  return pairs;
}

/// One digit a cell, rows of SoC from 0 %, and how many neighbours are out of order.
Json maps_of(const StudentNet& net) {
  Json maps = Json::list();
  for (const PolicyContext& context : kMaps) {
    const ActionGrid grid = student_grid(net, context);
    std::string cells;
    for (const std::int8_t action : grid) cells += static_cast<char>('0' + action);
    maps.add(Json::object({{"context_class", context.context_class},
                           {"quarter_hour", context.quarter_hour},
                           {"minute", context.minute_of_quarter_hour},
                           {"cells", cells},
                           {"wrong_pairs", wrong_pairs_of(grid)}}));
  }
  return maps;
}

/// The compiled student with the signs of some weights turned round: no sum can leave its integers,
/// and the order is lost.
StudentNet disordered_student() {
  StudentNet net = compiled_student().net;
  std::mt19937 random(2);
  const auto turn = [&](auto& weight) {
    for (auto& row : weight) {
      for (std::int16_t& w : row) {
        if (random() % 4 == 0) w = static_cast<std::int16_t>(-std::max<int>(w, -INT16_MAX));
      }
    }
  };
  turn(net.layer1.weight);
  turn(net.layer2.weight);
  return net;
}

/// States at which the action rises with the price, on rows drawn at random.
std::vector<LatticeState> disordered_states(const StudentNet& net) {
  std::mt19937 random(3);
  std::vector<LatticeState> found;
  for (int row = 0; row < kRowsSearched && found.size() < kCounterexamples; ++row) {
    LatticeState state = random_state(random);
    Action before = Action::kCharge;
    for (int price = kLatticePriceMinEurPerMwh; price <= kLatticePriceMaxEurPerMwh; ++price) {
      state.price_eur_per_mwh = static_cast<std::int16_t>(price);
      const Action action = net.decide(state);
      if (action > before) {
        found.push_back(state);
        break;
      }
      before = action;
    }
  }
  if (found.empty()) throw std::logic_error("the disordered student is in order");
  return found;
}

Json days_of(const std::vector<NamedEvaluation>& evaluations, EvaluationField field) {
  Json policies = Json::object();
  for (const NamedEvaluation& named : evaluations) {
    Json days = Json::list();
    for (const DayResult& day : (named.*field).days) {
      days.add(Json::object({{"date", day.date},
                             {"profit_eur", day.profit_eur},
                             {"throughput_mwh", day.throughput_mwh},
                             {"cycles", day.cycles},
                             {"switches", day.switches},
                             {"soc_end", day.soc_end_frac}}));
    }
    policies.set(named.name.c_str(), std::move(days));
  }
  return policies;
}

/// What each student breaks of each rule on the maps, over all prices and charges: {student:
/// [{rule: count} a map]}.
Json broken_rules_of(const StudentNet& net, const RuleSet& rules) {
  Json maps = Json::list();
  for (const PolicyContext& at : kMaps) {
    RuleChecker checker(rules, net.context.kind);
    const LatticeState context{
        .minute_of_quarter_hour = static_cast<std::int16_t>(at.minute_of_quarter_hour),
        .quarter_hour = static_cast<std::int16_t>(at.quarter_hour),
        .context_class = static_cast<std::int16_t>(at.context_class),
        .soc_index = 0,
        .price_eur_per_mwh = 0};
    std::vector<ActionGrid> neighbours;
    for (const RuleInput input : checker.neighbours_needed()) {
      const auto next = next_context(context, input);
      neighbours.push_back(!next ? ActionGrid{}
                                 : student_grid(net, {next->context_class, next->quarter_hour,
                                                      next->minute_of_quarter_hour}));
    }
    checker.check(context, student_grid(net, at), neighbours);
    Json counts = Json::object();
    for (std::size_t r = 0; r < rules.rules.size(); ++r) {
      counts.set(rules.rules[r].name.c_str(), checker.counts()[r].violations);
    }
    maps.add(std::move(counts));
  }
  return maps;
}

/// Everything that a page of a run is made of.
struct FixtureRun {
  StudentFile corrected, plain;
  std::vector<BrokenDemand> broken;
};

const std::vector<NamedEvaluation>& judged_baselines() {
  static const std::vector<NamedEvaluation> evaluations = [] {
    std::vector<NamedEvaluation> all;
    for (const char* name : {"rbc", "rbc-tuned", "sdp", kForesightName}) {
      const auto policy = make_policy(name, small_market(), {});
      all.push_back(named_evaluation(name, *policy));
    }
    return all;
  }();
  return evaluations;
}

/// In the order of a run: rule-based first, foresight last.
std::vector<NamedEvaluation> evaluations_of(const FixtureRun& run) {
  std::vector<NamedEvaluation> all = judged_baselines();
  const NamedEvaluation foresight = all.back();
  all.pop_back();
  const auto plain = std::make_shared<StudentPolicy>(run.plain.net);
  all.push_back(named_evaluation(kPlainName, *plain));
  const auto under = [&](const std::string& name, const RuleSet& rules) {
    RuledPolicy ruled(plain, rules, run.plain.net.context);
    all.push_back(named_evaluation(name, ruled));
  };
  RuleSet projected;
  for (const Rule& rule : run.corrected.certificate.rules.rules) {
    if (!can_be_projected(rule)) continue;
    projected.rules.push_back(rule);
    under(under_rule_name(rule.name), {{rule}});
  }
  if (!projected.empty()) under(kUnderAllRules, projected);
  all.push_back(named_evaluation(own_student_name(run.corrected.certificate),
                                 *exported_policy(run.corrected)));
  all.push_back(foresight);
  return all;
}

void write_expected(const FixtureRun& run, const std::vector<NamedEvaluation>& evaluations,
                    const std::filesystem::path& folder) {
  const Certificate& certificate = run.corrected.certificate;
  Json students = Json::object();
  for (const auto& [name, net] : {std::pair(own_student_name(certificate), &run.corrected.net),
                                  std::pair(kPlainName, &run.plain.net)}) {
    Json student = Json::object();
    student.set("answers", answers_of(*net));
    student.set("maps", maps_of(*net));
    student.set("broken_rules", broken_rules_of(*net, certificate.rules));
    students.set(name, std::move(student));
  }
  Json demands = Json::list();
  for (const DemandCount& count : demand_counts(certificate)) {
    demands.add(Json::object({{"label", count.label()},
                              {"text", count.text},
                              {"states", count.states},
                              {"violations", count.violations},
                              {"binds_student", count.binds_student}}));
  }
  Json expected = Json::object();
  expected.set("students", std::move(students));
  expected.set("days", days_of(evaluations, &NamedEvaluation::carried_over));
  expected.set("days_by_themselves", days_of(evaluations, &NamedEvaluation::day_reset));
  expected.set("headline", headline_json(headline_of(evaluations).value()));
  expected.set("capacity_mwh", BatteryParameters{}.capacity_wh / 1e6);
  expected.set("demands", std::move(demands));
  write_file(folder / "expected.json", expected.line());
}

void write_run_page(const FixtureRun& run, const std::filesystem::path& folder) {
  static const Teacher teacher = untrained_teacher();
  const std::vector<NamedEvaluation> evaluations = evaluations_of(run);
  const ReportInputs inputs{
      .market = small_market(),
      .evaluations = evaluations,
      .training_curve = {{0, 0, 100, 0}, {500, 3.0, 140, 0, 5}, {750, 2.9, 160, 0, -5}},
      .distil_curve = {{1, 1.0, 0.1, 0.9}, {2, 0.5, 0.01, 0.4}, {3, 0.3, 0, 0.2}},
      .checkpoints = {{1, 60, 101.5, CheckpointState::kPassedOver},
                      {1, 80, 104.25, CheckpointState::kDisobeys},
                      {1, 100, 103, CheckpointState::kChosen}},
      .teacher = &teacher,
      .uncorrected = &run.plain,
      .corrected = &run.corrected,
      .broken = run.broken,
      .provenance =
          "a line of provenance that is long enough to be broken on a narrow "
          "screen: crc32 0123456789abcdef0123456789abcdef0123456789abcdef",
      .facts = {{"prices", "prices.csv.gz: crc32 0badcafe, 123456 bytes"}}};
  write_report(inputs, folder);
  // As the stages of a run before its report do.
  write_file(folder / "evaluation_days.csv", evaluation_days_csv(evaluations));
  write_file(folder / "training_curve.csv", training_curve_csv(inputs.training_curve));
  write_file(folder / "student_checkpoints.csv", student_checkpoints_csv(inputs.checkpoints));
  write_file(folder / "distil_curve.csv", distil_curve_csv(inputs.distil_curve));
  write_expected(run, evaluations, folder);
}

/// Counted in a sample of the contexts, and told as if it were the whole lattice: quick.
Certificate counted(const StudentNet& net, const RuleSet& rules) {
  constexpr int kStride = 1'999;  // a prime, so that every hour, class and minute comes
  Certificate certificate = verify_student(net, {.rules = rules,
                                                 .context_stride = kStride,
                                                 .counterexamples_max = kCounterexamples,
                                                 .threads = 2});
  certificate.states_checked = kLatticeStateCount;
  return certificate;
}

FixtureRun run_with(const RuleSet& rules) {
  FixtureRun run{compiled_student(), {disordered_student(), {}, "disordered"}, {}};
  run.corrected.certificate = counted(run.corrected.net, rules);
  run.plain.certificate = counted(run.plain.net, rules);
  run.broken = broken_demands(run.corrected, CorrectionMethod::kConstruction);
  return run;
}

/// Of every kind that a map shows in its own way: a box at some hours, one of the guard's, one
/// beyond the lattice, a direction that two maps show, one that a single map does.
RuleSet rules_for_a_map(const std::string& first) {
  return parse_rules("[[rule]]\nname = \"a rule whose name is forty letters long\"\n" + first +
                         "\n[[rule]]\nname = \"evening cap\"\nhours = \"12:00-21:00\"\n"
                         "power_max = 0.5\nenforce = true\n"
                         "[[rule]]\nname = \"far away\"\nprice_min = 1800\nat_most = \"idle\"\n"
                         "enforce = true\n"
                         "[[rule]]\nname = \"falls with price\"\nnever_rises_with = \"price\"\n",
                     "fixture");
}

void write_runs(const std::filesystem::path& folder) {
  FixtureRun run{compiled_student(), {disordered_student(), {}, "disordered"}, {}};
  run.corrected.certificate = {};
  run.corrected.certificate.states_checked = kLatticeStateCount;
  run.plain.certificate = run.corrected.certificate;
  run.plain.certificate.counterexamples = disordered_states(run.plain.net);
  run.plain.certificate.set_violations_of(
      3, static_cast<std::int64_t>(run.plain.certificate.counterexamples.size()));
  write_run_page(run, folder);

  const FixtureRun ruled =
      run_with(rules_for_a_map("price_min = 1400\nat_most = \"idle\"\nenforce = true"));
  if (!ruled.broken.empty()) throw std::logic_error("the compiled student charges at 1400");
  write_run_page(ruled, folder / "ruled");

  const RuleSet broken = rules_for_a_map(
      "hours = \"10:00-01:00\"\nprice_min = -50\nprice_max = 500\nsoc_min = 0.2\nsoc_max = 0.7\n"
      "is = \"idle\"\n[[rule]]\nname = \"falls\"\nnever_rises_with = \"quarter_hour\"");
  const FixtureRun failed = run_with(broken);
  if (failed.broken.size() < 2) throw std::logic_error("the compiled student obeys all rules");
  write_run_page(failed, folder / "failed");
}

/// The days of one month.
Evaluation month_of(Evaluation evaluation, const std::string& month) {
  std::erase_if(evaluation.days,
                [&](const DayResult& day) { return !day.date.starts_with(month); });
  return evaluation;
}

void write_backtest(const std::filesystem::path& folder) {
  const std::vector<std::string> months{"2023-01", "2023-02"};
  BacktestResults results{.policies = {},
                          .fitted_days = {25, 31},
                          .skipped = {{"2022-12", "0 of the 31 days before it are there"}},
                          .window_days = 31,
                          .capacity_mwh = BatteryParameters{}.capacity_wh / 1e6,
                          .provenance = "made by hand"};
  for (const NamedEvaluation& named : judged_baselines()) {
    if (named.name == kForesightName) continue;
    WalkForward traded{
        .name = named.name, .total = named.carried_over, .months = months, .by_month = {}};
    for (const std::string& month : months)
      traded.by_month.push_back(month_of(traded.total, month));
    results.policies.push_back(std::move(traded));
  }
  write_file(folder / "backtest.json", backtest_json(results).line());
  write_file(folder / "backtest.csv", backtest_csv(results));
  write_backtest_page(results, folder);
}

}  // namespace
}  // namespace bess

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  bess::set_market_time_zone();
  const std::filesystem::path folder = argv[1];
  for (const char* part : {"ruled", "failed", "backtest", "many"}) {
    std::filesystem::create_directories(folder / part);
  }
  bess::write_runs(folder);
  bess::write_backtest(folder / "backtest");
  bess::write_many_runs(folder / "many", bess::judged_baselines());
  return 0;
}
