// PyTorch's gradient step (c51_torch.py) as a process beside the benchmark, set up for its best:
// its memory not given back to the system between steps, one pool of threads, and of the matrix
// kernels that its OpenBLAS has the one that is fastest here. On some processors the one that
// OpenBLAS picks by itself costs it a factor of two and more.
#pragma once

#include <sys/types.h>

#include <cstdio>
#include <memory>
#include <optional>
#include <string>

namespace bess {

class TorchPeer {
 public:
  /// Starts PyTorch with each kernel in turn and keeps the fastest; says on standard error what
  /// each took, or why there is nothing to compare with.
  explicit TorchPeer(int threads);
  ~TorchPeer();

  /// Milliseconds of one step, or nothing where PyTorch is missing.
  std::optional<double> step_ms();
  /// The library that multiplies its matrices, with its kernel: "OpenBLAS 0.3.21, kernel Zen".
  /// Without an optimised one it says so. Empty where PyTorch is missing.
  [[nodiscard]] const std::string& blas() const { return blas_; }

 private:
  class Process;
  std::unique_ptr<Process> process_;
  std::string blas_;
};

}  // namespace bess
