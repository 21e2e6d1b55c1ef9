#include "workstation/report/figures/policy_map.h"

#include "tests/support/rule_sets.h"
#include "tests/workstation/report/report_test_support.h"
#include "workstation/student/verify.h"

namespace bess {
namespace {

constexpr PolicyContext kContext{
    .context_class = 1, .quarter_hour = 48, .minute_of_quarter_hour = 7};

std::size_t cell(int soc, int price) { return static_cast<std::size_t>(soc * kPriceCount + price); }

ActionGrid grid_of(Action action) {
  return ActionGrid(static_cast<std::size_t>(kSocCount * kPriceCount),
                    static_cast<std::int8_t>(action));
}

/// The grid that the rectangles of every action paint.
ActionGrid painted(const ActionGrid& grid) {
  ActionGrid copy(grid.size(), std::int8_t{-1});
  for (const Action action : {Action::kDischarge, Action::kIdle, Action::kCharge}) {
    for (const GridRectangle& r : rectangles_of(grid, action)) {
      for (int soc = r.soc_bottom; soc <= r.soc_top; ++soc) {
        for (int p = r.price_first; p <= r.price_last; ++p) {
          EXPECT_EQ(copy[cell(soc, p)], -1) << "painted twice";
          copy[cell(soc, p)] = static_cast<std::int8_t>(action);
        }
      }
    }
  }
  return copy;
}

TEST(PolicyMap, RectanglesCoverTheGridOnce) {
  const ActionGrid grid = student_grid(untrained_student(), kContext);
  EXPECT_EQ(painted(grid), grid);
  EXPECT_EQ(rectangles_of(grid_of(Action::kIdle), Action::kIdle).size(), 1u);
}

TEST(PolicyMap, GridsAreThePoliciesThemselves) {
  const StudentNet net = untrained_student();
  const ActionGrid student = student_grid(net, kContext);
  const Teacher teacher = untrained_teacher();
  const TeacherPolicy policy(teacher);
  const ActionGrid taught = teacher_grid(teacher, kContext);
  int disagreements = 0;  // rounding of a matrix against a vector product, at ties only
  for (int soc = 0; soc < kSocCount; soc += 25) {
    for (int p = 0; p < kPriceCount; p += 100) {
      const auto price = static_cast<std::int16_t>(kLatticePriceMinEurPerMwh + p);
      const Action decided = net.decide({7, 48, 1, static_cast<std::int16_t>(soc), price});
      EXPECT_EQ(student[cell(soc, p)], static_cast<std::int8_t>(decided));
      MarketStep step{};
      step.observed_eur_per_mwh = price;
      step.minute_of_quarter_hour = 7;
      step.quarter_hour = 48;
      step.month = 1;
      const Action taught_here = policy.decide(step, 0, soc / 200.0);
      disagreements += taught[cell(soc, p)] != static_cast<std::int8_t>(taught_here) ? 1 : 0;
    }
  }
  EXPECT_LE(disagreements, 1);
}

/// Midnight lies inside the first rule's hours; the second is of another month, the third a
/// direction, the fourth beyond the lattice and the guard's alone.
TEST(PolicyMap, OutlinesAreTheBoxesOfTheRulesThatHoldThen) {
  const RuleSet rules = parse_rules(
      "[[rule]]\nname = \"night\"\nhours = \"23:00-06:00\"\nprice_min = -100\nprice_max = 400\n"
      "soc_max = 0.5\nis = \"idle\"\n"
      "[[rule]]\nname = \"winter\"\nmonths = [12]\nprice_min = 300\nat_most = \"idle\"\n"
      "[[rule]]\nname = \"slope\"\nnever_rises_with = \"price\"\n"
      "[[rule]]\nname = \"far\"\nprice_min = 2000\nat_most = \"idle\"\nenforce = true\n",
      "test.toml");
  const PolicyContext night{.context_class = 1, .quarter_hour = 2, .minute_of_quarter_hour = 0};
  const std::vector<RuleOutline> outlines = rule_outlines(rules, ContextKind::kMonth, night);
  ASSERT_EQ(outlines.size(), 1u);
  EXPECT_EQ(outlines[0].name, "night");
  const GridRectangle& box = outlines[0].box;
  EXPECT_EQ(kLatticePriceMinEurPerMwh + box.price_first, -100);
  EXPECT_EQ(kLatticePriceMinEurPerMwh + box.price_last, 400);
  EXPECT_EQ(box.soc_bottom, 0);
  EXPECT_EQ(box.soc_top, 100);
  EXPECT_TRUE(rule_outlines(rules, ContextKind::kMonth, kContext).empty()) << "at noon";
  const PolicyContext winter{.context_class = 12, .quarter_hour = 48, .minute_of_quarter_hour = 0};
  EXPECT_EQ(rule_outlines(rules, ContextKind::kMonth, winter).size(), 1u);
  EXPECT_TRUE(rule_outlines(rules, ContextKind::kLevel, winter).empty()) << "months are not seen";
}

TEST(PolicyMap, WrongBordersJoinNeighbouringPairs) {
  ActionGrid grid = grid_of(Action::kIdle);
  EXPECT_TRUE(wrong_borders_of(grid).empty());
  for (int p = 10; p < 15; ++p) {
    for (int soc = 50; soc < kSocCount; ++soc) {
      grid[cell(soc, p)] = static_cast<std::int8_t>(Action::kCharge);
    }
  }
  const auto borders = wrong_borders_of(grid);  // below the block, and left of it
  ASSERT_EQ(borders.size(), 2u);
  EXPECT_TRUE(borders[0].along_price);
  EXPECT_EQ(borders[0].pairs, 5);
  EXPECT_EQ(borders[0].soc, 49);
  EXPECT_FALSE(borders[1].along_price);
  EXPECT_EQ(borders[1].pairs, kSocCount - 50);
  EXPECT_EQ(borders[1].price, 9);
}

}  // namespace
}  // namespace bess
