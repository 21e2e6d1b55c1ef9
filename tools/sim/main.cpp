// bess-sim: the other two ends of the edge, a Modbus battery and a price server, in scaled time, and the
// settlement of what they exchanged.
//   exit 0 stopped   1 the input is bad or a port is in use   2 the command line is bad
#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>

#include "shared/local_time.h"
#include "shared/scaled_clock.h"
#include "tools/sim/commands.h"

namespace {

void add_clock_command(CLI::App& app) {
  static double in_s = 0;
  CLI::App* command = app.add_subcommand(
      "clock", "Print CLOCK_MONOTONIC in ns: the common anchor of several simulated processes");
  command->add_option("--in-s", in_s, "Seconds from now, so that all are up before it begins");
  command->callback([] {
    const auto ahead_ns = static_cast<long long>(in_s * 1e9);
    std::printf("%lld\n", static_cast<long long>(bess::clock_ns(CLOCK_MONOTONIC)) + ahead_ns);
  });
}

}  // namespace

int main(int argc, char** argv) {
  bess::set_market_time_zone();
  CLI::App app{"bess-sim: a simulated battery and a simulated price server", "bess-sim"};
  app.require_subcommand(1);
  app.set_version_flag("--version", BESS_VERSION);
  bess::add_battery_command(app);
  bess::add_market_command(app);
  bess::add_settle_command(app);
  add_clock_command(app);
  const auto is_named = [&](const CLI::App* command) { return command->get_name() == argv[1]; };
  if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(is_named).empty()) {
    std::fprintf(stderr, "bess-sim: unknown subcommand %s (see bess-sim --help)\n", argv[1]);
    return 2;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    std::fprintf(stderr, "bess-sim: %s (see bess-sim --help)\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bess-sim: %s\n", error.what());
    return 1;
  }
  return 0;
}
