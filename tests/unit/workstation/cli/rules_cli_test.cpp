// bess-train rules, as a user calls it.
#include <gmock/gmock.h>

#include <filesystem>

#include "shared/host/file.h"
#include "shared/host/json.h"
#include "tests/support/output_of_command.h"
#include "tests/support/rule_sets.h"
#include "tests/support/small_market.h"
#include "tests/support/student_nets.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"
#include "workstation/correction/student/student_file.h"

namespace bess {
namespace {

class RulesCli : public testing::Test {
 protected:
  RulesCli() { write_minute_file(prices_, small_series(), ""); }

  /// Standard output of `bess-train WORDS`.
  static std::string output(const std::string& words) {
    try {
      return output_of_command(words).output;
    } catch (...) {
      testing::internal::GetCapturedStderr();
      testing::internal::GetCapturedStdout();
      throw;
    }
  }
  static std::string rules_output(const std::string& arguments) {
    return output("rules " + arguments);
  }
  /// Of the JSON lines in `text`, one each.
  static std::vector<Json> json_lines(const std::string& text) {
    std::vector<Json> lines;
    for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1) {
      lines.push_back(Json::parse(text.substr(at, text.find('\n', at) - at)));
    }
    return lines;
  }
  static double number(const Json& json, const char* key) {
    return json.value()[key].number().value_or(NAN);
  }
  [[nodiscard]] std::string rule_file(const std::string& text) const {
    return folder_.write("rules.toml", text);
  }
  [[nodiscard]] std::string with_prices() const { return " --prices " + prices_.string(); }

  TemporaryFolder folder_;
  std::filesystem::path prices_ = folder_.file("prices.csv.gz");
};

TEST_F(RulesCli, CheckShowsWhatEachExampleBinds) {
  std::string files;
  for (const char* name : kExampleRules) files += " " + example_rule_path(name);
  const std::string by_level = rules_output("check --rules" + files);
  const auto binds_student = [](const std::string& table, const std::string& rule) {
    return has_code(table.substr(table.find(rule), 62), "student");
  };
  EXPECT_TRUE(binds_student(by_level, "quiet hours"));
  EXPECT_FALSE(binds_student(by_level, "evening power cap"));
  EXPECT_FALSE(binds_student(by_level, "black-out reserve"));
  EXPECT_TRUE(
      binds_student(rules_output("check --context month --rules" + files), "black-out reserve"));
}

TEST_F(RulesCli, CheckRefusesAContradiction) {
  const std::string file = rule_file("[[rule]]\nname = \"never sell\"\nat_least = \"idle\"\n");
  EXPECT_THROW(rules_output("check --rules " + file), UserError);
  EXPECT_THROW(rules_output("check --rules " + file + " --policy rbc"), UserError) << "no prices";
}

TEST_F(RulesCli, CheckCountsViolationsOfAPolicy) {
  const std::string file = rule_file(
      "[[rule]]\nname = \"dear\"\nprice_min = 100\nat_least = \"idle\"\nprice_max = 1400\n"
      "[[rule]]\nname = \"kept\"\nprice_min = 100\nat_most = \"idle\"\n");
  const std::vector<Json> lines = json_lines(
      rules_output("check --rules " + file + " --policy rbc:20:150 --json" + with_prices()));
  ASSERT_EQ(lines.size(), 6U) << "properties 1, 2, two directions, two rules";
  const Json& dear = lines[4];
  EXPECT_STREQ(dear.value()["rule"].text(), "dear");
  EXPECT_GT(number(dear, "visited_broken"), 0);
  EXPECT_LT(number(dear, "visited_broken"), number(dear, "visited"));
  EXPECT_GT(number(dear, "drawn"), number(dear, "visited"));
  const Json& kept = lines[5];
  EXPECT_EQ(number(kept, "visited_broken"), 0);
  EXPECT_GT(number(kept, "visited"), 0);
}

TEST_F(RulesCli, PriceShowsEachRuleAloneAndAllTogether) {
  const std::string file = rule_file(
      "[[rule]]\nname = \"no trade\"\nis = \"idle\"\nprice_min = -499\nprice_max = 1499\n"
      "[[rule]]\nname = \"far\"\nprice_min = 1400\nat_most = \"idle\"\n"
      "[[rule]]\nname = \"steady\"\nnever_rises_with = \"minute\"\n");
  const std::string arguments = "price --rules " + file + " --policy rbc:20:150" + with_prices();
  EXPECT_THAT(rules_output(arguments), testing::HasSubstr("\nsteady "));
  const std::vector<Json> lines = json_lines(rules_output(arguments + " --json"));
  const Json& first = lines.front();
  EXPECT_NEAR(number(first, "profit_eur_per_day_per_mwh"), 0, 1) << "idles at all of these prices";
  EXPECT_LT(number(first, "gain_eur_per_day_per_mwh"), -100);
  EXPECT_GT(number(first, "gain_standard_error"), 0);
  EXPECT_THROW(rules_output("price --policy foresight --rules " + file + with_prices()), UserError);
}

using RulesLearnt = RulesCli;

/// Two rules 4 EUR/MWh apart: consistent, and too steep for so few epochs.
TEST_F(RulesLearnt, AStudentThatIsNotProvedIsKeptUnderAnotherName) {
  const std::string config =
      " --config " + folder_.write("a.toml", "[distil]\nepochs = 2\nrepair_rounds = 0\n");
  const std::string rules = rule_file(
      "[[rule]]\nname = \"buy\"\nprice_max = 100\nhours = \"10:00-14:00\"\nis = \"charge\"\n"
      "[[rule]]\nname = \"sell\"\nprice_min = 104\nhours = \"12:00-13:00\"\nis = \"discharge\"\n");
  const std::string teacher = folder_.file("teacher.bin");
  output("train --steps 20 --out " + teacher + with_prices() + config);
  const std::string student = folder_.file("student.json");
  const std::string words =
      "distil --teacher " + teacher + " --rules " + rules + " --out " + student;
  EXPECT_THAT(
      refusal_of([&] { output(words + with_prices() + config); }),
      Names(folder_.file("student_unproved.json") + " \"sell\" 12:00-13:00 4 EUR/MWh \"buy\""));
  EXPECT_FALSE(std::filesystem::exists(student));
  const Certificate kept = load_student(folder_.file("student_unproved.json")).certificate;
  EXPECT_GT(kept.rule_counts()[1].violations, 0);
}

}  // namespace
}  // namespace bess
