// Time zone of this test binary: the market's local time, as in bess-train.
#include <gtest/gtest.h>

#include "shared/local_time.h"

namespace {

class TimeZoneEnvironment : public testing::Environment {
 public:
  void SetUp() override { bess::set_market_time_zone(); }
};

const testing::Environment* const environment =
    testing::AddGlobalTestEnvironment(new TimeZoneEnvironment);

}  // namespace
