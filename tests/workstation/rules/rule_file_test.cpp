// The rule file: what is read, what is written back, and what is refused with which mend.
#include "workstation/rules/rule_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/host/user_error.h"
#include "tests/support/rule_sets.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

using testing::HasSubstr;

TEST(RuleFile, EveryKeyIsRead) {
  const RuleSet set = one_rule(
      "hours = \"22:15-06:00\"\nmonths = [11, 12, 1]\nsoc_min = 0.1\nsoc_max = 0.305\n"
      "price_min = -100\nprice_max = 400\nis_not = \"charge\"\nenforce = true\n",
      "quiet, but (not) all");
  ASSERT_EQ(set.rules.size(), 1U);
  const Rule& rule = set.rules[0];
  EXPECT_EQ(rule.name, "quiet, but (not) all");
  EXPECT_EQ(rule.box, (RuleBox{-100, 400, 20, 61, 89, 31, 0xc01, kAllTwelve}));
  EXPECT_EQ(rule.actions(), action_bit(Action::kDischarge) | action_bit(Action::kIdle));
  EXPECT_TRUE(rule.enforce);
  EXPECT_EQ(rule.place, "test.toml:1");
  EXPECT_EQ(
      rule.text(),
      "22:15-06:00, months 1, 11, 12, SoC 10 to 30.5 %, price -100 to 400 EUR/MWh: the action "
      "is at most idle");
}

struct DemandCase {
  const char* lines;
  const char* text;
};

TEST(RuleFile, EveryDemandIsReadAndSaid) {
  const DemandCase cases[] = {
      {"is = \"idle\"", "always: the action is idle"},
      {"is_not = \"idle\"", "always: the action is not idle"},
      {"at_least = \"idle\"", "always: the action is at least idle"},
      {"at_most = \"discharge\"", "always: the action is discharge"},
      {"charge_at_or_below = -20", "price at most -20 EUR/MWh: the action is charge"},
      {"discharge_at_or_above = 900", "price at least 900 EUR/MWh: the action is discharge"},
      {"never_rises_with = \"soc\"", "the action never rises with the SoC"},
      {"never_falls_with = \"context_class\"", "the action never falls with the context class"},
      {"hours = \"18:00-24:00\"\npower_max = 0.25\nenforce = true",
       "18:00-00:00: at most 25 % of the rated power"},
      {"context_classes = [2, 1]\nat_most = \"idle\"", "classes 1, 2: the action is at most idle"},
  };
  for (const DemandCase& c : cases) {
    SCOPED_TRACE(c.lines);
    const RuleSet set = one_rule(c.lines);
    EXPECT_EQ(set.rules[0].text(), c.text);
    const RuleSet again = parse_rules(format_rules(set), "again.toml");
    ASSERT_EQ(again.rules.size(), 1U);
    EXPECT_EQ(again.rules[0].text(), c.text);
    EXPECT_EQ(again.rules[0].box, set.rules[0].box);
    EXPECT_EQ(again.rules[0].actions(), set.rules[0].actions());
    EXPECT_EQ(again.rules[0].demand->direction(), set.rules[0].demand->direction());
    EXPECT_EQ(again.rules[0].demand->power_permille_max(),
              set.rules[0].demand->power_permille_max());
    EXPECT_EQ(again.rules[0].enforce, set.rules[0].enforce);
    EXPECT_EQ(again.rules[0].is_threshold, set.rules[0].is_threshold);
  }
}

struct MistakeCase {
  const char* lines;
  const char* complaint;
};

TEST(RuleFile, AMistakeNamesLineKeyAndMend) {
  const MistakeCase cases[] = {
      {"", "asks for nothing: add one of is, is_not"},
      {"enforce = true", "asks for nothing: add one of is, is_not"},
      {"at_mostly = \"idle\"", "at_mostly is not a known key here; did you mean at_most?"},
      {"is = \"sleep\"", "is must be one of \"discharge\", \"idle\", \"charge\""},
      {"is = 1", "is must be text in quotes"},
      {"is = \"idle\"\nat_least = \"idle\"", "at_least is a second demand beside is"},
      {"at_least = \"discharge\"", "allows every action"},
      {"at_most = \"charge\"", "allows every action"},
      {"is = \"idle\"\nweekday = 1", "weekday is not a known key here"},
      {"is = \"idle\"\nhours = \"17:00\"", "hours must be two times in quarter-hours"},
      {"is = \"idle\"\nhours = \"17:00-20:10\"", "hours must be two times in quarter-hours"},
      {"is = \"idle\"\nhours = \"17:00-25:00\"", "hours must be two times in quarter-hours"},
      {"is = \"idle\"\nhours = \"17:00-17:00\"", "holds the whole day or nothing"},
      {"is = \"idle\"\nmonths = []", "months is empty"},
      {"is = \"idle\"\nmonths = [0]", "months must list whole numbers from 1 to 12"},
      {"is = \"idle\"\nmonths = [13]", "months must list whole numbers from 1 to 12"},
      {"is = \"idle\"\nmonths = [1]\ncontext_classes = [1]", "cannot stand beside months"},
      {"is = \"idle\"\nsoc_min = 0.333", "soc_min must be a multiple of 0.005"},
      {"is = \"idle\"\nsoc_max = 30", "soc_max must be a fraction between 0 and 1"},
      {"is = \"idle\"\nsoc_min = 0.5\nsoc_max = 0.4", "soc_max is below soc_min"},
      {"is = \"idle\"\nprice_min = 0.5", "price_min must be a whole number"},
      {"is = \"idle\"\nprice_max = 15001", "price_max must lie between -15000 and 15000"},
      {"is = \"idle\"\nprice_min = 2\nprice_max = 1", "price_max is below price_min"},
      {"never_falls_with = \"price\"", "contradicts property 3"},
      {"never_rises_with = \"weather\"", "never_rises_with must be one of"},
      {"never_rises_with = \"price\"\nprice_min = 3", "holds everywhere"},
      {"never_rises_with = \"price\"\nenforce = true", "enforce needs a demand on single states"},
      {"switches_max = 1", "switches_max is no rule any more"},
      {"switches_max = 2\nhours = \"17:00-18:00\"", "against to and fro keep a dead band"},
      {"is = \"idle\"\nswitches_max = 7", "write is_not = \"idle\""},
      {"power_max = 0.5", "is for the guard alone: add enforce = true"},
      {"power_max = 1\nenforce = true", "is all there is"},
      {"power_max = 2\nenforce = true", "power_max must lie between 0 and 1"},
      {"charge_at_or_below = 3\nenforce = true", "enforce is not for thresholds"},
      {"charge_at_or_below = 3\nsoc_min = 0.5", "holds at every hour and SoC"},
  };
  for (const MistakeCase& c : cases) {
    SCOPED_TRACE(c.lines);
    try {
      one_rule(c.lines);
      ADD_FAILURE() << "taken";
    } catch (const UserError& error) {
      EXPECT_THAT(error.what(), HasSubstr(c.complaint));
      EXPECT_THAT(error.what(), testing::StartsWith("test.toml:"));
    }
  }
}

TEST(RuleFile, NamesAreThereOnceAndFitEverywhere) {
  const auto complaint = [](const std::string& text) {
    try {
      parse_rules(text, "test.toml");
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  EXPECT_THAT(complaint("[[rule]]\nis = \"idle\"\n"), HasSubstr("name is missing"));
  for (const char* name : {"", "a/* b", "é", "0123456789012345678901234567890123456789x"}) {
    EXPECT_THAT(complaint(std::string("[[rule]]\nis = \"idle\"\nname = \"") + name + "\"\n"),
                HasSubstr("name must have 1 to 40 letters"))
        << name;
  }
  EXPECT_THAT(
      complaint("[[rule]]\nname = \"a\"\nis = \"idle\"\n[[rule]]\nname = \"a\"\nprice_min = "
                "2\nis_not = \"idle\"\n"),
      HasSubstr("test.toml:4: the name \"a\" is that of test.toml:1 already"));
  EXPECT_THAT(complaint("[[rule]]\nname = \"a\"\ncharge_at_or_below = 1\n[[rule]]\nname = "
                        "\"b\"\ncharge_at_or_below = 2\n"),
              HasSubstr("\"b\" is a second threshold beside \"a\""));
  EXPECT_THAT(complaint(""), HasSubstr("holds no [[rule]]"));
  EXPECT_THAT(complaint("rule = 3\n"), HasSubstr("must be a list"));
  EXPECT_THAT(complaint("[guard]\nrule = 3\n"), HasSubstr("guard is not a known key"));
}

TEST(RuleFile, FilesAddUpAndTheExamplesAreGood) {
  const RuleSet all = example_rules();
  ASSERT_EQ(all.rules.size(), std::size(kExampleRules));
  EXPECT_EQ(all.rules[0].name, "black-out reserve");
  EXPECT_EQ(all.guard_rules().size(), 5U) << "all of them are enforced";
  EXPECT_EQ(all.guard_rule_names().back(), "evening power cap");
  EXPECT_THROW(load_rules({example_rule_path("quiet_hours"), example_rule_path("quiet_hours")}),
               UserError)
      << "the same name twice";
  EXPECT_THROW(load_rules({"no/such/file.toml"}), UserError);
}

TEST(Rules, ThresholdsStandForThoseOfTheConfiguration) {
  const RuleSet set = one_rule("discharge_at_or_above = 2000");
  EXPECT_EQ(set.thresholds({-400, 1400}), (PriceThresholds{-400, 2000}));
  EXPECT_EQ(one_rule("charge_at_or_below = 7").thresholds({-400, 1400}),
            (PriceThresholds{7, 1400}));
}

struct BindingCase {
  const char* lines;
  bool by_level, by_month;
};

TEST(Rules, OnlyWhatAStudentSeesBindsIt) {
  const BindingCase cases[] = {
      {"price_min = 301\nat_most = \"idle\"", true, true},
      {"price_min = 1500\nat_most = \"idle\"", true, true},
      {"price_min = 1501\nat_most = \"idle\"", false, false},
      {"price_max = -501\nat_least = \"idle\"", false, false},
      {"months = [1]\nat_most = \"idle\"", false, true},
      {"power_max = 0.5\nenforce = true", false, false},
      {"discharge_at_or_above = 2000", false, false},
  };
  for (const BindingCase& c : cases) {
    const Rule rule = one_rule(c.lines).rules[0];
    EXPECT_EQ(binds_student(rule, ContextKind::kLevel), c.by_level) << c.lines;
    EXPECT_EQ(binds_student(rule, ContextKind::kMonth), c.by_month) << c.lines;
  }
}

}  // namespace
}  // namespace bess
