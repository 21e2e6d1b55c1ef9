#include "shared/host/gnuplot.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "shared/host/user_error.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

bool command_succeeds(const char* command) { return std::system(command) == 0; }

fs::path beside(const fs::path& path) {
  return path.parent_path() /
         fmt::format(".{}.{}{}", path.stem().string(), getpid(), path.extension().string());
}

/// True when gnuplot took the whole script and ended well.
bool run(const std::string& script, const fs::path& path) {
  std::FILE* gnuplot = popen("gnuplot > /dev/null 2>&1", "w");
  if (gnuplot == nullptr) fail("{}: gnuplot cannot be started", path.string());
  const bool sent = std::fwrite(script.data(), 1, script.size(), gnuplot) == script.size();
  return pclose(gnuplot) == 0 && sent;
}

}  // namespace

std::string gnuplot_quoted(std::string_view text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "''" : std::string(1, c);
  return quoted + "'";
}

void draw_with_gnuplot(const fs::path& path,
                       const std::function<std::string(const fs::path&)>& script) {
  if (!command_succeeds("command -v gnuplot > /dev/null 2>&1")) {
    fail("{}: drawing needs gnuplot, which is not installed; apt-get install gnuplot-nox",
         path.string());
  }
  const fs::path temporary = beside(path);
  const bool drawn = run(script(temporary), path) && fs::exists(temporary);
  std::error_code error;
  if (drawn) fs::rename(temporary, path, error);
  if (!drawn || error) {
    fs::remove(temporary, error);
    fail("{}: gnuplot could not draw; is the folder there and writable?", path.string());
  }
}

}  // namespace bess
