#include "edge/program/trip_clearance.h"

#include <fcntl.h>
#include <unistd.h>

#include <charconv>
#include <cstdio>
#include <string_view>

#include "edge/log/whole_file.h"

namespace bess {

FixedText<767> trip_clearance_path(const EdgeConfig& config) {
  char path[768];
  std::snprintf(path, sizeof path, "%s/cleared", config.state.folder.c_str());
  return FixedText<767>(path);
}

bool clear_trip_of(const char* path, std::int64_t trip_utc_s) {
  char text[32];
  const int size = std::snprintf(text, sizeof text, "%lld\n", static_cast<long long>(trip_utc_s));
  return replace_file_durably(path, {text, static_cast<std::size_t>(size)});
}

bool is_trip_cleared(const char* path, std::int64_t trip_utc_s) {
  const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (fd < 0) return false;
  char text[32];
  const ssize_t size = read(fd, text, sizeof text);
  close(fd);
  std::int64_t cleared_utc_s = 0;
  const auto [end, error] = std::from_chars(text, text + (size > 0 ? size : 0), cleared_utc_s);
  return error == std::errc{} && cleared_utc_s == trip_utc_s;
}

}  // namespace bess
