#include "workstation/correction/student/export.h"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <student_weights.h>

#include <charconv>
#include <filesystem>
#include <regex>

#include "shared/host/file.h"
#include "tests/support/program_output.h"
#include "tests/support/proved_students.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "workstation/correction/rules/rule.h"

namespace bess {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

/// Integers of one array of a header, in order, at any nesting.
std::vector<int> array_in(const std::string& header, const std::string& name) {
  std::size_t at = header.find("bess_student_" + name + '[');
  if (at == std::string::npos) return {};
  at = header.find('=', at);
  const std::size_t end = header.find(';', at);
  std::vector<int> values;
  while (at < end) {
    int value = 0;
    const auto [rest, error] = std::from_chars(&header[at], &header[end], value);
    if (error == std::errc{}) {
      values.push_back(value);
      at = static_cast<std::size_t>(rest - header.data());
    } else {
      ++at;
    }
  }
  return values;
}

template <typename T, std::size_t kCount>
std::vector<int> flat(const T (&values)[kCount]) {
  return {values, values + kCount};
}
template <typename T, std::size_t kRows, std::size_t kColumns>
std::vector<int> flat(const T (&values)[kRows][kColumns]) {
  return {&values[0][0], &values[0][0] + kRows * kColumns};
}

std::string committed_header() {
  return read_file(fs::path(BESS_COMMITTED_STUDENT_DIR) / "student_weights.h");
}

void expect_arrays(const std::string& header, const StudentNet& net) {
  EXPECT_EQ(array_in(header, "price_map"), flat(net.price_map));
  EXPECT_EQ(array_in(header, "layer1_weight"), flat(net.layer1.weight));
  EXPECT_EQ(array_in(header, "layer1_bias"), flat(net.layer1.bias));
  EXPECT_EQ(array_in(header, "layer2_weight"), flat(net.layer2.weight));
  EXPECT_EQ(array_in(header, "layer2_bias"), flat(net.layer2.bias));
  EXPECT_EQ(array_in(header, "layer3_weight"), flat(net.layer3.weight));
  EXPECT_EQ(array_in(header, "layer3_bias"), flat(net.layer3.bias));
  EXPECT_THAT(header, HasSubstr(fmt::format("relu1_shift = {};", net.relu1.shift)));
  EXPECT_THAT(header, HasSubstr(fmt::format("relu2_shift = {};", net.relu2.shift)));
  EXPECT_THAT(header, HasSubstr(fmt::format("WEIGHTS_HASH 0x{:08x}u", student_weights_hash(net))));
}

void expect_self_checks(const std::string& header, const StudentNet& net) {
  const std::vector<int> states = array_in(header, "self_check_state");
  const std::vector<int> logits = array_in(header, "self_check_logits");
  ASSERT_EQ(states.size() / kStudentInputs, logits.size() / kActionCount);
  ASSERT_GE(logits.size() / kActionCount, 32U);
  for (std::size_t n = 0; n < logits.size() / kActionCount; ++n) {
    const auto field = [&](std::size_t i) {
      return static_cast<std::int16_t>(states[n * kStudentInputs + i]);
    };
    std::int16_t x[kStudentInputs];
    std::int32_t z[kActionCount];
    net.quantise({field(0), field(1), field(2), field(3), field(4)}, x);
    net.propagate(x, z);
    for (std::size_t a = 0; a < kActionCount; ++a) EXPECT_EQ(z[a], logits[n * kActionCount + a]);
  }
}

TEST(Export, HeaderHoldsTheNet) {
  const std::string header = format_weight_header(crowded_student());
  expect_arrays(header, crowded_net());
  expect_self_checks(header, crowded_net());
}

TEST(Export, HeaderSaysWhatItWasProvedFor) {
  const std::string header = format_weight_header(crowded_student());
  EXPECT_THAT(header, Names("-400 EUR/MWh"));
  EXPECT_THAT(header, Names("1400 EUR/MWh"));
  EXPECT_THAT(header, HasSubstr("BESS_STUDENT_LOW_PRICE_EUR_PER_MWH (-400)\n"));
  EXPECT_THAT(header, HasSubstr("BESS_STUDENT_HIGH_PRICE_EUR_PER_MWH (1400)\n"));
  EXPECT_THAT(header, HasSubstr("BESS_STUDENT_STATES_CHECKED INT64_C(6950033280)\n"));
  EXPECT_THAT(header,
              HasSubstr(fmt::format("BESS_STUDENT_STATES_EVALUATED INT64_C({})\n",
                                    crowded_student().file().certificate.states_evaluated)));
  for (const int property : {1, 2, 3}) {
    EXPECT_THAT(header,
                HasSubstr(fmt::format("BESS_STUDENT_VIOLATIONS_PROPERTY_{} 0\n", property)));
  }
}

/// The header without its numbers and line breaks: the text of the exporter.
std::string form_of(std::string header) {
  const std::size_t provenance = header.find("#define BESS_STUDENT_PROVENANCE");
  header.erase(provenance, header.find('\n', provenance) - provenance);
  header = std::regex_replace(header, std::regex("0x[0-9a-f]{8}u|-?[0-9]+"), "#");
  return std::regex_replace(header, std::regex("\n"), "");
}

/// Proved again by tools/test: a minute of computing.
TEST(Export, CommittedHeaderIsWhatTheExporterWrites) {
  const std::string header = committed_header();
  const StudentNet net = compiled_student().net;
  EXPECT_EQ(form_of(header), form_of(format_weight_header(crowded_student())));
  expect_arrays(header, net);
  expect_self_checks(header, net);
}

/// The compiler's output for these options, with the header's folder in its include path.
ProgramOutput compiled(const TemporaryFolder& folder, const std::string& header,
                       std::vector<std::string> words) {
  write_file(folder.file("student_weights.h"), header);
  words.insert(words.end(), {"-I", folder.file(""), "-I", BESS_SOURCE_DIR});
  return answer_of(words);
}

/// Compiles the header in a C and a C++ program and runs both; both must find `provenance` in it.
void expect_header_compiles(const std::string& header, const std::string& provenance) {
  const TemporaryFolder folder;
  std::string literal;
  for (const char c : provenance) literal += fmt::format("\\{:03o}", static_cast<unsigned char>(c));
  const std::string c_source = folder.write(
      "header.c",
      "#include <string.h>\n#include <student_weights.h>\n#include \"student_weights.h\"\n"
      "int main(void) {\n"
      "  if (strcmp(BESS_STUDENT_PROVENANCE, \"" +
          literal +
          "\") != 0) return 2;\n"
          "  return bess_student_price_map[0] < bess_student_price_map[2000] ? 0 : 1;\n}\n");
  const std::string cpp_source =
      folder.write("header.cpp",
                   "#include <cstring>\n#include \"shared/nn/exported_student.h\"\n"
                   "int main() {\n"
                   "  if (std::strcmp(BESS_STUDENT_PROVENANCE, \"" +
                       literal +
                       "\") != 0) return 2;\n"
                       "  return bess::count_exported_self_check_failures() == 0 ? 0 : 1;\n}\n");
  const std::string program = folder.file("program");
  for (const auto& [compiler, standard, source] :
       {std::tuple(BESS_C_COMPILER, "-std=c11", c_source),
        std::tuple(BESS_CXX_COMPILER, "-std=c++20", cpp_source)}) {
    const ProgramOutput built = compiled(
        folder, header,
        {compiler, standard, "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-o", program, source});
    ASSERT_EQ(built.exit_code, 0) << built.text;
    EXPECT_EQ(answer_of({program}).exit_code, 0) << standard;
  }
}

/// The replays of workstation and edge are separate programs: one number compares them.
TEST(Export, TheSignatureIsTheOneOfTheBuild) {
  for (const std::string folder :
       {BESS_COMMITTED_STUDENT_DIR, BESS_SOURCE_DIR "/tests/data/golden/outlook_student"}) {
    const fs::path file = fs::path(folder) / "student.json";
    const StudentFile student = fs::exists(file) ? load_student(file) : compiled_student();
    EXPECT_EQ(decision_signature_line(student) + '\n',
              read_file(fs::path(folder) / kDecisionSignatureFile));
  }
}

TEST(Export, ProvenanceIsSafe) {
  const std::string harmless = "*/ #error // /* {} {0} %s why?\?) ?\?' ";
  std::string header = committed_header();
  const std::size_t literal = header.find('"', header.find("BESS_STUDENT_PROVENANCE"));
  header.replace(literal, header.find('\n', literal) - literal,
                 c_string_literal(harmless + "\"a\" 'b' one\ntwo\r\n\té C:\\new\\x41\\"));
  expect_header_compiles(header, harmless + "\"a\" 'b' one?two?\?\?\?\? C:\\new\\x41\\");
}

/// By the assertion about the content of `names`.
void expect_header_is_refused(const std::string& header, const std::string& names) {
  const TemporaryFolder folder;
  const std::string source = folder.write("a.cpp", "#include \"shared/nn/exported_student.h\"\n");
  const ProgramOutput outcome =
      compiled(folder, header, {BESS_CXX_COMPILER, "-std=c++20", "-fsyntax-only", source});
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_THAT(outcome.text, Names("exported_student.h " + names));
}

/// Training days and cycles may be missing; they are never invented.
TEST(Export, TheTrainingDaysAreWrittenAndAnOlderHeaderHasNone) {
  EXPECT_THAT(format_weight_header(crowded_student()),
              HasSubstr("#define BESS_STUDENT_TRAINED_FROM \"2024-02-29\"\n"
                        "#define BESS_STUDENT_TRAINED_UNTIL \"2024-12-31\"\n"
                        "#define BESS_STUDENT_CYCLES_PER_DAY_E2 321\n"));
  const std::string header = committed_header();
  expect_header_compiles(
      std::regex_replace(header, std::regex("#define BESS_STUDENT_(TRAINED|CYCLES)_.*\n"), ""),
      BESS_STUDENT_PROVENANCE);
  for (const char* day : {"2023-02-30", "2022-12-31"}) {
    expect_header_is_refused(
        std::regex_replace(header, std::regex("(TRAINED_UNTIL) .*"), fmt::format("$1 \"{}\"", day)),
        "kExportedTraining");
  }
}

TEST(Export, DamagedHeaderDoesNotCompile) {
  std::string header = committed_header();
  const std::size_t digit = header.find_first_of("234567", header.find("layer2_weight"));
  const std::size_t body = header.find_first_of("234567", header.find('{', digit));
  ++header[body];
  expect_header_is_refused(header, "BESS_STUDENT_WEIGHTS_HASH");
}

TEST(Export, UnprovedHeaderDoesNotCompile) {
  const char* const whole = "BESS_STUDENT_STATES_CHECKED kExportedViolations";
  for (const auto& [from, to, names] :
       {std::tuple("INT64_C(6950033280)", "INT64_C(3475016640)", whole),
        std::tuple("VIOLATIONS_PROPERTY_1 0", "VIOLATIONS_PROPERTY_1 1", whole),
        std::tuple("VIOLATIONS_PROPERTY_2 0", "VIOLATIONS_PROPERTY_2 1", whole),
        std::tuple("VIOLATIONS_PROPERTY_3 0", "VIOLATIONS_PROPERTY_3 1", whole),
        std::tuple("STUDENT_VERSION 3", "STUDENT_VERSION 2", "BESS_STUDENT_VERSION")}) {
    std::string header = committed_header();
    expect_header_is_refused(header.replace(header.find(from), std::string(from).size(), to),
                             names);
  }
}

// An operator's rules in the header.

constexpr const char* kHeaderRules =
    "[[rule]]\nname = \"no expensive charging\"\nprice_min = 301\nat_most = \"idle\"\nenforce = "
    "true\n"
    "[[rule]]\nname = \"winter (17-20)\"\nmonths = [11, 12, 1]\nhours = \"17:00-20:00\"\nsoc_max = "
    "0.3\n"
    "price_max = 200\nat_least = \"idle\"\nenforce = true\n"
    "[[rule]]\nname = \"proved alone\"\nprice_max = 24\nat_least = \"idle\"\n"
    "[[rule]]\nname = \"cap\"\nhours = \"22:00-06:00\"\npower_max = 0.5\nenforce = true\n"
    "[[rule]]\nname = \"far\"\nprice_min = 2000\nprice_max = 3000\nis = \"discharge\"\nenforce = "
    "true\n";

const ProvedStudent& ruled_student() {
  static const Verdict verdict =
      prove(crowded_file({.thresholds = kCrowdedThresholds,
                          .rules = parse_rules(kHeaderRules, "test.toml")}),
            2);
  return std::get<ProvedStudent>(verdict);
}

/// Everything from the rules' first line on is added; the text before it is the header without
/// rules.
TEST(Export, RulesAreAddedToTheHeader) {
  const std::string header = format_weight_header(ruled_student());
  const std::string plain = format_weight_header(crowded_student());
  EXPECT_THAT(header, Names("no expensive charging: 301 EUR/MWh"));
  EXPECT_THAT(header, Names("cap: 22:00-06:00: 50 %"));
  EXPECT_THAT(header, Names("proved alone: 24 EUR/MWh"));
  EXPECT_THAT(header, HasSubstr("#define BESS_STUDENT_GUARD_RULE_COUNT 4\n"));
  EXPECT_THAT(plain, testing::Not(HasSubstr("RULE")));
  const std::string_view body = std::string_view(plain).substr(plain.find("#pragma once"));
  const std::string_view nets = body.substr(0, body.find("/* clang-format on"));
  EXPECT_THAT(header, HasSubstr(std::string(nets)));
}

TEST(Export, AHeaderWithRulesIsCAndCppAndAnswersItsGoldenPoints) {
  expect_header_compiles(format_weight_header(ruled_student()), kCrowdedProvenance);
}

/// The edge's own guard, with rules in its header, against the exporter's statement.
TEST(Export, TheEdgeDecidesWithRulesAsTheSignatureSays) {
  const TemporaryFolder folder;
  const std::string source = folder.write("a.cpp", R"(
#include <cstdio>
#include "edge/core/control/decision_signature.h"
#include "edge/core/control/policy.h"
#include "shared/local_time.h"
int main() {
  bess::set_market_time_zone();
  std::puts(bess::signature_line(bess::student_hash(), bess::replay_recorded_days()).c_str());
})");
  const std::string program = folder.file("program");
  std::vector<std::string> command{BESS_CXX_COMPILER, "-std=c++20", "-O1", "-o", program, source};
  for (const char* const file :
       {"edge/core/control/policy", "edge/core/control/decision_signature",
        "edge/core/control/safety_guard", "shared/decision_signature", "shared/features",
        "shared/local_time", "shared/outlook/outlook_model", "shared/outlook/outlook_plan"}) {
    command.push_back(fmt::format("{}/{}.cpp", BESS_SOURCE_DIR, file));
  }
  const ProgramOutput built = compiled(folder, format_weight_header(ruled_student()), command);
  ASSERT_EQ(built.exit_code, 0) << built.text;
  EXPECT_EQ(answer_of({program}).text, decision_signature_line(ruled_student().file()) + '\n');
  EXPECT_NE(decision_signature_line(ruled_student().file()),
            decision_signature_line(crowded_student().file()));
}

TEST(Export, DamagedRulesDoNotCompile) {
  const std::string good = format_weight_header(ruled_student());
  const auto edited = [&good](const std::string& from, const std::string& to) {
    std::string header = good;
    const std::size_t at = header.find(from, header.find("bess_student_guard_rule["));
    EXPECT_NE(at, std::string::npos) << from;
    return header.replace(at, from.size(), to);
  };
  const std::string first = "{301,15000,0,200,0,96,4095,4095,3,1000},\n";
  ASSERT_THAT(good, HasSubstr(first));
  expect_header_is_refused(edited("{301,", "{302,"), "BESS_STUDENT_RULES_HASH");
  expect_header_is_refused(edited(first, ""), "BESS_STUDENT_RULES_HASH");
}

/// The exported points distinguish every field of every rule from its neighbours, so that a machine
/// with a different rule look-up fails at its start.
TEST(RuleHeader, TheGoldenPointsDistinguishEveryField) {
  const std::vector<GuardRule> rules = parse_rules(kHeaderRules, "test.toml").guard_rules();
  const std::vector<RulePoint> points = rule_check_points(rules);
  const auto differs = [&](const std::vector<GuardRule>& others) {
    return std::ranges::any_of(points, [&](const RulePoint& point) {
      return rule_limits_at(rules, point) != rule_limits_at(others, point);
    });
  };
  EXPECT_FALSE(differs(rules));
  for (std::size_t r = 0; r < rules.size(); ++r) {
    std::vector<GuardRule> without = rules;
    without.erase(without.begin() + static_cast<std::ptrdiff_t>(r));
    EXPECT_TRUE(differs(without)) << "rule " << r << " left out";
    std::vector<GuardRule> allowing = rules;
    allowing[r].limits = {};
    EXPECT_TRUE(differs(allowing)) << "rule " << r << " allows everything";
    const auto expect_seen = [&](auto RuleBox::*field, int change) {
      std::vector<GuardRule> other = rules;
      other[r].box.*field += change;
      EXPECT_TRUE(differs(other)) << "rule " << r << " by " << change;
    };
    for (const int change : {-1, 1}) {
      expect_seen(&RuleBox::price_min_eur_per_mwh, change);
      expect_seen(&RuleBox::price_max_eur_per_mwh, change);
      expect_seen(&RuleBox::soc_index_min, change);
      expect_seen(&RuleBox::soc_index_max, change);
    }
    if (rules[r].box.quarter_hour_count < kQuarterHourCount) {
      expect_seen(&RuleBox::quarter_hour_first, -1);
      expect_seen(&RuleBox::quarter_hour_first, 1);
      expect_seen(&RuleBox::quarter_hour_count, 1);
    }
    expect_seen(&RuleBox::quarter_hour_count, -1);
    for (int member = 0; member < 12; ++member) {
      for (auto RuleBox::*field : {&RuleBox::months, &RuleBox::context_classes}) {
        std::vector<GuardRule> other = rules;
        other[r].box.*field ^= 1 << member;
        EXPECT_TRUE(differs(other)) << "rule " << r << " member " << member + 1;
      }
    }
  }
}

// bess-train export. The nets are hand-made, so that the proof over the whole lattice is quick.

TEST(ExportCommand, WritesAProvedStudent) {
  const TemporaryFolder folder;
  const std::string student = folder.file("student.json");
  const std::string header = folder.file("out/student_weights.h");
  save_student(student, crowded_student().file());
  const ProgramOutput outcome = answer_of(
      {BESS_TRAIN_PROGRAM, "export", "--student", student, "--out", header, "--threads", "2"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_EQ(read_file(header), format_weight_header(crowded_student()));
  const std::string signature = read_file(folder.file("out/decision_signature.txt"));
  EXPECT_EQ(signature, decision_signature_line(crowded_student().file()) + '\n');
  EXPECT_THAT(outcome.text,
              testing::AllOf(HasSubstr(signature),
                             Names(header + " tools/package update-weights --student " +
                                   folder.file("out") + " " + student)));
}

/// The file claims a proof; the prover runs again and counts violations.
TEST(ExportCommand, RefusesViolations) {
  const TemporaryFolder folder;
  const std::string student = folder.file("student.json");
  const std::string header = folder.file("out/student_weights.h");
  save_student(student, {LinearNet{.charge_below = 0}.net(), flawless_claim(), "never charges"});
  const ProgramOutput outcome =
      answer_of({BESS_TRAIN_PROGRAM, "export", "--student", student, "--out", header});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.text, Names(student + ": 3473280 1"));
  EXPECT_TRUE(fs::is_empty(folder.file("out"))) << "created as a test";
}

}  // namespace
}  // namespace bess
