// Fake /sys for one folder, below BESS_ROOT: the wear of an eMMC and its ext4, in the layout of
// Linux (the folder's device number leads to a partition, next to it the card).
#pragma once

#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/temporary_folder.h"

namespace bess {

struct FakeCard {
  std::string life_time;
  std::string pre_eol_info;
  std::string errors;  ///< errors_count of the file system
};

inline void write_card(const TemporaryFolder& root, const std::string& folder,
                       const FakeCard& card) {
  namespace fs = std::filesystem;
  struct stat at {};
  if (stat(folder.c_str(), &at) != 0) return;
  for (const char* made : {"sys/devices/mmc0/block/mmcblk0/mmcblk0p2", "sys/devices/mmc0/card",
                           "sys/dev/block", "sys/fs/ext4/mmcblk0p2"}) {
    fs::create_directories(root.file(made));
  }
  fs::create_directory_symlink("../../card", root.file("sys/devices/mmc0/block/mmcblk0/device"));
  fs::create_directory_symlink("../../devices/mmc0/block/mmcblk0/mmcblk0p2",
                               root.file("sys/dev/block/" + std::to_string(major(at.st_dev)) + ":" +
                                         std::to_string(minor(at.st_dev))));
  std::ofstream(root.file("sys/devices/mmc0/card/life_time")) << card.life_time;
  std::ofstream(root.file("sys/devices/mmc0/card/pre_eol_info")) << card.pre_eol_info;
  std::ofstream(root.file("sys/fs/ext4/mmcblk0p2/errors_count")) << card.errors;
}

}  // namespace bess
