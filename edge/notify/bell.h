// A bell between threads: rung by any, heard by whoever polls its descriptor beside others.
#pragma once

#include <sys/eventfd.h>
#include <unistd.h>

#include <cstdint>

#include "shared/file_descriptor.h"

namespace bess {

class Bell {
 public:
  void ring() const {
    const std::uint64_t one = 1;
    static_cast<void>(!write(fd_.get(), &one, sizeof one));  // full: it rings already
  }
  /// Silent until it is rung again.
  void hush() const {
    std::uint64_t times = 0;
    static_cast<void>(!read(fd_.get(), &times, sizeof times));
  }
  /// Readable while it rings.
  [[nodiscard]] int fd() const { return fd_.get(); }

 private:
  FileDescriptor fd_{eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};
};

}  // namespace bess
