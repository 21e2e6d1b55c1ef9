#include "edge/account/money_settings.h"

namespace bess {

MoneySettings read_money_settings(TomlTable& root) {
  MoneySettings settings;
  std::string folder = "state";
  TomlTable battery(root.table("battery"), root.file(), "[battery]", root.error());
  battery.integer("capacity_wh", settings.capacity_wh, 1, 1'000'000'000);
  TomlTable state(root.table("state"), root.file(), "[state]", root.error());
  state.line("folder", folder);
  settings.settled_file = root.resolved(folder) + "/settled.csv";
  return settings;
}

MoneyTerms money_terms(const MoneySettings& settings, std::string& trouble) {
  MoneyTerms terms{.capacity_wh = settings.capacity_wh};
  trouble = terms.settled.read(settings.settled_file);
  return terms;
}

}  // namespace bess
