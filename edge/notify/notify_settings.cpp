#include "edge/notify/notify_settings.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "edge/log/installed_folders.h"
#include "edge/notify/webhook.h"
#include "edge/prices/http_secrets.h"
#include "shared/file_descriptor.h"
#include "shared/fixed_text.h"
#include "shared/host/toml_reader.h"

namespace bess {
namespace {

void read_text(TomlTable& table, std::string_view key, std::string& value) {
  const std::string* const found = table.text(key);
  if (found == nullptr) return;
  for (const char c : *found) {
    if (static_cast<unsigned char>(c) < 0x20) return table.fail(key, "must be one line of text");
  }
  value = *found;
}

/// Paths are relative to the configuration's folder.
std::string resolved(const TomlTable& table, const std::string& path) {
  return (std::filesystem::path(table.file()).parent_path() / path).string();
}

/// `name`, the value of `key`, as a path.
std::string readable_file(TomlTable& table, std::string_view key, const std::string& name) {
  const std::string path = resolved(table, name);
  if (access(path.c_str(), R_OK) != 0) table.fail(key, "= " + path + " cannot be read");
  return path;
}

std::string host_name() {
  char name[65] = {};
  return gethostname(name, sizeof name - 1) == 0 && *name != '\0' ? name : "bess";
}

/// One level of a topic, and an identifier of Home Assistant.
bool is_node_name(std::string_view name) {
  constexpr std::string_view kOthers = "-_";
  for (const char c : name) {
    const bool is_plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!is_plain && kOthers.find(c) == kOthers.npos) return false;
  }
  return !name.empty() && name.size() <= 64;
}

void read_node(TomlTable& table, NotifySettings& settings) {
  settings.node = host_name();
  for (char& c : settings.node) c = is_node_name({&c, 1}) ? c : '_';
  read_text(table, "node", settings.node);
  if (!is_node_name(settings.node)) {
    table.fail("node", "must be a name of at most 64 letters, digits, - and _");
  }
}

void read_mail(TomlTable& table, NotifySettings& settings) {
  settings.sendmail = "/usr/sbin/sendmail";
  read_text(table, "mail_to", settings.mail_to);
  read_text(table, "mail_from", settings.mail_from);
  read_text(table, "sendmail", settings.sendmail);
  if (settings.mail_to.empty()) return;
  settings.sendmail = resolved(table, settings.sendmail);
  if (access(settings.sendmail.c_str(), X_OK) != 0) {
    table.fail("sendmail", "= " + settings.sendmail +
                               " cannot be run: install a mailer (msmtp-mta, for one), or name it");
  }
}

void read_webhook(TomlTable& table, NotifySettings& settings) {
  std::string header_file;
  read_text(table, "webhook_url", settings.webhook_url);
  read_text(table, "webhook_header_file", header_file);
  read_text(table, "webhook_ca_file", settings.webhook_ca_file);
  if (settings.webhook_url.empty() || !table.ok()) return;
  if (!is_allowed_webhook(settings.webhook_url)) {
    return table.fail("webhook_url",
                      "must start with https://, or lead to this machine: http://127.0.0.1");
  }
  if (!settings.webhook_ca_file.empty()) {
    settings.webhook_ca_file = readable_file(table, "webhook_ca_file", settings.webhook_ca_file);
  }
  if (header_file.empty() || !table.ok()) return;
  FixedText<2047> headers;
  if (!load_http_headers(resolved(table, header_file).c_str(), headers, table.error())) return;
  settings.webhook_headers = headers.view();
}

bool is_loopback(const std::string& host) {
  in_addr address{};
  const bool is_numeric = inet_pton(AF_INET, host.c_str(), &address) == 1;
  return host == "localhost" || host == "::1" || (is_numeric && ntohl(address.s_addr) >> 24 == 127);
}

/// The first line of a file that others may not read.
void read_password(TomlTable& table, const std::string& name, std::string& password) {
  const std::string path = resolved(table, name);
  const FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat info {};
  char text[256];
  if (file.get() < 0 || fstat(file.get(), &info) != 0) {
    return table.fail("mqtt_password_file", "= " + path + " cannot be opened: " + strerror(errno));
  }
  if ((info.st_mode & S_IRWXO) != 0) {
    return table.fail("mqtt_password_file",
                      "= " + path + " is readable for others: chmod o-rwx it");
  }
  const ssize_t size = read(file.get(), text, sizeof text);
  if (size <= 0 || size == sizeof text) {
    return table.fail("mqtt_password_file", "= " + path + " must hold one line of 1 to 255 bytes");
  }
  password.assign(text, static_cast<std::size_t>(size));
  password.resize(std::min(password.size(), password.find_first_of("\r\n")));
}

void read_mqtt(TomlTable& table, MqttSettings& mqtt) {
  std::string password_file;
  mqtt.discovery_prefix = "homeassistant";
  read_text(table, "mqtt_host", mqtt.host);
  table.integer("mqtt_port", mqtt.port, 1, 65'535);
  read_text(table, "mqtt_ca_file", mqtt.ca_file);
  read_text(table, "mqtt_user", mqtt.user);
  read_text(table, "mqtt_password_file", password_file);
  read_text(table, "mqtt_discovery_prefix", mqtt.discovery_prefix);
  if (mqtt.host.empty() || !table.ok()) return;
  if (mqtt.port == 0) mqtt.port = mqtt.ca_file.empty() ? 1883 : 8883;
  if (!mqtt.ca_file.empty()) mqtt.ca_file = readable_file(table, "mqtt_ca_file", mqtt.ca_file);
  if (password_file.empty()) return;
  if (mqtt.user.empty()) table.fail("mqtt_password_file", "needs mqtt_user");
  if (mqtt.ca_file.empty() && !is_loopback(mqtt.host)) {
    table.fail("mqtt_password_file",
               "would be sent in clear: add mqtt_ca_file, or use a broker on this machine");
  }
  if (table.ok()) read_password(table, password_file, mqtt.password);
}

/// bess-edge beside this program, as both are installed.
std::string controller_beside() {
  std::error_code ignored;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", ignored);
  return (self.parent_path() / "bess-edge").string();
}

void read_notify(TomlTable table, NotifySettings& settings) {
  std::string folder = "notify";
  settings.program = controller_beside();
  read_node(table, settings);
  table.integer("every_s", settings.every_s, 1, 3'600);
  table.integer("after_s", settings.after_s, 0, 86'400);
  table.boolean("daily", settings.daily);
  read_text(table, "folder", folder);
  read_text(table, "program", settings.program);
  read_mail(table, settings);
  read_webhook(table, settings);
  read_mqtt(table, settings.mqtt);
  folder = resolved(table, folder);
  std::string run_folder(kInstalledNotify.run_beside(folder));
  read_text(table, "run_folder", run_folder);
  table.finish();
  settings.program = resolved(table, settings.program);
  settings.memory = folder + "/told.json";
  settings.memory_copies = {folder + "/told.copy"};
  if (!run_folder.empty()) {
    settings.memory_copies.push_back(resolved(table, run_folder) + "/told.json");
  }
  settings.lock = folder + "/lock";
}

}  // namespace

bool load_notify_settings(const std::string& path, NotifySettings& settings, std::string& error) {
  TomlValue document;
  if (!parse_toml_file(path, document, error)) return false;
  TomlTable root(&document, path, "", error);
  settings.config_path = path;
  std::string state = "state";
  TomlTable state_table(root.table("state"), path, "[state]", error);
  read_text(state_table, "folder", state);
  state = resolved(root, state);
  std::string run_folder(kInstalledEdge.run_beside(state));
  read_text(state_table, "run_folder", run_folder);
  settings.ring = state + "/decisions.ring";
  if (!run_folder.empty()) settings.run_ring = resolved(root, run_folder) + "/decisions.ring";
  read_notify(TomlTable(root.table("notify"), path, "[notify]", error), settings);
  return error.empty();
}

}  // namespace bess
