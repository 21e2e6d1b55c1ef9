#include "workstation/data/market/series/local_date.h"

#include <gmock/gmock.h>

#include "shared/host/minute_file.h"
#include "shared/utc_text.h"
#include "tests/support/market_test_support.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

TEST(LocalDate, ReadsOnlyRealDates) {
  EXPECT_EQ(parse_local_date("2024-02-29", "--from"), (LocalDate{2024, 2, 29}));
  for (const char* bad : {"2023-02-29", "2023-1-1", "20230101", "2023-01-01T00", ""}) {
    EXPECT_THAT(user_error_of([&] { (void)parse_local_date(bad, "--from"); }),
                Names(fmt::format("--from \"{}\"", bad)));
  }
}

TEST(LocalDate, MidnightsFollowTheClock) {
  EXPECT_EQ(utc_text(local_midnight_utc_s({2023, 1, 1})), "2022-12-31T23:00:00Z");
  EXPECT_EQ(utc_text(local_midnight_utc_s({2023, 3, 26})), "2023-03-25T23:00:00Z");
  EXPECT_EQ(utc_text(local_midnight_utc_s({2023, 3, 27})), "2023-03-26T22:00:00Z");
  EXPECT_EQ(utc_text(local_midnight_utc_s({2023, 10, 30})), "2023-10-29T23:00:00Z");
}

TEST(LocalDate, DaysCrossMonthsAndYears) {
  EXPECT_EQ(add_days({2023, 12, 31}, 1), (LocalDate{2024, 1, 1}));
  EXPECT_EQ(add_days({2024, 3, 1}, -1), (LocalDate{2024, 2, 29}));
  EXPECT_EQ(format_local_date({2024, 3, 1}), "2024-03-01");
}

}  // namespace
}  // namespace bess
