// What may be ordered by a broker, as commands of bess-edge.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "edge/companion/orders.h"

namespace bess {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

TEST(CompanionOrders, AreCommandsOfBessEdge) {
  EXPECT_THAT(read_order({{"order", "hold"}, {"power_w", "-2000"}, {"minutes", "90"}}).words,
              ElementsAre("hold", "-2000", "--for", "90m"));
  EXPECT_THAT(read_order({{"order", "release"}}).words, ElementsAre("hold", "--release"));
  EXPECT_THAT(read_order({{"order", "limit"}, {"charge_w", "0"}, {"minutes", "15"}}).words,
              ElementsAre("limit", "--charge", "0", "--for", "15m"));
  EXPECT_THAT(
      read_order({{"order", "limit"}, {"charge_w", "1"}, {"discharge_w", "2"}, {"minutes", "1"}})
          .words,
      ElementsAre("limit", "--charge", "1", "--discharge", "2", "--for", "1m"));
  EXPECT_THAT(read_order({{"order", "unlimit"}}).words, ElementsAre("limit", "--clear"));
  EXPECT_THAT(read_order({{"order", "clear"}}).words, ElementsAre("clear", "--yes"));
}

TEST(CompanionOrders, WhatIsNoneIsRefused) {
  const OrderFields bad[] = {
      {},
      {{"order", "commission"}},
      {{"order", "hold"}},
      {{"order", "hold"}, {"power_w", "--yes"}, {"minutes", "5"}},
      {{"order", "hold"}, {"power_w", "5 "}, {"minutes", "5"}},
      {{"order", "hold"}, {"power_w", "5.5"}, {"minutes", "5"}},
      {{"order", "hold"}, {"power_w", "99999999999999999999"}, {"minutes", "5"}},
      {{"order", "hold"}, {"power_w", "5"}, {"minutes", "1"}},
      {{"order", "hold"}, {"power_w", "5"}, {"minutes", "10081"}},
      {{"order", "hold"}, {"power_w", "5"}, {"minutes", "5m; reboot"}},
      {{"order", "limit"}, {"minutes", "5"}},
      {{"order", "limit"}, {"charge_w", "-1"}, {"minutes", "5"}},
      {{"order", "limit"}, {"charge_w", "5"}},
  };
  for (const OrderFields& fields : bad) {
    const Order order = read_order(fields);
    EXPECT_THAT(order.words, IsEmpty());
    EXPECT_THAT(order.complaint, Not(IsEmpty()));
  }
}

}  // namespace
}  // namespace bess
