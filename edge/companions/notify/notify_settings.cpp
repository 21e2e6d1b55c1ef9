#include "edge/companions/notify/notify_settings.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cstring>
#include <fstream>

#include "edge/app/settings/retired_keys.h"
#include "edge/companions/common/numeric_address.h"
#include "edge/records/log/battery_name.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

/// First line of a file that other users may not read.
std::string read_password(TomlTable& table, std::string_view key, const std::string& name) {
  const std::string path = table.resolved(name);
  char line[256] = "";
  struct stat info {};
  std::ifstream file(path);
  file.getline(line, sizeof line);
  const std::string password(line, std::strcspn(line, "\r"));
  if (file.fail() || password.empty() || stat(path.c_str(), &info) != 0) {
    table.fail(key, "= " + path + " must be a readable file with one line of 1 to 255 bytes");
  } else if ((info.st_mode & S_IRWXO) != 0) {
    table.fail(key, "= " + path + " is readable by other users: chmod o-rwx it");
  }
  return password;
}

void read_mqtt(TomlTable& table, MqttSettings& mqtt) {
  std::string password_file;
  table.line("mqtt_host", mqtt.host);
  table.integer("mqtt_port", mqtt.port, 1, 65'535);
  table.line("mqtt_ca_file", mqtt.ca_file);
  table.line("mqtt_user", mqtt.user);
  table.line("mqtt_password_file", password_file);
  table.boolean("mqtt_orders", mqtt.orders);
  if (mqtt.host.empty() || !table.ok()) return;
  const bool is_here = mqtt.host == "localhost" || is_loopback_address(mqtt.host);
  if (mqtt.orders && mqtt.user.empty() && !is_here) {
    table.fail("mqtt_orders", "needs mqtt_user: an open broker would accept orders from anyone");
  }
  if (mqtt.port == 0) mqtt.port = mqtt.ca_file.empty() ? 1883 : 8883;
  if (!mqtt.ca_file.empty()) {
    mqtt.ca_file = table.resolved(mqtt.ca_file);
    if (access(mqtt.ca_file.c_str(), R_OK) != 0) {
      table.fail("mqtt_ca_file", "= " + mqtt.ca_file + " cannot be read");
    }
  }
  if (password_file.empty()) return;
  if (mqtt.user.empty()) table.fail("mqtt_password_file", "needs mqtt_user");
  if (mqtt.ca_file.empty() && !is_here) {
    table.fail("mqtt_password_file",
               "would be sent unencrypted: add mqtt_ca_file, or use a broker on this machine");
  }
  mqtt.password = read_password(table, "mqtt_password_file", password_file);
}

void read_notify(TomlTable table, NotifySettings& settings) {
  std::string folder = "notify";
  table.integer("every_s", settings.every_s, 1, 3'600);
  table.integer("after_s", settings.after_s, 0, kSecondsPerDay);
  table.boolean("daily", settings.daily);
  table.line("folder", folder);
  table.line("program", settings.program);
  settings.program = table.resolved(settings.program);
  table.line("command", settings.command);
  read_mqtt(table, settings.mqtt);
  folder = table.resolved(folder);
  std::string run_folder(kInstalledNotify.run_beside(folder));
  table.line("run_folder", run_folder);
  table.finish();
  settings.memories = {folder + "/told.json"};
  if (!run_folder.empty()) settings.memories.push_back(table.resolved(run_folder) + "/told.json");
  settings.lock = folder + "/lock";
}

}  // namespace

bool load_notify_settings(const std::string& path, NotifySettings& settings, std::string& error) {
  TomlValue document;
  if (!parse_toml_file(path, document, error)) return false;
  TomlTable root(&document, path, "", error);
  static_cast<ControllerPlaces&>(settings) = controller_places(root);
  root.line("contact", settings.contact);
  root.child("battery").integer("power_w", settings.power_w, 1, 1'000'000'000);
  if (root.child("settled").has("url"))
    settings.settled_file = settings.state_folder + "/settled.csv";
  read_notify(section(root, "notify"), settings);
  return error.empty();
}

}  // namespace bess
