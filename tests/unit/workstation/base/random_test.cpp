#include "workstation/data/market/model/simulated_market.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

TEST(Random, FirstNumbersAreFixedForEveryMachine) {
  Random random(5489);
  EXPECT_DOUBLE_EQ(random.uniform(),
                   static_cast<double>(14514284786278117030ull >> 11) * 0x1.0p-53);
}

TEST(Random, NormalHasMeanZeroAndDeviationOne) {
  Random random(3);
  constexpr int kCount = 200'000;
  double sum = 0, squares = 0, beyond_two = 0;
  for (int i = 0; i < kCount; ++i) {
    const double value = random.normal();
    sum += value;
    squares += value * value;
    beyond_two += value > 2 ? 1 : 0;
  }
  EXPECT_NEAR(sum / kCount, 0, 0.01);
  EXPECT_NEAR(squares / kCount, 1, 0.02);
  EXPECT_NEAR(beyond_two / kCount, 0.02275, 0.002);
}

TEST(Random, AutoregressionKeepsVarianceAndCorrelation) {
  Random random(4);
  UnitAutoregression process(0.8);
  constexpr int kCount = 200'000;
  double squares = 0, products = 0, before = process.next(random);
  for (int i = 0; i < kCount; ++i) {
    const double value = process.next(random);
    squares += value * value;
    products += value * before;
    before = value;
  }
  EXPECT_NEAR(squares / kCount, 1, 0.03);
  EXPECT_NEAR(products / kCount, 0.8, 0.03);
}

}  // namespace
}  // namespace bess
