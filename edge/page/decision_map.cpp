#include "edge/page/decision_map.h"

#include <algorithm>

#include "edge/page/svg.h"
#include "shared/host/text.h"

namespace bess {
namespace {

constexpr double kWidth = 640;
constexpr double kHeight = 400;
constexpr double kLeft = 58;
constexpr double kRight = 612;
constexpr double kTop = 12;
constexpr double kBottom = 352;

double eur(std::int32_t centi) { return static_cast<double>(centi) / kCentiPerEur; }
double soc_percent(int index) { return 100.0 * index / (kSocCount - 1); }

/// All prices at which something changes, the present one, and some room.
Scale price_axis(const DecisionMap& map, const PresentPoint& now) {
  double low = now.price_eur_per_mwh;
  double high = now.price_eur_per_mwh;
  for (const DecisionMap::Column& column : map.columns) {
    low = std::min(low, eur(column.charge_up_to_centi));
    high = std::max(high, eur(column.discharge_from_centi));
  }
  const double room = std::max(20.0, (high - low) / 8);
  return {.low = low - room, .high = high + room, .from = kBottom, .to = kTop};
}

/// A staircase along one of the two prices, closed by the plot's edge.
template <typename PriceOf>
std::string area(const DecisionMap& map, const Scale& x, const Scale& y, const PriceOf& price_of,
                 double edge, const char* css_class) {
  std::string text = formatted("<path class=\"%s\" d=\"M", css_class) + place(kLeft, edge);
  const double half_step = 50.0 / (kSocCount - 1);
  for (int i = 0; i < kSocCount; ++i) {
    const double height = y.inside(eur(price_of(map.columns[static_cast<std::size_t>(i)])));
    text += "L" + place(x.inside(soc_percent(i) - half_step), height);
    text += "L" + place(x.inside(soc_percent(i) + half_step), height);
  }
  return text + "L" + place(kRight, edge) + "Z\"/>\n";
}

std::string present(const Scale& x, const Scale& y, const PresentPoint& now) {
  const double across = x.inside(now.soc_percent);
  const double up = y.inside(now.price_eur_per_mwh);
  return svg_line(kLeft, up, kRight, up, "now") + svg_line(across, kTop, across, kBottom, "now") +
         formatted("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"6\" class=\"here\"/>\n", across, up);
}

}  // namespace

DecisionMap make_decision_map(LatticeState at, const PriceThresholds& thresholds, Policy policy) {
  DecisionMap map;
  for (int i = 0; i < kSocCount; ++i) {
    at.soc_index = static_cast<std::int16_t>(i);
    const Margins margins = find_margins(at, 0, thresholds, policy);
    map.columns[static_cast<std::size_t>(i)] = {margins.charge_up_to_centi,
                                                margins.discharge_from_centi};
  }
  return map;
}

Json decision_map_json(const DecisionMap& map) {
  Json columns = Json::list();
  for (int i = 0; i < kSocCount; ++i) {
    const DecisionMap::Column& column = map.columns[static_cast<std::size_t>(i)];
    columns.add(Json::object(
        {{"soc_percent", Decimals{soc_percent(i), 1}},
         {"charge_up_to_eur_per_mwh", Decimals{eur(column.charge_up_to_centi), 2}},
         {"discharge_from_eur_per_mwh", Decimals{eur(column.discharge_from_centi), 2}}}));
  }
  return Json::object({{"columns", std::move(columns)}});
}

std::string decision_map_picture(const DecisionMap& map, const PresentPoint& now) {
  const Scale x{.low = 0, .high = 100, .from = kLeft, .to = kRight};
  const Scale y = price_axis(map, now);
  std::string text = formatted(
      "<svg viewBox=\"0 0 %.0f %.0f\" role=\"img\" aria-labelledby=\"map-title\">\n"
      "<title id=\"map-title\">What the student would do now at other prices and states of charge; "
      "the numbers are in api/map</title>\n",
      kWidth, kHeight);
  text += formatted("<rect class=\"idle\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n",
                    kLeft, kTop, kRight - kLeft, kBottom - kTop);
  text += area(
      map, x, y, [](const DecisionMap::Column& column) { return column.charge_up_to_centi; },
      kBottom, "charge");
  text += area(
      map, x, y, [](const DecisionMap::Column& column) { return column.discharge_from_centi; },
      kTop, "discharge");
  text += horizontal_grid(y, kLeft, kRight, 7);
  for (int soc = 0; soc <= 100; soc += 20) {
    text += svg_text(x.at(soc), kBottom + 18, "middle", formatted("%d %%", soc));
  }
  text += present(x, y, now);
  text += svg_text((kLeft + kRight) / 2, kBottom + 38, "middle",
                   "state of charge; upwards: price, EUR/MWh");
  return text + "</svg>\n";
}

}  // namespace bess
