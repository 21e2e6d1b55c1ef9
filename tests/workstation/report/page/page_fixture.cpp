// page_fixture FOLDER: a small run's report.html in FOLDER, and expected.json beside it: what the C++ says about the
// same students and days. page_test.py opens the page and compares.
#include <fmt/core.h>

#include <random>
#include <stdexcept>

#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/local_time.h"
#include "tests/workstation/report/report_test_support.h"
#include "workstation/cli/policy_factory.h"
#include "workstation/report/headline.h"
#include "workstation/report/policy_map.h"
#include "workstation/student/student_policy.h"

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

/// One digit a cell, rows of SoC from 0 %, and how many neighbours are out of order.
Json maps_of(const StudentNet& net) {
  Json maps = Json::list();
  for (const PolicyContext& context : kMaps) {
    const ActionGrid grid = student_grid(net, context);
    std::string cells;
    for (const std::int8_t action : grid) cells += static_cast<char>('0' + action);
    std::int64_t pairs = 0;
    for (const WrongBorder& border : wrong_borders_of(grid)) pairs += border.pairs;
    maps.add(Json::object({{"context_class", context.context_class},
                           {"quarter_hour", context.quarter_hour},
                           {"minute", context.minute_of_quarter_hour},
                           {"cells", cells},
                           {"wrong_pairs", pairs}}));
  }
  return maps;
}

/// The compiled student with the signs of some weights turned round: no sum can leave its integers, and the
/// order is lost.
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
                             {"soc_end", day.soc_end_frac}}));
    }
    policies.set(named.name.c_str(), std::move(days));
  }
  return policies;
}

void write_fixture(const std::filesystem::path& folder) {
  const Teacher teacher = untrained_teacher();
  StudentFile corrected = compiled_student();
  corrected.certificate.states_checked = kLatticeStateCount;
  StudentFile plain{disordered_student(), corrected.certificate, "disordered"};
  plain.certificate.counterexamples = disordered_states(plain.net);
  plain.certificate.violations_property_3 =
      static_cast<std::int64_t>(plain.certificate.counterexamples.size());

  std::vector<NamedEvaluation> evaluations;
  for (const char* name : {"rbc", "rbc-tuned", "sdp"}) {
    const auto policy = make_policy(name, small_market(), {});
    evaluations.push_back(named_evaluation(name, *policy));
  }
  StudentPolicy plain_policy(plain.net);
  evaluations.push_back(named_evaluation(kPlainName, plain_policy));
  StudentPolicy corrected_policy(corrected.net);
  evaluations.push_back(named_evaluation(kCorrectedName, corrected_policy));
  const auto foresight = make_policy(kForesightName, small_market(), {});
  evaluations.push_back(named_evaluation(kForesightName, *foresight));

  write_report({.market = small_market(),
                .evaluations = evaluations,
                .training_curve = {{250, 3.5, 100, 0}, {500, 3.0, 140, 0}, {750, 2.9, 120, 0}},
                .distil_curve = {{1, 1.0, 0.1, 0.9}, {2, 0.5, 0.01, 0.4}, {3, 0.3, 0, 0.2}},
                .checkpoints = {{1, 60, 101.5, CheckpointState::kPassedOver},
                                {1, 80, 104.25, CheckpointState::kDisobeys},
                                {1, 100, 103, CheckpointState::kChosen}},
                .teacher = &teacher,
                .uncorrected = &plain,
                .corrected = &corrected,
                .provenance = "a line of provenance that is long enough to be broken on a narrow "
                              "screen: crc32 0123456789abcdef0123456789abcdef0123456789abcdef",
                .facts = {{"prices", "prices.csv.gz: crc32 0badcafe, 123456 bytes"}}},
               folder);

  Json students = Json::object();
  for (const auto& [name, net] :
       {std::pair(kCorrectedName, &corrected.net), std::pair(kPlainName, &plain.net)}) {
    Json student = Json::object();
    student.set("answers", answers_of(*net));
    student.set("maps", maps_of(*net));
    students.set(name, std::move(student));
  }
  Json expected = Json::object();
  expected.set("students", std::move(students));
  expected.set("days", days_of(evaluations, &NamedEvaluation::carried_over));
  expected.set("days_by_themselves", days_of(evaluations, &NamedEvaluation::day_reset));
  expected.set("headline", headline_json(headline_of(evaluations).value()));
  expected.set("capacity_mwh", BatteryParameters{}.capacity_wh / 1e6);
  write_file(folder / "expected.json", expected.line());
}

}  // namespace
}  // namespace bess

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  bess::set_market_time_zone();
  bess::write_fixture(argv[1]);
  return 0;
}
