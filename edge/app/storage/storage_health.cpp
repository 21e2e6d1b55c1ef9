#include "edge/app/storage/storage_health.h"

#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "edge/records/log/atomic_file.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

/// /sys, below BESS_ROOT in tests.
std::string sysfs() {
  const char* const root = std::getenv("BESS_ROOT");
  return std::string(root == nullptr ? "" : root) + "/sys";
}

/// Value of "0x0a" at that position; 0 if malformed.
int hexadecimal_at(std::string_view text, std::size_t at) {
  int value = 0;
  text.remove_prefix(at + 2);
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  return read.ec == std::errc{} && value > 0 ? value : 0;
}

/// Path of the folder's block device in /sys; empty without the folder.
std::string block_device_of(const std::string& folder) {
  struct stat at {};
  if (stat(folder.c_str(), &at) != 0) return {};
  return sysfs() + "/dev/block/" + std::to_string(major(at.st_dev)) + ":" +
         std::to_string(minor(at.st_dev));
}

/// By the mount options of the folder's file system: "36 35 8:1 / /var rw - ext4 /dev/sda1
/// rw,emergency_ro".
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

std::string contents_of(const std::string& path) {
  const std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

int used_life_percent(std::string_view life_time) {
  constexpr int kTenthsMax = 11;  // life exceeded
  int worst = 0;
  for (std::size_t at = life_time.find("0x"); at != std::string_view::npos;
       at = life_time.find("0x", at + 1)) {
    worst = std::max(worst, hexadecimal_at(life_time, at));
  }
  return worst > kTenthsMax ? 0 : worst * 10;
}

int spare_level(std::string_view pre_eol_info) {
  constexpr int kLevelMax = 3;
  const int level = pre_eol_info.starts_with("0x") ? hexadecimal_at(pre_eol_info, 0) : 0;
  return level > kLevelMax ? 0 : level;
}

StorageWear storage_wear_of(const std::string& folder) {
  StorageWear wear;
  const std::string device = block_device_of(folder);
  if (device.empty()) return wear;
  // The device itself, or the disk of a partition.
  for (const std::string& place : {device + "/device", device + "/../device"}) {
    if (wear.used_life_percent == 0) {
      wear.used_life_percent = used_life_percent(contents_of(place + "/life_time"));
    }
    if (wear.spare_level == 0) wear.spare_level = spare_level(contents_of(place + "/pre_eol_info"));
  }
  std::error_code error;
  const auto block_device = std::filesystem::canonical(device, error);
  const std::string errors =
      contents_of(sysfs() + "/fs/ext4/" + block_device.filename().string() + "/errors_count");
  if (error || errors.empty()) return wear;
  std::int64_t count = -1;
  std::from_chars(errors.data(), errors.data() + errors.size(), count);
  wear.file_system_errors = count;
  return wear;
}

bool is_read_only(const char* folder) {
  struct statvfs disk {};
  return statvfs(folder, &disk) != 0 || (disk.f_flag & ST_RDONLY) != 0 || was_set_read_only(folder);
}

bool takes_no_file(const char* folder) {
  struct statvfs disk {};
  return is_read_only(folder) || (statvfs(folder, &disk) == 0 && disk.f_bavail == 0);
}

StorageHealth check_storage(const std::string& folder) {
  StorageHealth health;
  make_folder(folder.c_str());  // a failure is reported by the write
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
  health.wear = storage_wear_of(folder);
  return health;
}

}  // namespace bess
