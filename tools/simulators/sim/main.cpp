// bess-sim: simulated Modbus battery and price server in scaled time, and the settlement of a run.
//   exit 0 stopped   1 the input is bad or a port is in use   2 the command line is bad

#include <cstdio>

#include "shared/host/embed/build_info.h"
#include "shared/local_time.h"
#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"
#include "tools/simulators/sim/commands.h"

namespace {

void add_clock_command(bess::ProgramCommand& app) {
  static double in_s = 0;
  bess::ProgramCommand command = app.subcommand(
      "clock", "print CLOCK_MONOTONIC in ns, as common anchor of several simulated processes");
  command.option("--in-s", in_s, "offset from now, s, for the start of the processes")
      .range(0.0, 1.0 * bess::kSecondsPerDay);
  command.runs([] {
    const auto ahead_ns = static_cast<long long>(in_s * 1e9);
    std::printf("%lld\n", static_cast<long long>(bess::clock_ns(CLOCK_MONOTONIC)) + ahead_ns);
  });
}

}  // namespace

int main(int argc, char** argv) {
  bess::set_market_time_zone();
  bess::CommandLine command_line("bess-sim",
                                 "bess-sim: a simulated battery and a simulated price server",
                                 "bess-sim " BESS_VERSION "\n" + bess::build_line());
  bess::ProgramCommand root = command_line.root();
  bess::add_battery_command(root);
  bess::add_market_command(root);
  bess::add_settle_command(root);
  bess::add_site_command(root);
  add_clock_command(root);
  return command_line.run(argc, argv);
}
