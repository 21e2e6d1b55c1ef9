// What buying and selling a MWh costs beside its price: grid fees, taxes, the supplier's margin.
// The two directions differ, so a price alone no longer says what an exchange is worth:
//   import price = price + adder + percent of |price|
//   export price = price - fee   - percent of |price|
// A percentage is of the price's size, never of its sign: it always costs. At -100 EUR/MWh and 5 %
// one is paid 95 for taking a MWh and pays 105 for giving one. (Taken of the signed price it would
// add to what one is paid for taking: a fee that turns into a gift is no supplier's contract.)
#pragma once

namespace bess {

struct TradingCosts {
  double import_adder_eur_per_mwh = 0;
  double import_percent = 0;  ///< of |price|
  double export_fee_eur_per_mwh = 0;
  double export_percent = 0;  ///< of |price|

  /// What a MWh taken from the grid costs at this price.
  [[nodiscard]] constexpr double import_eur_per_mwh(double price_eur_per_mwh) const {
    return price_eur_per_mwh +
           (import_adder_eur_per_mwh + import_percent / 100 * size_of(price_eur_per_mwh));
  }
  /// What a MWh given to the grid earns.
  [[nodiscard]] constexpr double export_eur_per_mwh(double price_eur_per_mwh) const {
    return price_eur_per_mwh -
           (export_fee_eur_per_mwh + export_percent / 100 * size_of(price_eur_per_mwh));
  }

 private:
  static constexpr double size_of(double price) { return price < 0 ? -price : price; }
};

}  // namespace bess
