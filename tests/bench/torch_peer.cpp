#include "tests/bench/torch_peer.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <string>
#include <vector>

namespace bess {
namespace {

constexpr const char* kScript = BESS_SOURCE_DIR "/tests/bench/c51_torch.py";

/// What makes PyTorch on Debian fastest: the malloc settings keep its memory between steps; with
/// libopenblas0-openmp BLAS and PyTorch share one pool, with the pthread build two pools spin against
/// each other.
std::vector<std::string> command(int threads) {
  const std::string count = std::to_string(threads);
  return {"env",
          "-u",
          "OPENBLAS_CORETYPE",
          "OPENBLAS_NUM_THREADS=" + count,
          "OMP_NUM_THREADS=" + count,
          "MALLOC_MMAP_THRESHOLD_=4294967296",
          "MALLOC_TRIM_THRESHOLD_=8589934592",
          "MALLOC_TOP_PAD_=268435456",
          "/usr/bin/python3",
          kScript,
          count};
}

}  // namespace

TorchPeer::TorchPeer(int threads) {
  std::signal(SIGPIPE, SIG_IGN);
  int request[2];
  int answer[2];
  // Closed on exec, or a second peer would hold the first one's requests open for ever.
  if (pipe2(request, O_CLOEXEC) != 0 || pipe2(answer, O_CLOEXEC) != 0) return;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, request[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, answer[1], STDOUT_FILENO);
  std::vector<std::string> words = command(threads);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  if (posix_spawnp(&process_, "env", &actions, nullptr, arguments.data(), environ) != 0)
    process_ = -1;
  posix_spawn_file_actions_destroy(&actions);
  close(request[0]);
  close(answer[1]);
  requests_ = fdopen(request[1], "w");
  answers_ = fdopen(answer[0], "r");
  char line[200] = "python3 does not start\n";
  if (std::fgets(line, sizeof line, answers_) == nullptr || std::strcmp(line, "ready\n") != 0) {
    std::fprintf(stderr, "bess-bench: no PyTorch to compare with: %s", line);
    std::fclose(requests_);
    requests_ = nullptr;
  }
}

TorchPeer::~TorchPeer() {
  if (requests_ != nullptr) std::fclose(requests_);
  if (answers_ != nullptr) std::fclose(answers_);
  if (process_ > 0) waitpid(process_, nullptr, 0);
}

std::optional<double> TorchPeer::step_ms() {
  if (requests_ == nullptr) return {};
  double ms = 0;
  std::fputs("step\n", requests_);
  std::fflush(requests_);
  if (std::fscanf(answers_, "%lf", &ms) != 1) return {};
  return ms;
}

}  // namespace bess
