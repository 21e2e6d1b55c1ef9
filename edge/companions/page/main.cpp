// Web page program bess-page, outside the control process: it serves the output of bess-edge.
// Killed, hanging or absent, it does not affect the controller.
#include <cstdio>
#include <string>

#include "edge/companions/common/stop_signals.h"
#include "edge/companions/page/page_server.h"
#include "edge/companions/page/page_settings.h"
#include "shared/host/command_line.h"
#include "shared/local_time.h"

namespace bess {
namespace {

constexpr const char* kFooter =
    R"(Shows price, power and state of charge of the last 24 hours, the last decision with its
margins, earnings of this month, alerts and versions. Read-only: use bess-edge for orders. Listens
on 127.0.0.1 by default. The output of bess-edge is available as JSON (/api/status, why, month,
map), CSV (/api/log) and for Prometheus (/metrics). Takes no lock and does not disturb the
controller.
Exit codes:
  0 done
  1 settings wrong, or port in use
  2 command line error
Examples:
  bess-page --check
  bess-page --config edge.toml --port 0
  curl -s http://127.0.0.1:8745/api/why)";

struct Options {
  std::string config_path = "/etc/bess/edge.toml";
  int port = -1;
  bool is_check = false;
};

void print_check(const PageSettings& settings) {
  std::printf("page       http://%s:%d/, at most %d s old\n", settings.host.c_str(), settings.port,
              settings.refresh_s);
  std::printf("asks       %s --config %s\n", settings.program.c_str(),
              settings.config_path.c_str());
}

int fail(const std::string& message) {
  std::fprintf(stderr, "bess-page: %s\n", message.c_str());
  return 1;
}

int run(const Options& options) {
  PageSettings settings;
  std::string error;
  if (!load_page_settings(options.config_path, settings, error)) return fail(error);
  if (options.port >= 0) settings.port = options.port;
  if (options.is_check) {
    print_check(settings);
    return 0;
  }
  set_market_time_zone();
  PageServer server(settings);
  if (!server.bind(error)) return fail(error);
  std::printf("bess-page: http://%s:%d/\n", settings.host.c_str(), server.port());
  std::fflush(stdout);
  const StopSignals stop_signals([&] { server.stop(); });
  server.serve();
  return 0;
}

}  // namespace
}  // namespace bess

int main(int argc, char** argv) {
  bess::CommandLine line("bess-page", "show a battery controller as a web page",
                         "bess-page " BESS_VERSION);
  bess::Options options;
  bess::ProgramCommand root = line.root();
  root.option("--config", options.config_path, "settings of the controller, section [page]")
      .with_default();
  root.option("--port", options.port,
              "port to listen on, 0: any free port, printed; default: [page] port")
      .value_name("PORT")
      .range(0, 65'535);
  root.flag("--check", options.is_check, "check [page], serve nothing");
  root.footer(bess::kFooter);
  root.exits_with([&] { return bess::run(options); });
  return line.run(argc, argv);
}
