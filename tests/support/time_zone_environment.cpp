// Every test of this binary runs in the market's local time, as bess-train does.
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
