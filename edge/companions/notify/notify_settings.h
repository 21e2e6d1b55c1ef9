// [notify] of the controller's configuration, and what else of it the notifier needs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/companions/common/controller_places.h"

namespace bess {

struct MqttSettings {
  std::string host;  ///< empty: no MQTT
  std::int32_t port = 0;
  std::string ca_file;  ///< empty: in clear
  std::string user;
  std::string password;
  bool orders = false;               ///< holds may be ordered by it
  std::int32_t wait_ms_max = 5'000;  ///< for a connection, and for an acknowledgement
};

struct NotifySettings : ControllerPlaces {
  std::int32_t power_w = 4'000;       ///< [battery] power_w: the most that may be held
  std::vector<std::string> memories;  ///< files of what was reported, for a disk that dies
  std::string lock;                   ///< file that the one notifier of this folder holds
  std::string contact;                ///< stands in each message; empty: not said
  std::int32_t every_s = 30;
  std::int32_t after_s = 300;
  bool daily = true;
  std::string command;  ///< alarm_command.h; empty: none
  std::int32_t command_ms_max = 60'000;
  MqttSettings mqtt;
  std::string settled_file;  ///< that bess-prices writes; empty: it is not asked to

  [[nodiscard]] bool has_channel() const { return !command.empty() || !mqtt.host.empty(); }
};

/// False with one line: file, key, and the mend. Makes nothing and connects to nothing.
bool load_notify_settings(const std::string& path, NotifySettings& settings, std::string& error);

}  // namespace bess
