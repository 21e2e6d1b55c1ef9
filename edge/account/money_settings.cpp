#include "edge/account/money_settings.h"

namespace bess {

MoneySettings read_money_settings(TomlTable& root) {
  MoneySettings settings;
  std::string folder = "state";
  read_contract(TomlTable(root.table("contract"), root.file(), "[contract]", root.error()),
                settings.contract);
  // Of the other two the keys alone that count here: their own readers complain.
  TomlTable battery(root.table("battery"), root.file(), "[battery]", root.error());
  battery.integer("capacity_wh", settings.capacity_wh, 1, 1'000'000'000);
  TomlTable state(root.table("state"), root.file(), "[state]", root.error());
  state.line("folder", folder);
  settings.settled_file = root.resolved(folder) + "/settled.csv";
  return settings;
}

bool load_money_settings(const std::string& path, MoneySettings& settings, std::string& error) {
  TomlValue document;
  if (!parse_toml_file(path, document, error)) return false;
  TomlTable root(&document, path, "", error);
  settings = read_money_settings(root);
  return error.empty();
}

MoneyTerms money_terms(const MoneySettings& settings, std::string& trouble) {
  MoneyTerms terms{.contract = settings.contract, .capacity_wh = settings.capacity_wh};
  trouble = terms.settled.read(settings.settled_file);
  return terms;
}

}  // namespace bess
