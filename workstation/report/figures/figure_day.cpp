// One day as the battery lived it: prices, orders, state of charge.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "shared/utc_text.h"
#include "workstation/report/figures/figures.h"

namespace bess {
namespace {

constexpr double kSecondsPerHour = 3600;
constexpr int kTicQuarterHours = 12;  ///< a label every three local hours

double hours_of(const DayStory& story, std::size_t i) {
  return static_cast<double>(story.steps[i].utc_s - story.steps.front().utc_s) / kSecondsPerHour;
}

double end_hours_of(const DayStory& story) {
  return hours_of(story, story.steps.size() - 1) + kHoursPerStep;
}

/// Labels are local wall time, also on the days on which the clocks change.
std::string time_tics(const DayStory& story, bool labelled) {
  std::string text = "set xtics (";
  int last_labelled = -1;
  for (std::size_t i = 0; i < story.steps.size(); ++i) {
    const int quarter_hour = story.steps[i].quarter_hour;
    if (quarter_hour % kTicQuarterHours != 0 || quarter_hour == last_labelled) continue;
    last_labelled = quarter_hour;
    const std::string label = labelled ? fmt::format("{:02}:00", quarter_hour / 4) : "";
    text += fmt::format("'{}' {:.4f}, ", label, hours_of(story, i));
  }
  return text + fmt::format("'{}' {:.4f})\n", labelled ? "24:00" : "", end_hours_of(story));
}

std::vector<std::string> step_rows(const DayStory& story) {
  std::vector<std::string> rows;
  for (std::size_t i = 0; i < story.records.size(); ++i) {
    const StepRecord& r = story.records[i];
    rows.push_back(fmt::format("{:.4f} {:.2f} {:.2f} {:.3f}", hours_of(story, i),
                               r.observed_eur_per_mwh, r.paid_eur_per_mwh, 100 * r.soc_frac));
  }
  return rows;
}

/// Stretches with this order; `flowing` tells those in which power flowed from those at a bound.
std::vector<std::string> band_rows(const DayStory& story, Action action, bool flowing) {
  std::vector<std::string> rows;
  const auto belongs = [&](const StepRecord& r) {
    return r.action == action && (std::fabs(r.power_w) > 0) == flowing;
  };
  for (std::size_t i = 0; i < story.records.size(); ++i) {
    if (!belongs(story.records[i])) continue;
    const std::size_t first = i;
    while (i + 1 < story.records.size() && belongs(story.records[i + 1])) ++i;
    const double start = hours_of(story, first), end = hours_of(story, i) + kHoursPerStep;
    rows.push_back(fmt::format("{:.4f} {:.4f}", start, end));
  }
  if (rows.empty()) rows.emplace_back("NaN NaN");
  return rows;
}

PictureTable numbers_of(const DayStory& story) {
  PictureTable table{
      {}, {"utc", "observed_eur_per_mwh", "paid_eur_per_mwh", "soc_frac", "action", "power_w"}, {}};
  for (const StepRecord& r : story.records) {
    table.rows.push_back({std::string(utc_text(r.utc_s).view()), exact(r.observed_eur_per_mwh),
                          exact(r.paid_eur_per_mwh), exact(r.soc_frac),
                          std::string(action_name(r.action)), exact(r.power_w)});
  }
  return table;
}

constexpr double kFlowingDensity = 0.34;  ///< of a band's tint
constexpr double kAtBoundDensity = 0.10;

/// Tinted over the whole height of a panel.
std::string bands(double low, double high) {
  std::string text;
  const auto add = [&](const char* data, const Colour& colour, double density) {
    text += fmt::format(
        "${0} using 1:({1}):1:2:({1}):({2}) with boxxyerror fs transparent solid {3} noborder fc "
        "{4}, ",
        data, low, high, density, rgb(colour));
  };
  add("charge", kCharge, kFlowingDensity);
  add("discharge", kDischarge, kFlowingDensity);
  add("charge_full", kCharge, kAtBoundDensity);
  add("discharge_empty", kDischarge, kAtBoundDensity);
  return text;
}

struct PriceRange {
  double low, high;
};

PriceRange price_range(const DayStory& story) {
  PriceRange range{0, 0};
  for (const StepRecord& r : story.records) {
    range.low = std::min({range.low, r.observed_eur_per_mwh, r.paid_eur_per_mwh});
    range.high = std::max({range.high, r.observed_eur_per_mwh, r.paid_eur_per_mwh});
  }
  const double room = 0.05 * std::max(range.high - range.low, 1.0);
  return {range.low - room, range.high + room};
}

/// Room for the numbers of the price axis and its name: of five digits and more they need more.
double left_margin(const PriceRange& range) {
  constexpr double kFiveDigits = 10'000;
  return range.low <= -kFiveDigits || range.high >= kFiveDigits ? 0.135 : 0.10;
}

std::string price_panel(const DayStory& story) {
  const PriceRange range = price_range(story);
  return fmt::format(
             "set tmargin at screen 0.915\nset bmargin at screen 0.40\nset yrange [{0}:{1}]\n"
             "set ylabel 'price, EUR/MWh'\n"
             "plot {2}",
             range.low, range.high, bands(range.low, range.high)) +
         fmt::format(
             "$day using 1:2 with steps lw 1.2 lc {}, "
             "$day using 1:3 with steps lw 2 lc {}\n",
             rgb(kMuted), rgb(kInk));
}

std::string soc_panel(const DayStory& story) {
  return fmt::format(
      "set tmargin at screen 0.345\nset bmargin at screen 0.125\nset yrange [0:105]\n"
      "set ytics 0,25,100\nset ylabel 'charge, %'\n"
      "set xlabel 'local time'\n{}"
      "set arrow 1 from graph 0, first {} to graph 1, first {} nohead front dt (4,6) lw 1.2 lc {}\n"
      "plot {}$day using 1:4 with lines lw 2.5 lc {}\n",
      time_tics(story, true), 100 * story.battery.soc_min_frac, 100 * story.battery.soc_min_frac,
      rgb(kInk), bands(0, 105), rgb(kInk));
}

double day_profit_eur_per_mwh(const DayStory& story) {
  double eur = 0;
  for (const StepRecord& r : story.records) eur += r.profit_eur;
  return eur / (story.battery.capacity_wh / 1e6);
}

std::string caption_of(const DayStory& story) {
  const auto [low, high] =
      std::ranges::minmax_element(story.records, {}, &StepRecord::paid_eur_per_mwh);
  return fmt::format(
      "{} is the test day whose paid price ranged furthest, from {:.0f} to {:.0f} EUR/MWh. The {} "
      "earned {:.0f} EUR per MWh of capacity that day. Paler bands: ordered, but the battery was "
      "full or empty and nothing flowed. What is paid is known only after each quarter-hour.",
      story.date, low->paid_eur_per_mwh, high->paid_eur_per_mwh, story.policy,
      day_profit_eur_per_mwh(story));
}

}  // namespace

Figure day_figure(const DayStory& story) {
  Figure figure;
  figure.name = "test_day";
  figure.title = fmt::format("One day, {}: {}", story.date, story.policy);
  figure.height_px = 560;
  figure.alt = fmt::format(
      "Two panels over the hours of {}: observed and paid price with charging and discharging as "
      "coloured bands, and the state of charge below.",
      story.date);
  figure.caption = caption_of(story);
  figure.numbers = numbers_of(story);
  const KeyRow key =
      key_row(figure, 88,
              {{"charging", kCharge, KeyEntry::Kind::kArea, 0, kFlowingDensity},
               {"discharging", kDischarge, KeyEntry::Kind::kArea, 0, kFlowingDensity},
               {"price observed", kMuted, KeyEntry::Kind::kLine, 1.2},
               {"price paid", kInk, KeyEntry::Kind::kLine, 2}});
  figure.commands = data_block("day", step_rows(story)) +
                    data_block("charge", band_rows(story, Action::kCharge, true)) +
                    data_block("discharge", band_rows(story, Action::kDischarge, true)) +
                    data_block("charge_full", band_rows(story, Action::kCharge, false)) +
                    data_block("discharge_empty", band_rows(story, Action::kDischarge, false)) +
                    fmt::format(
                        "set multiplot\nset lmargin at screen {}\n"
                        "set rmargin at screen 0.97\nset xrange [0:{:.4f}]\n",
                        left_margin(price_range(story)), end_hours_of(story)) +
                    time_tics(story, false) + key.set + price_panel(story) + key.unset +
                    soc_panel(story) + "unset multiplot\n";
  return figure;
}

const MarketDay* widest_test_day(const MarketSteps& market) {
  const MarketDay* widest = nullptr;
  double widest_range = -1;
  for (const MarketDay& day : market.days) {
    if (day.split != Split::kTest) continue;
    const auto [low, high] =
        std::ranges::minmax_element(market.of(day), {}, &MarketStep::paid_eur_per_mwh);
    const double range = high->paid_eur_per_mwh - low->paid_eur_per_mwh;
    if (range <= widest_range) continue;
    widest_range = range;
    widest = &day;
  }
  return widest;
}

}  // namespace bess
