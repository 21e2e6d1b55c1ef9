// page_fixture FOLDER: writes report.html of a run with rules to FOLDER and of one whose proof
// failed to FOLDER/failed; and to FOLDER/expected.json the C++ answers of the first run's students.
#include <memory>
#include <random>

#include "shared/host/file.h"
#include "shared/host/json.h"
#include "tests/unit/workstation/report/report_test_support.h"
#include "workstation/correction/rules/rule.h"
#include "workstation/correction/student/certificate.h"
#include "workstation/correction/student/student_policy.h"
#include "workstation/report/headline.h"
#include "workstation/report/page_data.h"
#include "workstation/runs/chain/policy_factory.h"

namespace bess {
namespace {

/// 4,000 of [minute, quarter-hour, class, SoC index, price, three logits, action].
Json answers_of(const StudentNet& net) {
  std::mt19937 random(1);
  const auto draw = [&](int low, int high) {
    return static_cast<std::int16_t>(std::uniform_int_distribution(low, high)(random));
  };
  Json answers = Json::list();
  for (int i = 0; i < 4000; ++i) {
    const std::int16_t minute = draw(0, kMinuteOfQuarterHourCount - 1);
    const std::int16_t quarter_hour = draw(0, kQuarterHourCount - 1);
    const std::int16_t context_class = draw(1, kContextClassCount);
    const std::int16_t soc = draw(0, kSocCount - 1);
    const std::int16_t price = draw(kLatticePriceMinEurPerMwh, kLatticePriceMaxEurPerMwh);
    std::int16_t x[kStudentInputs];
    std::int32_t z[kActionCount];
    net.quantise({minute, quarter_hour, context_class, soc, price}, x);
    net.propagate(x, z);
    const std::int32_t numbers[] = {minute, quarter_hour, context_class,
                                    soc,    price,        z[0],
                                    z[1],   z[2],         static_cast<int>(argmax_action(z))};
    answers.add(std::span(numbers));
  }
  return answers;
}

/// One rule of every kind with a distinct display on a map: a box at some hours, one of the guard,
/// one beyond the lattice, a direction on two maps, one on a single map. Counted in a sample of the
/// contexts, and shown as the whole lattice, for speed.
StudentFile with_rules(const StudentNet& net, const std::string& first) {
  const RuleSet rules =
      parse_rules("[[rule]]\nname = \"a rule whose name is forty letters long\"\n" + first +
                      "[[rule]]\nname = \"evening cap\"\nhours = \"12:00-21:00\"\n"
                      "power_max = 0.5\nenforce = true\n"
                      "[[rule]]\nname = \"far away\"\nprice_min = 1800\nat_most = \"idle\"\n"
                      "enforce = true\n"
                      "[[rule]]\nname = \"falls with price\"\nnever_rises_with = \"price\"\n",
                  "fixture");
  const VerifyOptions options{.rules = rules, .context_stride = 1'999, .counterexamples_max = 25};
  StudentFile student{net, verify_student(net, options),
                      "a line that is long enough to be broken on a narrow screen: crc32 "
                      "0123456789abcdef0123456789abcdef0123456789abcdef"};
  student.certificate.states_checked = kLatticeStateCount;
  return student;
}

void write_page(const StudentFile& corrected, const StudentFile& plain,
                const std::filesystem::path& folder) {
  const Teacher teacher = untrained_teacher();
  std::vector<NamedEvaluation> evaluations;
  for (const auto& [name, policy] :
       std::initializer_list<std::pair<std::string, std::shared_ptr<Policy>>>{
           {"rbc", make_policy("rbc", small_market(), {})},
           {"sdp", make_policy("sdp", small_market(), {})},
           {kPlainName, std::make_shared<StudentPolicy>(plain.net)},
           {own_student_name(corrected.certificate), exported_policy(corrected)},
           {kForesightName, make_policy(kForesightName, small_market(), {})}}) {
    evaluations.push_back(named_evaluation(name, *policy));
  }
  write_report({.market = small_market(),
                .evaluations = evaluations,
                .training_curve = {{0, 0, 100, 0}, {500, 3.0, 140, 0, 5}, {750, 2.9, 160, 0, -5}},
                .distil_curve = {{1, 1.0, 0.1, 0.9}, {2, 0.5, 0.01, 0.4}, {3, 0.3, 0, 0.2}},
                .checkpoints = {{1, 80, 104.25, CheckpointState::kDisobeys},
                                {1, 100, 103, CheckpointState::kChosen}},
                .teacher = teacher,
                .plain = plain,
                .corrected = corrected,
                .broken = broken_demands(corrected, CorrectionMethod::kConstruction),
                .facts = {{"prices", "prices.csv.gz: crc32 0badcafe, 123456 bytes"}}},
               folder);
}

void write_pages(const std::filesystem::path& folder) {
  const std::string kept = "price_min = 1400\nat_most = \"idle\"\nenforce = true\n";
  const StudentFile corrected = with_rules(compiled_student().net, kept);
  const StudentFile plain = with_rules(untrained_student(), kept);
  write_page(corrected, plain, folder);
  write_page(with_rules(compiled_student().net,
                        "hours = \"10:00-01:00\"\nprice_min = -50\nprice_max = 500\n"
                        "soc_min = 0.2\nsoc_max = 0.7\nis = \"idle\"\n"),
             plain, folder / "failed");
  Json expected = Json::object();
  expected.set(own_student_name(corrected.certificate), answers_of(corrected.net));
  expected.set(kPlainName, answers_of(plain.net));
  write_file(folder / "expected.json", expected.line());
}

}  // namespace
}  // namespace bess

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  bess::write_pages(argv[1]);
  return 0;
}
