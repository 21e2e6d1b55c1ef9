#include <fmt/core.h>
#include <fmt/format.h>

#include <cmath>

#include "workstation/runs/chain/run_config.h"

namespace bess {

std::vector<ChangedKey> changed_keys(const RunConfig& config) {
  const auto here = config_entries(config);
  const auto standard = config_entries(RunConfig{});
  std::vector<ChangedKey> changed;
  for (std::size_t k = 0; k < here.size(); ++k) {
    if (here[k].second == standard[k].second) continue;
    changed.push_back({here[k].first, here[k].second, standard[k].second});
  }
  return changed;
}

std::string changed_keys_text(const RunConfig& config) {
  std::string text;
  for (const ChangedKey& changed : changed_keys(config)) {
    text += fmt::format("{}{} = {} (default {})", text.empty() ? "" : "; ", changed.key,
                        changed.value, changed.standard);
  }
  return text.empty() ? "none: every key has its default" : text;
}

RunConfig canonical(RunConfig config, double rate_step_percent) {
  double rate_per_h = config.battery.power_w_max / config.battery.capacity_wh;
  if (rate_step_percent > 0) {
    const double step = std::log1p(rate_step_percent / 100);
    rate_per_h = std::exp(step * std::round(std::log(rate_per_h) / step));
  }
  const double scale = BatteryParameters{}.capacity_wh / config.battery.capacity_wh;
  config.battery.standby_w *= scale;
  config.battery.response.ramp_w_per_s *= scale;
  config.battery.capacity_wh = BatteryParameters{}.capacity_wh;
  config.battery.power_w_max =
      std::stod(fmt::format("{:.12g}", rate_per_h)) * config.battery.capacity_wh;
  return config;
}

std::string learning_key(const RunConfig& config, const std::string& rules) {
  std::string text;
  for (const auto& [key, value] : learning_entries(config)) {
    text.append(key).append(" = ").append(value).append("\n");
  }
  return text + rules;
}

}  // namespace bess
