// Battery name in metrics, topics and titles. Start-up only.
#pragma once

#include <string>
#include <string_view>

namespace bess {

/// Folders of the installed services (systemd/*.service): StateDirectory on disk, RuntimeDirectory
/// in memory.
struct InstalledFolders {
  std::string_view state;
  std::string_view run;

  /// Default of `run_folder`: only for the installed state folder.
  [[nodiscard]] constexpr std::string_view run_beside(std::string_view state_folder) const {
    return state_folder == state ? run : std::string_view();
  }
};
inline constexpr InstalledFolders kInstalledEdge{"/var/lib/bess", "/run/bess"};
inline constexpr InstalledFolders kInstalledNotify{"/var/lib/bess-notify", "/run/bess-notify"};

inline constexpr std::string_view kNameCharacters =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

/// 1 to 63 letters, digits, - and _: valid as topic level and label value.
bool is_battery_name(std::string_view name);

/// Eight hexadecimal digits from machine id and state folder, different for each controller.
std::string battery_id(const std::string& state_folder);

/// Default of [battery] name: host name and the beginning of the id.
std::string default_battery_name(const std::string& state_folder);

}  // namespace bess
