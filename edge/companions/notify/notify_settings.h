// Settings of the notifier: [notify] and other keys of the controller's configuration.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/companions/common/controller_places.h"

namespace bess {

struct MqttSettings {
  std::string host;  ///< empty: no MQTT
  std::int32_t port = 0;
  std::string ca_file;  ///< empty: unencrypted
  std::string user;
  std::string password;
  bool orders = false;               ///< accepts holds
  std::int32_t wait_ms_max = 5'000;  ///< for a connection, and for an acknowledgement
};

struct NotifySettings : ControllerPlaces {
  std::int32_t power_w = 4'000;       ///< [battery] power_w: maximum of a hold
  std::vector<std::string> memories;  ///< state files, on disk and in memory
  std::string lock;                   ///< lock file of this folder's notifier
  std::string contact;                ///< in each message; empty: none
  std::int32_t every_s = 30;
  std::int32_t after_s = 300;
  bool daily = true;
  std::string command;  ///< notifier_state.h; empty: none
  std::int32_t command_ms_max = 60'000;
  MqttSettings mqtt;
  std::string settled_file;  ///< written by bess-prices; empty: not configured

  [[nodiscard]] bool has_channel() const { return !command.empty() || !mqtt.host.empty(); }
};

/// False with one line: file, key and remedy. Creates nothing and opens no connection.
bool load_notify_settings(const std::string& path, NotifySettings& settings, std::string& error);

}  // namespace bess
