// Thread team of fixed size that runs the same job on each member. Work is split by member index,
// so results depend on the team's size and never on timing.
#pragma once

#include <barrier>
#include <functional>
#include <thread>
#include <vector>

namespace bess {

class ThreadTeam {
 public:
  explicit ThreadTeam(int size) : size_(size), start_(size), finish_(size) {
    for (int i = 1; i < size; ++i) {
      threads_.emplace_back([this, i] { serve(i); });
    }
  }
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;
  ~ThreadTeam() {
    job_ = nullptr;
    start_.arrive_and_wait();
    for (std::thread& thread : threads_) thread.join();
  }

  [[nodiscard]] int size() const { return size_; }

  /// Runs job(0) here and job(1) .. job(size-1) on the other threads; waits for all. `job` must not
  /// throw.
  void run(const std::function<void(int)>& job) {
    job_ = &job;
    start_.arrive_and_wait();
    job(0);
    finish_.arrive_and_wait();
  }

 private:
  void serve(int index) {
    for (;;) {
      start_.arrive_and_wait();
      if (job_ == nullptr) return;
      (*job_)(index);
      finish_.arrive_and_wait();
    }
  }

  int size_;
  const std::function<void(int)>* job_ = nullptr;
  std::barrier<> start_;
  std::barrier<> finish_;
  std::vector<std::thread> threads_;
};

}  // namespace bess
