#include "workstation/correction/student/student_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <sstream>

#include "shared/host/file.h"
#include "tests/support/rule_sets.h"
#include "tests/support/student_nets.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"
#include "workstation/correction/student/prove.h"
#include "workstation/correction/student/student_policy.h"

namespace bess {
namespace {

StudentFile seeded_student() {
  return {
      seeded_net(21),
      {.thresholds = {-450, 1200},
       .states_checked = kLatticeStateCount,
       .states_evaluated = 58'325'611,
       .counts = {{true, 0, 1}, {true, 0, 20}, {true, 0, 1'000'000'000}, {true, 0, 2'000'000'000}}},
      "seeded \"21\" \\ é\nline"};
}

std::string seeded_text() {
  const TemporaryFolder folder;
  save_student(folder.file("student.json"), seeded_student());
  return read_file(folder.file("student.json"));
}

/// Text with the value of `key` replaced; the values of a student file are one per line.
std::string with(std::string text, const std::string& key, const std::string& value) {
  const std::size_t begin = text.find('"' + key + "\":\t") + key.size() + 4;
  const std::size_t end = text.find('\n', begin);
  const bool comma = text[end - 1] == ',';
  return text.replace(begin, end - begin, value + (comma ? "," : ""));
}

std::string without(std::string text, const std::string& key) {
  const std::size_t begin = text.find('"' + key + "\":\t");
  return text.erase(begin, text.find('\n', begin) + 1 - begin);
}

/// Text with the certificate on one line too.
std::string one_line_certificate(std::string text) {
  const std::size_t begin = text.find("\"certificate\"");
  const std::size_t end = text.find('}', begin);
  std::replace(text.begin() + static_cast<std::ptrdiff_t>(begin),
               text.begin() + static_cast<std::ptrdiff_t>(end), '\n', ' ');
  return text;
}

std::string array_of(const std::string& first, int count) {
  std::string text = '[' + first;
  for (int i = 1; i < count; ++i) text += ",0";
  return text + ']';
}

TEST(StudentFile, RoundTrip) {
  const TemporaryFolder folder;
  const StudentFile student = seeded_student();
  for (const char* name : {"student.json", "student.json.gz", "new/folder/student.json"}) {
    SCOPED_TRACE(name);
    save_student(folder.file(name), student);
    const StudentFile again = load_student(folder.file(name));
    EXPECT_EQ(student_weights_hash(again.net), student_weights_hash(student.net));
    EXPECT_EQ(again.certificate.thresholds, student.certificate.thresholds);
    EXPECT_EQ(again.certificate.states_checked, 6'950'033'280);
    EXPECT_EQ(again.certificate.states_evaluated, 58'325'611);
    EXPECT_EQ(again.certificate.violations_of(1), 1);
    EXPECT_EQ(again.certificate.violations_of(2), 20);
    EXPECT_EQ(again.certificate.violations_of(3), 3'000'000'000);
    EXPECT_EQ(again.provenance, student.provenance);
  }
}

/// A rule of the student, one of the guard alone, and the counts of a proof of both.
StudentFile ruled_student(std::int64_t violations) {
  StudentFile student = seeded_student();
  student.certificate = {.thresholds = {-450, 1200}, .states_checked = kLatticeStateCount};
  student.certificate.rules = one_rule("is = \"idle\"\nprice_min = 0\nprice_max = 9", "rest");
  student.certificate.rules.rules.push_back(one_rule("power_max = 0.5\nenforce = true").rules[0]);
  student.certificate.counts = {{}, {}, {}, {}, {true, 4711, violations}, {}};
  return student;
}

/// A run reads its students from their files, including the rules that it shows.
TEST(StudentFile, CountsOfRulesRoundTrip) {
  const TemporaryFolder folder;
  for (const std::int64_t violations : {0, 23'994}) {
    save_student(folder.file("student.json"), ruled_student(violations));
    const Certificate again = load_student(folder.file("student.json")).certificate;
    EXPECT_EQ(again.covers_lattice_without_violation(), violations == 0);
    const std::vector<DemandCount> counts = demand_counts(again);
    ASSERT_EQ(counts.size(), kPropertyCount + 2);
    EXPECT_EQ(counts[3].label(), "rule \"rest\"");
    EXPECT_EQ(counts[3].states, 4711);
    EXPECT_EQ(counts[3].violations, violations);
    EXPECT_TRUE(counts[3].binds_student);
    EXPECT_FALSE(counts[4].binds_student);
    EXPECT_EQ(round_of(again).text(), violations == 0 ? "" : "rule \"rest\": 23994");
  }
}

/// They only had the sum of all rules.
TEST(StudentFile, FilesWithoutCountsOfEachRuleAreStillRead) {
  const TemporaryFolder folder;
  for (const std::int64_t violations : {0, 5}) {
    save_student(folder.file("student.json"), ruled_student(violations));
    std::string text = read_file(folder.file("student.json"));
    text = without(without(text, "rule_states"), "rule_violations");
    const Certificate again = parse_student(text, "old.json").certificate;
    EXPECT_EQ(again.covers_lattice_without_violation(), violations == 0);
    EXPECT_EQ(again.rule_counts().size(), violations == 0 ? 2U : 0U) << "unknown which";
  }
}

/// Comment of the header; an older file has less information.
TEST(StudentFile, DaysAndCyclesAreShownWhereTheyAreKnown) {
  const TemporaryFolder folder;
  const auto loaded = [&](const StudentFile& student) {
    save_student(folder.file("student.json"), student);
    return load_student(folder.file("student.json"));
  };
  StudentFile student = compiled_student();
  EXPECT_FALSE(loaded(student).cycles_per_day);
  EXPECT_FALSE(learnt_span(loaded(student).learnt_for));
  student.learnt_for = {{"prices", "crc32 78d15778, 172740 minutes from 2022-12-31T23:00:00Z"}};
  student.cycles_per_day = 4.48;
  const auto span = learnt_span(loaded(student).learnt_for);
  ASSERT_TRUE(span);
  EXPECT_EQ(span->until_s - span->from_s, 60 * 172'740);
  EXPECT_EQ(loaded(student).cycles_per_day, 4.48);
  for (const char* const edited : {"", "today", "crc32 78d15778, 5 minutes from May"}) {
    student.learnt_for = {{"prices", edited}};
    EXPECT_FALSE(learnt_span(loaded(student).learnt_for)) << edited;
  }
  student.cycles_per_day = -1;
  EXPECT_THROW(loaded(student), UserError);
}

/// Files older than the counts: the thresholds were stored next to the weights.
TEST(StudentFile, Version1IsStillRead) {
  const StudentFile student = load_student(BESS_SOURCE_DIR
                                           "/tests/checks/fuzz/seeds/workstation/"
                                           "student_file_fuzz/version_1.json");
  constexpr std::uint32_t kHashInTheFile = 374'446'160;
  EXPECT_EQ(student_weights_hash(student.net), kHashInTheFile);
  EXPECT_EQ(student.net.context, ContextClasses{}) << "by month, the only kind then";
  EXPECT_EQ(student.certificate.thresholds, (PriceThresholds{-500, 1500}));
  EXPECT_EQ(student.certificate.states_checked, 0);
  EXPECT_FALSE(student.certificate.covers_lattice_without_violation());
}

TEST(StudentFile, DamageIsRefused) {
  const std::string good = seeded_text();
  ASSERT_NO_THROW(static_cast<void>(parse_student(good, "good.json")));
  const auto expect_refused = [](const std::string& text, const std::string& names) {
    EXPECT_THAT(refusal_of([&] { static_cast<void>(parse_student(text, "some/student.json")); }),
                Names("some/student.json " + names));
  };
  for (const char* text : {"", "price,soc\n1,2\n", "[1,2,3]", "17"}) expect_refused(text, "JSON");
  expect_refused("{\"a\": 1}", "\"format\"");
  StudentNet flat = seeded_net(21);
  flat.price_map[100] = flat.price_map[99];
  std::string flat_map = "[";
  for (const int p : flat.price_map) flat_map += std::to_string(p) + ',';
  flat_map.back() = ']';
  const struct {
    const char* key;
    std::string value;
    const char* names;
  } edits[] = {
      {"format", "\"bess-teacher\"", "\"format\" \"bess-student\""},
      {"format", "3", "format"},
      {"version", "6", "6"},      // newer
      {"version", "4", "rules"},  // has none
      {"context", "\"week\"", "\"level\" \"month\""},
      {"context", "\"level\"", "\"level_edge_eur_per_mwh\""},  // without edges
      {"level_edge_eur_per_mwh", "[1,2,3,4,5,6,7,8,9,10,11]", "\"level_edge_eur_per_mwh\" 0"},
      {"version", "1", "\"low_price_eur_per_mwh\""},  // older, with a certificate
      {"architecture_hash", "12345", ""},
      {"weights_hash", "12345", ""},
      {"layer3_bias", "[1,2,3]", ""},
      {"layer3_bias", "[1,2]", "\"layer3_bias\" 3"},
      {"layer3_bias", "[1,2,3,4]", "\"layer3_bias\" 3"},
      {"layer3_bias", "{\"a\":1}", "\"layer3_bias\" 3"},
      {"price_map", "5", "\"price_map\" 2001"},
      {"layer3_bias", "[1,\"2\",3]", "\"layer3_bias\" 32"},
      {"layer3_bias", "[1,null,3]", "\"layer3_bias\" 32"},
      {"layer3_bias", "[1,2.5,3]", "\"layer3_bias\" 32"},
      {"layer3_bias", "[1,3000000000,3]", "\"layer3_bias\" 32"},
      {"layer3_bias", "[1,1e999,3]", ""},
      {"layer3_weight", array_of("40000", kStudentHidden2 * 3), "\"layer3_weight\" 16"},
      {"layer3_weight", array_of("-32769", kStudentHidden2 * 3), "\"layer3_weight\" 16"},
      {"relu1_shift", "[31]", "31 0..30"},
      {"relu2_shift", "[-1]", "-1 0..30"},
      {"price_map", flat_map, "16384"},
      {"price_map", array_of("-1", kPriceCount), "16384"},
      {"layer3_bias", "[2147483647,0,0]", "32"},  // sums overflow
      {"low_price_eur_per_mwh", "\"-450\"", "low_price_eur_per_mwh"},
      {"low_price_eur_per_mwh", "-450.5", "\"low_price_eur_per_mwh\""},
      {"low_price_eur_per_mwh", "-1e300", "\"low_price_eur_per_mwh\""},
      {"high_price_eur_per_mwh", "2147483647", "\"high_price_eur_per_mwh\""},
      {"low_price_eur_per_mwh", "1200", "\"low_price_eur_per_mwh\""},  // they cross
      {"states_checked", "0.5", "states_checked"},
      {"violations_property_2", "-1", "\"violations_property_2\""},
      {"states_evaluated", "1e300", "\"states_evaluated\""},
      {"violations_property_3", "\"0\"", "violations_property_3"},
      {"provenance", "1", "provenance"},
  };
  for (const auto& edit : edits) {
    SCOPED_TRACE(edit.key + (" = " + edit.value.substr(0, 30)));
    expect_refused(with(good, edit.key, edit.value), edit.names);
  }
  const std::string one_line = one_line_certificate(good);
  expect_refused(without(one_line, "certificate"), "certificate");
  expect_refused(with(one_line, "certificate", "1"), "\"certificate\"");
  expect_refused(with(one_line, "certificate", "{}"), "\"low_price_eur_per_mwh\"");
  std::istringstream keys(
      "format version architecture_hash weights_hash provenance low_price_eur_per_mwh "
      "high_price_eur_per_mwh states_checked "
      "states_evaluated violations_property_1 violations_property_2 price_map context "
      "level_edge_eur_per_mwh layer1_weight "
      "layer1_bias relu1_shift layer2_weight layer2_bias relu2_shift layer3_weight");
  for (std::string key; keys >> key;) {
    SCOPED_TRACE(key);
    expect_refused(without(good, key), key);
    expect_refused(with(good, key, "null"), key);
  }
  const std::size_t end = good.rfind('}');
  for (std::size_t size = 0; size < end; size += 997) expect_refused(good.substr(0, size), "JSON");
  expect_refused(good.substr(0, end), "JSON");
}

TEST(StudentFile, EveryFlippedDigitIsNoticed) {
  const std::string good = seeded_text();
  const std::size_t first = good.find("\"price_map\"");
  Random random(601);
  for (int round = 0; round < 200; ++round) {
    std::string text = good;
    std::size_t at = first;
    do {
      at = first + random.index(good.size() - first);
    } while (good[at] < '2' || good[at] > '8');  // digits only, never a leading zero
    ++text[at];
    if (text.compare(good.rfind('"', at) - 6, 6, "relu1_") == 0) continue;
    EXPECT_THROW(static_cast<void>(parse_student(text, "flipped")), UserError) << at;
  }
}

TEST(StudentFile, ANetThatCouldOverflowIsNotSaved) {
  const TemporaryFolder folder;
  StudentFile student = seeded_student();
  student.net.layer1.bias[0] = std::numeric_limits<std::int32_t>::max();
  EXPECT_THROW(save_student(folder.file("student.json"), student), UserError);
  EXPECT_FALSE(std::filesystem::exists(folder.file("student.json")));
}

// Student as the edge runs it: with the rules of its guard, and nothing more.

constexpr int kEvening = 76;  ///< 19:00

MarketStep step_at(int quarter_hour, double price) {
  MarketStep step{};
  step.quarter_hour = static_cast<std::int8_t>(quarter_hour);
  step.month = 1;
  step.observed_eur_per_mwh = price;
  return step;
}

TEST(ExportedPolicy, IsTheStudentBehindItsGuard) {
  StudentFile student{.net = LinearNet{}.net(), .certificate = {}, .provenance = ""};
  student.certificate.rules = one_rule("hours = \"18:00-21:00\"\npower_max = 0.5\nenforce = true");
  RuleSet& rules = student.certificate.rules;
  rules.rules.push_back(
      one_rule("hours = \"18:00-21:00\"\nat_least = \"idle\"\nenforce = true", "keep").rules[0]);
  rules.rules.push_back(one_rule("at_most = \"idle\"", "not enforced").rules[0]);
  const std::unique_ptr<Policy> policy = exported_policy(student);
  EXPECT_EQ(policy->decide(step_at(0, 1400), 0, 0.5), Action::kDischarge) << "as the student";
  EXPECT_EQ(policy->decide(step_at(kEvening, 1400), 0, 0.5), Action::kIdle) << "the guard's";
  EXPECT_EQ(policy->decide(step_at(kEvening, -400), 0, 0.5), Action::kCharge)
      << "a rule without enforce only affects the proof";
  EXPECT_EQ(policy->power_share_max(step_at(0, 0), 0.5), 1);
  EXPECT_EQ(policy->power_share_max(step_at(kEvening, 0), 0.5), 0.5);
}

}  // namespace
}  // namespace bess
