#include "tests/bench/torch_peer.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

namespace bess {
namespace {

constexpr const char* kScript = BESS_SOURCE_DIR "/tests/bench/c51_torch.py";
constexpr std::string_view kReady = "ready ";
constexpr int kTrials = 5;

/// OpenBLAS kernels for processors with AVX, by their names in OPENBLAS_CORETYPE; "" is its own
/// choice. A kernel that this processor cannot run ends the process.
constexpr const char* kKernels[] = {"",         "Sandybridge", "Haswell",       "Zen",
                                    "SkylakeX", "Cooperlake",  "SapphireRapids"};

/// Fastest settings of PyTorch on Debian: the malloc settings keep its memory between steps; with
/// libopenblas0-openmp, BLAS and PyTorch share one pool, with the pthread build two pools spin
/// against each other.
std::vector<std::string> command(int threads, const std::string& kernel) {
  const std::string count = std::to_string(threads);
  std::vector<std::string> words{"env", "-u", "OPENBLAS_CORETYPE"};
  if (!kernel.empty()) words.push_back("OPENBLAS_CORETYPE=" + kernel);
  words.insert(words.end(),
               {"OPENBLAS_NUM_THREADS=" + count, "OMP_NUM_THREADS=" + count,
                "MALLOC_MMAP_THRESHOLD_=4294967296", "MALLOC_TRIM_THRESHOLD_=8589934592",
                "MALLOC_TOP_PAD_=268435456", "/usr/bin/python3", kScript, count});
  return words;
}

}  // namespace

/// One PyTorch.
class TorchPeer::Process {
 public:
  Process(int threads, const std::string& kernel) {
    int request[2];
    int answer[2];
    // Closed on exec, or a second peer would keep the first one's request pipe open.
    if (pipe2(request, O_CLOEXEC) != 0 || pipe2(answer, O_CLOEXEC) != 0) return;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, request[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, answer[1], STDOUT_FILENO);
    std::vector<std::string> words = command(threads, kernel);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (posix_spawnp(&id_, "env", &actions, nullptr, arguments.data(), environ) != 0) id_ = -1;
    posix_spawn_file_actions_destroy(&actions);
    close(request[0]);
    close(answer[1]);
    requests_ = fdopen(request[1], "w");
    answers_ = fdopen(answer[0], "r");
    char line[200] = "";
    if (std::fgets(line, sizeof line, answers_) != nullptr) said_ = line;
    while (said_.ends_with('\n')) said_.pop_back();
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process() {
    if (requests_ != nullptr) std::fclose(requests_);
    if (answers_ != nullptr) std::fclose(answers_);
    if (id_ > 0) waitpid(id_, nullptr, 0);
  }

  [[nodiscard]] bool is_ready() const { return said_.starts_with(kReady); }
  /// The first line: its matrix library, or the reason why it does not work; empty if it died.
  [[nodiscard]] std::string said() const {
    return is_ready() ? said_.substr(kReady.size()) : said_;
  }
  std::optional<double> step_ms() {
    double ms = 0;
    std::fputs("step\n", requests_);
    std::fflush(requests_);
    if (std::fscanf(answers_, "%lf", &ms) != 1) return {};
    return ms;
  }

 private:
  pid_t id_ = -1;
  std::FILE* requests_ = nullptr;
  std::FILE* answers_ = nullptr;
  std::string said_;
};

TorchPeer::TorchPeer(int threads) {
  std::signal(SIGPIPE, SIG_IGN);
  double best_ms = std::numeric_limits<double>::infinity();
  std::vector<std::string> tried;
  for (const char* kernel : kKernels) {
    auto process = std::make_unique<Process>(threads, kernel);
    if (!process->is_ready()) {
      if (*kernel != '\0') continue;  // this processor lacks the kernel's instructions
      const std::string why = process->said();
      fmt::print(stderr, "bess-bench: no PyTorch to compare with: {}\n",
                 why.empty() ? "python3 does not start" : why);
      return;
    }
    // Two names may mean one kernel, and a BLAS without kernels has only one: run it once.
    if (std::ranges::find(tried, process->said()) != tried.end()) continue;
    tried.push_back(process->said());
    double fastest_ms = std::numeric_limits<double>::infinity();
    for (int trial = 0; trial < kTrials; ++trial) {
      fastest_ms = std::min(fastest_ms, process->step_ms().value_or(fastest_ms));
    }
    fmt::print(stderr, "bess-bench: PyTorch, {} thread{}, {}{}: {:.1f} ms\n", threads,
               threads == 1 ? "" : "s", process->said(), *kernel == '\0' ? " (its own choice)" : "",
               fastest_ms);
    if (fastest_ms >= best_ms) continue;
    best_ms = fastest_ms;
    blas_ = process->said();
    process_ = std::move(process);
  }
}

TorchPeer::~TorchPeer() = default;

std::optional<double> TorchPeer::step_ms() { return process_ ? process_->step_ms() : std::nullopt; }

}  // namespace bess
