#include "edge/page/day_chart.h"

#include <algorithm>
#include <cmath>

#include "edge/page/svg.h"
#include "shared/host/text.h"
#include "shared/local_text.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr double kWidth = 960;
constexpr double kLeft = 58;
constexpr double kRight = 948;

/// One strip of the picture.
struct Panel {
  double top;
  double bottom;
  const char* title;
};
constexpr Panel kPrice{24, 214, "price, EUR/MWh; coloured where it charges or discharges"};
constexpr Panel kSoc{250, 340, "state of charge, %"};
constexpr Panel kPower{376, 466, "power, kW: ordered broad, measured thin"};
constexpr double kHeight = 496;

double price_of(const CycleRecord& record) {
  return static_cast<double>(record.price.price_centi_eur_per_mwh) / kCentiPerEur;
}

std::string frame(const Panel& panel, const Scale& y, int ticks) {
  return svg_text(kLeft, panel.top - 8, "start", panel.title) +
         horizontal_grid(y, kLeft, kRight, ticks);
}

/// A band for each run of cycles that order in the same direction.
std::string bands(const std::vector<CycleRecord>& records, const Scale& x) {
  std::string text;
  for (std::size_t begin = 0; begin < records.size();) {
    const auto sign = [](const CycleRecord& r) {
      return (r.ordered_power_w > 0) - (r.ordered_power_w < 0);
    };
    std::size_t end = begin + 1;
    while (end < records.size() && sign(records[end]) == sign(records[begin]) &&
           records[end].utc_s - records[end - 1].utc_s <= kSecondsPerStep) {
      ++end;
    }
    const double from = x.at(static_cast<double>(records[begin].utc_s));
    const double to = x.inside(static_cast<double>(records[end - 1].utc_s + kSecondsPerStep));
    if (sign(records[begin]) != 0) {
      text += formatted(
          "<rect class=\"%s\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"><title>%s to "
          "%s: "
          "%s</title></rect>\n",
          sign(records[begin]) > 0 ? "charge" : "discharge", from, kPrice.top, to - from,
          kPrice.bottom - kPrice.top, local_clock_text(records[begin].utc_s).c_str(),
          local_clock_text(records[end - 1].utc_s + kSecondsPerStep).c_str(),
          sign(records[begin]) > 0 ? "charging" : "discharging");
    }
    begin = end;
  }
  return text;
}

/// Steps through the cycles that have a value; a hole of the log is a hole of the line.
template <typename Has, typename ValueOf>
std::string steps(const std::vector<CycleRecord>& records, const Scale& x, const Scale& y,
                  const Has& has, const ValueOf& value_of, const char* css_class) {
  std::string path;
  std::int64_t drawn_to_utc_s = 0;
  for (const CycleRecord& record : records) {
    if (!has(record)) continue;
    const double from = x.at(static_cast<double>(record.utc_s));
    const double to = x.inside(static_cast<double>(record.utc_s + kSecondsPerStep));
    const double height = y.inside(value_of(record));
    path += (record.utc_s == drawn_to_utc_s ? "L" : "M") + place(from, height);
    path += "L" + place(to, height);
    drawn_to_utc_s = record.utc_s + kSecondsPerStep;
  }
  if (path.empty()) return "";
  return formatted("<path class=\"%s\" d=\"", css_class) + path + "\"/>\n";
}

std::string hours(const DaySpan& day, const Scale& x) {
  std::string text;
  for (std::int64_t utc_s = day.start_utc_s; utc_s <= day.end_utc_s; utc_s += 3'600) {
    const int hour = local_minute_of(utc_s).minute_of_day / 60;
    if (hour % 3 != 0) continue;
    const double across = x.at(static_cast<double>(utc_s));
    text += svg_line(across, kPrice.top, across, kPower.bottom, "grid");
    text += svg_text(across, kPower.bottom + 18, "middle",
                     utc_s == day.end_utc_s ? "24" : formatted("%02d", hour));
  }
  return text;
}

Scale price_axis(const std::vector<CycleRecord>& records) {
  double low = 0;
  double high = 100;
  for (const CycleRecord& record : records) {
    if (!record.price.has_row) continue;
    low = std::min(low, price_of(record));
    high = std::max(high, price_of(record));
  }
  return {.low = low, .high = high, .from = kPrice.bottom, .to = kPrice.top};
}

Scale power_axis(const std::vector<CycleRecord>& records) {
  double most_kw = 1;
  for (const CycleRecord& record : records) {
    most_kw = std::max(most_kw, std::abs(record.ordered_power_w) / 1e3);
    if (record.has_measurement) {
      most_kw = std::max(most_kw, std::abs(record.measurement.power_w) / 1e3);
    }
  }
  return {.low = -most_kw, .high = most_kw, .from = kPower.bottom, .to = kPower.top};
}

}  // namespace

DaySpan day_span_at(std::int64_t utc_s) {
  const LocalMinute now = local_minute_of(utc_s);
  CivilTime midnight{};
  midnight.year = now.year;
  midnight.month = now.month;
  midnight.day = now.day;
  const std::int64_t start = utc_from_local(midnight);
  const LocalMinute next = local_minute_of(start + 30 * 3'600);  // some hour of the day after
  midnight.year = next.year;
  midnight.month = next.month;
  midnight.day = next.day;
  return {start, utc_from_local(midnight)};
}

std::string day_picture(const std::vector<CycleRecord>& records, const DaySpan& day) {
  const Scale x{.low = static_cast<double>(day.start_utc_s),
                .high = static_cast<double>(day.end_utc_s),
                .from = kLeft,
                .to = kRight};
  const Scale price = price_axis(records);
  const Scale soc{.low = 0, .high = 100, .from = kSoc.bottom, .to = kSoc.top};
  const Scale power = power_axis(records);
  const auto is_measured = [](const CycleRecord& r) { return r.has_measurement; };
  std::string text = formatted(
      "<svg viewBox=\"0 0 %.0f %.0f\" role=\"img\" aria-labelledby=\"day-title\">\n"
      "<title id=\"day-title\">Today: price and orders, state of charge, power; the numbers are in "
      "api/today</title>\n",
      kWidth, kHeight);
  text += bands(records, x) + hours(day, x);
  text += frame(kPrice, price, 6) + frame(kSoc, soc, 3) + frame(kPower, power, 5);
  text += steps(
      records, x, price, [](const CycleRecord& r) { return r.price.has_row; }, price_of, "price");
  text += steps(
      records, x, soc, is_measured,
      [](const CycleRecord& r) { return r.measurement.soc_e4 / 100.0; }, "soc");
  text += steps(
      records, x, power, [](const CycleRecord& r) { return r.written; },
      [](const CycleRecord& r) { return r.ordered_power_w / 1e3; }, "ordered");
  text += steps(
      records, x, power, is_measured,
      [](const CycleRecord& r) { return r.measurement.power_w / 1e3; }, "measured");
  return text + "</svg>\n";
}

Json day_json(const std::vector<CycleRecord>& records) {
  Json list = Json::list();
  for (const CycleRecord& r : records) {
    Json cycle = Json::object({{"utc", utc_text(r.utc_s).view()},
                               {"local", local_text(r.utc_s).view()},
                               {"ordered_power_w", r.ordered_power_w},
                               {"reason", reason_name(r.reason)},
                               {"mode", mode_name(r.mode)}});
    cycle.set("price_eur_per_mwh", r.price.has_row ? Json(Decimals{price_of(r), 2}) : Json::null());
    cycle.set("soc_percent",
              r.has_measurement ? Json(Decimals{r.measurement.soc_e4 / 100.0, 2}) : Json::null());
    cycle.set("battery_power_w", r.has_measurement ? Json(r.measurement.power_w) : Json::null());
    list.add(std::move(cycle));
  }
  return list;
}

}  // namespace bess
