// bess-page: the controller, to look at in a browser. A program of its own, outside the control
// process, which passes on what `bess-edge` answers. If it is killed, hangs or is absent, nothing
// changes for the controller.
#include <signal.h>

#include <charconv>
#include <cstdio>
#include <string>
#include <thread>

#include "edge/companion/stop_signals.h"
#include "edge/page/page_server.h"
#include "edge/page/page_settings.h"
#include "shared/local_time.h"

namespace bess {
namespace {

constexpr const char* kHelp =
    R"(bess-page: the battery controller as a web page

  bess-page [--config FILE] [--port PORT]     serves the page until SIGTERM
  bess-page [--config FILE] --check           is [page] right? Serves nothing

  --config FILE  the controller's settings; section [page]; default /etc/bess/edge.toml
  --port PORT    in place of [page] port; 0: any free one, which is printed
  --help         this text
  --version      the version

Price, power and state of charge of the last 24 hours, why the last order was given and at which
price it would be another, the month's money, alarms, versions. It reads alone: orders are given by
bess-edge. By itself it listens on 127.0.0.1 alone. /api/status, why, month and map have
the numbers as JSON, /api/log as CSV, /metrics for Prometheus: as bess-edge prints them. It takes no
lock of the controller, which does not know that it exists.
Exit codes: 0 done   1 the settings are bad, or the port is taken   2 the command line is bad

  bess-page --check
  bess-page --config edge.toml --port 0
  curl -s http://127.0.0.1:8745/api/why
)";

struct Options {
  std::string config_path = "/etc/bess/edge.toml";
  int port = -1;
  bool is_check = false;
};

bool is_port(std::string_view text, int& port) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  return error == std::errc{} && end == text.data() + text.size() && port >= 0 && port <= 65'535;
}

/// -1 to go on; else the exit code.
int parse(int argc, char** argv, Options& options) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    const bool has_value = i + 1 < argc;
    if (argument == "--help" || argument == "-h") return std::fputs(kHelp, stdout), 0;
    if (argument == "--version") return std::printf("bess-page %s\n", BESS_VERSION), 0;
    if (argument == "--check") {
      options.is_check = true;
    } else if (argument == "--config" && has_value) {
      options.config_path = argv[++i];
    } else if (argument == "--port" && has_value && is_port(argv[i + 1], options.port)) {
      ++i;
    } else {
      std::fprintf(stderr,
                   "bess-page: unknown option, or a value is missing or wrong: %s (see --help)\n",
                   argv[i]);
      return 2;
    }
  }
  return -1;
}

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
  if (options.is_check) return print_check(settings), 0;
  const sigset_t stop_signals = block_stop_signals();
  set_market_time_zone();
  PageServer server(settings);
  if (!server.bind(error)) return fail(error);
  std::printf("bess-page: http://%s:%d/\n", settings.host.c_str(), server.port());
  std::fflush(stdout);
  std::thread waits([&] {
    int signal_number = 0;
    sigwait(&stop_signals, &signal_number);
    server.stop();
  });
  server.serve();
  pthread_kill(waits.native_handle(), SIGTERM);  // where it ended by itself
  waits.join();
  return 0;
}

}  // namespace
}  // namespace bess

int main(int argc, char** argv) {
  bess::Options options;
  const int exit_code = bess::parse(argc, argv, options);
  return exit_code >= 0 ? exit_code : bess::run(options);
}
