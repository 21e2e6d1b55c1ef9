#include "workstation/report/figures/policy_map.h"

#include "tests/workstation/report/report_test_support.h"
#include "workstation/student/verify.h"

namespace bess {
namespace {

TEST(PolicyMap, AGridIsTheStudentItself) {
  const StudentNet net = untrained_student();
  const ActionGrid grid =
      student_grid(net, {.context_class = 1, .quarter_hour = 48, .minute_of_quarter_hour = 7});
  ASSERT_EQ(grid.size(), static_cast<std::size_t>(kSocCount * kPriceCount));
  for (int soc = 0; soc < kSocCount; soc += 25) {
    for (int p = 0; p < kPriceCount; p += 100) {
      const auto price = static_cast<std::int16_t>(kLatticePriceMinEurPerMwh + p);
      const Action decided = net.decide({7, 48, 1, static_cast<std::int16_t>(soc), price});
      EXPECT_EQ(grid[static_cast<std::size_t>(soc * kPriceCount + p)],
                static_cast<std::int8_t>(decided));
    }
  }
}

}  // namespace
}  // namespace bess
