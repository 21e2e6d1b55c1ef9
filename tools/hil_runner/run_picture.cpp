#include "tools/hil_runner/run_picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "shared/host/file.h"
#include "shared/host/gnuplot.h"
#include "shared/scaled_clock.h"
#include "tools/hil_runner/command_timeline.h"
#include "tools/hil_runner/work_folder.h"

namespace bess {
namespace {

constexpr const char* kChargeColour = "#0072b2";
constexpr const char* kDischargeColour = "#d55e00";
constexpr const char* kRestColour = "#8a8f98";
constexpr std::size_t kDrawnPointsMax = 3'000;  ///< a picture is 900 pixels wide

std::string svg_of(const std::string& commands, int height_px) {
  const WorkFolder folder;
  const std::string path = folder.file("picture.svg");
  draw_with_gnuplot(path, [&](const std::filesystem::path& out) {
    return fmt::format(
               "set terminal svg size 900,{} noenhanced font 'Helvetica,13' background '#ffffff'\n"
               "set output {}\nset border 3\nset tics nomirror out scale 0.5\nunset key\n"
               "set grid lc rgb '#e3e6ea'\nset lmargin 10\nset rmargin 2\nset bmargin 2\n"
               "set tmargin 1\n",
               height_px, gnuplot_quoted(out.string())) +
           commands;
  });
  const std::string file = read_file(path);
  const std::size_t begin = file.find("<svg");
  return begin == std::string::npos ? "" : file.substr(begin);
}

/// `$name << EOD` with one row a point, thinned to what can be seen.
template <typename Row>
std::string block(const char* name, std::size_t count, const Row& row) {
  std::string text = fmt::format("${} << EOD\n", name);
  const std::size_t stride = std::max<std::size_t>(1, count / kDrawnPointsMax);
  for (std::size_t i = 0; i < count; i += stride) text += row(i);
  return text + "EOD\n";
}

const char* colour_of(const CommandInForce& command) {
  if (command.power_w > 0) return kChargeColour;
  return command.power_w < 0 ? kDischargeColour : kRestColour;
}

class RunPicture {
 public:
  RunPicture(const Outcome& outcome, const MinuteSpan& span)
      : outcome_(outcome),
        scenario_(outcome.scenario),
        commands_(outcome.evidence.orders),
        from_min_(span.from_min),
        to_min_(std::min(span.to_min, outcome.scenario.minutes)) {}

  std::string svg() const {
    std::string text = data() + bands();
    text += fmt::format("set xrange [{}:{}]\nset multiplot layout 4,1\nset format x ''\n",
                        from_min_, to_min_);
    text += "set ylabel 'EUR/MWh'\nplot $prices using 1:2 with steps lc rgb '#333333'\n";
    text +=
        "set ylabel 'W'\nplot $orders using 1:2 with steps lw 2 lc rgb '#0072b2', "
        "$minutes using 1:2 with steps lc rgb '#d55e00'\n";
    text +=
        "set ylabel 'SoC'\nset yrange [0:1]\nplot $minutes using 1:3 with lines lw 2 lc rgb "
        "'#009e73'\n";
    text +=
        "set ylabel 'mode'\nset format x '%g'\nset yrange [-0.5:4.5]\nset ytics ('start' 0, "
        "'running' 1, 'holding' 2, 'safe' 3, 'stopping' 4)\n"
        "plot $modes using 1:2 with steps lw 2 lc rgb '#333333'\nunset multiplot\n";
    return svg_of(text, 620);
  }

 private:
  [[nodiscard]] double minute_of(std::int64_t utc_s) const {
    return static_cast<double>(utc_s - scenario_.start_utc_s) / 60;
  }

  [[nodiscard]] std::string data() const {
    const Evidence& e = outcome_.evidence;
    const MinuteSeries& prices = outcome_.prices;
    const auto first = static_cast<std::size_t>((scenario_.start_utc_s - prices.start_utc_s) / 60 +
                                                static_cast<std::int64_t>(from_min_));
    const auto minutes = static_cast<std::size_t>(to_min_ - from_min_);
    std::string text = block("prices", minutes, [&](std::size_t i) {
      const double price = prices.indicative[first + i];
      const double minute = from_min_ + static_cast<double>(i);
      return std::isnan(price) ? std::string("\n") : fmt::format("{} {}\n", minute, price);
    });
    text += block("minutes", e.minutes.size(), [&](std::size_t i) {
      const MinuteRecord& m = e.minutes[i];
      return fmt::format("{} {} {}\n", minute_of(m.minute_utc_s), 60 * m.energy_wh, m.soc_frac);
    });
    text += block("orders", e.orders.size(), [&](std::size_t i) {
      const DispatchEvent& order = e.orders[i];
      return fmt::format("{} {}\n", minute_of(order.utc_ns / kNanosecondsPerSecond), order.power_w);
    });
    text += block("modes", e.log.size(), [&](std::size_t i) {
      return fmt::format("{} {}\n", minute_of(e.log[i].utc_s), static_cast<int>(e.log[i].mode));
    });
    return text;
  }

  /// What went wrong, where: battery orange, prices grey, processes a line.
  [[nodiscard]] std::string bands() const {
    std::string text;
    int number = 0;
    const auto band = [&](double from, double to, const char* colour) {
      text += fmt::format(
          "set object {} rect from first {}, graph 0 to first {}, graph 1 fc rgb '{}' fs solid "
          "0.25 "
          "noborder behind\n",
          ++number, std::max(from, from_min_), std::min(to, to_min_), colour);
    };
    const FaultSchedule& battery = scenario_.battery_fault.schedule;
    if (!battery.faults.empty()) band(battery.from_s / 60, battery.to_s / 60, "#e69f00");
    if (scenario_.price_fault.fault != MarketFault::kNone) {
      band(scenario_.price_fault.span.from_min, scenario_.price_fault.span.to_min, "#999999");
    }
    for (const MinuteSpan& gap : scenario_.prices.missing)
      band(gap.from_min, gap.to_min, "#999999");
    for (const ScenarioEvent& event : scenario_.events) {
      text += fmt::format(
          "set arrow from first {0}, graph 0 to first {0}, graph 1 nohead dt 2 lc rgb "
          "'#cc79a7'\n",
          event.at_min);
    }
    return text;
  }

  const Outcome& outcome_;
  const Scenario& scenario_;
  CommandTimeline commands_;
  double from_min_, to_min_;
};

}  // namespace

std::string run_picture(const Outcome& outcome, const MinuteSpan& span) {
  return RunPicture(outcome, span).svg();
}

std::string orders_picture(const Evidence& evidence, const MinuteSeries& prices,
                           std::int64_t from_utc_s) {
  constexpr int kMinutes = 240;
  const CommandTimeline commands(evidence.orders);
  std::string power = "$power << EOD\n";
  for (const MinuteRecord& m : evidence.minutes) {
    const std::int64_t minute = (m.minute_utc_s - from_utc_s) / 60;
    if (m.minute_utc_s < from_utc_s || minute >= kMinutes) continue;
    // The order of the middle of the minute.
    const CommandInForce command = commands.at((m.minute_utc_s + 30) * kNanosecondsPerSecond);
    power += fmt::format("{} {} {}\n", minute, 60 * m.energy_wh,
                         std::string("0x") + (colour_of(command) + 1));
  }
  std::string price = "$price << EOD\n";
  for (int minute = 0; minute < kMinutes; ++minute) {
    const auto index = static_cast<std::size_t>((from_utc_s - prices.start_utc_s) / 60 + minute);
    const double value = prices.indicative[index];
    price += std::isnan(value) ? std::string("\n") : fmt::format("{} {}\n", minute, value);
  }
  return svg_of(power + "EOD\n" + price + "EOD\n" +
                    fmt::format("set xrange [0:{}]\nset multiplot layout 2,1\nset format x ''\n"
                                "set ylabel 'EUR/MWh'\nplot $price using 1:2 with steps lc rgb "
                                "'#333333'\nset format x '%g'\nset ylabel 'measured W'\n"
                                "set boxwidth 1\nset style fill solid noborder\n"
                                "plot $power using ($1+0.5):2:3 with boxes lc rgb variable\n"
                                "unset multiplot\n",
                                kMinutes),
                420);
}

}  // namespace bess
