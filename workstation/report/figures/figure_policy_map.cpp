// Policy heat maps side by side [Paper, policy figures before and after correction].
#include <fmt/core.h>

#include <algorithm>

#include "workstation/env/context_fit.h"
#include "workstation/report/figures/figures.h"

namespace bess {
namespace {

constexpr double kOutlineWidth = 2.5;
constexpr double kPercentPerSocIndex = 100.0 / (kSocCount - 1);

/// Edge below a cell: half an index before its point.
double price_edge(int index) { return kLatticePriceMinEurPerMwh + index - 0.5; }
double soc_edge(int index) { return (index - 0.5) * kPercentPerSocIndex; }

std::string rectangle_data(const std::string& name, const ActionGrid& grid, Action action) {
  std::vector<std::string> rows;
  for (const GridRectangle& r : rectangles_of(grid, action)) {
    const double left = price_edge(r.price_first), right = price_edge(r.price_last + 1);
    const double bottom = soc_edge(r.soc_bottom), top = soc_edge(r.soc_top + 1);
    rows.push_back(fmt::format("{} {} {} {} {} {}", left, bottom, left, right, bottom, top));
  }
  if (rows.empty()) rows.emplace_back("NaN NaN NaN NaN NaN NaN");
  return data_block(name, rows);
}

/// Start and extent of each wrong border, on the edge between the two cells.
std::string border_data(const std::string& name, const std::vector<WrongBorder>& borders) {
  std::vector<std::string> rows;
  for (const WrongBorder& b : borders) {
    const auto pairs = static_cast<double>(b.pairs);
    rows.push_back(b.along_price
                       ? fmt::format("{} {} {} 0", price_edge(b.price), soc_edge(b.soc + 1), pairs)
                       : fmt::format("{} {} 0 {}", price_edge(b.price + 1), soc_edge(b.soc),
                                     pairs * kPercentPerSocIndex));
  }
  if (rows.empty()) rows.emplace_back("NaN NaN NaN NaN");
  return data_block(name, rows);
}

/// Each stretch of states of one map with the same action, ends included; idle is all else.
PictureTable map_numbers(const std::vector<NamedPolicyMap>& maps) {
  PictureTable table{{},
                     {"map", "action", "price_from_eur_per_mwh", "price_to_eur_per_mwh",
                      "soc_from_frac", "soc_to_frac"},
                     {}};
  const auto price = [](int index) { return fmt::format("{}", kLatticePriceMinEurPerMwh + index); };
  const auto soc = [](int index) { return fmt::format("{:g}", index / double{kSocCount - 1}); };
  for (const NamedPolicyMap& map : maps) {
    for (const auto& [name, action] :
         {std::pair{"charge", Action::kCharge}, {"discharge", Action::kDischarge}}) {
      for (const GridRectangle& r : rectangles_of(map.grid, action)) {
        table.rows.push_back({map.name, name, price(r.price_first), price(r.price_last),
                              soc(r.soc_bottom), soc(r.soc_top)});
      }
    }
  }
  return table;
}

std::int64_t wrong_pairs(const std::vector<WrongBorder>& borders) {
  std::int64_t pairs = 0;
  for (const WrongBorder& b : borders) pairs += b.pairs;
  return pairs;
}

std::string pairs_text(std::int64_t pairs) {
  return pairs == 0 ? "no pair out of order"
                    : fmt::format("{} pair{} out of order", pairs, pairs == 1 ? "" : "s");
}

std::string panel(const NamedPolicyMap& map, std::size_t index) {
  const std::vector<WrongBorder> borders = wrong_borders_of(map.grid);
  const auto data = [index](const char* what) { return fmt::format("{}{}", what, index); };
  std::string text = rectangle_data(data("charge"), map.grid, Action::kCharge) +
                     rectangle_data(data("discharge"), map.grid, Action::kDischarge) +
                     border_data(data("wrong"), borders);
  text += fmt::format("set title \"{}\\n{}\" offset 0,-0.4\n", map.name,
                      pairs_text(wrong_pairs(borders)));
  if (index == 1) text += "unset ylabel\nset format y ''\n";
  return text + fmt::format(
                    "plot $charge{0} using 1:2:3:4:5:6 with boxxyerror fc {1}, "
                    "$discharge{0} using 1:2:3:4:5:6 with boxxyerror fc {2}, "
                    "$wrong{0} using 1:2:3:4 with vectors nohead lw 3 lc {3}, "
                    "$wrong{0} using ($1+$3/2):($2+$4/2) with points pt 7 ps 0.35 lc {3}\n",
                    index, rgb(kCharge), rgb(kDischarge), rgb(kMark));
}

/// In every panel, on the edges of the cells.
std::string outline_objects(const std::vector<RuleOutline>& outlines) {
  constexpr int kFirstObject = 200;
  std::string text;
  int object = kFirstObject;
  for (const auto& [name, box] : outlines) {
    text +=
        fmt::format("set object {} rectangle from {},{} to {},{} front fs empty border {} lw {}\n",
                    object++, price_edge(box.price_first), std::max(0.0, soc_edge(box.soc_bottom)),
                    price_edge(box.price_last + 1), std::min(100.0, soc_edge(box.soc_top + 1)),
                    rgb(kInk), kOutlineWidth);
  }
  return text;
}

std::string frame(std::size_t panels, const BatteryParameters& battery) {
  const double right = panels == 1 ? 0.55 : panels == 2 ? 0.82 : 0.97;
  return fmt::format(
      "set multiplot layout 1,{} margins screen 0.085,{},0.165,0.77 spacing screen 0.05,0\n"
      "set xrange [{}:{}]\nset yrange [0:100]\nset xtics 500 font ',13'\nset ytics 20\nunset grid\n"
      "set xlabel 'indicative price, EUR/MWh'\nset ylabel 'state of charge, %'\n"
      "set object 1 rectangle from graph 0,0 to graph 1,1 fc {} fs solid noborder behind\n"
      "set arrow 1 from graph 0, first {} to graph 1, first {} nohead front dt (4,6) lw 1.2 lc "
      "{}\n",
      panels, right, kLatticePriceMinEurPerMwh, kLatticePriceMaxEurPerMwh, rgb(kIdle),
      100 * battery.soc_min_frac, 100 * battery.soc_min_frac, rgb(kInk));
}

int minute_of(const PolicyContext& context) {
  return context.quarter_hour % 4 * 15 + context.minute_of_quarter_hour;
}

std::string clock_text(const PolicyContext& context) {
  return fmt::format("{:02}:{:02}", context.quarter_hour / 4, minute_of(context));
}

std::string caption_of(const PolicyContext& context, const ContextClasses& classes,
                       const std::vector<NamedPolicyMap>& maps,
                       const std::vector<RuleOutline>& outlines, const BatteryParameters& battery,
                       const std::string& note) {
  std::string text = note;
  text += fmt::format(
      "What to do at {} local time {}, for every price and charge. The dearer the energy or the "
      "fuller the battery, the less a policy may charge; dots and lines mark neighbouring states "
      "that "
      "break this order",
      clock_text(context), context_text(classes, context.context_class));
  for (std::size_t i = 0; i < maps.size(); ++i) {
    text += fmt::format("{}{}: {}", i == 0 ? " (" : "; ", maps[i].name,
                        wrong_pairs(wrong_borders_of(maps[i].grid)));
  }
  text += fmt::format("{}. Below the dotted line at {:.0f} % lies charge that the battery keeps.",
                      maps.empty() ? "" : ")", 100 * battery.soc_min_frac);
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    text += fmt::format("{}{}", i == 0 ? " Outlined: where rules hold: " : ", ", outlines[i].name);
  }
  if (!outlines.empty()) text += ".";
  return text;
}

}  // namespace

Figure policy_map_figure(const PolicyContext& context, const ContextClasses& classes,
                         const std::vector<NamedPolicyMap>& maps, const RuleSet& rules,
                         const BatteryParameters& battery, const std::string& note) {
  const std::vector<RuleOutline> outlines = rule_outlines(rules, classes.kind, context);
  Figure figure;
  figure.name = fmt::format("policy_map_{:02}_{:02}{:02}", context.context_class,
                            context.quarter_hour / 4, minute_of(context));
  figure.title = fmt::format("The policy {} at {}", context_text(classes, context.context_class),
                             clock_text(context));
  figure.width_px = 960;
  figure.height_px = 430;
  figure.alt = fmt::format(
      "Maps of {} policies, price from -500 to 1500 EUR/MWh across and state of charge from 0 to "
      "100 % upwards: charge at low prices, discharge at high prices, idle between.",
      maps.size());
  figure.caption = caption_of(context, classes, maps, outlines, battery, note);
  std::vector<KeyEntry> entries{{"charge", kCharge},
                                {"idle", kIdle},
                                {"discharge", kDischarge},
                                {"out of order", kMark, KeyEntry::Kind::kLine, 3}};
  if (!outlines.empty()) {
    entries.push_back({"where a rule holds", kInk, KeyEntry::Kind::kLine, kOutlineWidth});
  }
  const KeyRow key = key_row(figure, 80, entries);
  figure.commands = key.set + frame(maps.size(), battery) + outline_objects(outlines);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    figure.commands += panel(maps[i], i) + (i == 0 ? key.unset : "");
  }
  figure.commands += "unset multiplot\n";
  figure.numbers = map_numbers(maps);
  return figure;
}

}  // namespace bess
