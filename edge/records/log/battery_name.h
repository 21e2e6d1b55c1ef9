// What tells one battery from another where several report to the same place: metrics, topics,
// titles. Start-up only.
#pragma once

#include <string>
#include <string_view>

namespace bess {

// Folders of the installed services (systemd/*.service): StateDirectory on the disk and
// RuntimeDirectory in memory. Where the one is configured and the other is not, it is meant.

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

/// 1 to 63 letters, digits, - and _: one level of a topic, and a value of a label.
bool is_battery_name(std::string_view name);

/// Eight hexadecimal digits of this machine and the controller's state folder: two controllers
/// never share them.
std::string battery_id(const std::string& state_folder);

/// [battery] name where none is given: the machine's name and the beginning of the id.
std::string default_battery_name(const std::string& state_folder);

}  // namespace bess
