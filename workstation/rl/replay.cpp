#include "workstation/rl/replay.h"

#include <algorithm>

namespace bess {

void Replay::store(const Transition& transition) {
  if (ring_.size() < capacity_) {
    ring_.push_back(transition);
    return;
  }
  ring_[next_] = transition;
  next_ = (next_ + 1) % capacity_;
}

void Replay::play(const Teacher& teacher, std::size_t days, double epsilon, Random& random) {
  struct Episode {
    TrainingMarket::Day day;
    double soc_frac;
  };
  std::vector<Episode> episodes(days);
  std::size_t longest = 0;
  for (Episode& episode : episodes) {
    episode = {market_.days()[random.index(market_.days().size())], market_.draw_soc(random)};
    longest = std::max(longest, episode.day.count);
  }
  Matrix x = Matrix::Zero(kNetworkInputs, static_cast<Eigen::Index>(days));
  MlpTile tile;
  for (std::size_t step = 0; step < longest; ++step) {
    for (std::size_t e = 0; e < days; ++e) {
      const std::size_t at = std::min(step, episodes[e].day.count - 1);
      write_input(market_.context(episodes[e].day.first + at), episodes[e].soc_frac,
                  x.col(static_cast<Eigen::Index>(e)).data());
    }
    const Matrix values = teacher.action_values(x, tile);
    for (std::size_t e = 0; e < days; ++e) {
      if (step >= episodes[e].day.count) continue;
      const Action greedy = argmax_action(values.col(static_cast<Eigen::Index>(e)).data());
      const bool explore = random.uniform() < epsilon;
      const Action action = explore ? static_cast<Action>(random.index(kActionCount)) : greedy;
      Transition transition{};
      episodes[e].soc_frac = market_.make_transition(episodes[e].day.first + step,
                                                     episodes[e].soc_frac, action, transition);
      store(transition);
    }
  }
}

void Replay::draw(std::size_t count, Random& random, MiniBatch& batch) {
  drawn_.resize(count);
  for (std::uint32_t& slot : drawn_) slot = static_cast<std::uint32_t>(random.index(ring_.size()));
  fill_minibatch(ring_, drawn_, batch);
}

void Replay::save(BinaryWriter& out) const {
  out.put(static_cast<std::uint64_t>(next_));
  out.put_list(ring_);
}

void Replay::restore(BinaryReader& in) {
  next_ = in.take<std::uint64_t>();
  ring_ = in.take_list<Transition>();
  const bool full = ring_.size() == capacity_;
  if (ring_.size() > capacity_ || (full ? next_ >= capacity_ : next_ != 0)) {
    in.damaged("holds a replay ring of another size");
  }
}

}  // namespace bess
