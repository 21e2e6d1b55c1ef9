#include "tools/simulators/site/controller_settings.h"

namespace bess {

std::string records_url(const std::string& market, const std::string& dataset) {
  return fmt::format(
      "{}/api/explore/v2.1/catalog/datasets/{}/records?order_by=datetime%20desc&limit=20", market,
      dataset);
}

std::string controller_settings(const ControllerSettings& s) {
  std::string text = fmt::format("control = {}\n[battery]\n{}", s.control, s.battery);
  text += fmt::format("[price]\nurl = \"{}\"\n{}", records_url(s.market, "ods161"), s.price);
  text += fmt::format("[guard]\n{}[state]\n{}{}", s.guard, s.state, s.tables);
  text += fmt::format("[log]\ncsv = \"{}\"\n", s.csv);
  return s.clock ? text + s.clock->table() : text;
}

}  // namespace bess
