#include "tools/hil_runner/scenario/scenario_parts.h"

#include <fmt/core.h>

#include <algorithm>
#include <sstream>

namespace bess {
namespace {

class Parts {
 public:
  explicit Parts(const Scenario& scenario) : scenario_(scenario) {}

  /// `take(without)` takes the part away from a copy.
  template <typename Take>
  void add(std::string name, const Take& take) {
    found_.push_back({.name = std::move(name), .without = scenario_});
    take(found_.back().without);
  }
  template <typename Take>
  void add_if(bool has, const char* name, const Take& take) {
    if (has) add(name, take);
  }
  /// Each item of a list from `first` on, counted from 1.
  template <typename ListOf>
  void add_each(const char* name, std::size_t first, const ListOf& list_of) {
    Scenario copy = scenario_;
    for (std::size_t i = first; i < list_of(copy).size(); ++i) {
      add(fmt::format("{} {}", name, i + 1), [&](Scenario& without) {
        auto& list = list_of(without);
        list.erase(list.begin() + static_cast<std::ptrdiff_t>(i));
      });
    }
  }
  /// Each line of one table for the edge; of several tables, all of them.
  void add_lines(const char* table, std::string Scenario::*text);

  std::vector<ScenarioPart> take() { return std::move(found_); }

 private:
  const Scenario& scenario_;
  std::vector<ScenarioPart> found_;
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.find_first_not_of(" \t") != std::string::npos) lines.push_back(line);
  }
  return lines;
}

void Parts::add_lines(const char* table, std::string Scenario::*text) {
  const std::vector<std::string> lines = lines_of(scenario_.*text);
  const bool are_keys = std::ranges::all_of(lines, [](const std::string& line) {
    return line.find('=') != std::string::npos && line.front() != '[';
  });
  if (!are_keys) return add(fmt::format("edge {}", table), [&](Scenario& s) { (s.*text).clear(); });
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string key = lines[i].substr(0, lines[i].find_first_of(" ="));
    add(fmt::format("edge {} {}", table, key), [&](Scenario& without) {
      (without.*text).clear();
      for (std::size_t k = 0; k < lines.size(); ++k) {
        if (k != i) without.*text += lines[k] + "\n";
      }
    });
  }
}

/// The first is a part only where another price takes its place at the start: of the days before.
std::size_t first_price_step(const std::vector<ScenarioPrices::Step>& steps) {
  return steps.size() > 1 && steps[1].from_min <= 0 ? 0 : 1;
}

}  // namespace

std::vector<ScenarioPart> parts_of(const Scenario& scenario) {
  Parts parts(scenario);
  const Scenario usual;
  const std::string usual_map = map_path(kUsualMap, "");
  parts.add_if(scenario.battery.map != usual_map, "map", [&](Scenario& s) {
    s.battery.map = usual_map;
    s.battery.variant.clear();
  });
  parts.add_if(scenario.battery.map == usual_map && !scenario.battery.variant.empty(), "variant",
               [](Scenario& s) { s.battery.variant.clear(); });
  parts.add_if(scenario.battery.rtu, "transport", [](Scenario& s) { s.battery.rtu = false; });
  if (scenario.battery_faults.size() > 1) {
    parts.add_each(
        "battery_fault", 0, [](Scenario & s) -> auto& { return s.battery_faults; });
  } else {
    parts.add_if(!scenario.battery_faults.empty(), "battery_fault",
                 [](Scenario& s) { s.battery_faults.clear(); });
  }
  parts.add_if(!scenario.meter.fault.schedule.faults.empty(), "meter_fault",
               [](Scenario& s) { s.meter.fault = {}; });
  parts.add_if(scenario.price_fault.fault != MarketFault::kNone, "price_fault",
               [](Scenario& s) { s.price_fault = {}; });
  parts.add_if(scenario.day_ahead && scenario.day_ahead->fault != AuctionFault::kNone,
               "day_ahead fault", [](Scenario& s) { s.day_ahead->fault = AuctionFault::kNone; });
  parts.add_each(
      "event", 0, [](Scenario & s) -> auto& { return s.events; });
  parts.add_each(
      "missing", 0, [](Scenario & s) -> auto& { return s.prices.missing; });
  parts.add_each(
      "price step", first_price_step(scenario.prices.steps),
      [](Scenario & s) -> auto& { return s.prices.steps; });
  parts.add_if(scenario.prices.latency_s != usual.prices.latency_s, "latency_s",
               [&](Scenario& s) { s.prices.latency_s = usual.prices.latency_s; });
  parts.add_each(
      "house step", 1, [](Scenario & s) -> auto& { return s.house.steps; });
  parts.add_lines("battery", &Scenario::edge_battery);
  parts.add_lines("price", &Scenario::edge_price);
  parts.add_lines("guard", &Scenario::edge_guard);
  parts.add_lines("meter", &Scenario::edge_meter);
  parts.add_lines("limits", &Scenario::edge_limits);
  parts.add_lines("other", &Scenario::edge_other);
  return parts.take();
}

}  // namespace bess
