#include "shared/host/gnuplot.h"

#include <fmt/core.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "shared/file_descriptor.h"
#include "shared/host/file.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

bool command_succeeds(const char* command) { return std::system(command) == 0; }

/// Standard output of gnuplot for this script; empty on failure.
std::string drawn(const std::string& script, const fs::path& path) {
  const FileDescriptor file(memfd_create("gnuplot", 0));  // the shell and gnuplot inherit it
  std::FILE* gnuplot = nullptr;
  if (pwrite(file.get(), script.data(), script.size(), 0) == static_cast<ssize_t>(script.size())) {
    gnuplot = popen(fmt::format("gnuplot /dev/fd/{} 2> /dev/null", file.get()).c_str(), "r");
  }
  if (gnuplot == nullptr) fail("{}: gnuplot cannot be started", path.string());
  std::string picture;
  char part[1 << 14];
  for (std::size_t got = 0; (got = std::fread(part, 1, sizeof part, gnuplot)) > 0;) {
    picture.append(part, got);
  }
  return pclose(gnuplot) == 0 ? picture : std::string();
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
  const std::string picture = drawn(script("/dev/stdout"), path);
  if (picture.empty()) fail("{}: gnuplot could not draw", path.string());
  write_file(path, picture);
}

}  // namespace bess
