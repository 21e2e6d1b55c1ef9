// bess-sim settle: energy and money of a closed-loop run, from both ends of the loop.
#include <fmt/core.h>

#include <memory>

#include "shared/host/json.h"
#include "tools/simulators/settle/settlement.h"
#include "tools/simulators/sim/commands.h"

namespace bess {
namespace {

struct Options {
  std::string record;
  std::string edge_log;
  std::string prices;
  BatteryParameters battery{.power_w_max = 4000, .capacity_wh = 8000};
  bool json = false;
};

Json account_json(const Account& account) {
  return Json::object({{"charged_wh", Decimals{account.charged_wh, 3}},
                       {"discharged_wh", Decimals{account.discharged_wh, 3}},
                       {"profit_eur", Decimals{account.profit_eur, 6}},
                       {"soc_end", Decimals{account.soc_end_frac, 5}}});
}

Json latency_json(const Latency& latency) {
  return Json::object({{"median", Decimals{latency.median_us, 0}},
                       {"p99", Decimals{latency.p99_us, 0}},
                       {"max", Decimals{latency.max_us, 0}}});
}

void print_json(const RunSettlement& s) {
  const Json json = Json::object({{"cycles", s.cycles},
                                  {"cycles_running", s.cycles_running},
                                  {"battery", account_json(s.battery)},
                                  {"edge", account_json(s.edge)},
                                  {"decision_us", latency_json(s.decision)},
                                  {"write_us", latency_json(s.write)},
                                  {"total_us", latency_json(s.total)}});
  fmt::print("{}\n", json.line());
}

void print_text(const RunSettlement& s) {
  fmt::print("{} control cycles, {} of them running\n", s.cycles, s.cycles_running);
  fmt::print("{:24} {:>12} {:>14} {:>10} {:>9}\n", "", "charged Wh", "discharged Wh", "EUR",
             "SoC end");
  const auto line = [](const char* name, const Account& a) {
    fmt::print("{:24} {:12.1f} {:14.1f} {:10.4f} {:8.2f} %\n", name, a.charged_wh, a.discharged_wh,
               a.profit_eur, 100 * a.soc_end_frac);
  };
  line("battery's own record", s.battery);
  line("edge's log", s.edge);
  const auto latency = [](const char* name, const Latency& l) {
    fmt::print("{:36} median {:.0f} us, 99 % {:.0f} us, worst {:.0f} us\n", name, l.median_us,
               l.p99_us, l.max_us);
  };
  latency("decision", s.decision);
  latency("order written and read back", s.write);
  latency("price received to order read back", s.total);
}

/// Same names and ranges as the keys of bess-train's configuration.
void add_costs(ProgramCommand& command, BatteryParameters& battery) {
  TradingCosts& costs = battery.costs;
  const auto add = [&](const char* name, double& cost, double most, const char* help) {
    command.option(name, cost, help).range(0.0, most).with_default();
  };
  add("--import-adder-eur-per-mwh", costs.import_adder_eur_per_mwh, 1000,
      "surcharge on charged energy, EUR/MWh");
  add("--import-percent", costs.import_percent, 100,
      "surcharge on charged energy, % of the absolute price");
  add("--export-fee-eur-per-mwh", costs.export_fee_eur_per_mwh, 1000,
      "fee on discharged energy, EUR/MWh");
  add("--export-percent", costs.export_percent, 100,
      "fee on discharged energy, % of the absolute price");
  add("--wear-eur-per-mwh", battery.wear_eur_per_mwh, 1000,
      "wear cost of energy charged or discharged, EUR/MWh");
}

}  // namespace

void add_settle_command(ProgramCommand& app) {
  auto options = std::make_shared<Options>();
  ProgramCommand command =
      app.subcommand("settle", "compare energy and money of a run: battery trace against edge log");
  command.option("--record", options->record, "battery trace, CSV (bess-sim battery --record)")
      .required();
  command.option("--edge-log", options->edge_log, "decision log, CSV (bess-edge log --csv)")
      .required();
  command.option("--prices", options->prices, "minute file with settled prices").required();
  add_rating_options(command, options->battery);
  add_costs(command, options->battery);
  command.flag("--json", options->json, "output as one JSON object");
  command.footer(
      "Example:\n"
      "  bess-sim settle --record battery.csv --edge-log edge.csv --prices market.csv.gz\n"
      "  bess-sim settle --record battery.csv --edge-log edge.csv --prices market.csv.gz "
      "--import-adder-eur-per-mwh 45 --export-fee-eur-per-mwh 2");
  command.runs([options] {
    const RunSettlement settlement =
        settle(CsvTable::read(options->record), CsvTable::read(options->edge_log),
               read_minute_file(options->prices), options->battery);
    if (options->json) {
      print_json(settlement);
    } else {
      print_text(settlement);
    }
  });
}

}  // namespace bess
