// PyTorch's gradient step (c51_torch.py) as a process beside the benchmark, set up for its best: its
// memory not given back to the system between steps, one pool of threads.
#pragma once

#include <sys/types.h>

#include <cstdio>
#include <optional>

namespace bess {

class TorchPeer {
 public:
  explicit TorchPeer(int threads);
  TorchPeer(const TorchPeer&) = delete;
  TorchPeer& operator=(const TorchPeer&) = delete;
  ~TorchPeer();

  /// Milliseconds of one step, or nothing where PyTorch is missing (said once on standard error).
  std::optional<double> step_ms();

 private:
  pid_t process_ = -1;
  std::FILE* requests_ = nullptr;
  std::FILE* answers_ = nullptr;
};

}  // namespace bess
