#include "edge/notify/notify_settings.h"

#include <unistd.h>

#include <algorithm>

#include "edge/companion/numeric_address.h"
#include "edge/companion/secret_file.h"
#include "edge/log/installed_folders.h"

namespace bess {
namespace {

/// `name`, the value of `key`, as a path.
std::string readable_file(TomlTable& table, std::string_view key, const std::string& name) {
  const std::string path = table.resolved(name);
  if (access(path.c_str(), R_OK) != 0) table.fail(key, "= " + path + " cannot be read");
  return path;
}

/// An error and not a note in the journal: no alarm would arrive any more.
void refuse_former_ways(TomlTable& table) {
  for (const char* const key : {"mail_to", "webhook_url"}) {
    if (!table.has(key)) continue;
    table.fail(key,
               "is of earlier versions: alarms go to a command now, such as "
               "command = 'mail -s \"$BESS_TITLE\" operator@example.org', or apprise");
  }
  std::string ignored;
  for (const char* const key :
       {"mail_from", "sendmail", "webhook_header_file", "webhook_ca_file"}) {
    table.line(key, ignored);
  }
}

/// The first line of a file that others may not read.
void read_password(TomlTable& table, const std::string& name, std::string& password) {
  const SecretFile file{.key = "mqtt_password_file",
                        .name = name,
                        .bytes_max = 255,
                        .shape = "must hold one line of 1 to 255 bytes"};
  const std::string path = read_secret(table, file, password);
  if (table.ok() && password.empty())
    table.fail(file.key, "= " + path + " " + std::string(file.shape));
  password.resize(std::min(password.size(), password.find_first_of("\r\n")));
}

void read_mqtt(TomlTable& table, MqttSettings& mqtt) {
  std::string password_file;
  mqtt.discovery_prefix = "homeassistant";
  table.line("mqtt_host", mqtt.host);
  table.integer("mqtt_port", mqtt.port, 1, 65'535);
  table.line("mqtt_ca_file", mqtt.ca_file);
  table.line("mqtt_user", mqtt.user);
  table.line("mqtt_password_file", password_file);
  table.line("mqtt_discovery_prefix", mqtt.discovery_prefix);
  table.boolean("mqtt_orders", mqtt.orders);
  table.integer("mqtt_hold_minutes", mqtt.hold_minutes, 2, 10'080);
  if (mqtt.host.empty() || !table.ok()) return;
  if (mqtt.orders && mqtt.user.empty() && mqtt.host != "localhost" &&
      !is_loopback_address(mqtt.host)) {
    table.fail("mqtt_orders", "needs mqtt_user: a broker that lets in anybody lets anybody order");
  }
  if (mqtt.port == 0) mqtt.port = mqtt.ca_file.empty() ? 1883 : 8883;
  if (!mqtt.ca_file.empty()) mqtt.ca_file = readable_file(table, "mqtt_ca_file", mqtt.ca_file);
  if (password_file.empty()) return;
  if (mqtt.user.empty()) table.fail("mqtt_password_file", "needs mqtt_user");
  if (mqtt.ca_file.empty() && mqtt.host != "localhost" && !is_loopback_address(mqtt.host)) {
    table.fail("mqtt_password_file",
               "would be sent in clear: add mqtt_ca_file, or use a broker on this machine");
  }
  if (table.ok()) read_password(table, password_file, mqtt.password);
}

void read_notify(TomlTable table, NotifySettings& settings) {
  std::string folder = "notify";
  table.integer("every_s", settings.every_s, 1, 3'600);
  table.integer("after_s", settings.after_s, 0, 86'400);
  table.boolean("daily", settings.daily);
  table.line("folder", folder);
  read_program(table, settings);
  table.line("command", settings.command);
  refuse_former_ways(table);
  read_mqtt(table, settings.mqtt);
  folder = table.resolved(folder);
  std::string run_folder(kInstalledNotify.run_beside(folder));
  table.line("run_folder", run_folder);
  table.finish();
  settings.memory = folder + "/told.json";
  settings.memory_copies = {folder + "/told.copy"};
  if (!run_folder.empty()) {
    settings.memory_copies.push_back(table.resolved(run_folder) + "/told.json");
  }
  settings.lock = folder + "/lock";
}

}  // namespace

bool load_notify_settings(const std::string& path, NotifySettings& settings, std::string& error) {
  TomlValue document;
  if (!parse_toml_file(path, document, error)) return false;
  TomlTable root(&document, path, "", error);
  static_cast<ControllerPlaces&>(settings) = controller_places(root);
  root.line("contact", settings.contact);
  TomlTable battery(root.table("battery"), path, "[battery]", error);
  battery.integer("power_w", settings.power_w, 1, 1'000'000'000);
  settings.money = read_money_settings(root);
  TomlTable settled(root.table("settled"), path, "[settled]", error);
  std::string settled_url;
  settled.line("url", settled_url);
  settings.awaits_settled = !settled_url.empty();
  read_notify(TomlTable(root.table("notify"), path, "[notify]", error), settings);
  return error.empty();
}

}  // namespace bess
