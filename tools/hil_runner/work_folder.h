// Where the files of a run lie while it goes on: below the system's folder for temporary files, removed at
// the end unless they are to be kept.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <string>

#include "shared/host/user_error.h"

namespace bess {

class WorkFolder {
 public:
  WorkFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "bess-hil-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) fail("{}: cannot make this folder", name);
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
