#include "tools/hil_runner/scenario/edge_settings.h"

#include <algorithm>
#include <cmath>

#include "edge/core/control/price_history.h"
#include "shared/host/file.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

/// For runs in scaled wall time.
constexpr std::int32_t kWallTimeoutMs = 200;

std::string market_of(const EdgePlaces& places) {
  return fmt::format("http://127.0.0.1:{}", places.market_port);
}

/// Unless the scenario sets a timeout.
std::string wall_timeout(const std::string& lines, const EdgePlaces& places) {
  const bool is_wall = places.clock.has_value();
  const bool has_timeout = lines.find("response_timeout_ms") != std::string::npos;
  return is_wall && !has_timeout ? fmt::format("response_timeout_ms = {}\n", kWallTimeoutMs) : "";
}

std::string battery_keys(const Scenario& scenario, const EdgePlaces& places) {
  const ScenarioBattery& battery = scenario.battery;
  std::string text =
      fmt::format("map = \"{}\"\npower_w = {:.0f}\ncapacity_wh = {:.0f}\n", battery.map,
                  battery.physics.power_w_max, battery.physics.capacity_wh);
  if (!battery.variant.empty()) text += fmt::format("variant = \"{}\"\n", battery.variant);
  if (!places.battery_link.empty()) return text + places.battery_link + scenario.edge_battery;
  text += fmt::format("port = {}\n", places.battery_port);
  if (battery.rtu) {
    text += fmt::format("transport = \"rtu\"\ndevice = \"{}\"\nbaud = 115200\n",
                        places.serial_device.empty() ? "/dev/null" : places.serial_device);
  }
  return text + wall_timeout(scenario.edge_battery, places) + scenario.edge_battery;
}

std::string meter_table(const Scenario& scenario, const EdgePlaces& places) {
  using enum ScenarioMeter::Source;
  const ScenarioMeter& meter = scenario.meter;
  if (meter.source == kNone) return "";
  std::string text = "[meter]\n";
  if (meter.source == kBattery) {
    text += "source = \"battery\"\n";
  } else {
    text += fmt::format("map = \"{}\"\nport = {}\n", meter.map, places.meter_port);
    if (!meter.variant.empty()) text += fmt::format("variant = \"{}\"\n", meter.variant);
    text += wall_timeout(scenario.edge_meter, places);
  }
  return text + scenario.edge_meter + "\n";
}

/// Price level of earlier days, or the hours of history to request.
std::string history_keys(const Scenario& scenario, const MinuteSeries& prices,
                         const EdgePlaces& places) {
  if (scenario.prices.history_hours > 0) {
    return fmt::format("history_hours = {}\nhistory_url = \"{}\"\n", scenario.prices.history_hours,
                       records_url(market_of(places), "ods133"));
  }
  const PriceLevel level = level_before(prices, scenario.start_utc_s);
  if (!level.is_known()) return "history_hours = 0\n";
  return fmt::format("history_hours = 0\nlevel_start_eur_per_mwh = {:.2f}\n",
                     level.centi_eur_per_mwh() / 100.0);
}

}  // namespace

PriceLevel level_before(const MinuteSeries& prices, std::int64_t start_utc_s, int hours) {
  PriceHistory history(hours, start_utc_s);
  for (std::size_t m = 0; m < prices.size() && prices.utc_s(m) < start_utc_s; ++m) {
    if (std::isnan(prices.indicative[m])) continue;
    history.add(prices.utc_s(m),
                static_cast<std::int32_t>(std::lround(100 * prices.indicative[m])));
  }
  return history.level();
}

std::string edge_settings(const Scenario& scenario, const MinuteSeries& prices,
                          const EdgePlaces& places) {
  const std::string limits =
      scenario.has_limits() ? "[limits]\nfile = \"limit\"\n" + scenario.edge_limits + "\n" : "";
  const std::string outlook =
      scenario.day_ahead ? fmt::format(
                               "[outlook]\n"
                               "url = \"{}/price?bzn=BE&start={{today}}&end={{tomorrow}}\"\n",
                               market_of(places))
                         : "";
  return controller_settings(
      {.battery = battery_keys(scenario, places) + "\n",
       .market = market_of(places),
       .price = history_keys(scenario, prices, places) + scenario.edge_price + "\n",
       .guard = scenario.edge_guard + "\n",
       .tables = meter_table(scenario, places) + limits + outlook + scenario.edge_other + "\n",
       .clock = places.clock});
}

EdgeConfig load_edge_settings(const Scenario& scenario, const std::string& path,
                              const std::string& text) {
  write_file(path, text);
  EdgeConfig config;
  std::string error;
  if (load_edge_config(path, config, error)) return config;
  // File and lines are not the user's.
  if (error.starts_with(path)) error = error.substr(std::min(error.size(), error.find(": ") + 2));
  fail("{}: [edge], read as settings of bess-edge: {}", scenario.path, error);
}

}  // namespace bess
