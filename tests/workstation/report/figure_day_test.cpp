// The picture of one day: its axis holds prices of any size.
#include <gmock/gmock.h>

#include <vector>

#include "workstation/report/figures/figures.h"

namespace bess {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string commands_for(double eur_per_mwh) {
  const std::vector<MarketStep> steps(4, MarketStep{});
  std::vector<StepRecord> records;
  for (int step = 0; step < 4; ++step) {
    const double price = step == 1 ? eur_per_mwh : 90.0;
    records.push_back({.utc_s = 1'745'704'800 + 120 * step,
                       .observed_eur_per_mwh = price,
                       .paid_eur_per_mwh = price,
                       .level_eur_per_mwh = 90,
                       .soc_frac = 0.5,
                       .action = Action::kIdle,
                       .power_w = 0,
                       .profit_eur = 0});
  }
  const DayStory story{.date = "2025-04-27",
                       .policy = "corrected student",
                       .steps = steps,
                       .records = records,
                       .battery = {}};
  return day_figure(story).commands;
}

TEST(DayFigure, TheNameOfTheAxisHasRoomBesideFiveDigits) {
  EXPECT_THAT(commands_for(2'547.85), HasSubstr("set lmargin at screen 0.1\n"));
  EXPECT_THAT(commands_for(-999), HasSubstr("set lmargin at screen 0.1\n"));
  for (const double price : {25'907.54, -25'907.54, 99'999.0, -99'999.0}) {
    const std::string commands = commands_for(price);
    EXPECT_THAT(commands, HasSubstr("set lmargin at screen 0.135\n")) << price;
    EXPECT_THAT(commands, Not(HasSubstr("screen 0.1\n"))) << price;
  }
}

}  // namespace
}  // namespace bess
