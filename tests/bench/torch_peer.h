// PyTorch peer process (c51_torch.py) in its fastest configuration: memory kept between steps, one
// thread pool, and the OpenBLAS kernel that is fastest here. On some processors the default kernel
// costs a factor of two or more.
#pragma once

#include <sys/types.h>

#include <cstdio>
#include <memory>
#include <optional>
#include <string>

namespace bess {

class TorchPeer {
 public:
  /// Starts PyTorch with each kernel and keeps the fastest; prints each time, or why there is no
  /// comparison, to standard error.
  explicit TorchPeer(int threads);
  ~TorchPeer();

  /// Milliseconds of one step, or nothing if PyTorch is missing.
  std::optional<double> step_ms();
  /// The matrix library with its kernel: "OpenBLAS 0.3.21, kernel Zen", or a note that it is not
  /// optimised. Empty if PyTorch is missing.
  [[nodiscard]] const std::string& blas() const { return blas_; }

 private:
  class Process;
  std::unique_ptr<Process> process_;
  std::string blas_;
};

}  // namespace bess
