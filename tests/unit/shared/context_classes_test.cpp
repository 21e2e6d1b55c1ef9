// Context classes of the student: the month, or the class of the price level, and the validity of
// its edges.
#include "shared/context_classes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace bess {
namespace {

/// Edges at -50, 0, 50, ... 450 EUR/MWh.
ContextClasses by_level() {
  ContextClasses classes{.kind = ContextKind::kLevel};
  for (int i = 0; i < kContextClassCount - 1; ++i) {
    classes.level_edge_eur_per_mwh[i] = static_cast<std::int16_t>(50 * i - 50);
  }
  return classes;
}

TEST(ContextClasses, ByMonthTheLevelDoesNotCount) {
  const ContextClasses classes;
  EXPECT_TRUE(classes.is_valid());
  for (int month = 1; month <= 12; ++month) {
    for (const std::int32_t level : {-50'000, 0, 150'000}) {
      EXPECT_EQ(classes.class_of(month, level), month);
    }
  }
}

TEST(ContextClasses, ByLevelAClassBeginsAtItsEdge) {
  const ContextClasses classes = by_level();
  EXPECT_TRUE(classes.is_valid());
  const struct {
    std::int32_t level_centi;
    int context_class;
  } cases[] = {{-50'000, 1}, {-5'001, 1}, {-5'000, 2},  {-1, 2},      {0, 3},       {4'999, 3},
               {5'000, 4},   {5'001, 4},  {44'999, 11}, {45'000, 12}, {150'000, 12}};
  for (const auto& c : cases) {
    for (const int month : {1, 12}) {
      EXPECT_EQ(classes.class_of(month, c.level_centi), c.context_class) << c.level_centi;
    }
  }
}

TEST(ContextClasses, EdgesRiseStrictlyAndAMonthHasNone) {
  ContextClasses classes = by_level();
  classes.level_edge_eur_per_mwh[5] = classes.level_edge_eur_per_mwh[4];
  EXPECT_FALSE(classes.is_valid());  // equal
  classes = by_level();
  std::swap(classes.level_edge_eur_per_mwh[9], classes.level_edge_eur_per_mwh[10]);
  EXPECT_FALSE(classes.is_valid());  // the last two the wrong way round
  EXPECT_FALSE((ContextClasses{.kind = ContextKind::kLevel}).is_valid());  // all 0
  classes = by_level();
  classes.kind = ContextKind::kMonth;
  EXPECT_FALSE(classes.is_valid());
  ContextClasses equal;
  std::fill(std::begin(equal.level_edge_eur_per_mwh), std::end(equal.level_edge_eur_per_mwh),
            std::int16_t{7});
  EXPECT_FALSE(equal.is_valid());
}

}  // namespace
}  // namespace bess
