#include "workstation/size/size_plan.h"

#include <algorithm>

#include "shared/host/file.h"
#include "shared/host/toml_reader.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

constexpr double kKiloMin = 0.01;
constexpr double kKiloMax = 1e6;
constexpr std::size_t kCellsMax = 10'000;

/// A list of kW or kWh as W or Wh.
std::vector<double> read_kilos(TomlTable& table, std::string_view key) {
  table.require(key);
  std::vector<double> sizes;
  const TomlArray* list = table.array(key);
  if (list == nullptr) return sizes;
  for (const TomlValue& value : *list) {
    const double kilos = value.number().value_or(0);
    if (!(kilos >= kKiloMin && kilos <= kKiloMax)) {
      table.fail_at(value, std::string(key) + ": expected numbers from 0.01 to 1000000");
    } else if (std::ranges::find(sizes, kilos * 1e3) != sizes.end()) {
      table.fail_at(value, std::string(key) + ": a value stands there twice");
    }
    sizes.push_back(kilos * 1e3);
  }
  if (list->empty()) table.fail(key, "is empty: give one value at least");
  return sizes;
}

SizeContract as_configured(const RunConfig& base) {
  SizeContract contract{.name = "as configured", .costs = base.battery.costs};
  contract.wear_eur_per_mwh = base.battery.wear_eur_per_mwh;
  contract.cycles_per_day_max = base.battery.cycles_per_day_max;
  return contract;
}

SizeContract read_contract(TomlTable& table, const RunConfig& base) {
  SizeContract contract = as_configured(base);
  table.require("name");
  table.line("name", contract.name);
  table.number("import_adder_eur_per_mwh", contract.costs.import_adder_eur_per_mwh, 0, 1000);
  table.number("import_percent", contract.costs.import_percent, 0, 100);
  table.number("export_fee_eur_per_mwh", contract.costs.export_fee_eur_per_mwh, 0, 1000);
  table.number("export_percent", contract.costs.export_percent, 0, 100);
  table.number("wear_eur_per_mwh", contract.wear_eur_per_mwh, 0, 1000);
  table.number("cycles_per_day_max", contract.cycles_per_day_max, 0, 1000);
  table.number("share_percent", contract.share_percent, 0, 100);
  table.number("fee_eur_per_month", contract.fee_eur_per_month, 0, 1e6);
  table.number("capacity_eur_per_kw_year", contract.capacity_eur_per_kw_year, 0, 10'000);
  table.number("capacity_free_kw", contract.capacity_free_kw, 0, kKiloMax);
  table.finish();
  return contract;
}

void read_contracts(TomlTable& top, const RunConfig& base, SizePlan& plan) {
  const TomlArray* list = top.has("contract") ? top.array("contract") : nullptr;
  if (list == nullptr) return plan.contracts.push_back(as_configured(base));
  for (const TomlValue& value : *list) {
    TomlTable table(&value, top.file(), "[[contract]]", top.error());
    plan.contracts.push_back(read_contract(table, base));
    const auto same =
        std::ranges::count(plan.contracts, plan.contracts.back().name, &SizeContract::name);
    if (same > 1) top.fail_at(value, "[[contract]]: this name stands there twice");
  }
}

void read_purchase(TomlTable& top, SizePlan& plan) {
  TomlTable purchase(top.table("purchase"), top.file(), "[purchase]", top.error());
  purchase.number("eur", plan.purchase.eur, 0, 1e9);
  purchase.number("eur_per_kw", plan.purchase.eur_per_kw, 0, 1e5);
  purchase.number("eur_per_kwh", plan.purchase.eur_per_kwh, 0, 1e5);
  purchase.finish();
  TomlTable ageing(top.table("ageing"), top.file(), "[ageing]", top.error());
  ageing.number("calendar_percent_per_year", plan.ageing.calendar_percent_per_year, 0, 50);
  ageing.number("cycle_percent_per_1000", plan.ageing.cycle_percent_per_1000, 0, 100);
  ageing.number("end_percent", plan.ageing.end_percent, 1, 99);
  ageing.finish();
}

}  // namespace

SizePlan read_size_plan(const std::string& path, const RunConfig& base) {
  TomlValue document;
  std::string error;
  if (!parse_toml_text(read_file(path, kTomlBytesMax), path, document, error)) {
    throw UserError(error);
  }
  SizePlan plan;
  TomlTable top(&document, path, "", error);
  top.require("size");
  TomlTable size(top.table("size"), path, "[size]", error);
  plan.power_w = read_kilos(size, "power_kw");
  plan.capacity_wh = read_kilos(size, "capacity_kwh");
  std::int64_t window_days = plan.window_days;
  size.integer("window_days", window_days, 30, 3650);
  plan.window_days = static_cast<int>(window_days);
  size.line("policy", plan.policy);
  size.finish();
  read_contracts(top, base, plan);
  read_purchase(top, plan);
  top.finish();
  if (!error.empty()) throw UserError(error);
  const std::size_t cells = plan.power_w.size() * plan.capacity_wh.size() * plan.contracts.size();
  if (cells > kCellsMax) fail("{}: {} cells are more than {}", path, cells, kCellsMax);
  return plan;
}

}  // namespace bess
