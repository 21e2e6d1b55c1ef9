#include "edge/commands/price_check.h"

#include <filesystem>
#include <string_view>
#include <system_error>

#include "shared/host/run_program.h"

namespace bess {

PriceCheck check_prices(const std::string& config_path) {
  constexpr std::int64_t kPatienceS = 180;  // two requests of a minute at most
  std::error_code ignored;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", ignored);
  // Of a build under another name, such as bess-edge-outlook, the one of that build.
  constexpr std::string_view kEdge = "bess-edge";
  std::string name = self.filename().string();
  const bool is_usual = name.starts_with(kEdge);
  name = "bess-prices" + (is_usual ? name.substr(kEdge.size()) : "");
  const std::string program = (self.parent_path() / name).string();
  const ProgramResult result =
      run_and_hear({program, "--check", "--config", config_path}, kPatienceS);
  PriceCheck check{.is_well = result.is_well(), .lines = result.output + result.errors};
  if (!result.trouble.empty()) check.lines += program + ": " + result.trouble + "\n";
  return check;
}

}  // namespace bess
