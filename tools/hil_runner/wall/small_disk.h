// A small file system of its own for the edge's state, where this user may mount one.
#pragma once

#include <fmt/core.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include <fstream>
#include <string>
#include <utility>

#include "shared/host/user_error.h"

namespace bess {

class SmallDisk {
 public:
  explicit SmallDisk(std::string folder) : folder_(std::move(folder)) {
    constexpr int kBytes = 32 * 1'024 * 1'024;  // more than a log of 35 days
    mkdir(folder_.c_str(), 0755);
    if (mount("tmpfs", folder_.c_str(), "tmpfs", 0, fmt::format("size={}", kBytes).c_str()) != 0) {
      fail("{}: no small disk can be mounted here: that needs root", folder_);
    }
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  ~SmallDisk() { umount2(folder_.c_str(), MNT_DETACH); }
  void fill() const {
    std::ofstream file(folder_ + "/filler", std::ios::binary);
    const std::string block(4'096, 'x');
    while (file.write(block.data(), static_cast<std::streamsize>(block.size())).flush()) continue;
  }

 private:
  std::string folder_;
};

}  // namespace bess
