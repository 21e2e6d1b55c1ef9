// The paper's experience: epsilon-greedy days from a uniform initial SoC, into a ring of
// transitions. Days are acted in lock-step, many at once with the weights of that moment, because
// one forward pass over 32 columns costs little more than one over a single column.
#pragma once

#include <vector>

#include "workstation/base/binary_file.h"
#include "workstation/rl/experience.h"
#include "workstation/rl/teacher.h"

namespace bess {

class Replay {
 public:
  Replay(const TrainingMarket& market, std::size_t capacity)
      : market_(market), capacity_(capacity) {}

  /// Plays `days` days drawn with replacement, exploring with probability epsilon.
  void play(const Teacher& teacher, std::size_t days, double epsilon, Random& random);

  /// A minibatch of `count` transitions drawn with replacement.
  void draw(std::size_t count, Random& random, MiniBatch& batch);

  /// In the order of the ring's slots.
  [[nodiscard]] const std::vector<Transition>& transitions() const { return ring_; }

  void save(BinaryWriter& out) const;
  /// Throws UserError when the ring in the file does not fit this one.
  void restore(BinaryReader& in);

 private:
  void store(const Transition& transition);

  const TrainingMarket& market_;
  std::size_t capacity_;
  std::size_t next_ = 0;  ///< slot that the next transition overwrites once the ring is full
  std::vector<Transition> ring_;
  std::vector<std::uint32_t> drawn_;  ///< slots of the last minibatch
};

}  // namespace bess
