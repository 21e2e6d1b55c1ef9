#include "workstation/correction/student/certificate.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <utility>

#include "workstation/base/parallel_for.h"
#include "workstation/base/progress.h"

namespace bess {
namespace {

/// Boxes with at most this many states are evaluated one by one: a bound costs as much as a few
/// states.
constexpr int kSmallBox = 6;

struct Box {
  int soc_begin, soc_end, price_begin, price_end;  ///< half-open, lattice indices
  [[nodiscard]] int size() const { return (soc_end - soc_begin) * (price_end - price_begin); }
};

/// Interval of `kCount` values, stored in both orders so that a bound is one dot product.
template <int kCount>
struct Interval {
  std::int16_t low_high[2 * kCount];  ///< all lower ends, then all upper ones
  std::int16_t high_low[2 * kCount];

  /// Activations for sums between `low` and `high`: a ReLU is monotone.
  void set(const ClippedRelu<kCount>& relu, const std::int32_t (&low)[kCount],
           const std::int32_t (&high)[kCount]) {
    for (int i = 0; i < kCount; ++i) {
      low_high[i] = high_low[kCount + i] = relu.rescale(low[i]);
      low_high[kCount + i] = high_low[i] = relu.rescale(high[i]);
    }
  }
};

/// Positive weights, then negative ones: the product with an interval's (low, high) ends is the
/// smallest weighted sum, with (high, low) the largest.
template <typename Weight, int kCount>
void split_by_sign(int i, Weight weight, Weight (&split)[2 * kCount]) {
  split[i] = std::max<Weight>(weight, 0);
  split[kCount + i] = std::min<Weight>(weight, 0);
}

template <typename Sum, typename Weight, int kCount>
Sum dot(const Weight (&weight)[kCount], const std::int16_t (&x)[kCount]) {
  Sum sum = 0;
  for (int i = 0; i < kCount; ++i) sum += Sum{weight[i]} * x[i];
  return sum;
}

/// First layer and its ReLU. Few inputs: the loop over the outputs vectorises.
struct Layer1Bounds {
  std::int32_t positive[kStudentInputs][kStudentHidden1];
  std::int32_t negative[kStudentInputs][kStudentHidden1];
  const StudentNet& net;

  explicit Layer1Bounds(const StudentNet& student) : net(student) {
    for (int i = 0; i < kStudentInputs; ++i) {
      for (int o = 0; o < kStudentHidden1; ++o) {
        positive[i][o] = std::max<std::int32_t>(net.layer1.weight[i][o], 0);
        negative[i][o] = std::min<std::int32_t>(net.layer1.weight[i][o], 0);
      }
    }
  }
  void bound(const std::int16_t (&x_low)[kStudentInputs],
             const std::int16_t (&x_high)[kStudentInputs], Interval<kStudentHidden1>& y) const {
    std::int32_t low[kStudentHidden1];
    std::int32_t high[kStudentHidden1];
    for (int o = 0; o < kStudentHidden1; ++o) low[o] = high[o] = net.layer1.bias[o];
    for (int i = 0; i < kStudentInputs; ++i) {
      const std::int32_t l = x_low[i];
      const std::int32_t h = x_high[i];
      for (int o = 0; o < kStudentHidden1; ++o) {
        low[o] += positive[i][o] * l + negative[i][o] * h;
        high[o] += positive[i][o] * h + negative[i][o] * l;
      }
    }
    y.set(net.relu1, low, high);
  }
};

/// Second layer and its ReLU. Many inputs: the loop over the inputs vectorises, two products at a
/// time.
struct Layer2Bounds {
  std::int16_t weight[kStudentHidden2][2 * kStudentHidden1];  ///< split by sign
  const StudentNet& net;

  explicit Layer2Bounds(const StudentNet& student) : net(student) {
    for (int i = 0; i < kStudentHidden1; ++i) {
      for (int o = 0; o < kStudentHidden2; ++o) {
        split_by_sign<std::int16_t, kStudentHidden1>(i, net.layer2.weight[i][o], weight[o]);
      }
    }
  }
  void bound(const Interval<kStudentHidden1>& x, Interval<kStudentHidden2>& y) const {
    std::int32_t low[kStudentHidden2];
    std::int32_t high[kStudentHidden2];
    for (int o = 0; o < kStudentHidden2; ++o) {
      low[o] = net.layer2.bias[o] + dot<std::int32_t>(weight[o], x.low_high);
      high[o] = net.layer2.bias[o] + dot<std::int32_t>(weight[o], x.high_low);
    }
    y.set(net.relu2, low, high);
  }
};

/// Decides boxes of one net. Immutable, so threads share it.
class BoxBounds {
 public:
  explicit BoxBounds(const StudentNet& net) : net_(net), layer1_(net), layer2_(net) {
    for (int c = 0; c < kActionCount; ++c) {
      for (int other = 0; other < kActionCount; ++other) {
        lead_bias_[c][other] = std::int64_t{net.layer3.bias[c]} - net.layer3.bias[other];
        for (int i = 0; i < kStudentHidden2; ++i) {
          const auto& weight = net.layer3.weight[i];
          split_by_sign<std::int32_t, kStudentHidden2>(i, std::int32_t{weight[c]} - weight[other],
                                                       lead_weight_[c][other]);
        }
      }
    }
  }

  /// True if every state of the box has the same action, returned in `action`.
  bool single_action(const LatticeState& low_corner, const LatticeState& high_corner,
                     Action& action) const {
    std::int16_t x_low[kStudentInputs];
    std::int16_t x_high[kStudentInputs];
    net_.quantise(low_corner, x_low);
    net_.quantise(high_corner, x_high);
    Interval<kStudentHidden1> hidden1;
    Interval<kStudentHidden2> hidden2;
    layer1_.bound(x_low, x_high, hidden1);
    layer2_.bound(hidden1, hidden2);
    for (const Action candidate : {Action::kCharge, Action::kIdle, Action::kDischarge}) {
      if (wins(candidate, hidden2)) {
        action = candidate;
        return true;
      }
    }
    return false;
  }

 private:
  /// Whether `candidate` beats both others for all hidden activations inside the bounds, by the
  /// smallest possible difference of logits; ties go to the lower action as in argmax_action.
  [[nodiscard]] bool wins(Action candidate, const Interval<kStudentHidden2>& hidden) const {
    const int c = static_cast<int>(candidate);
    for (int other = 0; other < kActionCount; ++other) {
      if (other == c) continue;
      const std::int64_t least =
          lead_bias_[c][other] + dot<std::int64_t>(lead_weight_[c][other], hidden.low_high);
      const bool beats = other > c ? least >= 0 : least > 0;
      if (!beats) return false;
    }
    return true;
  }

  const StudentNet& net_;
  Layer1Bounds layer1_;
  Layer2Bounds layer2_;
  /// Logit difference of two actions: weights of the last layer, split by sign.
  std::int32_t lead_weight_[kActionCount][kActionCount][2 * kStudentHidden2];
  std::int64_t lead_bias_[kActionCount][kActionCount];
};

/// Fills the action grid of one context.
class GridFiller {
 public:
  GridFiller(const StudentNet& net, const BoxBounds& bounds) : net_(net), bounds_(bounds) {}

  std::int64_t fill(const LatticeState& context, bool exhaustive, std::vector<std::int8_t>& grid) {
    state_ = context;
    grid.resize(static_cast<std::size_t>(kSocCount) * kPriceCount);
    grid_ = grid.data();
    evaluated_ = 0;
    const Box whole{0, kSocCount, 0, kPriceCount};
    if (exhaustive) {
      evaluate(whole);
    } else {
      fill_box(whole);
    }
    return evaluated_;
  }

 private:
  [[nodiscard]] LatticeState state_at(int soc, int price) const {
    return at_indices(state_, soc, price);
  }
  /// Flattened: inlines the net with this file's optimisation. A separate function might be linked
  /// from a test program's unoptimised copy.
  [[gnu::flatten]] void evaluate(const Box& box) {
    for (int s = box.soc_begin; s < box.soc_end; ++s) {
      for (int p = box.price_begin; p < box.price_end; ++p) {
        grid_[s * kPriceCount + p] = static_cast<std::int8_t>(net_.decide(state_at(s, p)));
      }
    }
    evaluated_ += box.size();
  }
  void fill_box(const Box& box) {
    if (box.size() <= kSmallBox) {
      evaluate(box);
      return;
    }
    Action action{};
    if (bounds_.single_action(state_at(box.soc_begin, box.price_begin),
                              state_at(box.soc_end - 1, box.price_end - 1), action)) {
      for (int s = box.soc_begin; s < box.soc_end; ++s) {
        std::fill_n(grid_ + s * kPriceCount + box.price_begin, box.price_end - box.price_begin,
                    static_cast<std::int8_t>(action));
      }
      return;
    }
    halve(box);
  }
  /// Halves the side that spans more of its input's range.
  void halve(const Box& box) {
    const int socs = box.soc_end - box.soc_begin;
    const int prices = box.price_end - box.price_begin;
    const int price_span = net_.price_map[box.price_end - 1] - net_.price_map[box.price_begin];
    Box first = box;
    Box second = box;
    if (prices > 1 && (socs == 1 || price_span >= (socs - 1) * kSocScale)) {
      first.price_end = second.price_begin = box.price_begin + prices / 2;
    } else {
      first.soc_end = second.soc_begin = box.soc_begin + socs / 2;
    }
    fill_box(first);
    fill_box(second);
  }

  const StudentNet& net_;
  const BoxBounds& bounds_;
  LatticeState state_{};
  std::int8_t* grid_ = nullptr;
  std::int64_t evaluated_ = 0;
};

void thin_out(std::vector<LatticeState>& states, std::size_t count_max) {
  if (states.size() <= count_max) return;
  for (std::size_t i = 0; i < count_max; ++i) states[i] = states[i * states.size() / count_max];
  states.resize(count_max);
}

}  // namespace

LatticeState context_at(int index) {
  return lattice_context(index % kMinuteOfQuarterHourCount,
                         index / kMinuteOfQuarterHourCount % kQuarterHourCount,
                         index / (kMinuteOfQuarterHourCount * kQuarterHourCount) + 1);
}

std::int64_t fill_action_grid(const StudentNet& net, const LatticeState& context, bool exhaustive,
                              std::vector<std::int8_t>& grid) {
  const BoxBounds bounds(net);
  return GridFiller(net, bounds).fill(context, exhaustive, grid);
}

Certificate verify_student(const StudentNet& net, const VerifyOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const BoxBounds bounds(net);
  const int contexts = (kContextCount + options.context_stride - 1) / options.context_stride;
  Certificate total{.thresholds = options.thresholds, .rules = options.rules};
  const RuleSet demands = total.demands();
  std::vector<Certificate> parts(static_cast<std::size_t>(options.threads));
  std::atomic<int> done{0};
  Progress progress("verify", "contexts", contexts);
  parallel_for(parts.size(), options.threads, [&](std::size_t w) {
    const auto worker = static_cast<int>(w);
    Certificate& part = parts[w];
    GridFiller filler(net, bounds);
    RuleChecker checker(demands, net.context.kind);
    std::vector<ActionGrid> neighbours(checker.neighbours_needed().size());
    ActionGrid grid;
    for (int c = worker; c < contexts; c += options.threads) {
      const LatticeState context = context_at(c * options.context_stride);
      part.states_evaluated += filler.fill(context, options.exhaustive, grid);
      for (std::size_t n = 0; n < neighbours.size(); ++n) {
        const auto next = next_state(context, checker.neighbours_needed()[n]);
        neighbours[n].clear();
        if (next) filler.fill(*next, options.exhaustive, neighbours[n]);
      }
      checker.check(context, grid, neighbours);
      part.states_checked += std::int64_t{kSocCount} * kPriceCount;
      const int finished = ++done;
      if (worker == 0) progress.update(finished);
    }
    part.counts = checker.counts();
  });
  total.counts.resize(demands.rules.size());
  for (const Certificate& part : parts) {
    total.states_checked += part.states_checked;
    total.states_evaluated += part.states_evaluated;
    for (std::size_t d = 0; d < demands.rules.size(); ++d) total.counts[d].add(part.counts[d]);
  }
  total.counterexamples = std::exchange(total.counts.front().counterexamples, {});
  thin_out(total.counterexamples, options.counterexamples_max);
  for (const RuleCount& count : total.counts) {
    total.counterexamples.insert(total.counterexamples.end(), count.counterexamples.begin(),
                                 count.counterexamples.end());
  }
  total.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return total;
}

}  // namespace bess
