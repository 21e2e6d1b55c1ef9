#include "edge/page/page_settings.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "edge/log/installed_folders.h"
#include "edge/page/numeric_address.h"
#include "shared/file_descriptor.h"
#include "shared/host/toml_reader.h"

namespace bess {
namespace {

void read_line(TomlTable& table, std::string_view key, std::string& value) {
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

std::string host_name() {
  char name[65] = {};
  return gethostname(name, sizeof name - 1) == 0 && *name != '\0' ? name : "bess";
}

void read_hosts(TomlTable& table, std::vector<std::string>& hosts) {
  const TomlArray* const names = table.array("hosts");
  if (names == nullptr) return;
  for (const TomlValue& name : *names) {
    const auto* const text = name.as<std::string>();
    if (text == nullptr || text->empty() || text->find_first_of(" /:@") != text->npos) {
      return table.fail_at(name, "[page] hosts must be names of a host, without scheme and port");
    }
    hosts.push_back(*text);
  }
}

/// Orders may be given by who knows a token of this file.
void read_tokens(TomlTable& table, const std::string& name, AccessTokens& tokens) {
  const std::string path = resolved(table, name);
  const FileDescriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat info {};
  char text[4'096];
  if (file.get() < 0 || fstat(file.get(), &info) != 0) {
    return table.fail("token_file", "= " + path + " cannot be opened: " + strerror(errno));
  }
  if ((info.st_mode & S_IRWXO) != 0) {
    return table.fail("token_file", "= " + path + " is readable for others: chmod o-rwx it");
  }
  const ssize_t size = read(file.get(), text, sizeof text);
  if (size < 0 || size == sizeof text) {
    return table.fail("token_file", "= " + path + " must be a text of less than 4 KiB");
  }
  std::string trouble;
  if (!tokens.parse({text, static_cast<std::size_t>(size)}, trouble)) {
    table.fail("token_file", "= " + path + ": " + trouble);
  }
}

/// bess-edge beside this program, as both are installed.
std::string controller_beside() {
  std::error_code ignored;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", ignored);
  return (self.parent_path() / "bess-edge").string();
}

void read_page(TomlTable table, PageSettings& settings) {
  std::string token_file;
  settings.program = controller_beside();
  settings.name = host_name();
  read_line(table, "name", settings.name);
  read_line(table, "host", settings.host);
  table.integer("port", settings.port, 1, 65'535);
  table.integer("refresh_s", settings.refresh_s, 1, 600);
  read_line(table, "token_file", token_file);
  read_line(table, "program", settings.program);
  read_hosts(table, settings.hosts);
  if (!is_numeric_address(settings.host)) {
    table.fail("host", "must be a numeric address: 127.0.0.1, ::1, or one of this machine");
  }
  if (!token_file.empty() && table.ok()) {
    if (is_loopback_address(settings.host)) {
      read_tokens(table, token_file, settings.tokens);
    } else {
      table.fail("token_file",
                 "would be asked for in clear: listen on 127.0.0.1, behind a proxy with TLS");
    }
  }
  table.finish();
  settings.program = resolved(table, settings.program);
}

}  // namespace

bool load_page_settings(const std::string& path, PageSettings& settings, std::string& error) {
  TomlValue document;
  if (!parse_toml_file(path, document, error)) return false;
  TomlTable root(&document, path, "", error);
  settings.config_path = path;
  std::string state = "state";
  TomlTable state_table(root.table("state"), path, "[state]", error);
  read_line(state_table, "folder", state);
  state = resolved(root, state);
  std::string run_folder(kInstalledEdge.run_beside(state));
  read_line(state_table, "run_folder", run_folder);
  settings.ring = state + "/decisions.ring";
  if (!run_folder.empty()) settings.run_ring = resolved(root, run_folder) + "/decisions.ring";
  read_page(TomlTable(root.table("page"), path, "[page]", error), settings);
  return error.empty();
}

}  // namespace bess
