#include "edge/page/page_settings.h"

#include "edge/companion/numeric_address.h"

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

void read_page(TomlTable table, PageSettings& settings) {
  std::string token_file;
  table.line("host", settings.host);
  table.integer("port", settings.port, 1, 65'535);
  // Keys of earlier versions.
  static_cast<void>(table.take_retired("refresh_s"));
  table.line("token_file", token_file);
  read_program(table, settings);
  read_hosts(table, settings.hosts);
  if (!is_numeric_address(settings.host)) {
    table.fail("host", "must be a numeric address: 127.0.0.1, ::1, or one of this machine");
  }
  if (!token_file.empty()) {
    settings.note =
        "[page] token_file has no effect any more: the page orders nothing; "
        "bess-edge hold, limit and clear do";
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
