// bess-sim settle: energy and money of a closed-loop run, from both ends of the loop.
#include <fmt/core.h>

#include <memory>

#include "tools/settle/settlement.h"
#include "tools/sim/commands.h"

namespace bess {
namespace {

struct Options {
  std::string record;
  std::string edge_log;
  std::string prices;
  BatteryParameters battery{.power_w_max = 4000, .capacity_wh = 8000};
  bool json = false;
};

void print_json(const Settlement& s) {
  const auto account = [](const Account& a) {
    return fmt::format(
        R"({{"charged_wh": {:.3f}, "discharged_wh": {:.3f}, "profit_eur": {:.6f}, "soc_end": {:.5f}}})",
        a.charged_wh, a.discharged_wh, a.profit_eur, a.soc_end_frac);
  };
  const auto latency = [](const Latency& l) {
    return fmt::format(R"({{"median": {:.0f}, "p99": {:.0f}, "max": {:.0f}}})", l.median_us,
                       l.p99_us, l.max_us);
  };
  fmt::print(
      R"({{"cycles": {}, "cycles_running": {}, "battery": {}, "edge": {}, "decision_us": {}, )"
      R"("write_us": {}, "total_us": {}}})"
      "\n",
      s.cycles, s.cycles_running, account(s.battery), account(s.edge), latency(s.decision),
      latency(s.write), latency(s.total));
}

void print_text(const Settlement& s) {
  fmt::print("{} cycles, {} of them running\n", s.cycles, s.cycles_running);
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

}  // namespace

void add_settle_command(ProgramCommand& app) {
  auto options = std::make_shared<Options>();
  ProgramCommand command = app.subcommand(
      "settle", "Count a run's energy and money from the battery's record and from the edge's log");
  command.option("--record", options->record, "Battery record (bess-sim battery --record)")
      .required();
  command.option("--edge-log", options->edge_log, "The edge's CSV log").required();
  command.option("--prices", options->prices, "Minute file with settled prices").required();
  command.option("--power-w", options->battery.power_w_max, "Battery's power")
      .positive()
      .with_default();
  command.option("--capacity-wh", options->battery.capacity_wh, "Battery's capacity")
      .positive()
      .with_default();
  command.flag("--json", options->json, "One JSON object");
  command.footer(
      "Example:\n"
      "  bess-sim settle --record battery.csv --edge-log edge.csv --prices market.csv.gz");
  command.runs([options] {
    const Settlement settlement =
        settle(CsvTable::read(options->record), CsvTable::read(options->edge_log),
               read_minute_prices(options->prices), options->battery);
    if (options->json) {
      print_json(settlement);
    } else {
      print_text(settlement);
    }
  });
}

}  // namespace bess
