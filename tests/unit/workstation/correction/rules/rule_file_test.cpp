// Rule file: accepted keys, written rules, and refusals with their corrections.
#include "workstation/correction/rules/rule.h"

#include <gmock/gmock.h>

#include <set>

#include "tests/support/rule_sets.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"

namespace bess {
namespace {

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
  EXPECT_THAT(rule.text(), Names("22:15-06:00 1 11 12 10 30.5 % -100 400 EUR/MWh idle"));
}

struct DemandCase {
  const char* lines;
  const char* names;
};

TEST(RuleFile, EveryDemandIsReadAndSaid) {
  const DemandCase cases[] = {
      {"is = \"idle\"", "idle"},
      {"is_not = \"idle\"", "idle"},
      {"at_least = \"idle\"", "idle"},
      {"at_most = \"discharge\"", "discharge"},
      {"charge_at_or_below = -20", "-20 EUR/MWh charge"},
      {"discharge_at_or_above = 900", "900 EUR/MWh discharge"},
      {"never_rises_with = \"soc\"", "SoC"},
      {"never_falls_with = \"context_class\"", "class"},
      {"hours = \"18:00-24:00\"\npower_max = 0.25\nenforce = true", "18:00-00:00 25 %"},
      {"context_classes = [2, 1]\nat_most = \"idle\"", "1 2 idle"},
  };
  std::set<std::string> texts;
  for (const DemandCase& c : cases) {
    SCOPED_TRACE(c.lines);
    const RuleSet set = one_rule(c.lines);
    EXPECT_THAT(set.rules[0].text(), Names(c.names));
    EXPECT_TRUE(texts.insert(set.rules[0].text()).second) << "another's";
    const RuleSet again = parse_rules(format_rules(set), "again.toml");
    ASSERT_EQ(again.rules.size(), 1U);
    EXPECT_EQ(again.rules[0].text(), set.rules[0].text());
    EXPECT_EQ(again.rules[0].box, set.rules[0].box);
    EXPECT_EQ(again.rules[0].actions(), set.rules[0].actions());
    EXPECT_EQ(again.rules[0].demand->direction(), set.rules[0].demand->direction());
    EXPECT_EQ(again.rules[0].demand->power_permille_max(),
              set.rules[0].demand->power_permille_max());
    EXPECT_EQ(again.rules[0].enforce, set.rules[0].enforce);
    EXPECT_EQ(again.rules[0].is_threshold, set.rules[0].is_threshold);
  }
}

TEST(RuleFile, AMistakeNamesLineKeyAndCorrection) {
  const DemandCase cases[] = {
      {"", "test.toml is_not"},
      {"enforce = true", "test.toml is_not"},
      {"at_mostly = \"idle\"", "test.toml at_mostly at_most"},
      {"is = \"sleep\"", "test.toml is \"discharge\" \"idle\" \"charge\""},
      {"is = 1", "test.toml is"},
      {"is = \"idle\"\nat_least = \"idle\"", "test.toml at_least"},
      {"at_least = \"discharge\"", "test.toml at_least"},
      {"at_most = \"charge\"", "test.toml at_most"},
      {"is = \"idle\"\nweekday = 1", "test.toml weekday"},
      {"is = \"idle\"\nhours = \"17:00\"", "test.toml hours"},
      {"is = \"idle\"\nhours = \"17:00-20:10\"", "test.toml hours"},
      {"is = \"idle\"\nhours = \"17:00-25:00\"", "test.toml hours"},
      {"is = \"idle\"\nhours = \"17:00-17:00\"", "test.toml hours"},
      {"is = \"idle\"\nmonths = []", "test.toml months"},
      {"is = \"idle\"\nmonths = [0]", "test.toml months 1 12"},
      {"is = \"idle\"\nmonths = [13]", "test.toml months 1 12"},
      {"is = \"idle\"\nmonths = [1]\ncontext_classes = [1]", "test.toml:5 context_classes months"},
      {"is = \"idle\"\nsoc_min = 0.333", "test.toml soc_min 0.005"},
      {"is = \"idle\"\nsoc_max = 30", "test.toml soc_max 0 1"},
      {"is = \"idle\"\nsoc_min = 0.5\nsoc_max = 0.4", "test.toml soc_max soc_min"},
      {"is = \"idle\"\nprice_min = 0.5", "test.toml price_min"},
      {"is = \"idle\"\nprice_max = 15001", "test.toml price_max -15000 15000"},
      {"is = \"idle\"\nprice_min = 2\nprice_max = 1", "test.toml price_max price_min"},
      {"never_falls_with = \"price\"", "test.toml:3 never_falls_with"},
      {"never_rises_with = \"weather\"", "test.toml never_rises_with"},
      {"never_rises_with = \"price\"\nprice_min = 3", "test.toml:3 never_rises_with"},
      {"never_rises_with = \"price\"\nenforce = true", "test.toml enforce"},
      {"switches_max = 1", "test.toml switches_max"},
      {"switches_max = 2\nhours = \"17:00-18:00\"", "test.toml:3 switches_max is_not"},
      {"is = \"idle\"\nswitches_max = 7", "test.toml is_not \"idle\""},
      {"power_max = 0.5", "test.toml:3 power_max enforce = true"},
      {"power_max = 1\nenforce = true", "test.toml:3 power_max 1"},
      {"power_max = 2\nenforce = true", "test.toml power_max 0 1"},
      {"charge_at_or_below = 3\nenforce = true", "test.toml enforce"},
      {"charge_at_or_below = 3\nsoc_min = 0.5", "test.toml:3 charge_at_or_below"},
  };
  for (const DemandCase& c : cases) {
    SCOPED_TRACE(c.lines);
    EXPECT_THAT(refusal_of([&] { one_rule(c.lines); }), Names(c.names));
  }
}

TEST(RuleFile, NamesAreThereOnceAndFitEverywhere) {
  const auto complaint = [](const std::string& text) {
    return refusal_of([&] { parse_rules(text, "test.toml"); });
  };
  EXPECT_THAT(complaint("[[rule]]\nis = \"idle\"\n"), Names("test.toml:1 name"));
  for (const char* name : {"", "a/* b", "é", "0123456789012345678901234567890123456789x"}) {
    EXPECT_THAT(complaint(std::string("[[rule]]\nis = \"idle\"\nname = \"") + name + "\"\n"),
                Names("test.toml:3 name 1 40"))
        << name;
  }
  EXPECT_THAT(
      complaint("[[rule]]\nname = \"a\"\nis = \"idle\"\n[[rule]]\nname = \"a\"\nprice_min = "
                "2\nis_not = \"idle\"\n"),
      Names("test.toml:4 \"a\" test.toml:1"));
  EXPECT_THAT(complaint("[[rule]]\nname = \"a\"\ncharge_at_or_below = 1\n[[rule]]\nname = "
                        "\"b\"\ncharge_at_or_below = 2\n"),
              Names("test.toml:4 \"b\" \"a\" test.toml:1"));
  EXPECT_THAT(complaint(""), Names("test.toml [[rule]]"));
  EXPECT_THAT(complaint("rule = 3\n"), Names("test.toml:1 rule"));
  EXPECT_THAT(complaint("[guard]\nrule = 3\n"), Names("test.toml:1 guard"));
}

TEST(RuleFile, FilesAddUpAndTheExamplesAreGood) {
  const RuleSet all = example_rules();
  ASSERT_EQ(all.rules.size(), std::size(kExampleRules));
  EXPECT_EQ(all.rules[0].name, "black-out reserve");
  EXPECT_EQ(all.guard_rules().size(), 5U) << "all of them are enforced";
  EXPECT_EQ(all.rules.back().name, "evening power cap");
  EXPECT_THROW(load_rules({example_rule_path("quiet_hours"), example_rule_path("quiet_hours")}),
               UserError)
      << "the same name twice";
  EXPECT_THROW(load_rules({"no/such/file.toml"}), UserError);
}

TEST(Rules, ThresholdsReplaceThoseOfTheConfiguration) {
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
