// A limit on equivalent full cycles by its shadow price: throughput beyond the limit is not worth
// more than lambda EUR/MWh, so a planner that counts lambda as extra wear keeps the limit by itself
// and saves its cycles for the hours that pay best, where one that knows nothing of it uses them up
// in the morning. Cycles fall with lambda, so bisection finds the smallest that suffices
// [Everett 1963, generalised Lagrange multipliers].
#pragma once

namespace bess {

inline constexpr double kShadowPriceMaxEurPerMwh = 5'000;
inline constexpr int kShadowPriceBisections = 16;  ///< to 0.1 EUR/MWh

/// The bracket of one limit's shadow price, narrowed by what a trial price leads to.
class ShadowPrice {
 public:
  /// To be tried next, EUR/MWh of throughput; 0 at first.
  [[nodiscard]] double trial() const { return tried_ ? 0.5 * (low_ + high_) : 0.0; }
  /// Once every bisection is done: keeps the limit.
  [[nodiscard]] double found() const { return high_; }
  /// Tells whether the last trial kept the limit.
  void learn(bool kept) {
    if (!tried_) {
      if (kept) high_ = 0;
      tried_ = true;
      return;
    }
    (kept ? high_ : low_) = 0.5 * (low_ + high_);
  }

 private:
  double low_ = 0;
  double high_ = kShadowPriceMaxEurPerMwh;
  bool tried_ = false;
};

}  // namespace bess
