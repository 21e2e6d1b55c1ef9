#include "edge/page/page_settings.h"

#include "edge/companion/numeric_address.h"
#include "edge/companion/secret_file.h"

namespace bess {
namespace {

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
  std::string text;
  const SecretFile file{.key = "token_file",
                        .name = name,
                        .bytes_max = 4'095,
                        .shape = "must be a text of less than 4 KiB"};
  const std::string path = read_secret(table, file, text);
  std::string trouble;
  if (!table.ok() || tokens.parse(text, trouble)) return;
  table.fail("token_file", "= " + path + ": " + trouble);
}

void read_page(TomlTable table, PageSettings& settings) {
  std::string token_file;
  table.line("host", settings.host);
  table.integer("port", settings.port, 1, 65'535);
  table.integer("refresh_s", settings.refresh_s, 1, 600);
  table.line("token_file", token_file);
  read_program(table, settings);
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
}

}  // namespace

bool load_page_settings(const std::string& path, PageSettings& settings, std::string& error) {
  TomlValue document;
  if (!parse_toml_file(path, document, error)) return false;
  TomlTable root(&document, path, "", error);
  static_cast<ControllerPlaces&>(settings) = controller_places(root);
  read_page(TomlTable(root.table("page"), path, "[page]", error), settings);
  return error.empty();
}

}  // namespace bess
