#include "workstation/cli/learnt_for.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>

namespace bess {

std::string learnt_otherwise(const std::filesystem::path& model, const Entries& here) {
  if (!std::filesystem::is_regular_file(model)) return {};
  const auto run = load_run_record({model.parent_path()});
  if (!run) return {};
  Entries there;
  std::ranges::copy_if(run->identity, std::back_inserter(there), [&](const auto& entry) {
    return std::ranges::find(here, entry.first, &Entries::value_type::first) != here.end();
  });
  return differences(there, here);
}

void warn_learnt_otherwise(const std::filesystem::path& model, const Entries& here) {
  const std::string other = learnt_otherwise(model, here);
  if (other.empty()) return;
  fmt::print(stderr, "bess-train: warning: {} was learnt for other circumstances: {}\n",
             model.string(), other);
}

}  // namespace bess
