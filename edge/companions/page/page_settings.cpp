#include "edge/companions/page/page_settings.h"

#include "edge/app/settings/retired_keys.h"
#include "edge/companions/common/numeric_address.h"

namespace bess {
namespace {

void read_hosts(TomlTable& table, std::vector<std::string>& hosts) {
  const TomlArray* const names = table.array("hosts");
  if (names == nullptr) return;
  for (const TomlValue& name : *names) {
    const auto* const text = name.as<std::string>();
    if (text == nullptr || text->empty() || text->find_first_of(" /:@") != text->npos) {
      return table.fail_at(name, "[page] hosts must be host names, without scheme and port");
    }
    hosts.push_back(*text);
  }
}

void read_page(TomlTable table, PageSettings& settings) {
  table.line("host", settings.host);
  table.integer("port", settings.port, 1, 65'535);
  read_hosts(table, settings.hosts);
  if (!is_numeric_address(settings.host)) {
    table.fail("host", "must be a numeric address of this machine, such as 127.0.0.1 or ::1");
  }
  table.finish();
}

}  // namespace

bool load_page_settings(const std::string& path, PageSettings& settings, std::string& error) {
  TomlValue document;
  if (!parse_toml_file(path, document, error)) return false;
  TomlTable root(&document, path, "", error);
  static_cast<ControllerPlaces&>(settings) = controller_places(root);
  read_page(section(root, "page"), settings);
  return error.empty();
}

}  // namespace bess
