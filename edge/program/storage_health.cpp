#include "edge/program/storage_health.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "edge/log/whole_file.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

/// Its place in /sys; empty when there is no such folder.
std::string block_device_of(const std::string& folder) {
  struct stat at {};
  if (stat(folder.c_str(), &at) != 0) return {};
  return "/sys/dev/block/" + std::to_string(major(at.st_dev)) + ":" +
         std::to_string(minor(at.st_dev));
}

/// By the options of the file system that the folder lies on: "36 35 8:1 / /var rw - ext4 /dev/sda1 rw,emergency_ro".
bool was_set_read_only(const char* folder) {
  struct stat at {};
  if (stat(folder, &at) != 0) return true;
  const std::string device =
      " " + std::to_string(major(at.st_dev)) + ":" + std::to_string(minor(at.st_dev)) + " ";
  std::ifstream mounts("/proc/self/mountinfo");
  for (std::string line; std::getline(mounts, line);) {
    const std::size_t of_file_system = line.find(" - ");
    const bool is_there = line.find(device) < of_file_system;
    if (is_there && line.find("emergency_ro", of_file_system) != std::string::npos) return true;
  }
  return false;
}

/// 0, or an errno.
int write_and_sync(const std::string& path) {
  const int fd = make_afresh(path.c_str());
  if (fd < 0) return errno;
  const char block[4'096] = {};
  const bool is_written = write(fd, block, sizeof block) == sizeof block && fdatasync(fd) == 0;
  const int error = is_written ? 0 : errno;
  close(fd);
  unlink(path.c_str());
  return error;
}

}  // namespace

std::optional<int> used_life_of(const std::string& folder) {
  const std::string device = block_device_of(folder);
  if (device.empty()) return std::nullopt;
  // Of the device itself, or of the one that it is a partition of.
  for (const char* const place : {"/device/life_time", "/../device/life_time"}) {
    std::ifstream file(device + place);
    std::ostringstream text;
    if (file && text << file.rdbuf()) return used_life_percent(text.str());
  }
  return std::nullopt;
}

std::int64_t file_system_errors_of(const std::string& folder) {
  std::error_code error;
  const auto device = std::filesystem::canonical(block_device_of(folder), error);
  if (error) return 0;
  std::ifstream file("/sys/fs/ext4/" + device.filename().string() + "/errors_count");
  std::int64_t errors = 0;
  return file >> errors ? errors : 0;
}

std::optional<int> used_life_percent(std::string_view life_time) {
  int worst = 0;
  while (!life_time.empty()) {
    const std::size_t begin = life_time.find("0x");
    if (begin == std::string_view::npos) break;
    life_time.remove_prefix(begin + 2);
    int tenths = 0;
    const auto [end, error] =
        std::from_chars(life_time.data(), life_time.data() + life_time.size(), tenths, 16);
    if (error != std::errc{}) return std::nullopt;
    life_time.remove_prefix(static_cast<std::size_t>(end - life_time.data()));
    worst = tenths > worst ? tenths : worst;
  }
  if (worst < 1 || worst > 11) return std::nullopt;  // 0: not defined; 11: beyond its life
  return worst * 10;
}

bool is_read_only(const char* folder) {
  struct statvfs disk {};
  return statvfs(folder, &disk) != 0 || (disk.f_flag & ST_RDONLY) != 0 || was_set_read_only(folder);
}

bool takes_no_file(const char* folder) {
  struct statvfs disk {};
  return is_read_only(folder) || (statvfs(folder, &disk) == 0 && disk.f_bavail == 0);
}

StorageHealth look_at_storage(const std::string& folder) {
  StorageHealth health;
  make_folder(folder.c_str());  // when it fails, the write says why
  const std::int64_t begin_ns = clock_ns(CLOCK_MONOTONIC);
  const int error = write_and_sync(folder + "/self-test.new");
  health.is_writable = error == 0;
  if (!health.is_writable) {
    health.error = std::strerror(error);
    return health;
  }
  health.synced_write_ms = static_cast<double>(clock_ns(CLOCK_MONOTONIC) - begin_ns) / 1e6;
  struct statvfs disk {};
  if (statvfs(folder.c_str(), &disk) == 0) {
    health.free_mb = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize) / 1e6;
  }
  health.used_life_percent = used_life_of(folder);
  return health;
}

}  // namespace bess
