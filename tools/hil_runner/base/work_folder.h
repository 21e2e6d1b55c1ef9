// Work folder of a run, below the system's temporary folder; removed at the end unless kept.
#pragma once

#include <stdlib.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>

#include "shared/host/user_error.h"

namespace bess {

class WorkFolder {
 public:
  WorkFolder() {
    std::error_code error;
    const std::filesystem::path place = std::filesystem::temp_directory_path(error);
    if (error) fail("no temporary folder: set TMPDIR");
    std::string name = (place / "bess-hil-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      fail("{}: cannot create a work folder: {}", place.string(), std::strerror(errno));
    }
    path_ = name;
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  ~WorkFolder() {
    std::error_code ignored;
    if (!is_kept_) std::filesystem::remove_all(path_, ignored);
  }

  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }
  void keep() { is_kept_ = true; }

 private:
  std::filesystem::path path_;
  bool is_kept_ = false;
};

}  // namespace bess
