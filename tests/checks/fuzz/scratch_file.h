// File in memory for readers that take a path; the folder next to it can hold links.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

namespace bess {

class ScratchFile {
 public:
  explicit ScratchFile(const char* name) {
    char folder[] = "/dev/shm/bess_fuzz_XXXXXX";
    if (mkdtemp(folder) == nullptr) std::abort();
    folder_ = folder;
    path_ = folder_ / name;
  }
  ~ScratchFile() {
    std::error_code error;
    std::filesystem::remove_all(folder_, error);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// Path of the file, now holding `contents`.
  std::string holding(std::string_view contents) const {
    const int fd = open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (fd < 0 ||
        write(fd, contents.data(), contents.size()) != static_cast<ssize_t>(contents.size())) {
      std::abort();
    }
    close(fd);
    return path_.string();
  }

 private:
  std::filesystem::path folder_, path_;
};

}  // namespace bess
