#include "workstation/sweep/check_share.h"

#include <algorithm>
#include <cmath>

#include "workstation/base/random.h"

namespace bess {

std::vector<int> drawn_share(const std::vector<int>& done, double percent, std::uint64_t seed) {
  if (done.empty()) return {};
  const auto wanted = static_cast<std::size_t>(
      std::max(1.0, std::ceil(percent / 100 * static_cast<double>(done.size()))));
  std::vector<int> drawn = done;
  Random random(seed);
  for (std::size_t i = 0; i < std::min(wanted, drawn.size()); ++i) {
    std::swap(drawn[i], drawn[i + random.index(drawn.size() - i)]);
  }
  drawn.resize(std::min(wanted, drawn.size()));
  std::ranges::sort(drawn);
  return drawn;
}

std::vector<std::string> check_task(const SweepFolder& folder, int task, const TaskWork& work) {
  namespace fs = std::filesystem;
  const fs::path at = folder.path / "checks" / (SweepFolder::number_text(task) + "." + own_name());
  std::error_code error;
  fs::remove_all(at, error);
  fs::create_directories(at);
  try {
    work(at);
  } catch (...) {
    fs::remove_all(at, error);
    throw;
  }
  const std::vector<std::string> here = marks_of_folder(at);
  const std::vector<std::string> there = marks_of_folder(folder.result(task));
  std::vector<std::string> other;
  std::ranges::set_difference(there, here, std::back_inserter(other));
  for (std::string& mark : other) mark += " is there, and was not made here";
  std::vector<std::string> own;
  std::ranges::set_difference(here, there, std::back_inserter(own));
  for (const std::string& mark : own) other.push_back(mark + " was made here");
  fs::remove_all(at, error);
  fs::remove(folder.path / "checks", error);
  return other;
}

}  // namespace bess
