// bess-train rules, as a user calls it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/user_error.h"
#include "tests/support/rule_sets.h"
#include "tests/support/small_market.h"
#include "tests/support/student_nets.h"
#include "tests/support/temporary_folder.h"
#include "workstation/chain/distilled_prices.h"
#include "workstation/cli/commands.h"
#include "workstation/student/student_file.h"

namespace bess {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class RulesCli : public testing::Test {
 protected:
  RulesCli() { write_minute_file(prices_, small_series(), ""); }

  /// Standard output of `bess-train WORDS`.
  static std::string output(const std::string& words) {
    CommandLine command_line("bess-train", "", "");
    ProgramCommand root = command_line.root();
    add_commands(root);
    testing::internal::CaptureStdout();
    try {
      command_line.parse(words);
    } catch (...) {
      testing::internal::GetCapturedStdout();
      throw;
    }
    return testing::internal::GetCapturedStdout();
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

TEST_F(RulesCli, CheckSaysWhomEachExampleBinds) {
  std::string files;
  for (const char* name : kExampleRules) files += " " + example_rule_path(name);
  const std::string by_level = rules_output("check --rules" + files);
  EXPECT_THAT(by_level, HasSubstr("quiet hours                               student and guard  "));
  EXPECT_THAT(by_level, HasSubstr("evening power cap                         guard              "));
  EXPECT_THAT(by_level, HasSubstr("black-out reserve                         guard              "));
  EXPECT_THAT(rules_output("check --context month --rules" + files),
              HasSubstr("black-out reserve                         student and guard  "));
}

TEST_F(RulesCli, CheckRefusesAContradiction) {
  const std::string file = rule_file("[[rule]]\nname = \"never sell\"\nat_least = \"idle\"\n");
  EXPECT_THROW(rules_output("check --rules " + file), UserError);
  EXPECT_THROW(rules_output("check --rules " + file + " --policy rbc"), UserError) << "no prices";
}

TEST_F(RulesCli, CheckCountsWhatAPolicyBreaks) {
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

TEST_F(RulesCli, PriceTellsEachRuleAloneAndAllTogether) {
  const std::string file = rule_file(
      "[[rule]]\nname = \"no trade\"\nis = \"idle\"\nprice_min = -499\nprice_max = 1499\n"
      "[[rule]]\nname = \"far\"\nprice_min = 1400\nat_most = \"idle\"\n"
      "[[rule]]\nname = \"steady\"\nnever_rises_with = \"minute\"\n");
  const std::string arguments = "price --rules " + file + " --policy rbc:20:150" + with_prices();
  const std::string text = rules_output(arguments);
  EXPECT_THAT(text,
              AllOf(HasSubstr("no trade "), HasSubstr("far "), HasSubstr("all together "),
                    HasSubstr("steady                                    no demand on single")));
  const std::vector<Json> lines = json_lines(rules_output(arguments + " --json"));
  const Json& first = lines.front();
  EXPECT_NEAR(number(first, "profit_eur_per_day_per_mwh"), 0, 1)
      << "idles wherever these prices go";
  EXPECT_LT(number(first, "gain_eur_per_day_per_mwh"), -100);
  EXPECT_GT(number(first, "gain_standard_error"), 0);
  EXPECT_THROW(rules_output("price --policy foresight --rules " + file + with_prices()), UserError);
}

using RulesLearnt = RulesCli;

/// Two seeds of three kinds of student, all of them proved; what is told of them, `evaluate` tells
/// of those kept.
TEST_F(RulesLearnt, EachIsPricedAloneAndAllTogetherByStudentsThatStay) {
  const std::string config = " --config " + folder_.write("a.toml", "[distil]\nepochs = 60\n");
  const std::string teacher = folder_.file("teacher.bin");
  output("train --steps 20 --out " + teacher + with_prices() + config);
  const std::string files =
      example_rule_path("quiet_hours") + " " + example_rule_path("no_dear_charging");
  const std::filesystem::path kept = folder_.file("kept");
  std::vector<Json> lines;
  for (Json& json : json_lines(rules_output("price --alone --seeds 2 --json --rules " + files +
                                            " --policy " + teacher + " --teacher " + teacher +
                                            " --keep " + kept.string() + with_prices() + config))) {
    const char* const by = json.value()["by"].text();
    if (by != nullptr && std::string_view(by) == "distillation") lines.push_back(std::move(json));
  }
  ASSERT_EQ(lines.size(), 3U);
  const auto earned = [&](const std::string& name) {
    double sum = 0;
    for (const char* seed : {"1", "2"}) {
      const std::string student = (kept / (name + ".seed-" + seed + ".json")).string();
      const std::string line = output("evaluate --json --split val+test --policy '" + student +
                                      "'" + with_prices() + config);
      sum += number(Json::parse(line), "profit_eur_per_day_per_mwh");
    }
    return sum / 2;
  };
  const double without = earned("without rules");
  const char* const names[] = {"quiet hours", "no dear charging", "all together"};
  for (std::size_t i = 0; i < lines.size(); ++i) {
    SCOPED_TRACE(names[i]);
    EXPECT_STREQ(lines[i].value()["rule"].text(), names[i]);
    EXPECT_EQ(number(lines[i], "violations"), 0);
    EXPECT_GT(number(lines[i], "states_checked"), 1e9);
    const double with = earned(names[i]);
    EXPECT_NEAR(number(lines[i], "profit_eur_per_day_per_mwh"), with, 1e-3);
    EXPECT_NEAR(number(lines[i], "profit_without_rules_eur_per_day_per_mwh"), without, 1e-3);
    EXPECT_NEAR(number(lines[i], "gain_eur_per_day_per_mwh"), with - without, 1e-3);
    EXPECT_GE(number(lines[i], "gain_deviation_over_seeds"), 0);
  }
  EXPECT_LT(number(lines[0], "gain_eur_per_day_per_mwh"), -50) << "a third of the day is quiet";
}

/// Two rules four EUR/MWh apart: consistent, and too steep for so few epochs.
TEST_F(RulesLearnt, AStudentThatIsNotProvedIsKeptUnderAnotherName) {
  const std::string config =
      " --config " + folder_.write("a.toml", "[distil]\nepochs = 2\nrepair_rounds = 0\n");
  const std::string rules = rule_file(
      "[[rule]]\nname = \"buy\"\nprice_max = 100\nhours = \"10:00-14:00\"\nis = \"charge\"\n"
      "[[rule]]\nname = \"sell\"\nprice_min = 104\nhours = \"12:00-13:00\"\nis = \"discharge\"\n");
  const std::string teacher = folder_.file("teacher.bin");
  output("train --steps 20 --out " + teacher + with_prices() + config);
  const std::string student = folder_.file("student.json");
  try {
    output("distil --teacher " + teacher + " --rules " + rules + " --out " + student +
           with_prices() + config);
    ADD_FAILURE() << "proved";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("kept as " + folder_.file("student_unproved.json")),
                                    HasSubstr("rule \"sell\" (12:00-13:00, "),
                                    HasSubstr("leave more than 4 EUR/MWh to \"buy\"")));
  }
  EXPECT_FALSE(std::filesystem::exists(student));
  const Certificate kept = load_student(folder_.file("student_unproved.json")).certificate;
  EXPECT_GT(kept.rule_counts()[1].violations, 0);
}

TEST_F(RulesCli, WhatIsAboutDistillingNeedsATeacher) {
  const std::string arguments =
      "price --policy rbc --rules " + example_rule_path("quiet_hours") + with_prices();
  for (const char* option : {" --alone", " --seeds 3", " --keep students"}) {
    EXPECT_THROW(rules_output(arguments + option), UserError) << option;
  }
}

Evaluation two_days(double first_eur, double second_eur) {
  return {.days = {{"a", first_eur, 0, 0, 0}, {"b", second_eur, 0, 0, 0}}, .capacity_mwh = 2};
}

/// Two seeds whose differences are 1, 3 and 3, 5 EUR on two days of 2 MWh: means 1 and 2 a MWh;
/// over seeds 2, 4 EUR a day.
TEST(DistilledPrices, TheErrorIsOverDaysAndTheSpreadOverSeeds) {
  const std::vector<Evaluation> without{two_days(10, 20), two_days(30, 40)};
  const std::vector<Evaluation> with{two_days(11, 23), two_days(33, 45)};
  const SeededDifference difference = seeded_difference(with, without);
  EXPECT_NEAR(difference.mean, 1.5, 1e-12);
  EXPECT_NEAR(difference.standard_error, 0.5, 1e-12);
  EXPECT_NEAR(difference.spread, std::sqrt(0.5), 1e-12);
  EXPECT_TRUE(std::isnan(seeded_difference({with[0]}, {without[0]}).spread)) << "one seed";
}

}  // namespace
}  // namespace bess
