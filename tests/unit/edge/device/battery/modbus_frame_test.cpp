// Modbus frames: the bytes of a request against literals from the standard, and every possible
// difference of a reply from its request.
#include "edge/device/battery/modbus_frame.h"

#include <gtest/gtest.h>

#include <vector>

namespace bess {
namespace {

using Bytes = std::vector<int>;

constexpr std::uint16_t kValues[] = {0x0001, 0xFA24};
constexpr ModbusRequest kRead{.unit = 85, .address = 0x0102, .count = 2, .transaction = 0x1234};
constexpr ModbusRequest kWriteOne{
    .unit = 85, .function = 6, .address = 0x0880, .values = kValues, .transaction = 0x1234};
constexpr ModbusRequest kWriteMany{.unit = 85,
                                   .function = 16,
                                   .address = 0x0880,
                                   .count = 2,
                                   .values = kValues,
                                   .transaction = 0x1234};

Bytes request_bytes(Framing framing, const ModbusRequest& request) {
  ModbusFrame frame;
  build_request(framing, request, frame);
  return {frame.bytes, frame.bytes + frame.size};
}

ModbusFrame frame_of(const Bytes& bytes) {
  ModbusFrame frame;
  for (const int byte : bytes) frame.bytes[frame.size++] = static_cast<std::uint8_t>(byte);
  return frame;
}

TEST(ModbusFrame, RequestsAreTheStandardsBytes) {
  EXPECT_EQ(request_bytes(Framing::kTcp, kRead),
            (Bytes{0x12, 0x34, 0, 0, 0, 6, 85, 3, 0x01, 0x02, 0, 2}));
  EXPECT_EQ(request_bytes(Framing::kTcp, kWriteOne),
            (Bytes{0x12, 0x34, 0, 0, 0, 6, 85, 6, 0x08, 0x80, 0, 1}));
  EXPECT_EQ(request_bytes(Framing::kTcp, kWriteMany),
            (Bytes{0x12, 0x34, 0, 0, 0, 11, 85, 16, 0x08, 0x80, 0, 2, 4, 0, 1, 0xFA, 0x24}));
  // The classic example: unit 1, one register from 0, has CRC 0x0A84, low byte first.
  EXPECT_EQ(request_bytes(Framing::kRtu, {.unit = 1, .address = 0, .count = 1}),
            (Bytes{1, 3, 0, 0, 0, 1, 0x84, 0x0A}));
}

TEST(ModbusFrame, WhatTheProtocolCannotCarryIsNotValid) {
  EXPECT_TRUE((ModbusRequest{.address = 0xFFFF, .count = 1}.is_valid()));
  EXPECT_TRUE((ModbusRequest{.count = 125}.is_valid()));
  EXPECT_TRUE((ModbusRequest{.function = 16, .count = 123}.is_valid()));
  EXPECT_FALSE((ModbusRequest{.address = 0xFFFF, .count = 2}.is_valid()));
  EXPECT_FALSE((ModbusRequest{.count = 126}.is_valid()));
  EXPECT_FALSE((ModbusRequest{.count = 0}.is_valid()));
  EXPECT_FALSE((ModbusRequest{.function = 16, .count = 124}.is_valid()));
  EXPECT_FALSE((ModbusRequest{.function = 6, .count = 2}.is_valid()));
  EXPECT_FALSE((ModbusRequest{.function = 5}.is_valid()));
  EXPECT_FALSE((ModbusRequest{.unit = 256}.is_valid()));
  EXPECT_FALSE((ModbusRequest{.unit = -1}.is_valid()));
}

struct ReplyCase {
  const char* what;
  const ModbusRequest& request;
  Bytes reply;
  Status status;
  int exception = 0;
};

TEST(ModbusFrame, ATcpReplyMustRepeatWhatWasAsked) {
  using enum Status;
  const ReplyCase cases[] = {
      {"read", kRead, {0x12, 0x34, 0, 0, 0, 7, 85, 3, 4, 1, 2, 3, 4}, kOk},
      {"write one", kWriteOne, {0x12, 0x34, 0, 0, 0, 6, 85, 6, 8, 0x80, 0, 1}, kOk},
      {"write many", kWriteMany, {0x12, 0x34, 0, 0, 0, 6, 85, 16, 8, 0x80, 0, 2}, kOk},
      {"busy", kRead, {0x12, 0x34, 0, 0, 0, 3, 85, 0x83, 6}, kBusBusy, 6},
      {"at work", kWriteOne, {0x12, 0x34, 0, 0, 0, 3, 85, 0x86, 5}, kBusBusy, 5},
      {"denied", kRead, {0x12, 0x34, 0, 0, 0, 3, 85, 0x83, 0x80}, kNotPermitted, 0x80},
      {"no address", kRead, {0x12, 0x34, 0, 0, 0, 3, 85, 0x83, 2}, kBusException, 2},
      {"transaction", kRead, {0x12, 0x35, 0, 0, 0, 7, 85, 3, 4, 1, 2, 3, 4}, kBadReply},
      {"protocol, low", kRead, {0x12, 0x34, 0, 1, 0, 7, 85, 3, 4, 1, 2, 3, 4}, kBadReply},
      {"protocol, high", kRead, {0x12, 0x34, 1, 0, 0, 7, 85, 3, 4, 1, 2, 3, 4}, kBadReply},
      {"unit", kRead, {0x12, 0x34, 0, 0, 0, 7, 7, 3, 4, 1, 2, 3, 4}, kBadReply},
      {"unit of exception", kRead, {0x12, 0x34, 0, 0, 0, 3, 7, 0x83, 6}, kBadReply},
      {"function", kRead, {0x12, 0x34, 0, 0, 0, 7, 85, 4, 4, 1, 2, 3, 4}, kBadReply},
      {"other exception", kRead, {0x12, 0x34, 0, 0, 0, 3, 85, 0x90, 6}, kBadReply},
      {"fewer", kRead, {0x12, 0x34, 0, 0, 0, 5, 85, 3, 2, 1, 2}, kBadReply},
      {"more", kRead, {0x12, 0x34, 0, 0, 0, 9, 85, 3, 6, 1, 2, 3, 4, 5, 6}, kBadReply},
      {"count", kRead, {0x12, 0x34, 0, 0, 0, 7, 85, 3, 2, 1, 2, 3, 4}, kBadReply},
      {"truncated", kRead, {0x12, 0x34, 0, 0, 0, 7, 85, 3, 4, 1, 2}, kBadReply},
      {"trailing", kRead, {0x12, 0x34, 0, 0, 0, 7, 85, 3, 4, 1, 2, 3, 4, 5}, kBadReply},
      {"echoed address", kWriteMany, {0x12, 0x34, 0, 0, 0, 6, 85, 16, 8, 0x81, 0, 2}, kBadReply},
      {"echoed count", kWriteMany, {0x12, 0x34, 0, 0, 0, 6, 85, 16, 8, 0x80, 0, 1}, kBadReply},
      {"echoed address", kWriteOne, {0x12, 0x34, 0, 0, 0, 6, 85, 6, 9, 0x80, 0, 1}, kBadReply},
      {"echoed value", kWriteOne, {0x12, 0x34, 0, 0, 0, 6, 85, 6, 8, 0x80, 0, 0}, kBadReply},
      {"nothing", kRead, {}, kBadReply},
  };
  for (const ReplyCase& c : cases) {
    std::uint16_t registers[2] = {0xDEAD, 0xDEAD};
    const ReplyCheck check = check_reply(Framing::kTcp, c.request, frame_of(c.reply), registers);
    EXPECT_EQ(check.status, c.status) << c.what;
    EXPECT_EQ(check.exception, c.exception) << c.what;
    const bool filled = c.status == kOk && !c.request.is_write();
    EXPECT_EQ(registers[0], filled ? 0x0102 : 0xDEAD) << c.what;
    EXPECT_EQ(registers[1], filled ? 0x0304 : 0xDEAD) << c.what;
  }
}

TEST(ModbusFrame, AnRtuReplyMustFitAndHaveItsCrc) {
  const ModbusRequest request{.unit = 1, .address = 0, .count = 1};
  const Bytes good{1, 3, 2, 0, 5, 0x78, 0x47};
  std::uint16_t value = 0;
  EXPECT_EQ(check_reply(Framing::kRtu, request, frame_of(good), &value).status, Status::kOk);
  EXPECT_EQ(value, 5);
  for (std::size_t i = 0; i < good.size(); ++i) {
    Bytes spoilt = good;
    spoilt[i] ^= 1;
    EXPECT_EQ(check_reply(Framing::kRtu, request, frame_of(spoilt), &value).status,
              Status::kBadReply)
        << i;
  }
}

TEST(ModbusFrame, WaitsForTheReplysOwnLengthAndNeverForMoreThanAFrame) {
  const auto missing = [](Framing framing, const Bytes& so_far) {
    return missing_bytes(framing, kRead, frame_of(so_far));
  };
  EXPECT_EQ(missing(Framing::kTcp, {}), 6);
  EXPECT_EQ(missing(Framing::kTcp, {0x12, 0x34, 0, 0, 0, 7}), 7);
  EXPECT_EQ(missing(Framing::kTcp, {0x12, 0x34, 0, 0, 0, 254}), 254);
  EXPECT_EQ(missing(Framing::kTcp, {0x12, 0x34, 0, 0, 0, 255}), -1);
  EXPECT_EQ(missing(Framing::kTcp, {0x12, 0x34, 0, 0, 0xFF, 0xFF}), -1);
  EXPECT_EQ(missing(Framing::kTcp, {0x12, 0x34, 0, 0, 0, 2}), -1);
  EXPECT_EQ(missing(Framing::kRtu, {}), 5);
  EXPECT_EQ(missing(Framing::kRtu, {85, 3, 4, 1, 2}), 4);
  EXPECT_EQ(missing(Framing::kRtu, {85, 0x83, 6, 1, 2}), 0);
  EXPECT_EQ(missing(Framing::kRtu, {85, 16, 4, 1, 2}), -1);  // another answer, or noise
}

}  // namespace
}  // namespace bess
