#include "workstation/chain/changed_keys.h"

#include <fmt/core.h>

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

}  // namespace bess
