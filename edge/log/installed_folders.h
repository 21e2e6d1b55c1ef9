// Folders of the installed services (systemd/*.service): StateDirectory on the disk and
// RuntimeDirectory in memory. Where the one is configured and the other is not, it is meant.
#pragma once

#include <string_view>

namespace bess {

struct InstalledFolders {
  std::string_view state;
  std::string_view run;

  /// What `run_folder` is by default.
  [[nodiscard]] constexpr std::string_view run_beside(std::string_view state_folder) const {
    return state_folder == state ? run : std::string_view();
  }
};
inline constexpr InstalledFolders kInstalledEdge{"/var/lib/bess", "/run/bess"};
inline constexpr InstalledFolders kInstalledNotify{"/var/lib/bess-notify", "/run/bess-notify"};

}  // namespace bess
